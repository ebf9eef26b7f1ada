# SPDX-License-Identifier: Apache-2.0
"""Keys of a scene and the words that they take, as docs/interface.md has them; tests hold the two
against each other."""
from . import _arrays
from .errors import InputError

KEYS = {
    "": ("title", "mesh", "inputs", "recording", "material", "fixed", "instrument", "crack",
         "interface", "destroy", "fracture", "solver", "time", "output", "load", "dynamics"),
    "material": ("young", "poisson", "yield", "law", "density", "toughness", "energy", "volume",
                 "preset", "fibres"),
    "fibres": ("direction", "surface", "around", "curve", "field", "k1", "k2", "dispersion", "young_along",
               "poisson_along", "shear_along", "yield_across", "toughness_across",
               "energy_across"),
    "around": ("point", "axis"),
    "fixed": ("axes", "box", "nodes", "near", "radius", "surface"),
    "instrument": ("name", "kind", "force", "displacement", "axes", "rigid", "turn", "ramp", "at",
                   "side", "crack", "box", "nodes", "near", "radius", "surface"),
    "crack": ("volume", "elements", "mouth", "tip", "tips"),
    "interface": ("between", "strength", "energy", "shear_ratio"),
    "destroy": ("step", "volume", "elements", "box"),
    "fracture": ("model", "alpha", "yield_measure", "sigma0", "crack_length", "sif", "crack",
                 "max_events", "plane_normal", "birth", "max_new_nodes", "averaging", "stress", "contact"),
    "solver": ("backend", "route", "update", "precision", "tolerance", "device", "prepare", "max_ms"),
    "time": ("steps",),
    "output": ("fields",),
    "load": ("gravity",),
    "dynamics": ("time_step", "max_iterations", "felt_inertia", "damping"),
}
FLAGS = {("fracture", "contact")}  # members of C that are 0 or 1
WORDS = {
    ("material", "volume"): ("element", "pooled"),
    ("material", "law"): ("linear", "corotated", "neo-hookean", "saint-venant-kirchhoff"),
    ("instrument", "kind"): ("expansion", "pressure"),
    ("instrument", "side"): ("upper", "lower"),
    ("fracture", "model"): ("none", "A", "B", "P"),
    ("fracture", "yield_measure"): ("max_shear", "tresca"),
    ("fracture", "sigma0"): ("line", "tip", "present"),
    ("fracture", "crack_length"): ("path", "tool"),
    ("fracture", "sif"): ("formula", "field"),
    ("fracture", "crack"): ("destroyed", "split"),
    ("fracture", "birth"): ("element", "through"),
    ("fracture", "stress"): ("cauchy", "biot"),
    ("solver", "backend"): ("auto", "cpu", "vulkan"),
    ("solver", "route"): ("auto", "inverse", "condensed", "factor", "cg"),
    ("solver", "update"): ("auto", "eager", "deferred"),
    ("solver", "precision"): ("auto", "fp32", "fp64"),
}


def full(table, key):
    return f"{table}.{key}" if table else key


def unknown(table, key):
    return InputError(f'unknown key "{full(table, key)}"; allowed are {", ".join(KEYS[table])}')


def place(table, key, value):
    """A word as the C interface counts them."""
    words = WORDS[table, key]
    if value not in words:
        raise InputError(f"{full(table, key)} is {value!r}; allowed are "
                         + ", ".join(f'"{w}"' for w in words))
    return words.index(value)


def flag(table, key, value):
    if not isinstance(value, (bool,)):
        raise InputError(f"{full(table, key)} is {value!r}; allowed are True and False")
    return value


def put(struct, table, key, value):
    """A key's value into the member of its name."""
    if key not in KEYS[table] or not hasattr(struct, key):
        raise unknown(table, key)
    if value is None:
        return
    if (table, key) in WORDS:
        setattr(struct, key, place(table, key, value))
    elif (table, key) in FLAGS:
        setattr(struct, key, int(flag(table, key, value)))
    elif key == "plane_normal":
        struct.plane_normal[:] = _arrays.reals(value, full(table, key), (3,))
    elif isinstance(getattr(struct, key), float):
        setattr(struct, key, float(_arrays.reals(value, full(table, key), ())))
    else:
        setattr(struct, key, int(_arrays.ids(value, full(table, key), ())))
