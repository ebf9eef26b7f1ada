# SPDX-License-Identifier: Apache-2.0
"""What a host does to a live body: grasp, push, cut, go back and forth, record, draw."""
from __future__ import annotations

import ctypes as c
from typing import Any, Sequence

import numpy as np

from . import _arrays, _c
from .errors import InputError, check

_lib = _c.library

TRIANGLE = np.dtype([("place", "i4"), ("nodes", "i4", 3), ("element", "i4"), ("piece", "i4"),
                     ("opened", "i4")])


class Live:
    """Of a Simulation. Set live=True in Scene.set_live() where nothing in the scene breaks."""

    handle: int

    def warm_up(self) -> None:
        """Before the first step: does once what a step does first. No result changes."""
        check(_lib.sunder_simulation_warm_up(self.handle))

    # ---- grips and pushes

    def grasp(self, nodes: Sequence[int] | None = None, *, near: Any = None,
              radius: float | None = None, rigid: bool = False) -> int:
        """Takes hold of `nodes`, ids (k,), or of all within `radius` [mm] of the place `near`, (3,)
        [mm], where they are now. rigid: as one solid, which may turn. Returns the grip's id."""
        grip = c.c_int32()
        if (nodes is None) == (near is None) or (near is None) != (radius is None):
            raise InputError("a grip takes nodes, or near with radius")
        if nodes is not None:
            ids = _arrays.ids(nodes, "nodes", (None,))
            check(_lib.sunder_simulation_grasp(self.handle, ids.ctypes.data, ids.size, int(bool(rigid)),
                                               c.byref(grip)))
        else:
            place = _arrays.reals(near, "near", (3,))
            check(_lib.sunder_simulation_grasp_near(self.handle, place.ctypes.data, radius,
                                                    int(bool(rigid)), c.byref(grip)))
        return grip.value

    def held_nodes(self, grip: int) -> np.ndarray:
        """(nodes,) int32 of a grip."""
        count = c.c_size_t()
        check(_lib.sunder_simulation_held_nodes(self.handle, grip, None, 0, c.byref(count)))
        nodes = np.empty(count.value, np.int32)
        check(_lib.sunder_simulation_held_nodes(self.handle, grip, nodes.ctypes.data, nodes.size,
                                                c.byref(count)))
        return nodes

    def grip_place(self, grip: int) -> np.ndarray:
        """(3,) [mm]: where a grip is."""
        place = np.empty(3)
        check(_lib.sunder_simulation_grip_place(self.handle, grip, place.ctypes.data))
        return place

    def pose(self, grip: int, position: Any, quaternion: Any = None) -> None:
        """Brings a grip to a place (3,) [mm] and a rotation since it took hold, a quaternion (4,)
        as x, y, z, w of any length, no unit, from the next step on."""
        place = _arrays.reals(position, "position", (3,))
        turn = None if quaternion is None else _arrays.reals(quaternion, "quaternion", (4,))
        check(_lib.sunder_simulation_pose(self.handle, grip, place.ctypes.data,
                                          None if turn is None else turn.ctypes.data))

    def wrench(self, grip: int) -> tuple[np.ndarray, np.ndarray]:
        """Force (3,) [N] and torque (3,) about the grip's place [N mm] on the body, of the last solve."""
        force, torque = np.empty(3), np.empty(3)
        check(_lib.sunder_simulation_wrench(self.handle, grip, force.ctypes.data, torque.ctypes.data))
        return force, torque

    def release(self, grip: int) -> None:
        """Lets go: from the next step on the body is as if it had never been held there. A grip of
        the scene lets go by its instrument's number."""
        check(_lib.sunder_simulation_release(self.handle, grip))

    def push(self, nodes: Sequence[int], force: Any) -> int:
        """A force (3,) [N] in equal parts on nodes, ids (k,), until it is dropped. Returns its id."""
        push = c.c_int32()
        ids, f = _arrays.ids(nodes, "nodes", (None,)), _arrays.reals(force, "force", (3,))
        check(_lib.sunder_simulation_push(self.handle, ids.ctypes.data, ids.size, f.ctypes.data,
                                          c.byref(push)))
        return push.value

    def move(self, push: int, nodes: Sequence[int], force: Any) -> None:
        """A push acts on these nodes, ids (k,), with this force, (3,) [N]."""
        ids, f = _arrays.ids(nodes, "nodes", (None,)), _arrays.reals(force, "force", (3,))
        check(_lib.sunder_simulation_move(self.handle, push, ids.ctypes.data, ids.size, f.ctypes.data))

    def drop(self, push: int) -> None:
        """A push ends."""
        check(_lib.sunder_simulation_drop(self.handle, push))

    # ---- elements

    def remove(self, elements: Sequence[int]) -> None:
        """Takes live elements out, ids (k,), by one event."""
        ids = _arrays.ids(elements, "elements", (None,))
        check(_lib.sunder_simulation_remove(self.handle, ids.ctypes.data, ids.size))

    def cut(self, swept: Any) -> int:
        """Removes what a blade has passed: triangles (t, 3, 3) [mm]. Returns how many elements;
        where cracks split, how many faces have opened, and nothing is removed."""
        removed = c.c_int32()
        t = _arrays.reals(swept, "swept", (None, 3, 3))
        check(_lib.sunder_simulation_cut(self.handle, t.ctypes.data, t.size, c.byref(removed)))
        return removed.value

    def prepare(self, elements: Sequence[int] | None = None, *, near: Any = None,
                radius: float | None = None) -> int:
        """Says which elements may soon be removed, cut or grasped, ids (k,), or those within
        `radius` [mm] of the place `near`, (3,) [mm], now; in place of those named before. No
        result changes. Returns how many elements."""
        if (elements is None) == (near is None) or (near is None) != (radius is None):
            raise InputError("it takes elements, or near with radius")
        if elements is not None:
            ids = _arrays.ids(elements, "elements", (None,))
            check(_lib.sunder_simulation_prepare(self.handle, ids.ctypes.data, ids.size))
            return ids.size
        count = c.c_int32()
        place = _arrays.reals(near, "near", (3,))
        check(_lib.sunder_simulation_prepare_near(self.handle, place.ctypes.data, radius, c.byref(count)))
        return count.value

    # ---- back and forth

    def keep_history(self, quick: int = 100) -> None:
        """Keeps what is done from now on; before the first step, grip and push."""
        check(_lib.sunder_simulation_keep_history(self.handle, quick))

    def history(self) -> tuple[int, int]:
        """How many actions can be undone and redone."""
        undos, redos = c.c_int32(), c.c_int32()
        check(_lib.sunder_simulation_history(self.handle, c.byref(undos), c.byref(redos)))
        return undos.value, redos.value

    def undo(self, actions: int = 1) -> tuple[int, bool]:
        """Takes back the last of these: steps and removals in which something broke, grips and pushes
        that came or went. Returns how many events went, and whether it was by doing again."""
        events, replayed = c.c_int32(), c.c_int32()
        check(_lib.sunder_simulation_undo(self.handle, actions, c.byref(events), c.byref(replayed)))
        return events.value, bool(replayed.value)

    def redo(self, actions: int = 1) -> int:
        """Does again what was taken back. Returns how many events came."""
        events = c.c_int32()
        check(_lib.sunder_simulation_redo(self.handle, actions, c.byref(events)))
        return events.value

    def save(self) -> int:
        """Marks the state of now."""
        mark = c.c_int32()
        check(_lib.sunder_simulation_save(self.handle, c.byref(mark)))
        return mark.value

    def restore(self, mark: int) -> bool:
        """Comes back to a marked state. Returns whether it was by doing again."""
        replayed = c.c_int32()
        check(_lib.sunder_simulation_restore(self.handle, mark, c.byref(replayed)))
        return bool(replayed.value)

    def forget(self, mark: int) -> None:
        """Lets a mark and what it holds go."""
        check(_lib.sunder_simulation_forget(self.handle, mark))

    def store(self) -> bytes:
        """The history: what was done, not the body."""
        length = c.c_size_t()
        check(_lib.sunder_simulation_store(self.handle, None, 0, c.byref(length)))
        room = c.create_string_buffer(length.value)
        check(_lib.sunder_simulation_store(self.handle, room, length.value, c.byref(length)))
        return room.raw

    def load(self, history: bytes) -> None:
        """Does what such bytes tell, from the beginning."""
        history = bytes(history)
        check(_lib.sunder_simulation_load(self.handle, history, len(history)))

    # ---- drawing

    def surface(self) -> dict[str, int]:
        """triangle_count, node_count, version: follows what has happened since the last call."""
        surface = _c.structs["sunder_surface"]()
        check(_lib.sunder_simulation_surface(self.handle, c.byref(surface)))
        return {name: getattr(surface, name) for name in ("triangle_count", "node_count", "version")}

    def surface_changes(self, since: int = 0) -> np.ndarray:
        """(k,) records, one per triangle that has changed since a version (0: all): place, nodes,
        element, piece, opened. Those in places from triangle_count on are gone."""
        count = c.c_size_t()
        check(_lib.sunder_simulation_surface_changes(self.handle, since, None, 0, c.byref(count)))
        triangles = np.empty(count.value, TRIANGLE)
        check(_lib.sunder_simulation_surface_changes(self.handle, since, triangles.ctypes.data,
                                                     triangles.size, c.byref(count)))
        return triangles

    def surface_points(self) -> tuple[np.ndarray, np.ndarray]:
        """Where the body's nodes are (node_count, 3) float32 [mm], and their normals of length 1,
        (node_count, 3) float32, no unit."""
        count = self.surface()["node_count"]
        places, normals = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
        check(_lib.sunder_simulation_surface_points(self.handle, places.ctypes.data, normals.ctypes.data,
                                                    places.size))
        return places, normals

    def set_skin(self, vertices: Any) -> None:
        """A fine mesh that the tetrahedra carry: (v, 3), in the undeformed body [mm]."""
        v = _arrays.reals(vertices, "vertices", (None, 3))
        check(_lib.sunder_simulation_set_skin(self.handle, v.ctypes.data, v.size))
        self._vertices = len(v)

    def skin(self) -> tuple[np.ndarray, np.ndarray]:
        """Where its vertices are (v, 3) float32 [mm], and (v,) bool: what carries them is there."""
        count = getattr(self, "_vertices", 0)
        places, lives = np.empty((count, 3), np.float32), np.empty(count, np.bool_)
        check(_lib.sunder_simulation_skin(self.handle, places.ctypes.data, places.size,
                                          lives.ctypes.data))
        return places, lives
