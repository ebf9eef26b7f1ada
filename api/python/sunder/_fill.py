# SPDX-License-Identifier: Apache-2.0
"""A scene from a file or a dict with the keys of docs/interface.md "Scene"."""
import copy
import os
import pathlib
import tomllib
from collections.abc import Mapping

from . import _words
from .errors import Error, InputError
from .mesh import Mesh


def load(source, overrides):
    """The tree of keys of a file or a dict, and what paths in it are relative to."""
    if isinstance(source, Mapping):
        # Arrays and meshes are handed on, tables are copied.
        tree, folder, name = _copied(source), pathlib.Path("."), "scene"
    elif isinstance(source, (str, os.PathLike)):
        path = pathlib.Path(source)
        folder, name = path.parent, str(path)
        try:
            tree = tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}") from None
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: not valid TOML: {error}") from None
    else:
        raise InputError(f"a scene is the path of a file or a dict, not {type(source).__name__}")
    for key, value in overrides.items():
        override(tree, key, value)
    return tree, folder, name


def _copied(value):
    if isinstance(value, Mapping):
        return {k: _copied(v) for k, v in value.items()}
    if isinstance(value, list) and any(isinstance(v, Mapping) for v in value):
        return [_copied(v) for v in value]
    return copy.copy(value) if isinstance(value, list) else value


def override(tree, path, value):
    """Sets "instrument.0.force" in a tree, as --set does."""
    parts = path.split(".")
    here = tree
    for part, following in zip(parts, parts[1:]):
        here = _child(here, part, path, [] if following.isdigit() else {})
    _put(here, parts[-1], path, value)


def _child(here, part, path, new):
    if isinstance(here, list):
        place = _index(here, part, path)
        if place == len(here):
            here.append(new)
        return here[place]
    if not isinstance(here, dict):
        raise InputError(f"set {path}: {part!r} lies inside a plain value")
    if not isinstance(here.setdefault(part, new), (dict, list)):
        raise InputError(f"set {path}: {part!r} is a plain value")
    return here[part]


def _put(here, part, path, value):
    if isinstance(here, list):
        place = _index(here, part, path)
        here[place:place + 1] = [value]
    elif isinstance(here, dict):
        here[part] = value
    else:
        raise InputError(f"set {path}: {part!r} lies inside a plain value")


def _index(here, part, path):
    if not part.isdigit() or int(part) > len(here):
        raise InputError(f"set {path}: {part!r} is no index here; allowed are 0 to {len(here)}")
    return int(part)


def fill(scene, source, overrides):
    """Everything of the source into the scene. Raises InputError that begins with the file."""
    tree, folder, name = load(source, overrides)
    try:
        _fill(scene, tree, folder, name)
    except Error as error:
        raise type(error)(f"{name}: {error}") from None


def _table(tree, name, kind=Mapping):
    value = tree.get(name, {} if kind is Mapping else [])
    if not isinstance(value, kind):
        raise InputError(f"{name} is not {'a table' if kind is Mapping else 'an array of tables'}")
    if kind is list:
        for row in value:
            if not isinstance(row, Mapping):
                raise InputError(f"{name} is not an array of tables")
            _check_keys(name, row)
    elif name != "material":
        _check_keys(name, value)
    return value


def _check_keys(table, keys):
    for key in keys:
        if key not in _words.KEYS[table]:
            raise _words.unknown(table, key)


def _fill(scene, tree, folder, name):
    _check_keys("", tree)
    for key, programs in (("inputs", "run, plan and view"), ("recording", "run and plan")):
        if key in tree:
            raise InputError(f"{key} is for the program: sunder {programs}; leave the key out here")
    scene.title = tree.get("title", pathlib.Path(name).stem)
    _fill_mesh(scene, tree, folder)
    for volume, keys in _table(tree, "material").items():
        if not isinstance(keys, Mapping):
            raise InputError(f"material.{volume} is not a table")
        _check_keys("material", keys)
        needed = [] if "preset" in keys else [k for k in ("young", "poisson") if k not in keys]
        if needed:
            raise InputError(f'material "{volume}" has no {needed[0]}')
        scene.add_material(volume, **keys)
    for keys in _table(tree, "fixed", list):
        scene.add_support(**keys)
    for keys in _table(tree, "instrument", list):
        _fill_instrument(scene, dict(keys))
    for keys in _table(tree, "crack", list):
        scene.add_crack(**keys)
    for keys in _table(tree, "interface", list):
        needed = [k for k in ("between", "strength", "energy") if k not in keys]
        if needed:
            raise InputError(f"interface has no {needed[0]}")
        scene.add_interface(**keys)
    for keys in _table(tree, "destroy", list):
        if "step" not in keys:
            raise InputError("destroy has no step")
        scene.add_removal(**keys)
    scene.set_fracture(**_table(tree, "fracture"))
    scene.set_solver(**_table(tree, "solver"))
    scene.set_steps(_table(tree, "time").get("steps", 1))
    if "gravity" in _table(tree, "load"):
        scene.set_gravity(tree["load"]["gravity"])
    if "dynamics" in tree:
        keys = _table(tree, "dynamics")
        if "time_step" not in keys:
            raise InputError("dynamics has no time_step")
        scene.set_dynamics(**keys)
    fields = _table(tree, "output").get("fields", ["displacement", "stress"])
    for field in fields:
        if field not in ("displacement", "stress"):
            raise InputError(f'output.fields has {field!r}; allowed are "displacement", "stress"')
    scene.set_stress("stress" in fields)


def _fill_mesh(scene, tree, folder):
    mesh = tree.get("mesh")
    if isinstance(mesh, (str, os.PathLike)):
        if not str(mesh):
            raise InputError("mesh is empty; allowed is the path of a mesh file")
        mesh = Mesh.read(folder / mesh)
    if mesh is not None and scene.mesh is None:
        scene.set_mesh(mesh)
    if scene.mesh is None:
        raise InputError("the scene has no mesh")


def _fill_instrument(scene, keys):
    kind = keys.pop("kind", None)
    if kind is None:
        raise InputError("instrument has no kind")
    presses = _words.place("instrument", "kind", kind) == 1
    of_presses = [k for k in ("at", "side", "crack") if k in keys]
    if of_presses and not presses:
        raise InputError(f'instrument.{of_presses[0]} belongs to kind "pressure"')
    if presses and not of_presses:
        raise InputError('an instrument of kind "pressure" needs at and side')
    scene.add_instrument(keys.pop("name", None), **keys)
