# SPDX-License-Identifier: Apache-2.0
"""Gmsh's .msh, versions 2.2 and 4.1, text and binary: what a mesh of tetrahedra takes from it, as
the program takes it (docs/interface.md "Meshes")."""
import numpy as np

from .errors import InputError

_NODES_OF = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 13: 18,
             14: 14, 15: 1, 16: 8, 17: 20, 18: 15, 19: 13, 20: 9, 21: 10, 22: 12, 23: 15, 24: 15,
             25: 21, 26: 4, 27: 5, 28: 6, 29: 20, 30: 35, 31: 56}
_TRIANGLES, _TETS = (2, 9, 20, 21), (4, 11, 29, 30)


class _Reader:
    """Numbers one after the other, from text or from binary."""

    def __init__(self, data, path):
        self.data, self.path, self.at, self.binary = data, path, 0, False

    def fail(self, what):
        raise InputError(f"{self.path}: {what}")

    def line(self):
        end = self.data.find(b"\n", self.at)
        if end < 0:
            self.fail("it ends in the middle")
        text, self.at = self.data[self.at:end], end + 1
        return text.decode("utf-8", "replace").strip()

    def numbers(self, count, dtype):
        if self.binary:
            size = count * np.dtype(dtype).itemsize
            if count < 0 or self.at + size > len(self.data):
                self.fail("it ends in the middle")
            values = np.frombuffer(self.data, dtype, count, self.at)
            self.at += size
            return values
        words = []
        while len(words) < count:
            words += self.line().split()
        try:
            return np.array(words[:count], dtype=float).astype(dtype)
        except ValueError:
            self.fail("a number is expected and is not there")

    def section(self, name):
        """To behind the line $name; False: there is none."""
        place = self.data.find(b"$" + name.encode() + b"\n")
        if place < 0:
            place = self.data.find(b"$" + name.encode() + b"\r\n")
        if place < 0:
            return False
        self.at = place
        self.line()
        return True


def read(path):
    """The arguments of a Mesh. Raises InputError."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    r = _Reader(data, path)
    if not r.section("MeshFormat"):
        r.fail("no .msh file: it does not begin with $MeshFormat")
    version, binary, _ = (r.line().split() + ["", "", ""])[:3]
    r.binary = binary == "1"
    if version not in ("2.2", "4.1"):
        r.fail(f"version {version} of .msh; allowed are 2.2 and 4.1")
    names = _names(r)
    read_nodes, read_cells = (_nodes_2, _cells_2) if version == "2.2" else (_nodes_4, _cells_4)
    entities = _entities_4(r) if version == "4.1" else {}
    if not r.section("Nodes"):
        r.fail("it has no nodes")
    tags, points = read_nodes(r)
    if not r.section("Elements"):
        r.fail("it has no elements")
    cells = read_cells(r, entities)
    place = np.full(int(tags.max(initial=0)) + 1, -1, np.int64)
    place[tags] = np.arange(len(tags))
    tets, of, surfaces = [], [], {}
    for kind, physical, corners in cells:
        if corners.size and (corners.min() < 0 or corners.max() >= len(place)):
            r.fail("an element has a node that is not there")
        corners = place[corners]
        if (corners < 0).any():
            r.fail("an element has a node that is not there")
        if kind in _TETS:
            tets.append(corners[:, :4])
            of.append(physical)
        elif kind in _TRIANGLES:
            for tag in np.unique(physical):
                name = names.get((2, int(tag)))
                if name:
                    surfaces.setdefault(name, []).append(corners[physical == tag, :3])
    if not tets:
        r.fail("it has no tetrahedra")
    return without_unused(points, np.concatenate(tets), np.concatenate(of), names,
                          {n: np.concatenate(t) for n, t in surfaces.items()})


def without_unused(points, tets, tags, names, surfaces):
    """Nodes that no tetrahedron uses are left out; a group without name is volume-TAG."""
    used, renumbered = np.unique(tets, return_inverse=True)
    place = np.full(len(points), -1, np.int64)
    place[used] = np.arange(len(used))
    present = np.unique(tags)
    name_of = [names.get((3, int(t))) or (f"volume-{t}" if t else "volume") for t in present]
    kept = {}
    for name, triangles in surfaces.items():
        triangles = place[triangles]
        kept[name] = triangles[(triangles >= 0).all(axis=1)]
    return {"nodes": points[used], "tets": renumbered.reshape(tets.shape),
            "volume_of": np.searchsorted(present, tags), "volumes": tuple(name_of),
            "surfaces": kept}


def _names(r):
    names = {}
    if r.section("PhysicalNames"):
        for _ in range(int(r.line())):
            dimension, tag, name = r.line().split(maxsplit=2)
            names[int(dimension), int(tag)] = name.strip().strip('"')
    return names


def _nodes_2(r):
    count = int(r.line())
    if r.binary:
        rows = r.numbers(count, np.dtype([("tag", "<i4"), ("x", "<f8", 3)]))
        return rows["tag"], rows["x"].astype(float)
    rows = r.numbers(4 * count, float).reshape(-1, 4)
    return rows[:, 0].astype(np.int64), rows[:, 1:]


def _cells_2(r, _):
    count, cells = int(r.line()), []
    if not r.binary:
        by_kind = {}
        for _ in range(count):
            row = [int(w) for w in r.line().split()]
            if len(row) < 3 or row[1] not in _NODES_OF:
                r.fail("an element is not one")
            by_kind.setdefault(row[1], []).append((row[3] if row[2] else 0, row[3 + row[2]:]))
        for kind, rows in by_kind.items():
            if any(len(corners) != _NODES_OF[kind] for _, corners in rows):
                r.fail("an element has another number of nodes than its type")
            cells.append((kind, np.array([p for p, _ in rows]), np.array([n for _, n in rows])))
        return cells
    while count > 0:
        kind, here, tags = (int(v) for v in r.numbers(3, "<i4"))
        if kind not in _NODES_OF or here < 1:
            r.fail("a block of elements is not one")
        rows = r.numbers(here * (1 + tags + _NODES_OF[kind]), "<i4").reshape(here, -1)
        cells.append((kind, rows[:, 1] if tags else np.zeros(here, int), rows[:, 1 + tags:]))
        count -= here
    return cells


def _entities_4(r):
    """(dimension, entity): physical tag, 0: none."""
    found = {}
    if not r.section("Entities"):
        return found
    counts = [int(n) for n in r.numbers(4, "<u8")]
    for dimension, count in enumerate(counts):
        for _ in range(count):
            if r.binary:
                tag = int(r.numbers(1, "<i4")[0])
                r.numbers(3 if dimension == 0 else 6, "<f8")
                physical = r.numbers(int(r.numbers(1, "<u8")[0]), "<i4")
                if dimension:
                    r.numbers(int(r.numbers(1, "<u8")[0]), "<i4")
            else:
                row = r.line().split()
                tag, at = int(row[0]), 4 if dimension == 0 else 7
                physical = [int(p) for p in row[at + 1:at + 1 + int(row[at])]]
            found[dimension, tag] = abs(int(physical[0])) if len(physical) else 0
    return found


def _nodes_4(r):
    blocks = int(r.numbers(4, "<u8")[0])
    tags, points = [], []
    for _ in range(blocks):
        if r.binary:
            r.numbers(3, "<i4")
            count = int(r.numbers(1, "<u8")[0])
        else:
            count = int(r.line().split()[3])
        tags.append(r.numbers(count, "<u8").astype(np.int64))
        points.append(r.numbers(3 * count, "<f8").reshape(-1, 3))
    return np.concatenate(tags), np.concatenate(points)


def _cells_4(r, entities):
    cells = []
    for _ in range(int(r.numbers(4, "<u8")[0])):
        dimension, entity, kind = (int(v) for v in r.numbers(3, "<i4")) if r.binary else (0, 0, 0)
        if r.binary:
            count = int(r.numbers(1, "<u8")[0])
        else:
            dimension, entity, kind, count = (int(w) for w in r.line().split())
        if kind not in _NODES_OF:
            r.fail("a block of elements is not one")
        rows = r.numbers(count * (1 + _NODES_OF[kind]), "<u8").reshape(count, -1).astype(np.int64)
        cells.append((kind, np.full(count, entities.get((dimension, entity), 0)), rows[:, 1:]))
    return cells
