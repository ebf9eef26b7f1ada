# SPDX-License-Identifier: Apache-2.0
"""Sunder: soft tissue that tears. Units are mm, N, MPa, s; angles are in degrees; ids count from 0.

    import sunder
    with sunder.run("scene.toml", progress=True) as torn:
        torn.plot(path="torn.png")
"""
from __future__ import annotations

import ctypes as _ctypes
from typing import Any

from . import _c
from .errors import (AllowedError, BusyError, Cancelled, DeviceError, Error, HandleError, InputError,
                     InternalError, NumericalError, OrderError, OutOfMemory, SizeError)
from .mesh import Mesh
from .plotting import plot
from .scene import Scene, devices, presets
from .simulation import Bodies, Frames, Grips, Simulation, Step, cause_name
from .sweeping import sweep

constants: dict[str, int] = _c.constants


def _version() -> str:
    numbers = [_ctypes.c_int32() for _ in range(3)]
    _c.library.sunder_version(*(_ctypes.addressof(n) for n in numbers))
    return ".".join(str(n.value) for n in numbers)


__version__ = _version()


def run(source: Any, *, set: dict[str, Any] | None = None, mesh: Any = None,
        progress: Any = False) -> Simulation:
    """All steps of a scene (what Scene() takes), and the simulation at its end."""
    with Scene(source, set=set, mesh=mesh) as scene:
        simulation = Simulation(scene)
    try:
        simulation.run(progress)
    except BaseException:
        simulation.close()
        raise
    return simulation


__all__ = [
    "AllowedError", "Bodies", "BusyError", "Cancelled", "DeviceError", "Error", "Frames", "Grips",
    "HandleError", "InputError", "InternalError", "Mesh", "NumericalError", "OrderError", "OutOfMemory", "Scene",
    "Simulation", "SizeError", "Step", "cause_name", "constants", "devices", "plot", "presets", "run",
    "sweep",
]
