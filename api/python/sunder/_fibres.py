# SPDX-License-Identifier: Apache-2.0
"""Directions of fibres along a curve and along a surface, an array (tets, 3) as the program has
them: C takes them as a field."""
import numpy as np

from . import _arrays
from .errors import InputError

_AT_ONCE = 4096  # elements


def directions(mesh, family, what):
    middles = mesh.nodes[mesh.tets].mean(axis=1)
    if family.get("curve") is not None:
        points = _arrays.reals(family["curve"], f"curve of {what}", (None, 3))
        return _along_curve(middles, points, what)
    direction = _arrays.reals(family["direction"], f"direction of {what}", (3,))
    name = family["surface"]
    if name not in mesh.surfaces:
        raise InputError(f"{what} has surface = \"{name}\", which the mesh has not")
    return _along_surface(middles, mesh.nodes[mesh.surfaces[name]], direction, what)


def _along_curve(middles, points, what):
    if len(points) < 2:
        raise InputError(f"curve of {what} needs two points or more")
    pieces = np.diff(points, axis=0)
    squares = (pieces**2).sum(axis=1)
    if not (squares > 0).all():
        raise InputError(f"curve of {what} has a point twice in a row")
    found = np.empty_like(middles)
    for first in range(0, len(middles), _AT_ONCE):
        way = middles[first:first + _AT_ONCE, None] - points[None, :-1]
        at = np.clip((way * pieces).sum(axis=2) / squares, 0, 1)
        distance = ((way - at[..., None] * pieces)**2).sum(axis=2)
        found[first:first + _AT_ONCE] = pieces[distance.argmin(axis=1)]
    return np.ascontiguousarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _along_surface(middles, corners, direction, what):
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    places = corners.mean(axis=1)
    length = np.linalg.norm(direction)
    if not length > 0:
        raise InputError(f"direction of {what} is zero")
    found = np.empty_like(middles)
    for first in range(0, len(middles), 256):
        part = middles[first:first + 256]
        nearest = ((part[:, None] - places[None])**2).sum(axis=2).argmin(axis=1)
        n = normals[nearest]
        found[first:first + 256] = direction / length - n * (n @ (direction / length))[:, None]
    size = np.linalg.norm(found, axis=1, keepdims=True)
    if not (size > 1e-6).all():
        raise InputError(f"direction of {what} is across its surface at element "
                         f"{int((size <= 1e-6).argmax())}")
    return np.ascontiguousarray(found / size)
