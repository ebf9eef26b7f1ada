# SPDX-License-Identifier: Apache-2.0
"""The model and what acts on it."""
from __future__ import annotations

import ctypes as c
import os
from typing import Any, Mapping, Sequence

import numpy as np

from . import _arrays, _c, _fibres, _words
from ._handle import Handled
from .errors import AllowedError, InputError, check
from .mesh import Mesh

_lib = _c.library
_AXES = {"x": 1, "y": 2, "z": 4}


class Selection:
    """Nodes or elements, by exactly one of: `nodes`, ids (k,); `elements`, ids (k,); `box`, (2, 3) [mm],
    [min, max], closed; `near`, (3,) [mm], with `radius` [mm], a ball; `surface` or `volume`, a name of
    the mesh."""

    def __init__(self, mesh: Mesh | None, what: str, given: Mapping[str, Any]):
        self.struct = _c.structs["sunder_selection"]()
        self._ids = None
        named = [k for k in ("nodes", "elements", "box", "near", "surface", "volume")
                 if given.get(k) is not None]
        if len(named) != 1:
            raise InputError(f"{what} selects by {' and '.join(named) or 'nothing'}; allowed is "
                             "exactly one of nodes, elements, box, near, surface, volume")
        if (given.get("radius") is not None) != (named[0] == "near"):
            raise InputError(f"{what}: near and radius come together")
        getattr(self, "_" + named[0])(mesh, what, given)

    def _take(self, ids):
        self._ids = np.ascontiguousarray(ids, dtype=np.int32)
        self.struct.ids = self._ids.ctypes.data
        self.struct.id_count = self._ids.size

    def _nodes(self, mesh, what, given):
        self._take(_arrays.ids(given["nodes"], f"nodes of {what}", (None,)))

    def _elements(self, mesh, what, given):
        self._take(_arrays.ids(given["elements"], f"elements of {what}", (None,)))

    def _box(self, mesh, what, given):
        box = _arrays.reals(given["box"], f"box of {what}", (2, 3))
        self.struct.kind = _c.constants["SUNDER_SELECT_BOX"]
        self.struct.min[:], self.struct.max[:] = box[0], box[1]

    def _near(self, mesh, what, given):
        self.struct.kind = _c.constants["SUNDER_SELECT_BALL"]
        self.struct.min[:] = _arrays.reals(given["near"], f"near of {what}", (3,))
        self.struct.radius = _number(given["radius"], f"radius of {what}")

    def _surface(self, mesh, what, given):
        mesh = _mesh_of(mesh, what)
        mesh.surface_nodes(given["surface"])
        self.struct.kind = _c.constants["SUNDER_SELECT_FACES"]
        self._take(mesh.surfaces[given["surface"]].ravel())

    def _volume(self, mesh, what, given):
        mesh = _mesh_of(mesh, what)
        if given["volume"] not in mesh.volumes:
            raise InputError(f'{what}: the mesh has no volume "{given["volume"]}"; it has '
                             f"{list(mesh.volumes)}")
        self._take(np.flatnonzero(mesh.volume_of == mesh.volumes.index(given["volume"])))


def _mesh_of(mesh, what):
    if mesh is None:
        raise InputError(f"{what} names a part of the mesh; set the mesh first")
    return mesh


def _number(value, what):
    return float(_arrays.reals(value, what, ()))


def _axes(text, what):
    if not isinstance(text, str) or not text or set(text) - set(_AXES) or len(set(text)) < len(text):
        raise InputError(f"axes of {what} is {text!r}; allowed are x, y and z, each once")
    return sum(_AXES[a] for a in text)


def _families(given, what):
    if given is None:
        return []
    families = [given] if isinstance(given, Mapping) else given
    if not isinstance(families, (list, tuple)) or not all(isinstance(f, Mapping) for f in families):
        raise InputError(f"fibres of {what} is not a dict, or a list of them")
    return families


def _name(text):
    return None if text is None else str(text).encode()


class Scene(Handled):
    """A scene: from a file, from a dict with the same keys (docs/interface.md "Scene"), or empty, to
    be filled by the methods below. A context manager; closing twice does no harm.

    source: path of a .toml, a dict whose `mesh` may also be a Mesh, a pair (nodes, tets) or an object
        like meshio's, or None.
    set: keys to override or add, {"instrument.0.force": [0, -50, 0]}.
    mesh: in place of the source's.
    """

    def __init__(self, source: str | os.PathLike | Mapping | None = None, *,
                 set: Mapping[str, Any] | None = None, mesh: Any = None):
        handle = c.c_void_p()
        check(_lib.sunder_scene_create(c.byref(handle)))
        self._handle = handle.value
        self.title = ""
        self.mesh: Mesh | None = None
        self.materials: list[str] = []
        self.instruments: list[str] = []
        try:
            if mesh is not None:
                self.set_mesh(mesh)
            if source is not None:
                from ._fill import fill
                fill(self, source, set or {})
            elif set:
                raise InputError("set overrides keys of a source, and there is none")
        except BaseException:
            self.close()
            raise

    _what = "scene"

    def _destroy(self, handle):
        _lib.sunder_scene_destroy(handle)

    def set_mesh(self, mesh: Any) -> None:
        """The body: what Mesh.of() takes. Materials go to volumes by name (add_material)."""
        self.mesh = Mesh.of(mesh)
        self._hand_over(self.mesh.volume_of)

    def _hand_over(self, material_of):
        m = self.mesh
        check(_lib.sunder_scene_set_mesh(self.handle, m.nodes.ctypes.data, m.nodes.size,
                                         m.tets.ctypes.data, m.tets.size, material_of.ctypes.data,
                                         material_of.size))

    def add_material(self, name: str | None = None, *, young: float | None = None,
                     poisson: float | None = None, preset: str | None = None,
                     **members: Any) -> int:
        """A material. Named as a volume of the mesh it is that volume's; else the n-th material is
        the n-th volume's. Returns its index.

        young [MPa], poisson, yield_stress [MPa] (left out: unbreakable; `yield` by **{"yield": 2}),
        law ("linear", "corotated", "neo-hookean", "saint-venant-kirchhoff"), density [t/mm^3],
        toughness [MPa sqrt(mm)] or energy [N/mm], volume ("element", "pooled"); preset: a tissue of
        presets(), which they override. fibres: a family, or a list of two: a dict of one of
        direction (3,), which `surface`, a name, lays along itself, around {"point": (3,), "axis":
        (3,)} [mm], curve (any, 3) [mm] and field (tets, 3), with the
        numbers of docs/interface.md (k1, young_along, toughness_across, ...).
        """
        m = _c.options("sunder_material")
        what = f"material {name!r}"
        if preset is not None:
            check(_lib.sunder_material_preset(str(preset).encode(), c.byref(m)))
        given = {"young": young, "poisson": poisson, **members}
        if "yield_stress" in given:
            given["yield"] = given.pop("yield_stress")
        if given.get("toughness") is not None or given.get("energy") is not None:
            m.toughness = m.energy = 0  # in the preset's place
        for key, value in given.items():
            if key in ("law", "volume"):
                setattr(m, key, _words.place("material", key, value))
            elif key in ("young", "poisson", "yield", "density", "toughness", "energy"):
                if value is not None:
                    setattr(m, key, _number(value, f"{key} of {what}"))
                    # In C 0 stands for none.
                    if key not in ("young", "poisson") and not getattr(m, key) > 0:
                        raise InputError(f"{what} {key} is {value}; allowed are numbers above 0")
            elif key != "fibres":
                raise _words.unknown("material", key)
        m.name = _name(name)
        index = c.c_int32()
        check(_lib.sunder_scene_add_material(self.handle, c.byref(m), c.byref(index)))
        self.materials.append(str(index.value) if name is None else str(name))
        for number, family in enumerate(_families(given.get("fibres"), what)):
            self._add_fibres(index.value, family, f"fibres {number} of {what}")
        return index.value

    def _add_fibres(self, material, family, what):
        for key in family:
            if key not in _words.KEYS["fibres"]:
                raise _words.unknown("fibres", key)
        f = _c.options("sunder_fibres")
        ways = [key for key in ("direction", "around", "curve", "field")
                if family.get(key) is not None]
        if len(ways) != 1:
            raise InputError(f"{what} has {' and '.join(ways) or 'no direction, around, curve or field'}; "
                             "allowed is one of them")
        if family.get("surface") is not None and ways != ["direction"]:
            raise InputError(f"{what} has surface, which goes with direction only")
        field = None
        if ways == ["curve"] or family.get("surface") is not None:
            f.run = _c.constants["SUNDER_FIBRES_FIELD"]
            field = _fibres.directions(self.mesh, family, what)
            f.field, f.field_size = field.ctypes.data, field.size
        elif ways == ["direction"]:
            f.run = _c.constants["SUNDER_FIBRES_STRAIGHT"]
            f.direction[:] = _arrays.reals(family["direction"], f"direction of {what}", (3,))
        elif ways == ["around"]:
            f.run = _c.constants["SUNDER_FIBRES_AROUND"]
            around = family["around"]
            if not isinstance(around, Mapping) or set(around) != {"point", "axis"}:
                raise InputError(f"around of {what} takes point and axis")
            f.point[:] = _arrays.reals(around["point"], f"point of {what}", (3,))
            f.direction[:] = _arrays.reals(around["axis"], f"axis of {what}", (3,))
        else:
            if isinstance(family["field"], str):
                raise InputError(f"field of {what} is a name, which the program alone looks up: sunder "
                                 "run; allowed is an array (tets, 3)")
            f.run = _c.constants["SUNDER_FIBRES_FIELD"]
            field = _arrays.reals(family["field"], f"field of {what}", (None, 3))
            f.field, f.field_size = field.ctypes.data, field.size
        for key in _words.KEYS["fibres"]:
            if key in ("direction", "surface", "around", "curve", "field") or family.get(key) is None:
                continue
            value = _number(family[key], f"{key} of {what}")
            # In C 0 stands for none.
            if value == 0 and key not in ("k2", "dispersion", "poisson_along"):
                raise InputError(f"{key} of {what} is 0; allowed are numbers above 0")
            setattr(f, key, value)
        check(_lib.sunder_scene_add_fibres(self.handle, material, c.byref(f)))

    def add_support(self, *, axes: str = "xyz", **nodes: Any) -> None:
        """Holds nodes (Selection) along `axes`."""
        s = _c.options("sunder_support")
        s.axes = _axes(axes, "a support")
        selection = Selection(self.mesh, "a support", nodes)
        s.nodes = selection.struct
        check(_lib.sunder_scene_add_support(self.handle, c.byref(s)))

    def add_instrument(self, name: str | None = None, *, force: Sequence[float] | None = None,
                       displacement: Sequence[float] | None = None, axes: str | None = None,
                       rigid: bool = False, turn: Sequence[float] | None = None,
                       ramp: Sequence[float] | None = None, at: Sequence[float] | None = None,
                       side: str | None = None, crack: int | None = None, **nodes: Any) -> int:
        """An instrument, and its index: `force` (3,) [N] pulls nodes, `displacement` (3,) [mm] grips
        them along `axes` (`rigid`: as one solid, `turn` (3,) [deg]), `force` with `at` (3,) [mm],
        `side` ("upper", "lower") and `crack` presses on a face of a crack. ramp: [t0, t1], scene
        times of no and of full action."""
        what = f"instrument {name!r}"
        if (force is None) == (displacement is None):
            raise InputError(f"{what} has force and displacement, or neither; allowed is one of them")
        i = _c.options("sunder_instrument")
        i.name = _name(name)
        i.value[:] = _arrays.reals(force if force is not None else displacement,
                                   f"{'force' if force is not None else 'displacement'} of {what}", (3,))
        selection = None
        if at is not None or side is not None or crack is not None:
            self._press(i, what, force, at, side, crack, nodes)
        else:
            selection = Selection(self.mesh, what, nodes)
            i.nodes = selection.struct
        if displacement is not None:
            i.kind = _c.constants["SUNDER_DISPLACEMENT"]
            i.rigid = bool(rigid)
            i.axes = _axes("xyz" if axes is None else axes, what)
            if turn is not None:
                i.turn[:] = _arrays.reals(turn, f"turn of {what}", (3,))
            if rigid and i.axes != 7:
                raise InputError(f"{what} is rigid, which holds all axes, and has axes {axes!r}")
            if turn is not None and not rigid:
                raise InputError(f"{what} has a turn, which is a rigid grip's")
        elif axes is not None or rigid or turn is not None:
            raise InputError(f"{what}: axes, rigid and turn belong to displacement")
        if ramp is not None:
            i.has_ramp = 1
            i.ramp[:] = _arrays.reals(ramp, f"ramp of {what}", (2,))
        index = c.c_int32()
        check(_lib.sunder_scene_add_instrument(self.handle, c.byref(i), c.byref(index)))
        self.instruments.append(f"instrument-{index.value}" if name is None else str(name))
        return index.value

    def _press(self, i, what, force, at, side, crack, nodes):
        if force is None or at is None or side is None or any(v is not None for v in nodes.values()):
            raise InputError(f"{what} presses: it needs force, at and side, and selects no nodes")
        i.kind = _c.constants["SUNDER_PRESSURE"]
        i.at[:] = _arrays.reals(at, f"at of {what}", (3,))
        i.side = _words.place("instrument", "side", side)
        i.crack = int(_arrays.ids(0 if crack is None else crack, f"crack of {what}", ()))

    def add_crack(self, *, mouth: Sequence[float] | None = None, tip: Sequence[float] | None = None,
                  tips: Any = None, **elements: Any) -> None:
        """A crack that is there from the start: its elements (Selection; [] where nodes of the mesh
        are split), with `mouth` (3,) [mm] and `tip` (3,) [mm], an edge crack, or with `tips` (2, 3)
        [mm]."""
        if (mouth is None) != (tip is None) or (mouth is None) == (tips is None):
            raise InputError("a crack has a mouth and a tip, or tips")
        k = _c.structs["sunder_preset_crack"]()
        selection = Selection(self.mesh, "a crack", elements)
        k.elements = selection.struct
        if mouth is not None:
            k.has_mouth = 1
            k.mouth[:] = _arrays.reals(mouth, "mouth of a crack", (3,))
            k.tips[0][:] = _arrays.reals(tip, "tip of a crack", (3,))
        else:
            both = _arrays.reals(tips, "tips of a crack", (2, 3))
            for j in range(2):
                k.tips[j][:] = both[j]
        check(_lib.sunder_scene_add_crack(self.handle, c.byref(k)))

    def add_interface(self, between: Sequence[str], *, strength: float, energy: float,
                      shear_ratio: float = 1.0) -> None:
        """Where two volumes of the mesh share faces they part by a law of their own: `between`, their
        names, whose materials are there already; strength [MPa] in tension, energy [N/mm] that
        parting takes, shear_ratio, of the strength in shear to that in tension, no unit."""
        names = () if isinstance(between, str) else tuple(between)
        if len(names) != 2:
            raise InputError(f"between of an interface is {between!r}; allowed are the names of two volumes")
        what = f"the interface between {names[0]!r} and {names[1]!r}"
        numbers = [_number(value, f"{key} of {what}") for key, value in
                   (("strength", strength), ("energy", energy), ("shear_ratio", shear_ratio))]
        check(_lib.sunder_scene_add_interface(self.handle, *(self._material_of(n, what) for n in names),
                                              *numbers))

    def _material_of(self, volume, what):
        """Its index, as _give_materials() will have it."""
        if volume in self.materials:
            return self.materials.index(volume)
        volumes = () if self.mesh is None else self.mesh.volumes
        if volume not in volumes:
            raise InputError(f"{what} names volume {volume!r}; there are "
                             f"{list(volumes) or self.materials}")
        if volumes.index(volume) >= len(self.materials) or set(self.materials) & set(volumes):
            raise InputError(f"{what}: volume {volume!r} has no material yet; add that first")
        return volumes.index(volume)

    def add_removal(self, step: int, **elements: Any) -> None:
        """Elements (Selection) taken out before the first solve of a step, from 0: a cut."""
        selection = Selection(self.mesh, "a removal", elements)
        check(_lib.sunder_scene_add_removal(self.handle, int(_arrays.ids(step, "step", ())),
                                            c.byref(selection.struct)))

    def set_fracture(self, *, attribution: bool = False, **keys: Any) -> None:
        """What breaks, and how: the keys of [fracture]. attribution: events say which instrument."""
        f = _c.options("sunder_fracture_options")
        f.attribution = bool(attribution)
        if keys.get("plane_normal") is not None:
            f.has_plane_normal = 1
        for key, value in keys.items():
            _words.put(f, "fracture", key, value)
        check(_lib.sunder_scene_set_fracture(self.handle, c.byref(f)))

    def set_solver(self, **keys: Any) -> None:
        """How it is computed: the keys of [solver]."""
        s = _c.options("sunder_solver_options")
        for key, value in keys.items():
            if key == "prepare":
                s.no_preparation = 0 if _words.flag("solver", key, value) else 1
            else:
                _words.put(s, "solver", key, value)
        check(_lib.sunder_scene_set_solver(self.handle, c.byref(s)))

    def set_steps(self, steps: int) -> None:
        """Number of steps, at least 1."""
        check(_lib.sunder_scene_set_steps(self.handle, int(_arrays.ids(steps, "steps", ()))))

    def set_live(self, live: bool = True) -> None:
        """Whether elements may be removed and nodes grasped where nothing in the scene breaks."""
        check(_lib.sunder_scene_set_live(self.handle, int(bool(live))))

    def set_gravity(self, gravity: Sequence[float]) -> None:
        """(3,) [mm/s^2]; materials need a density."""
        g = _arrays.reals(gravity, "gravity", (3,))
        check(_lib.sunder_scene_set_gravity(self.handle, g.ctypes.data))

    def set_dynamics(self, *, time_step: float, damping: Sequence[float] = (0, 0),
                     max_iterations: int = 0, felt_inertia: bool = False) -> None:
        """Motion: each step is one of `time_step` [s]. damping: (2,), per mass [1/s], per stiffness
        [s]."""
        d = _c.options("sunder_dynamics")
        d.time_step = _number(time_step, "time_step")
        d.mass_damping, d.stiffness_damping = _arrays.reals(damping, "damping", (2,))
        d.max_iterations = int(_arrays.ids(max_iterations, "max_iterations", ()))
        d.felt_inertia = bool(felt_inertia)
        check(_lib.sunder_scene_set_dynamics(self.handle, c.byref(d)))

    def set_statics(self) -> None:
        """Takes set_dynamics() back."""
        check(_lib.sunder_scene_set_dynamics(self.handle, None))

    def set_stress(self, wanted: bool) -> None:
        """Whether stress is wanted; without it is left out unless the fracture model needs it."""
        check(_lib.sunder_scene_set_stress(self.handle, int(bool(wanted))))

    def plan(self) -> dict[str, Any]:
        """What the scene takes, before it runs: the engine's sizes, device, route and why, `buffers`
        (name: bytes), `left_out` (sentences)."""
        self._give_materials()
        plan = c.c_void_p()
        check(_lib.sunder_plan_create(self.handle, c.byref(plan)))
        try:
            engine = _c.structs["sunder_engine"]()
            check(_lib.sunder_plan_engine(plan, c.byref(engine)))
            buffers, left_out = c.c_int32(), c.c_int32()
            check(_lib.sunder_plan_counts(plan, c.byref(buffers), c.byref(left_out)))
            result = as_dict(engine)
            result["buffers"] = dict(_buffer(plan, i) for i in range(buffers.value))
            result["left_out"] = [text_of(_lib.sunder_plan_left_out, plan, i)
                                  for i in range(left_out.value)]
            return result
        finally:
            _lib.sunder_plan_destroy(plan)

    def _give_materials(self):
        """Materials that have a volume's name are that volume's, whatever their order."""
        if self.mesh is None or not set(self.materials) & set(self.mesh.volumes):
            return
        missing = [v for v in self.mesh.volumes if v not in self.materials]
        if missing:
            raise InputError(f'volume "{missing[0]}" has no material')
        unknown = [m for m in self.materials if m not in self.mesh.volumes]
        if unknown:
            raise InputError(f'material "{unknown[0]}": the mesh has no such volume; it has '
                             f"{list(self.mesh.volumes)}")
        index = np.array([self.materials.index(v) for v in self.mesh.volumes], np.int32)
        self._hand_over(np.ascontiguousarray(index[self.mesh.volume_of]))


def _buffer(plan, index):
    size = c.c_uint64()
    name = c.create_string_buffer(256)
    check(_lib.sunder_plan_buffer(plan, index, c.byref(size), c.cast(name, c.c_char_p), 256, None))
    return name.value.decode(), size.value


def text_of(function: Any, *arguments: Any) -> str:
    """A text that a function of the C interface hands out."""
    length = c.c_size_t()
    check(function(*arguments, None, 0, c.byref(length)))
    room = c.create_string_buffer(length.value + 1)
    check(function(*arguments, c.cast(room, c.c_char_p), length.value + 1, None))
    return room.value.decode("utf-8", "replace")


def as_dict(struct: c.Structure) -> dict[str, Any]:
    """Members of a result by name; texts as str."""
    result = {}
    for name, _ in struct._fields_:
        if name in ("struct_size", "reserved", "reserved2"):
            continue
        value = getattr(struct, name)
        result[name] = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return result


def presets() -> list[str]:
    """Tissues that a material's `preset` takes (docs/tissues.md)."""
    count = c.c_int32()
    check(_lib.sunder_preset_count(c.byref(count)))
    return [text_of(_lib.sunder_preset_at, i) for i in range(count.value)]


def devices() -> list[dict[str, Any]]:
    """Devices that can compute, with backend, index, chosen, name, driver, precisions, why."""
    count = c.c_int32()
    check(_lib.sunder_device_count(c.byref(count)))
    found = []
    for i in range(count.value):
        device = _c.structs["sunder_device"]()
        check(_lib.sunder_device_at(i, c.byref(device)))
        found.append(as_dict(device))
    return found
