# SPDX-License-Identifier: Apache-2.0
"""Meshes of tetrahedra: from arrays, from meshio-like objects, from files."""
from __future__ import annotations

import dataclasses
import os
import pathlib
from typing import Any

import numpy as np

from . import _arrays, _msh
from .errors import InputError


@dataclasses.dataclass
class Mesh:
    """A body of tetrahedra with named volumes and surfaces.

    nodes: (nodes, 3) float64, coordinates [mm].
    tets: (tets, 4) int32, node ids from 0, in either orientation.
    volume_of: (tets,) int32, which of `volumes` each tetrahedron belongs to; None: all to the first.
    volumes: names of the volumes; a scene's materials go by them.
    surfaces: named sets of triangles, (triangles, 3) int32 each, to select nodes by.
    """
    nodes: np.ndarray
    tets: np.ndarray
    volume_of: np.ndarray | None = None
    volumes: tuple[str, ...] = ("volume",)
    surfaces: dict[str, np.ndarray] = dataclasses.field(default_factory=dict)

    def __post_init__(self):
        self.nodes = _arrays.reals(self.nodes, "nodes", (None, 3))
        self.tets = _arrays.ids(self.tets, "tets", (None, 4))
        count = len(self.tets)
        if self.volume_of is None:
            self.volume_of = np.zeros(count, np.int32)
        self.volume_of = _arrays.ids(self.volume_of, "volume_of", (count,))
        self.volumes = tuple(self.volumes)
        if len(set(self.volumes)) != len(self.volumes):
            raise InputError("volumes has a name twice")
        if count and not (0 <= self.volume_of.min() and self.volume_of.max() < len(self.volumes)):
            raise InputError(f"volume_of has an index outside 0 to {len(self.volumes) - 1}")
        self.surfaces = {name: _arrays.ids(t, f"surface {name!r}", (None, 3))
                         for name, t in self.surfaces.items()}

    @classmethod
    def read(cls, path: str | os.PathLike) -> "Mesh":
        """A .msh of version 2.2 or 4.1 (text and binary) by a reader of its own; another format by
        meshio, where that is installed. Nodes that no tetrahedron uses are left out, as the program
        leaves them out. Raises InputError."""
        path = pathlib.Path(path)
        if path.suffix == ".msh":
            return cls(**_msh.read(path))
        try:
            import meshio
        except ImportError:
            raise InputError(f"{path}: without meshio only .msh is read; `sunder mesh` or gmsh "
                             "make one") from None
        return cls.of(meshio.read(path))

    @classmethod
    def of(cls, mesh: Any) -> "Mesh":
        """From a Mesh, a pair (nodes, tets), or an object like meshio's, with `points` and `cells`
        (blocks with `type` and `data`, or a dict); volumes by `cell_data["gmsh:physical"]` and
        `field_data` where they are there."""
        if isinstance(mesh, cls):
            return mesh
        if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
            return cls(*mesh)
        if not hasattr(mesh, "points") or not hasattr(mesh, "cells"):
            raise InputError(f"a mesh is a Mesh, a pair (nodes, tets) or has points and cells, as "
                             f"meshio's have; not {type(mesh).__name__}")
        return cls(**_of_meshio(mesh))

    def surface_nodes(self, name: str) -> np.ndarray:
        """(k,) ids of a named surface's nodes, ascending."""
        if name not in self.surfaces:
            raise InputError(f'the mesh has no surface "{name}"; it has {list(self.surfaces)}')
        return np.unique(self.surfaces[name])


def _of_meshio(mesh):
    blocks = list(mesh.cells.items()) if isinstance(mesh.cells, dict) else [
        (b.type, b.data) if hasattr(b, "type") else tuple(b) for b in mesh.cells]
    physical = (getattr(mesh, "cell_data", None) or {}).get("gmsh:physical")
    names = {(int(v[1]), int(v[0])): k for k, v in (getattr(mesh, "field_data", None) or {}).items()}
    tets, tags, triangles = [], [], {}
    for i, (kind, data) in enumerate(blocks):
        of = None
        if physical is not None:
            of = physical[kind] if isinstance(physical, dict) else physical[i]
        if kind in ("tetra", "tetra10"):
            tets.append(np.asarray(data)[:, :4])
            tags.append(np.zeros(len(data), int) if of is None else np.asarray(of))
        elif kind in ("triangle", "triangle6") and of is not None:
            for tag in np.unique(of):
                name = names.get((2, int(tag)))
                if name:
                    triangles.setdefault(name, []).append(np.asarray(data)[np.asarray(of) == tag, :3])
    if not tets:
        raise InputError("the mesh has no tetrahedra")
    return _msh.without_unused(np.asarray(mesh.points, dtype=float), np.concatenate(tets),
                               np.concatenate(tags), names,
                               {n: np.concatenate(t) for n, t in triangles.items()})
