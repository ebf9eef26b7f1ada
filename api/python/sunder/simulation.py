# SPDX-License-Identifier: Apache-2.0
"""A run: its steps, its fields, what broke."""
from __future__ import annotations

import ctypes as c
from typing import Any, Callable, Iterator, Sequence

import numpy as np

from . import _arrays, _c, _words
from ._handle import Handled, Lent, Owner
from ._live import Live
from ._threads import Frames, Grips
from .errors import InputError, check
from .mesh import Mesh
from .scene import Scene, as_dict, text_of

_lib = _c.library
_CAUSES = {0: "mss", 1: "sif", 2: "preset", 3: "script", 4: "principal", 5: "interface"}


class Step(_c.structs["sunder_step"]):
    """What a step has come to; members as in sunder.h: step, load_factor, events, destroyed,
    compliance [N mm], error, max_yield_ratio, ms_total, strain_max, time [s], kinetic ..."""
    _sized = True

    def as_dict(self) -> dict[str, Any]:
        """All members by name."""
        return as_dict(self)

    def __repr__(self):
        return (f"Step(step={self.step}, load_factor={self.load_factor:.6g}, events={self.events}, "
                f"destroyed={self.destroyed}, error={self.error:.3g})")


def _dtype(name, *left_out):
    """A struct of results as numpy's, whose records can lie in the library's own form."""
    struct = _c.structs[name]
    kinds = {"names": [], "formats": [], "offsets": [], "itemsize": c.sizeof(struct)}
    for member, kind in struct._fields_:
        if member in ("struct_size", "reserved", *left_out):
            continue
        kinds["names"].append(member)
        text = getattr(kind, "_type_", None) is c.c_char
        kinds["formats"].append(f"S{c.sizeof(kind)}" if text else np.dtype(kind))
        kinds["offsets"].append(getattr(struct, member).offset)
    return np.dtype(kinds)


# A step is to cost no more than its frame: what Python does for one is some microseconds.
_STEP = bytes(Step())
_new_step, _step, _byref = Step.from_buffer_copy, _lib.sunder_simulation_step, c.byref

# A field's number in the C interface, what its rows are of the mesh, and what a row has.
_VIEWS = {
    "displacement": (_c.constants["SUNDER_FIELD_DISPLACEMENT"], "nodes", (3,)),
    "velocity": (_c.constants["SUNDER_FIELD_VELOCITY"], "nodes", (3,)),
    "stress": (_c.constants["SUNDER_FIELD_STRESS"], "tets", (6,)),
    "max_shear": (_c.constants["SUNDER_FIELD_MAX_SHEAR"], "tets", ()),
    "yield_ratio": (_c.constants["SUNDER_FIELD_YIELD_RATIO"], "tets", ()),
    "destroyed": (None, "tets", ()),
}

EVENT = _dtype("sunder_event")
CRACK = _dtype("sunder_crack")
TIP = _dtype("sunder_tip")
INTERFACE = _dtype("sunder_interface")


class Bodies(Handled):
    """What simulations of one intact body share on the CPU by the linear law in statics: its factor
    and inverse, made once. A context manager; simulations made of it go on after its end.

    most: so many bodies are kept, those asked for last.
    """

    def __init__(self, most: int = 1):
        handle = c.c_void_p()
        check(_lib.sunder_bodies_create(int(_arrays.ids(most, "most", ())), c.byref(handle)))
        self._handle = handle.value

    _what = "set of bodies"

    def _destroy(self, handle):
        _lib.sunder_bodies_destroy(handle)


class Simulation(Handled, Live):
    """A scene that runs. A context manager; closing twice does no harm.

    scene: a Scene, or what Scene() takes.
    log: called with (level, text), level 0 info, 1 warning, 2 error.
    bodies: what is made of one intact body is taken from there, or left there.
    progress: called with a dict (phase, step, steps, events, destroyed) before each phase of the
        set-up and after each event of a step; a true result cancels (Cancelled).

    Shapes are by `mesh`, the mesh at creation, n nodes and m tetrahedra; with interfaces that is the
    scene's with copies of nodes and thin tetrahedra behind its own, in volumes "interface-0" ... Each field takes `out`, an array of
    its shape and type, into which the library writes; without it is a new one. view() shows a field
    in the library's own memory.
    """

    def __init__(self, scene: Scene | Any, *,
                 log: Callable[[int, str], None] | None = None,
                 progress: Callable[[dict[str, int]], Any] | None = None,
                 bodies: "Bodies | None" = None):
        self._handle = None
        self._bodies = bodies
        self._open_grips: Grips | None = None
        if not isinstance(scene, Scene):
            with Scene(scene) as made:
                self._create(made, log, progress)
        else:
            self._create(scene, log, progress)

    def _create(self, scene, log, progress):
        scene._give_materials()
        if scene.mesh is None:
            raise InputError("the scene has no mesh")
        self.mesh = scene.mesh
        self.title = scene.title
        self.instruments = list(scene.instruments)
        self._raised: BaseException | None = None
        self._callbacks = self._make_callbacks(log, progress)
        handle = c.c_void_p()
        if self._bodies is None:
            status = _lib.sunder_simulation_create(scene.handle, c.byref(self._callbacks), c.byref(handle))
        else:
            status = _lib.sunder_simulation_create_of(scene.handle, self._bodies.handle,
                                                      c.byref(self._callbacks), c.byref(handle))
        self._check(status)
        self._handle = handle.value
        self._owner = Owner(self._handle, _lib.sunder_simulation_destroy)
        if len(self.interfaces()):
            self.mesh = self._with_layers(scene.mesh)

    def _with_layers(self, mesh):
        """The scene's mesh and what its interfaces add."""
        body, layers = self.body, self.interfaces()
        nodes = self._field(_lib.sunder_simulation_body_nodes, "nodes", (body["node_count"], 3), None)
        tets = self._field(_lib.sunder_simulation_body_corners, "tets", (body["tet_count"], 4), None,
                           np.int32)
        volume_of = np.empty(len(tets), np.int32)
        volume_of[:len(mesh.tets)] = mesh.volume_of
        for i, layer in enumerate(layers):
            first = layer["first_element"]
            volume_of[first:first + layer["element_count"]] = len(mesh.volumes) + i
        names = tuple(f"interface-{i}" for i in range(len(layers)))
        return Mesh(nodes, tets, volume_of, mesh.volumes + names, mesh.surfaces)

    def _make_callbacks(self, log, progress):
        callbacks = _c.structs["sunder_callbacks"]()
        kinds = dict(_c.structs["sunder_callbacks"]._fields_)
        # What a callback raises ends the call that it was made in, and comes out of that.
        if log is not None:
            def on_log(_, level, text):
                try:
                    log(level, (text or b"").decode("utf-8", "replace"))
                except BaseException as error:
                    self._raised = error
            self._on_log = kinds["log"](on_log)
            callbacks.log = self._on_log
        if progress is not None:
            def on_progress(_, where):
                try:
                    state = _c.structs["sunder_progress"].from_address(where)
                    return 1 if self._raised or progress(as_dict(state)) else 0
                except BaseException as error:
                    self._raised = error
                    return 1
            self._on_progress = kinds["progress"](on_progress)
            callbacks.progress = self._on_progress
        return callbacks

    def _check(self, status):
        raised, self._raised = self._raised, None
        if raised is not None:
            raise raised
        if status:
            check(status)

    _what = "simulation"

    def _destroy(self, handle):
        self._owner = None  # the last view of a field gives the memory back

    # ---- steps

    def step(self) -> Step:
        """The next step: loads, displacement, stress, decision, update, until nothing breaks. Raises
        OrderError when all are done, NumericalError (the last good results can be read), Cancelled."""
        step = _new_step(_STEP)
        status = _step(self._handle, _byref(step))
        if status or self._raised:
            self._check(status)
        return step

    def step_by(self, dt: float) -> Step:
        """In motion: the next step, of `dt` [s] in place of the scene's."""
        step = Step()
        self._check(_lib.sunder_simulation_step_by(self._handle, dt, c.byref(step)))
        return step

    def step_within(self, max_ms: float) -> Step:
        """The next step with a bound on its time [ms]; `out_of_time` says that it ended by it."""
        step = Step()
        self._check(_lib.sunder_simulation_step_within(self._handle, max_ms, c.byref(step)))
        return step

    def steps(self) -> Iterator[Step]:
        """The steps that are left, one after the other."""
        from .errors import OrderError
        while True:
            try:
                step = self.step()
            except OrderError:
                return
            yield step

    def run(self, progress: bool | Callable[[Step], Any] = False) -> list[Step]:
        """All steps that are left. progress: True shows a line on a terminal or in a notebook."""
        from ._progress import Line
        show = Line(self.title) if progress is True else progress or (lambda step: None)
        done = []
        try:
            for step in self.steps():
                done.append(step)
                show(step)
        finally:
            if isinstance(show, Line):
                show.close()
        return done

    def cancel(self) -> None:
        """Ends the running step after its current event; from any thread."""
        check(_lib.sunder_simulation_cancel(self.handle))

    def drive(self, instrument: int | str, value: Any) -> None:
        """By hand from the next step on: force [N] or displacement [mm], (3,)."""
        check(_lib.sunder_simulation_drive(self.handle, self._number(instrument), _three(value, "value")))

    def turn(self, instrument: int | str, turn: Any) -> None:
        """A rigid grip by hand from the next step on: rotation vector (3,) [deg]."""
        check(_lib.sunder_simulation_turn(self.handle, self._number(instrument), _three(turn, "turn")))

    def _number(self, instrument):
        if isinstance(instrument, str):
            if instrument not in self.instruments:
                raise InputError(f'there is no instrument "{instrument}"; there are {self.instruments}')
            return self.instruments.index(instrument)
        return int(_arrays.ids(instrument, "instrument", ()))

    def grips(self) -> Grips:
        """Forces of the grips between steps, for another thread; one at a time."""
        return Grips(self)

    def frames(self, *fields: str, nodes: Sequence[int] | None = None) -> Frames:
        """Fields of the last finished step, for another thread while the next one runs; one at a
        time. `fields`: "displacement", "stress", "yield_ratio", "destroyed"; `nodes`: those whose
        displacement is wanted, else all of the body."""
        return Frames(self, fields, nodes)

    @property
    def engine(self) -> dict[str, Any]:
        """Sizes, device, precision, route, update and why."""
        engine = _c.structs["sunder_engine"]()
        check(_lib.sunder_simulation_engine(self.handle, c.byref(engine)))
        return as_dict(engine)

    # ---- fields

    def _field(self, function, what, shape, out, dtype=np.float64):
        array = _arrays.room(out, what, shape, dtype)
        check(function(self.handle, array.ctypes.data, array.size))
        return array

    @property
    def _nodes(self):
        return len(self.mesh.nodes)

    @property
    def _tets(self):
        return len(self.mesh.tets)

    def view(self, field: str) -> np.ndarray:
        """A field in the library's own memory, read-only and without a copy of numpy's: "displacement",
        "velocity": (n, 3) [mm], [mm/s]; "stress": (m, 6) [MPa]; "max_shear", "yield_ratio",
        "destroyed": (m,) [MPa], no unit, bool. It stays as it is through further steps, until the same
        field is viewed again: every view of it is the same memory. That lives as long as a view does,
        also after close()."""
        if field not in _VIEWS:
            raise InputError(f"field is {field!r}; allowed are {', '.join(_VIEWS)}")
        number, per, columns = _VIEWS[field]
        address, size = c.c_void_p(), c.c_size_t()
        if number is None:
            check(_lib.sunder_simulation_lend_destroyed(self.handle, c.byref(address), c.byref(size)))
        else:
            check(_lib.sunder_simulation_lend(self.handle, number, c.byref(address), c.byref(size)))
        rows = len(getattr(self.mesh, per))
        kind = np.bool_ if number is None else np.float64
        return np.asarray(Lent(self._owner, address.value, (rows, *columns), kind))

    def displacement(self, out: np.ndarray | None = None) -> np.ndarray:
        """(n, 3) float64 [mm]; zero before the first step."""
        return self._field(_lib.sunder_simulation_displacement, "displacement", (self._nodes, 3), out)

    def velocity(self, out: np.ndarray | None = None) -> np.ndarray:
        """(n, 3) float64 [mm/s], in motion."""
        return self._field(_lib.sunder_simulation_velocity, "velocity", (self._nodes, 3), out)

    def set_velocity(self, velocity: Any) -> None:
        """The body goes on with these, (n, 3) [mm/s]; what supports hold stays."""
        v = _arrays.reals(velocity, "velocity", (self._nodes, 3))
        check(_lib.sunder_simulation_set_velocity(self.handle, v.ctypes.data, v.size))

    def stress(self, out: np.ndarray | None = None) -> np.ndarray:
        """(m, 6) float64 [MPa]: xx yy zz xy yz zx."""
        return self._field(_lib.sunder_simulation_stress, "stress", (self._tets, 6), out)

    def max_shear(self, out: np.ndarray | None = None) -> np.ndarray:
        """(m,) float64: maximum shear stress [MPa]."""
        return self._field(_lib.sunder_simulation_max_shear, "max_shear", (self._tets,), out)

    def yield_ratio(self, out: np.ndarray | None = None) -> np.ndarray:
        """(m,) float64, no unit: yield measure over yield stress; 0 where unbreakable or destroyed."""
        return self._field(_lib.sunder_simulation_yield_ratio, "yield_ratio", (self._tets,), out)

    def destroyed(self, out: np.ndarray | None = None) -> np.ndarray:
        """(m,) bool."""
        return self._field(_lib.sunder_simulation_destroyed, "destroyed", (self._tets,), out, np.bool_)

    def reactions(self, out: np.ndarray | None = None) -> np.ndarray:
        """(instruments, 3) float64: force of each instrument on the body [N]."""
        shape = (len(self.instruments), 3)
        return self._field(_lib.sunder_simulation_reactions, "reactions", shape, out)

    def support_reaction(self, out: np.ndarray | None = None) -> np.ndarray:
        """(3,) float64: force of the supports on the body [N]."""
        return self._field(_lib.sunder_simulation_support_reaction, "support_reaction", (3,), out)

    # ---- the body as split cracks leave it

    @property
    def body(self) -> dict[str, int]:
        """version, node_count, tet_count, crack_face_count."""
        body = _c.structs["sunder_body"]()
        check(_lib.sunder_simulation_body(self.handle, c.byref(body)))
        return as_dict(body)

    def body_corners(self, out: np.ndarray | None = None) -> np.ndarray:
        """(m, 4) int32: nodes of each element now."""
        return self._field(_lib.sunder_simulation_body_corners, "body_corners", (self._tets, 4), out,
                           np.int32)

    def body_parents(self, out: np.ndarray | None = None) -> np.ndarray:
        """(node_count,) int32: the mesh's node that lies where each node lies."""
        return self._field(_lib.sunder_simulation_body_parents, "body_parents",
                           (self.body["node_count"],), out, np.int32)

    def body_displacement(self, out: np.ndarray | None = None) -> np.ndarray:
        """(node_count, 3) float64 [mm]."""
        return self._field(_lib.sunder_simulation_body_displacement, "body_displacement",
                           (self.body["node_count"], 3), out)

    def crack_faces(self, out: np.ndarray | None = None) -> np.ndarray:
        """(crack_face_count, 7) int32: the crack's id, three nodes of each lip."""
        return self._field(_lib.sunder_simulation_crack_faces, "crack_faces",
                           (self.body["crack_face_count"], 7), out, np.int32)

    # ---- what broke, and why

    def _records(self, count_of, at, dtype, struct):
        count = c.c_int32()
        check(count_of(self.handle, c.byref(count)))
        records = np.zeros(count.value, dtype)
        raw = records.view(np.uint8).reshape(count.value, dtype.itemsize)
        raw[:, :4] = np.frombuffer(np.uint32(c.sizeof(struct)).tobytes(), np.uint8)
        for i in range(count.value):
            check(at(self.handle, i, records.ctypes.data + i * dtype.itemsize))
        return records

    def events(self) -> np.ndarray:
        """(k,) records, one per destroyed element, growth or birth of a crack: members as sunder_event
        has them (order, step, event, element, cause, crack, load_factor, ratio, k [MPa sqrt(mm)],
        theta [deg] ...). cause_name() has the words."""
        return self._records(_lib.sunder_simulation_event_count, _lib.sunder_simulation_event_at,
                             EVENT, _c.structs["sunder_event"])

    def cracks(self) -> np.ndarray:
        """(k,) records, one per crack: id, kind, tip_count, mouth, tips, directions, length [mm] ..."""
        return self._records(_lib.sunder_simulation_crack_count, _lib.sunder_simulation_crack_at,
                             CRACK, _c.structs["sunder_crack"])

    def crack_path(self, crack: int) -> np.ndarray:
        """(points, 3) float64 [mm], from the mouth or the first tip."""
        count = self._crack(crack).path_count
        array = np.empty((count, 3))
        check(_lib.sunder_simulation_crack_path(self.handle, crack, array.ctypes.data, array.size))
        return array

    def crack_elements(self, crack: int) -> np.ndarray:
        """(elements,) int32, in the order of destruction."""
        count = self._crack(crack).element_count
        array = np.empty(count, np.int32)
        check(_lib.sunder_simulation_crack_elements(self.handle, crack, array.ctypes.data, array.size))
        return array

    def _crack(self, crack):
        struct = _c.structs["sunder_crack"]()
        check(_lib.sunder_simulation_crack_at(self.handle, crack, c.byref(struct)))
        return struct

    def tips(self) -> np.ndarray:
        """(k,) records, one per tip as the last solve leaves it: crack, tip, ended, known (a sum of
        constants["SUNDER_TIP_..."]), position [mm], k [MPa sqrt(mm)], theta [deg], j [N/mm] ..."""
        return self._records(_lib.sunder_simulation_measure_tips, _lib.sunder_simulation_tip_at, TIP,
                             _c.structs["sunder_tip"])

    def interfaces(self) -> np.ndarray:
        """(k,) records, one per interface: materials, first_element, element_count, strength [MPa],
        stiffness [N/mm^3], opening [mm], area and `parted` of it [mm^2], `spent` energy [N mm] ..."""
        return self._records(_lib.sunder_simulation_interface_count, _lib.sunder_simulation_interface_at,
                             INTERFACE, _c.structs["sunder_interface"])

    @property
    def warnings(self) -> list[str]:
        """A sentence each."""
        count = c.c_int32()
        check(_lib.sunder_simulation_warning_count(self.handle, c.byref(count)))
        return [text_of(_lib.sunder_simulation_warning_at, self.handle, i) for i in range(count.value)]

    def plot(self, **options: Any) -> Any:
        """A picture of the body as it is now; sunder.plot() says what it takes."""
        from .plotting import plot
        return plot(self, **options)


def cause_name(cause: int) -> str:
    """Of an event: "mss", "sif", "preset", "script", "principal" or "interface"."""
    return _CAUSES[int(cause)]


def _three(value, what):
    return _arrays.reals(value, what, (3,)).ctypes.data_as(c.c_void_p)
