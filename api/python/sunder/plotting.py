# SPDX-License-Identifier: Apache-2.0
"""A picture of a body in one call, by matplotlib where it is installed."""
from __future__ import annotations

import os
from typing import Any, Sequence

import numpy as np

from .errors import InputError

# Faces of a tetrahedron of positive volume, normals outwards, and the corner that each leaves out.
_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
_FIELDS = ("max_shear", "yield_ratio", "displacement")


def free_faces(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (faces, 3), node ids, that one of the tetrahedra (m, 4) alone has, and the ids of those
    whose they are (faces,)."""
    triangles = corners[:, _FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True,
                                return_counts=True)
    alone = np.sort(first[count == 1])
    return triangles[alone], alone // 4


def plot(simulation: Any, field: str = "max_shear", *, scale: float = 1.0,
         path: str | os.PathLike | None = None, limits: Sequence[float] | None = None,
         axes: Any = None, view: Sequence[float] = (80, -90)) -> Any:
    """Draws the living surface of a simulation's body, displaced, coloured by a field.

    field: "max_shear" [MPa], "yield_ratio" or "displacement" [mm].
    scale: of the displacement; 1 is true scale.
    path: picture to write; else nothing is written.
    limits: (2,), of the colours. axes: matplotlib's of a 3D projection, to draw into.
    view: elevation and azimuth [deg].
    Returns matplotlib's axes. Raises ImportError without matplotlib.
    """
    if field not in _FIELDS:
        raise InputError(f"field is {field!r}; allowed are {', '.join(_FIELDS)}")
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection
    except ImportError:
        raise ImportError("sunder.plot needs matplotlib (Debian: python3-matplotlib)") from None
    live = ~simulation.destroyed()
    elements = np.flatnonzero(live)
    parents = simulation.body_parents()
    u = simulation.body_displacement()
    x = simulation.mesh.nodes[parents] + scale * u
    faces, owner = free_faces(simulation.body_corners()[live])
    if field == "displacement":
        colour = np.linalg.norm(u, axis=1)[faces].mean(axis=1)
    else:
        colour = getattr(simulation, field)()[elements[owner]]
    figure = None
    if axes is None:
        figure = Figure(figsize=(8, 7))
        FigureCanvasAgg(figure)
        axes = figure.add_subplot(projection="3d")
    surface = Poly3DCollection(x[faces], linewidths=0.2, edgecolors=(0, 0, 0, 0.35), cmap="viridis")
    surface.set_array(colour)
    surface.set_clim(*(limits if limits is not None else (colour.min(initial=0), colour.max(initial=1e-30))))
    axes.add_collection3d(surface)
    shown = x[np.unique(faces)] if len(faces) else simulation.mesh.nodes
    low, high = shown.min(axis=0), shown.max(axis=0)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(np.maximum(high - low, 1e-9))
    axes.view_init(*view)
    axes.set_axis_off()
    axes.set_title(simulation.title)
    units = {"max_shear": "maximum shear stress [MPa]", "yield_ratio": "yield ratio",
             "displacement": "displacement [mm]"}
    axes.figure.colorbar(surface, ax=axes, shrink=0.6, label=units[field])
    if path is not None:
        axes.figure.savefig(path, dpi=120, bbox_inches="tight")
    return axes
