# SPDX-License-Identifier: Apache-2.0
"""What other threads read beside the steps: forces of the grips, fields of the last finished one."""
from __future__ import annotations

import ctypes as c
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from . import _arrays, _c
from .errors import HandleError, InputError, OrderError, check

_lib = _c.library

_READ = {"displacement": _lib.sunder_frames_displacement, "stress": _lib.sunder_frames_stress,
         "yield_ratio": _lib.sunder_frames_yield_ratio, "destroyed": _lib.sunder_frames_destroyed}
_STATES = {_c.constants["SUNDER_FELT_" + name.upper()]: name
           for name in ("waiting", "live", "gone", "overflow")}


class Felt(NamedTuple):
    """What forces come from."""

    state: str  #: "waiting", "live", "gone"
    solution: int  #: its number, from 1 on
    step: int  #: that it belongs to; -1: unknown
    age_ms: float  #: since it was found
    share: float  #: of it in the forces, below 1 while the one before is blended in


class Grips:
    """Forces of the grips between steps, for a thread of its own: a call neither waits for a step nor
    makes one wait."""

    def __init__(self, simulation: Any):
        handle = c.c_void_p()
        self._handle = None
        check(_lib.sunder_grips_create(simulation.handle, c.byref(handle)))
        self._handle = handle.value
        self._shape = (len(simulation.instruments), 3)

    def forces(self, displacements: Any, out: np.ndarray | None = None) -> np.ndarray:
        """(instruments, 3) [N] if the grips were at (instruments, 3) [mm]."""
        d = _arrays.reals(displacements, "displacements", self._shape)
        array = _arrays.room(out, "forces", self._shape, np.float64)
        check(_lib.sunder_grips_forces(self._open(), d.ctypes.data, array.ctypes.data, array.size))
        return array

    def blend(self, ms: float) -> None:
        """Where a new solution changes forces they go there within so many ms; 0: at once."""
        check(_lib.sunder_grips_blend(self._open(), ms))

    def feel(self, hands: Mapping[int, Any]) -> tuple[dict[int, tuple[np.ndarray, np.ndarray]], Felt]:
        """Of grips that were grasped at run time, by id: where a hand has each, a place (3,) [mm] or a
        pair of place and quaternion (4,), no unit. Returns force (3,) [N] and torque (3,) about that place
        [N mm] of each that is held, and what they come from: `Felt`, whose state is "waiting" (no
        solution), "live" or "gone" (the simulation is closed)."""
        array = (_c.structs["sunder_hand"] * len(hands))()
        for hand, (grip, pose) in zip(array, hands.items()):
            pair = isinstance(pose, tuple) and len(pose) == 2
            place, turn = pose if pair else (pose, (0, 0, 0, 1))
            hand.grip = grip
            hand.position[:] = _arrays.reals(place, "place", (3,))
            hand.quaternion[:] = _arrays.reals(turn, "quaternion", (4,))
        felt = _c.structs["sunder_felt"]()
        try:
            check(_lib.sunder_grips_feel(self._open(), None, None, 0, c.byref(array), len(array),
                                         c.byref(felt)))
        except (OrderError, HandleError):
            if _STATES[felt.state] == "live":
                raise
        held = {hand.grip: (np.array(hand.force), np.array(hand.torque))
                for hand in array if hand.held}
        return held, Felt(_STATES[felt.state], felt.solution, felt.step, felt.age_ms, felt.share)

    def _open(self):
        if not self._handle:
            raise HandleError("the grips are closed")
        return self._handle

    def close(self) -> None:
        """Gives them back; twice does no harm."""
        handle, self._handle = getattr(self, "_handle", None), None
        if handle:
            _lib.sunder_grips_destroy(handle)

    def __enter__(self) -> "Grips":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self):
        self.close()


class Frames:
    """Fields of the last finished step, for a thread of its own: a call neither waits for a step nor
    makes one wait. `nodes`: ids (k,) of those whose displacement is wanted; none: all of the body."""

    def __init__(self, simulation: Any, fields: Sequence[str], nodes: Sequence[int] | None):
        handle = c.c_void_p()
        self._handle = None
        wanted = 0
        for name in fields:
            bit = _c.constants.get("SUNDER_FRAME_" + str(name).upper())
            if bit is None or name != str(name).lower():
                raise InputError(f'a frame has no field "{name}"; there are "displacement", "stress", '
                                 '"yield_ratio", "destroyed"')
            wanted |= bit
        ids = _arrays.ids([] if nodes is None else nodes, "nodes", (None,))
        check(_lib.sunder_frames_create(simulation.handle, wanted, ids.ctypes.data if ids.size else None,
                                        ids.size, c.byref(handle)))
        self._handle = handle.value
        self._fields = tuple(fields)
        self._nodes = ids.size
        self._elements = simulation.engine["tets"]

    def take(self) -> tuple[int, dict[str, np.ndarray]]:
        """The last finished step (-1: before the first one) and its fields: displacement (nodes, 3)
        [mm], stress (elements, 6) [MPa], yield_ratio (elements,), destroyed (elements,) bool."""
        if not self._handle:
            raise HandleError("the frames are closed")
        frame = _c.structs["sunder_frame"]()
        check(_lib.sunder_frames_take(self._handle, c.byref(frame)))
        shapes = {"displacement": (self._nodes or frame.node_count, 3), "stress": (self._elements, 6),
                  "yield_ratio": (self._elements,), "destroyed": (self._elements,)}
        result = {}
        for name in self._fields:
            array = np.empty(shapes[name], np.bool_ if name == "destroyed" else np.float64)
            check(_READ[name](self._handle, array.ctypes.data, array.size))
            result[name] = array
        return frame.step, result

    def close(self) -> None:
        """Gives them back; twice does no harm."""
        handle, self._handle = getattr(self, "_handle", None), None
        if handle:
            _lib.sunder_frames_destroy(handle)

    def __enter__(self) -> "Frames":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self):
        self.close()
