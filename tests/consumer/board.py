#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The C interface from Python's ctypes: two tetrahedra, pulled until one breaks.
   board.py LIBRARY"""
import ctypes as c
import sys


class Selection(c.Structure):
    _fields_ = [("kind", c.c_int32), ("reserved", c.c_int32), ("ids", c.POINTER(c.c_int32)),
                ("id_count", c.c_size_t), ("min", c.c_double * 3), ("max", c.c_double * 3),
                ("radius", c.c_double)]


class Sized(c.Structure):
    """What SUNDER_..._INIT does in C: struct_size as it is declared here, and the defaults."""
    defaults = {}

    def __init__(self, **members):
        super().__init__(**{"struct_size": c.sizeof(self), **self.defaults, **members})


class Material(Sized):
    # The member is called yield in C, which is a keyword here; only its place matters.
    _fields_ = [("struct_size", c.c_uint32), ("reserved", c.c_uint32), ("young", c.c_double),
                ("poisson", c.c_double), ("yield_stress", c.c_double), ("name", c.c_char_p),
                ("law", c.c_int32), ("reserved2", c.c_int32), ("density", c.c_double),
                ("toughness", c.c_double), ("energy", c.c_double)]


class Support(Sized):
    _fields_ = [("struct_size", c.c_uint32), ("axes", c.c_uint32), ("nodes", Selection)]
    defaults = {"axes": 7}


class Instrument(Sized):
    _fields_ = [("struct_size", c.c_uint32), ("kind", c.c_int32), ("name", c.c_char_p),
                ("nodes", Selection), ("value", c.c_double * 3), ("axes", c.c_uint32),
                ("side", c.c_int32), ("crack", c.c_int32), ("has_ramp", c.c_int32),
                ("at", c.c_double * 3), ("ramp", c.c_double * 2)]
    defaults = {"axes": 7}


class Fracture(Sized):
    _fields_ = [("struct_size", c.c_uint32), ("model", c.c_int32), ("alpha", c.c_double),
                ("yield_measure", c.c_int32), ("sigma0", c.c_int32), ("crack_length", c.c_int32),
                ("birth", c.c_int32), ("sif", c.c_int32), ("max_events", c.c_int32),
                ("has_plane_normal", c.c_int32), ("attribution", c.c_int32),
                ("plane_normal", c.c_double * 3)]
    defaults = {"alpha": 1e-6, "max_events": 10000}


class Step(Sized):
    _fields_ = [("struct_size", c.c_uint32), ("step", c.c_int32), ("load_factor", c.c_double),
                ("events", c.c_int32), ("destroyed", c.c_int32), ("iterations", c.c_int32),
                ("polished", c.c_int32), ("compliance", c.c_double), ("residual", c.c_double),
                ("error", c.c_double), ("max_yield_ratio", c.c_double), ("ms", c.c_double * 6)]


library = c.CDLL(sys.argv[1])
library.sunder_last_error.restype = c.c_char_p


def check(status):
    if status != 0:
        raise RuntimeError(library.sunder_last_error().decode())


def expect_defaults(struct, function):
    """The library's own, which may be longer than what is declared here."""
    room = c.create_string_buffer(4096)
    function(room)
    ours = bytes(struct())
    # The first four bytes are the size, which a later version of the library says of itself.
    assert room.raw[4:len(ours)] == ours[4:], struct.__name__


def ids(*numbers):
    array = (c.c_int32 * len(numbers))(*numbers)
    return Selection(kind=0, ids=array, id_count=len(numbers))


nodes = (c.c_double * 15)(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1)
tets = (c.c_int32 * 8)(0, 1, 2, 3, 1, 4, 2, 3)
scene, simulation = c.c_void_p(), c.c_void_p()
check(library.sunder_scene_create(c.byref(scene)))
check(library.sunder_scene_set_mesh(scene, nodes, c.c_size_t(15), tets, c.c_size_t(8), None,
                                    c.c_size_t(0)))
for struct, function in ((Material, library.sunder_material_init),
                         (Support, library.sunder_support_init),
                         (Instrument, library.sunder_instrument_init),
                         (Fracture, library.sunder_fracture_options_init)):
    expect_defaults(struct, function)
tissue = Material(young=5, poisson=0.4, yield_stress=2)
check(library.sunder_scene_add_material(scene, c.byref(tissue), None))
liver = Material()
check(library.sunder_material_preset(b"liver-porcine", c.byref(liver)))
assert liver.young > 0 and liver.energy > 0 and liver.toughness == 0, liver.energy
support = Support(nodes=ids(0, 2, 3))
check(library.sunder_scene_add_support(scene, c.byref(support)))
forceps = Instrument(nodes=ids(4))
forceps.value[0] = 40
check(library.sunder_scene_add_instrument(scene, c.byref(forceps), None))
fracture = Fracture(model=1)
check(library.sunder_scene_set_fracture(scene, c.byref(fracture)))
check(library.sunder_simulation_create(scene, None, c.byref(simulation)))
step = Step()
check(library.sunder_simulation_step(simulation, c.byref(step)))

destroyed = (c.c_uint8 * 2)()
u = (c.c_double * 15)()
check(library.sunder_simulation_destroyed(simulation, destroyed, c.c_size_t(2)))
check(library.sunder_simulation_displacement(simulation, u, c.c_size_t(15)))
assert sum(destroyed) > 0 and u[12] > 0, (list(destroyed), list(u))
assert step.destroyed == sum(destroyed) and step.load_factor == 1, step.destroyed
# A wrong call is an exception of ours, not the end of the interpreter.
try:
    check(library.sunder_simulation_step(scene, None))
    sys.exit("a scene was taken for a simulation")
except RuntimeError as error:
    assert "simulation" in str(error), error
check(library.sunder_simulation_destroy(simulation))
check(library.sunder_scene_destroy(scene))
print(f"python: {sum(destroyed)} destroyed")
