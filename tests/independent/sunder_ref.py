#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The method a second time, written from docs/method.md's rules alone, in another language.
It shares no line and no data structure with the library; compare.py holds the two together.

usage: sunder_ref.py SCENE.toml -o OUT/events.csv [--trace trace.json] [--set key.path=value]... [--quiet]
writes OUT/events.csv, OUT/cracks.json (and the trace: everything every tip computed at every decision).

fp64; K(damage) is assembled and factorised afresh (SuperLU) at every event, one step of refinement.
"[n]" in comments is the rule number of docs/method.md.
"""
import os
os.environ.setdefault("OMP_NUM_THREADS", "1")
import sys, json, math, argparse, time
import tomllib
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl


class InputError(Exception):
    pass


# Readings that can be switched with --reading key=value (the first value is the default)
READ = {"ray": "ray",              # ray | line: "within 0.2 h / h of the ray", behind the tip
        "fewer": "all",            # all | least: "such elements" of the tie rule of [10]
        "relabel": "yes",          # yes | no: a labelled node of a newly destroyed element gets its new side
        "born_order": "low",       # low | high: first tip of an internal crack born from an MSS rupture
        "F": "current",            # current | pristine: reactions of displaced grips in s of [7]
        "tool_floor": "no",        # no | yes: crack_length "tool" uses b' with its floor h/2
        "taken": "dead",           # dead | live: elements taken by an earlier tip of the same event, in [10]'s choice of side
        "preset_labels": "no",     # no | yes: nodes of a preset's and a born crack's elements are labelled by the side of the path
        "end_K0": "v"}             # v | K: a tip's band is looked at when v != 0 | when K > 0


# ------------------------------------------------------------------ mesh
class Mesh:
    pass


def read_msh(path):
    with open(path) as f:
        lines = f.read().split("\n")
    names = {}
    raw = {}
    order = []
    tets, tags, tris, tritags = [], [], [], []
    i = 0
    while i < len(lines):
        s = lines[i].strip()
        if s == "$MeshFormat":
            if not lines[i + 1].split()[0].startswith("2.2") or lines[i + 1].split()[1] != "0":
                raise InputError("only msh 2.2 ascii")
        elif s == "$PhysicalNames":
            for k in range(int(lines[i + 1])):
                d, t, n = lines[i + 2 + k].split(None, 2)
                names[(int(d), int(t))] = n.strip().strip('"')
        elif s == "$Nodes":
            n = int(lines[i + 1])
            for k in range(n):
                w = lines[i + 2 + k].split()
                raw[int(w[0])] = (float(w[1]), float(w[2]), float(w[3]))
                order.append(int(w[0]))
            i += n
        elif s == "$Elements":
            n = int(lines[i + 1])
            for k in range(n):
                w = [int(x) for x in lines[i + 2 + k].split()]
                nt = w[2]
                phys = w[3] if nt else 0
                nodes = w[3 + nt:]
                if w[1] == 4:
                    tets.append(nodes)
                    tags.append(phys)
                elif w[1] == 2:
                    tris.append(nodes)
                    tritags.append(phys)
            i += n
        i += 1
    used = set(x for t in tets for x in t)
    kept = [x for x in order if x in used]
    m = Mesh()
    m.dropped = len(order) - len(kept)
    new = {x: k for k, x in enumerate(kept)}
    m.X = np.array([raw[x] for x in kept])
    m.T = np.array([[new[x] for x in t] for t in tets], dtype=int)
    m.vol_name = [names.get((3, t)) for t in tags]
    m.volumes = sorted(set(names[k] for k in names if k[0] == 3))
    m.surf = {}
    for t, g in zip(tris, tritags):
        n = names.get((2, g))
        if n and all(x in new for x in t):
            m.surf.setdefault(n, set()).update(new[x] for x in t)
    return m


# ------------------------------------------------------------------ scene
ALLOWED = {
    "": {"title", "mesh", "material", "fixed", "instrument", "crack", "destroy", "fracture", "solver", "time", "output"},
    "material": {"young", "poisson", "yield"},
    "fixed": {"box", "nodes", "near", "radius", "surface", "axes"},
    "instrument": {"name", "kind", "box", "nodes", "near", "radius", "surface", "force", "displacement", "axes", "ramp",
                   "at", "side", "crack"},
    "crack": {"volume", "elements", "mouth", "tip", "tips"},
    "destroy": {"step", "elements", "volume", "box"},
    "fracture": {"model", "alpha", "yield_measure", "sigma0", "crack_length", "sif", "max_events", "plane_normal"},
    "time": {"steps"},
}


def check_keys(d, where):
    for k in d:
        if k not in ALLOWED[where]:
            raise InputError("unknown key %s.%s" % (where, k))


def select_nodes(m, d, what):
    X = m.X
    if "box" in d:
        lo, hi = np.array(d["box"][0], float), np.array(d["box"][1], float)
        ids = np.nonzero(np.all((X >= lo) & (X <= hi), axis=1))[0]
    elif "nodes" in d:
        ids = np.array(d["nodes"], int)
    elif "near" in d:
        ids = np.nonzero(np.linalg.norm(X - np.array(d["near"], float), axis=1) <= d["radius"])[0]
    elif "surface" in d:
        ids = np.array(sorted(m.surf[d["surface"]]), int)
    else:
        raise InputError(what + ": no node selection")
    if len(ids) == 0:
        raise InputError(what + ": selects no nodes")
    return ids


def select_elements(m, d, what):
    if "elements" in d:
        ids = list(d["elements"])
    elif "volume" in d:
        ids = [i for i, v in enumerate(m.vol_name) if v == d["volume"]]
    elif "box" in d:
        c = m.X[m.T].mean(axis=1)
        lo, hi = np.array(d["box"][0], float), np.array(d["box"][1], float)
        ids = list(np.nonzero(np.all((c >= lo) & (c <= hi), axis=1))[0])
    else:
        raise InputError(what + ": no element selection")
    if not ids:
        raise InputError(what + ": selects no elements")
    for e in ids:
        if not 0 <= e < len(m.T):
            raise InputError(what + ": element id out of range")
    return [int(e) for e in ids]


# ------------------------------------------------------------------ FEM [1]-[3]
class Fem:
    permc = "MMD"          # --permc COLAMD: another elimination order, to see what rounding can change

    """Elasticity [1]: Voigt order xx yy zz xy yz zx, engineering shear."""

    def __init__(self, m, E, nu, held):
        X, T = m.X, m.T
        ne, self.nn = len(T), len(X)
        J = np.stack([X[T[:, k]] - X[T[:, 0]] for k in (1, 2, 3)], axis=2)   # columns: edges
        det = np.linalg.det(J)
        if np.any(det == 0):
            raise InputError("degenerate tetrahedron")
        self.V = np.abs(det) / 6
        # gradients of the barycentric coordinates 1..3: rows of J^-1
        Ji = np.linalg.inv(J)
        G = np.zeros((ne, 4, 3))
        G[:, 1:, :] = Ji
        G[:, 0, :] = -Ji.sum(axis=1)
        B = np.zeros((ne, 6, 12))
        for a in range(4):
            gx, gy, gz = G[:, a, 0], G[:, a, 1], G[:, a, 2]
            B[:, 0, 3 * a] = gx
            B[:, 1, 3 * a + 1] = gy
            B[:, 2, 3 * a + 2] = gz
            B[:, 3, 3 * a] = gy
            B[:, 3, 3 * a + 1] = gx
            B[:, 4, 3 * a + 1] = gz
            B[:, 4, 3 * a + 2] = gy
            B[:, 5, 3 * a + 2] = gx
            B[:, 5, 3 * a] = gz
        lam = E * nu / ((1 + nu) * (1 - 2 * nu))
        mu = E / (2 * (1 + nu))
        D = np.zeros((ne, 6, 6))
        for i in range(3):
            for j in range(3):
                D[:, i, j] = lam
            D[:, i, i] = lam + 2 * mu
            D[:, i + 3, i + 3] = mu
        self.DB = D @ B
        self.Ke = self.V[:, None, None] * (B.transpose(0, 2, 1) @ self.DB)
        self.edof = (3 * T[:, :, None] + np.arange(3)[None, None, :]).reshape(ne, 12)
        self.I = np.repeat(self.edof, 12, axis=1).ravel()
        self.J = np.tile(self.edof, (1, 12)).ravel()
        nd = 3 * self.nn
        self.held = np.zeros(nd, bool)
        self.held[held] = True
        self.free = np.nonzero(~self.held)[0]

    def factor(self, scale):
        """K = sum scale_e K_e; factor of its free block."""
        nd = 3 * self.nn
        K = sp.csc_matrix(((scale[:, None, None] * self.Ke).ravel(), (self.I, self.J)), shape=(nd, nd))
        Kff = K[self.free][:, self.free].tocsc()
        if self.permc == "COLAMD":
            lu = spl.splu(Kff, permc_spec="COLAMD")
        else:
            lu = spl.splu(Kff, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return K, Kff, lu

    def solve(self, fac, f, u0):
        """u with u = u0 on the held dofs, and the forces (K u - f) that hold them."""
        K, Kff, lu = fac
        u = np.where(self.held, u0, 0.0)
        r = (f - K @ u)[self.free]
        x = lu.solve(r)
        x += lu.solve(r - Kff @ x)
        u[self.free] = x
        react = np.where(self.held, K @ u - f, 0.0)
        return u, react

    def stress(self, u, scale):
        return scale[:, None] * np.einsum("eij,ej->ei", self.DB, u[self.edof])


def tensor(s):
    return np.array([[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]])


def max_shear(S):
    """tau = (s1 - s3)/2 [2]"""
    A = np.zeros((len(S), 3, 3))
    A[:, 0, 0], A[:, 1, 1], A[:, 2, 2] = S[:, 0], S[:, 1], S[:, 2]
    A[:, 0, 1] = A[:, 1, 0] = S[:, 3]
    A[:, 1, 2] = A[:, 2, 1] = S[:, 4]
    A[:, 0, 2] = A[:, 2, 0] = S[:, 5]
    w = np.linalg.eigvalsh(A)
    return 0.5 * (w[:, 2] - w[:, 0])


# ------------------------------------------------------------------ plane geometry
def left(d):
    return np.array([-d[1], d[0]])


def principal2(t):
    """largest principal value of [[t0, t2], [t2, t1]], its unit direction, equal?"""
    m, q, r = 0.5 * (t[0] + t[1]), 0.5 * (t[0] - t[1]), t[2]
    rad = math.hypot(q, r)
    phi = 0.5 * math.atan2(r, q)
    equal = rad <= 1e-14 * max(abs(t[0]), abs(t[1]), abs(t[2]), 1e-300)
    return m + rad, np.array([math.cos(phi), math.sin(phi)]), equal


def path_length(path):
    return float(sum(np.linalg.norm(path[i + 1] - path[i]) for i in range(len(path) - 1)))


def path_middle(path):
    """middle by arc length: point, unit direction of its segment"""
    half = 0.5 * path_length(path)
    acc = 0.0
    for i in range(len(path) - 1):
        v = path[i + 1] - path[i]
        l = float(np.linalg.norm(v))
        if l > 0 and (acc + l >= half or i == len(path) - 2):
            return path[i] + (half - acc) / l * v, v / l
        acc += l
    raise InputError("crack path of no length")


def side_of_path(path, x):
    """sign of x by the nearest segment: +1 left of the path's direction, 0 on it"""
    best = None
    for i in range(len(path) - 1):
        a, v = path[i], path[i + 1] - path[i]
        l2 = float(v @ v)
        if l2 == 0:
            continue
        s = min(max(float((x - a) @ v) / l2, 0.0), 1.0)
        dist = float(np.linalg.norm(x - a - s * v))
        if best is None or dist < best[0]:
            best = (dist, float(left(v) @ (x - a)) / math.sqrt(l2))
    c = best[1]
    return 0 if abs(c) < 1e-9 else (1 if c > 0 else -1)


class Tip:
    def __init__(self, p, d, orient):
        self.p, self.d = np.array(p, float), np.array(d, float)
        self.orient = orient          # +1: moves along the path's direction, -1: against it
        self.ended = False


class Crack:
    def __init__(self, cid, kind, path, tips, elements):
        self.id, self.kind = cid, kind
        self.path = [np.array(x, float) for x in path]   # from the mouth, or from tip 0 to tip 1
        self.tips = tips
        self.elements = list(elements)
        self.label = {}               # node -> +1 left of the path, -1 right of it

    def a(self):
        l = path_length(self.path)
        return l if self.kind == "edge" else 0.5 * l

    def n_up(self, e_ref=None):
        """[7] normal at the mouth / middle, and the sign (+1: upper = left of the path)"""
        if self.kind == "edge":
            i = next(i for i in range(len(self.path) - 1) if np.linalg.norm(self.path[i + 1] - self.path[i]) > 0)
            v = self.path[i + 1] - self.path[i]
            v = v / np.linalg.norm(v)
        else:
            v = path_middle(self.path)[1]
        n = left(v)
        flip = (n[0] < 0) if abs(n[1]) < 0.1 else (n[1] < 0)
        return (-n, -1) if flip else (n, 1)


# ------------------------------------------------------------------ instruments
class Instrument:
    pass


# ------------------------------------------------------------------ the simulation
class Sim:
    def __init__(self, scene, base, quiet=False, trace=False):
        self.quiet = quiet
        self.want_trace = trace
        self.trace = []
        self.warnings = []
        self.t0 = time.time()
        check_keys(scene, "")
        mp = scene["mesh"]
        self.m = m = read_msh(mp if os.path.isabs(mp) else os.path.join(base, mp))
        if m.dropped:
            self.warn("%d nodes used by no tetrahedron dropped" % m.dropped)
        self.ne, self.nn = len(m.T), len(m.X)
        mats = scene["material"]
        E, nu, y = np.zeros(self.ne), np.zeros(self.ne), np.full(self.ne, np.inf)
        for e, v in enumerate(m.vol_name):
            if v not in mats:
                raise InputError("volume without material: %s" % v)
            E[e], nu[e], y[e] = mats[v]["young"], mats[v]["poisson"], mats[v].get("yield", np.inf)
        for v in mats:
            check_keys(mats[v], "material")
        self.yield_ = y
        self.breakable = np.isfinite(y)

        fr = scene.get("fracture", {})
        check_keys(fr, "fracture")
        self.model = fr.get("model", "none")
        self.alpha = fr.get("alpha", 1e-6)
        self.measure = fr.get("yield_measure", "max_shear")
        self.sigma0 = fr.get("sigma0", "line")
        self.crack_length = fr.get("crack_length", "path")
        self.max_events = fr.get("max_events", 10000)
        if self.model not in ("none", "A", "B") or fr.get("sif", "formula") != "formula":
            raise InputError("fracture model/sif not covered by this reference")
        if self.measure not in ("max_shear", "tresca") or self.sigma0 not in ("line", "tip") \
                or self.crack_length not in ("path", "tool"):
            raise InputError("bad fracture option")
        check_keys(scene.get("time", {}), "time")
        self.steps = scene.get("time", {}).get("steps", 1)

        self.geometry(fr.get("plane_normal"))

        held, self.u0 = [], np.zeros(3 * self.nn)
        fixed = np.zeros(3 * self.nn, bool)
        for d in scene.get("fixed", []):
            check_keys(d, "fixed")
            for n in select_nodes(m, d, "fixed"):
                for c in d.get("axes", "xyz"):
                    fixed[3 * n + "xyz".index(c)] = True
        owner = {}
        self.instruments = []
        for k, d in enumerate(scene.get("instrument", [])):
            check_keys(d, "instrument")
            i = Instrument()
            i.name, i.kind, i.ramp = d.get("name", "instrument %d" % k), d["kind"], d.get("ramp")
            i.force = np.array(d["force"], float) if "force" in d else None
            i.disp = np.array(d["displacement"], float) if "displacement" in d else None
            if (i.force is None) == (i.disp is None):
                raise InputError("instrument: exactly one of force, displacement")
            if i.kind == "expansion":
                i.nodes = select_nodes(m, d, i.name)
                if i.disp is not None:
                    i.axes = [("xyz").index(c) for c in d.get("axes", "xyz")]
                    for n in i.nodes:
                        for c in i.axes:
                            if fixed[3 * n + c] or 3 * n + c in owner:
                                raise InputError("%s: dof held twice" % i.name)
                            owner[3 * n + c] = i
            elif i.kind == "pressure":
                if i.disp is not None:
                    raise InputError("a pressure instrument takes a force")
                i.at, i.side, i.crack = np.array(d["at"], float), d["side"], d["crack"]
                if i.side not in ("upper", "lower"):
                    raise InputError("side")
                i.pressed = None                   # list of (node, share)
            else:
                raise InputError("instrument kind")
            self.instruments.append(i)
        held = np.nonzero(fixed)[0].tolist() + sorted(owner)
        self.fem = Fem(m, E, nu, held)
        self.intact = self.fem.factor(np.ones(self.ne))

        # original free faces: in one tetrahedron only
        faces = {}
        for e, t in enumerate(m.T):
            for k in range(4):
                f = tuple(sorted(int(x) for j, x in enumerate(t) if j != k))
                faces.setdefault(f, []).append(e)
        self.free_faces = {}
        for f, es in faces.items():
            if len(es) == 1:
                self.free_faces.setdefault(es[0], []).append(f)

        self.node_elems = [[] for _ in range(self.nn)]
        for e, t in enumerate(m.T):
            for n in t:
                self.node_elems[n].append(e)

        self.live = np.ones(self.ne, bool)
        self.order = []
        self.cracks = []
        self.rows = []
        self.event = 0
        self.scripts = {}
        for d in scene.get("destroy", []):
            check_keys(d, "destroy")
            if not 0 <= d["step"] < self.steps:
                raise InputError("script for a step that does not exist")
            self.scripts.setdefault(d["step"], []).append(select_elements(m, d, "destroy"))
        self.presets = []
        for d in scene.get("crack", []):
            check_keys(d, "crack")
            self.presets.append((d, select_elements(m, d, "crack")))
        for i in self.instruments:
            if i.kind == "pressure" and i.crack >= len(self.presets) and self.model != "B":
                raise InputError("pressure on a crack that cannot exist")

    def warn(self, s):
        self.warnings.append(s)
        if not self.quiet:
            print("warning: " + s, file=sys.stderr)

    # ---- [Model B, Geometry]
    def geometry(self, plane_normal):
        X, T = self.m.X, self.m.T
        ext = X.max(axis=0) - X.min(axis=0)
        axes = sorted(range(3), key=lambda k: (-ext[k], k))      # ties: x before y before z
        I = np.eye(3)
        if plane_normal is None:
            self.e1, self.e2, self.e3 = I[axes[0]], I[axes[1]], I[axes[2]]
        else:
            n = np.array(plane_normal, float)
            n = n / np.linalg.norm(n)
            got = []
            for k in axes:
                v = I[k] - (I[k] @ n) * n
                for g in got:
                    v = v - (v @ g) * g
                if np.linalg.norm(v) > 1e-6 and len(got) < 2:
                    got.append(v / np.linalg.norm(v))
            self.e1, self.e2, self.e3 = got[0], got[1], n
        self.P = np.stack([X @ self.e1, X @ self.e2], axis=1)    # projected nodes
        z = X @ self.e3
        self.zmin, self.zmax = z.min(), z.max()
        self.z = z
        self.t = self.zmax - self.zmin
        self.lo, self.hi = self.P.min(axis=0), self.P.max(axis=0)
        pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
        Q = self.P[T]
        self.h = float(np.mean([np.linalg.norm(Q[:, a] - Q[:, b], axis=1) for a, b in pairs]))
        self.cen = Q.mean(axis=1)
        self.around_point = {}

    def proj(self, x):
        x = np.array(x, float)
        return np.array([x @ self.e1, x @ self.e2])

    def plane_tensor(self, s):
        """(11, 22, 12) of a Voigt stress in e1, e2"""
        A = tensor(s)
        return np.array([self.e1 @ A @ self.e1, self.e2 @ A @ self.e2, self.e1 @ A @ self.e2])

    def outline_distance(self, p):
        """to the bounding rectangle's sides, negative outside"""
        return float(min((p - self.lo).min(), (self.hi - p).min()))

    def chord(self, p, d):
        s0, s1 = -np.inf, np.inf
        for k in range(2):
            if abs(d[k]) > 1e-15:
                a, b = (self.lo[k] - p[k]) / d[k], (self.hi[k] - p[k]) / d[k]
                s0, s1 = max(s0, min(a, b)), min(s1, max(a, b))
        return float(s1 - s0)

    # ---- loads
    def factor_of(self, i, t):
        if i.ramp is None:
            return 1.0
        a, b = i.ramp
        if a == b:
            return 1.0 if t >= a else 0.0
        return min(max((t - a) / (b - a), 0.0), 1.0)

    def loads(self, t, pressure):
        f, u0 = np.zeros(3 * self.nn), np.zeros(3 * self.nn)
        for i in self.instruments:
            c = self.factor_of(i, t)
            if i.kind == "expansion":
                if i.force is not None:
                    for n in i.nodes:
                        f[3 * n:3 * n + 3] += c * i.force / len(i.nodes)
                else:
                    for n in i.nodes:
                        for k in i.axes:
                            u0[3 * n + k] = c * i.disp[k]
            elif pressure and i.pressed and c > 0:
                for n, w in i.pressed:
                    f[3 * n:3 * n + 3] += c * w * i.force
        return f, u0

    # ---- [7] pressed nodes
    def choose_pressed(self, i):
        cr = self.cracks[i.crack]
        up = cr.n_up()[1]
        want = up if i.side == "upper" else -up
        cand = []
        for n in sorted(set(int(x) for e in cr.elements for x in self.m.T[e])):
            if not any(self.live[e] for e in self.node_elems[n]):
                continue
            s = cr.label[n] if n in cr.label else side_of_path(cr.path, self.P[n])
            if s == want:
                cand.append(n)
        tol = 1e-6 * self.t
        at2 = self.proj(i.at)
        bot = [n for n in cand if abs(self.z[n] - self.zmin) <= tol]
        top = [n for n in cand if abs(self.z[n] - self.zmax) <= tol]

        def nearest2(ns):
            return min(ns, key=lambda n: (float(np.linalg.norm(self.P[n] - at2)), n))
        if not cand:
            self.warn_once("%s: no node to press" % i.name)
            i.pressed = []
        elif bot and top:
            i.pressed = [(nearest2(bot), 0.5), (nearest2(top), 0.5)]
        else:
            i.pressed = [(min(cand, key=lambda n: (float(np.linalg.norm(self.m.X[n] - i.at)), n)), 1.0)]
        if not self.quiet:
            print("  %s presses %s" % (i.name, [(n, [round(float(x), 3) for x in self.m.X[n]]) for n, w in i.pressed]),
                  file=sys.stderr)

    def update_pressed(self, t):
        for i in self.instruments:
            if i.kind != "pressure" or self.factor_of(i, t) <= 0 or i.crack >= len(self.cracks):
                continue
            lost = bool(i.pressed) and any(not any(self.live[e] for e in self.node_elems[n]) for n, w in i.pressed)
            if not i.pressed or lost:
                self.choose_pressed(i)

    # ---- bookkeeping
    def destroy(self, e):
        assert self.live[e]
        self.live[e] = False
        self.order.append(e)

    def row(self, step, t, e, crit, crack="", ratio="", extra=None):
        self.rows.append([step, self.event, e, crit, crack, ratio, t] + (extra or [""] * 11))

    def end_outline(self, tip):
        if self.outline_distance(tip.p) <= 0.05 * self.h:
            tip.ended = True

    # ---- pristine field (Geometry)
    def around(self, p):
        """Breakable elements within 1.5 h of p with their volumes; asked again and again."""
        key = p.tobytes()
        if key not in self.around_point:
            near = np.flatnonzero(self.breakable & (((self.cen - p) ** 2).sum(axis=1) <= (1.5 * self.h) ** 2))
            self.around_point[key] = near, self.fem.V[near]
        return self.around_point[key]

    def pristine_at(self, p):
        near, V = self.around(p)
        if not len(near):
            return None
        return self.plane_tensor(V @ self.prist[near] / V.sum())

    # ---- [5]-[8] of one tip
    def tip_state(self, cr, tip, t, F):
        h = self.h
        p, d = tip.p, tip.d
        r = {"crack": cr.id, "tip": cr.tips.index(tip), "p": p.copy(), "d": d.copy()}
        # [5]
        start = cr.path[0] if cr.kind == "edge" else path_middle(cr.path)[0]
        if self.sigma0 == "line":
            st = [start + (k + 0.5) / 9 * (p - start) for k in range(9)]
        else:
            st = [p]
        ts = [self.pristine_at(x) for x in st]
        ok = [x for x in ts if x is not None]
        r["stations"], r["station_tensors"] = st, ts
        n = left(d)
        if ok:
            mean = np.mean(ok, axis=0)
            s0, n1, _ = principal2(mean)
            cosb = min(1.0, abs(float(n @ n1)))
        else:
            mean, s0, n1, cosb = np.zeros(3), 0.0, n, 1.0
        r.update(mean=mean, s0=s0, n1=n1, cosb=cosb, beta=math.degrees(math.acos(cosb)))
        # [7]
        nu_, _ = cr.n_up()
        Pu = Pl = wsum = bsum = 0.0
        for i in self.instruments:
            if i.kind != "pressure" or i.crack != cr.id or not i.pressed:
                continue
            c = self.factor_of(i, t)
            if c <= 0:
                continue
            o = nu_ if i.side == "upper" else -nu_
            o3 = o[0] * self.e1 + o[1] * self.e2
            push = float(c * i.force @ o3)
            if push < 0:
                self.warn_once("%s: closing push counts zero" % i.name)
            Pi = max(0.0, push) / self.t
            if i.side == "upper":
                Pu += Pi
            else:
                Pl += Pi
            pos = np.mean([self.P[nn] for nn, w in i.pressed], axis=0)
            wsum += Pi
            bsum += Pi * float(np.linalg.norm(p - pos))
        tool = None
        Kb = Kc = 0.0
        ec = np.zeros(2)
        bp = None
        if wsum > 0:
            tool = bsum / wsum
            bp = max(tool, h / 2)
            Kb = 2 * min(Pu, Pl) / math.sqrt(2 * math.pi * bp)
            Kc = abs(Pu - Pl) / math.sqrt(2 * math.pi * bp)
            if Pu > Pl:
                ec = nu_
            elif Pl > Pu:
                ec = -nu_
        s = 1.0
        Fn = float(np.linalg.norm(F))
        if Fn > 0:
            dot = float((ec[0] * self.e1 + ec[1] * self.e2) @ F)
            if abs(dot) >= 1e-9 * Fn:
                s = 1.0 if dot > 0 else -1.0
        # [6]
        a = cr.a()
        if self.crack_length == "tool" and tool is not None:
            a = tool if READ["tool_floor"] == "no" else bp
        b = self.chord(p, d)
        if cr.kind == "edge":
            x = min(a / b, 0.95)
            if x <= 0.6:
                Fx = 1.12 - 0.231 * x + 10.55 * x**2 - 21.72 * x**3 + 30.39 * x**4
            else:
                q = math.pi * x / 2
                Fx = math.sqrt(2 / (math.pi * x) * math.tan(q)) * (0.752 + 2.02 * x + 0.37 * (1 - math.sin(q))**3) / math.cos(q)
        else:
            x = min(2 * a / b, 0.95)
            Fx = math.sqrt(1 / math.cos(math.pi * x / 2)) * (1 - 0.025 * x**2 + 0.06 * x**4)
        Ka = Fx * cosb**2 * max(s0, 0.0) * math.sqrt(math.pi * a)
        K = max(Ka + Kb + s * Kc, 0.0)
        # [8]
        tp = self.pristine_at(p)
        if tp is None:
            ea, n1p = d.copy(), None
        else:
            _, n1p, _ = principal2(tp)
            ea = left(n1p)
            dd = float(ea @ d)
            if dd < 0:
                ea = -ea
            elif dd == 0:
                ea = left(d)
        v = Ka * ea + Kb * d + Kc * ec
        grows = bool(np.linalg.norm(v) > 0)
        theta = 0.0
        if grows:
            theta = math.atan2(float(left(d) @ v), float(d @ v))
            theta = min(max(theta, -math.pi / 2), math.pi / 2)
        g = math.cos(theta) * d + math.sin(theta) * left(d)
        r.update(n_up=nu_, Pu=Pu, Pl=Pl, b_press=bp, s=s, F=F, a=a, b=b, x=x, Fx=Fx, Ka=Ka, Kb=Kb, Kc=Kc, K=K,
                 tensor_p=tp, n1_p=n1p, e_a=ea, e_c=ec, v=v, grows=grows, theta=theta, g=g)
        return r

    def warn_once(self, s):
        if s not in self.warnings:
            self.warn(s)

    # ---- [9], [10]
    def band_of(self, cr, tip, g):
        """band for the chosen side of the near nodes: (choice, side array, band ids in walking order, rho)"""
        h, p = self.h, tip.p
        m = left(g)
        T = self.m.T
        rel = self.P - p
        along, across = rel @ g, rel @ m
        dray = np.abs(across) if READ["ray"] == "line" else \
            np.where(along >= 0, np.abs(across), np.hypot(along, across))     # distance to the ray
        base = np.sign(across)
        lab = [(n, l * tip.orient) for n, l in cr.label.items() if dray[n] <= h]
        rho = (self.cen - p) @ g
        res = {}
        for c in (1, -1):
            side = base.copy()
            side[dray <= 0.2 * h] = c
            for n, l in lab:
                side[n] = l
            S = side[T]
            band = (S > 0).any(axis=1) & (S < 0).any(axis=1) & (rho > -h / 2) & (along[T].max(axis=1) > -h / 4)
            ids = np.nonzero(band)[0]
            ids = ids[np.lexsort((ids, rho[ids]))]
            live = self.live if READ["taken"] == "dead" else self.live_before
            sel = [e for e in ids if live[e] and rho[e] < 1.5 * h]
            ymin = min([self.yield_[e] for e in sel], default=math.inf)
            num = len(sel) if READ["fewer"] == "all" else sum(self.yield_[e] == ymin for e in sel)
            res[c] = (ymin, num, side, ids)
        (y1, n1, *_), (y2, n2, *_) = res[1], res[-1]
        c = 1
        if y2 < y1 or (y2 == y1 and n2 < n1):
            c = -1
        return c, res[c][2], res[c][3], rho, {k: (v[0], v[1]) for k, v in res.items()}

    def move(self, cr, tip, st, step, t):
        """walk the band; True if the tip moved"""
        h = self.h
        g, K, theta = st["g"], st["K"], st["theta"]
        c, side, ids, rho, cmp = self.band_of(cr, tip, g)
        angular = (math.cos(theta / 2) * (1 + math.sin(abs(theta) / 2)))**2
        taken, survivor, adv = [], None, 0.0
        log = []
        for e in ids:
            e = int(e)
            if not self.live[e]:
                continue
            y = self.yield_[e]
            re = K * K / (2 * math.pi * y * y) * angular if math.isfinite(y) else 0.0
            reff = max(rho[e], h / 2)
            stop = None
            if not self.breakable[e]:
                stop = "unbreakable"
            elif reff > re:
                stop = "reach"
            elif rho[e] > 1.5 * h:
                stop = "1.5h"
            log.append((e, float(rho[e]), float(y), re, stop))
            if stop:
                survivor = e
                break
            taken.append((e, re, float(reff)))
            adv = max(adv, min(re, 1.5 * h, reff + h / 4))
        any_live = any(self.live[e] and rho[e] <= 1.5 * h for e in ids)
        st.update(choice=c, compare=cmp, walk=log,
                  band=[(int(e), float(rho[e]), bool(self.live[e])) for e in ids if rho[e] <= 1.5 * h],
                  taken=[x[0] for x in taken], survivor=survivor, advance=0.0)
        if not any_live:
            tip.ended = True
            st["ended"] = "band"
            return False
        if not taken:
            return False
        if survivor is not None and rho[survivor] > 0:
            adv = min(adv, float(rho[survivor]))
        st["advance"] = adv
        for e, re, reff in taken:
            self.destroy(e)
            cr.elements.append(e)
            self.row(step, t, e, "sif", cr.id, re / reff,
                     [cr.tips.index(tip), K, st["Ka"], st["Kb"], st["Kc"], math.degrees(theta), re, st["s0"], st["beta"],
                      st["a"], st["b"]])
            for n in self.m.T[e]:
                if side[n] != 0 and (READ["relabel"] == "yes" or int(n) not in cr.label):
                    cr.label[int(n)] = int(side[n]) * tip.orient
        tip.p = tip.p + adv * g
        tip.d = g.copy()
        if cr.kind == "edge" or tip is cr.tips[1]:
            cr.path.append(tip.p.copy())
        else:
            cr.path.insert(0, tip.p.copy())
        self.end_outline(tip)
        if tip.ended:
            st["ended"] = "outline"
        return True

    # ---- [4]
    def preset(self, d, elements):
        k = len(self.cracks)
        if "tips" in d:
            if "mouth" in d or "tip" in d:
                raise InputError("internal crack: tips alone")
            q = [self.proj(x) for x in d["tips"]]
            v = q[1] - q[0]
            v = v / np.linalg.norm(v)
            cr = Crack(k, "internal", q, [Tip(q[0], -v, -1), Tip(q[1], v, 1)], elements)
        else:
            M, p = self.proj(d["mouth"]), self.proj(d["tip"])
            v = (p - M) / np.linalg.norm(p - M)
            cr = Crack(k, "edge", [M, p], [Tip(p, v, 1)], elements)
        for tip in cr.tips:
            self.end_outline(tip)
        self.first_labels(cr)
        self.cracks.append(cr)

    def first_labels(self, cr):
        if READ["preset_labels"] == "yes":
            for n in set(int(x) for e in cr.elements for x in self.m.T[e]):
                l = side_of_path(cr.path, self.P[n])
                if l:
                    cr.label[n] = l

    def born(self, e, sig):
        _, n1, equal = principal2(self.plane_tensor(sig))
        d = np.array([1.0, 0.0]) if equal else left(n1)
        if d[0] < 0 or (d[0] == 0 and d[1] < 0):      # R: a definite sign, e1 first
            d = -d
        T, P, X = self.m.T[e], self.P, self.m.X
        c = self.cen[e]
        lateral = []
        for f in self.free_faces.get(e, []):
            q = X[list(f)]
            n = np.cross(q[1] - q[0], q[2] - q[0])
            n = n / np.linalg.norm(n)
            if abs(n @ self.e3) < 0.5:
                lateral.append(q.mean(axis=0))
        k = len(self.cracks)
        if lateral:
            M = self.proj(np.mean(lateral, axis=0))
            if float(d @ (c - M)) < 0:
                d = -d
            L = float(((P[T] - M) @ d).max())
            p = M + L * d
            cr = Crack(k, "edge", [M, p], [Tip(p, d, 1)], [e])
        else:
            s = (P[T] - c) @ d
            if READ["born_order"] == "high":
                d, s = -d, -s
            p0, p1 = c + s.min() * d, c + s.max() * d
            cr = Crack(k, "internal", [p0, p1], [Tip(p0, -d, -1), Tip(p1, d, 1)], [e])
        for tip in cr.tips:
            self.end_outline(tip)
        self.first_labels(cr)
        self.cracks.append(cr)
        return cr

    # ---- time loop
    def run(self):
        for k, (d, es) in enumerate(self.presets):
            self.preset(d, es)
            for e in es:
                if self.live[e]:
                    self.destroy(e)
                    self.row(0, 1.0 / self.steps, e, "preset", k)
        if self.presets:
            self.event = 1
        fac, fac_n = None, -1
        for step in range(self.steps):
            t = (step + 1) / self.steps
            n0 = len(self.rows)
            for es in self.scripts.get(step, []):
                for e in es:
                    if self.live[e]:
                        self.destroy(e)
                        self.row(step, t, e, "script")
                    else:
                        self.warn("step %d: element %d is destroyed already" % (step, e))
            if len(self.rows) > n0 and self.rows[-1][3] == "script" and self.rows[-1][1] == self.event:
                self.event += 1
            if self.model == "B":
                f, u0 = self.loads(t, False)
                u, self.prist_react = self.fem.solve(self.intact, f, u0)
                self.prist = self.fem.stress(u, np.ones(self.ne))
            done, worst = 0, 0.0
            while True:
                self.update_pressed(t)
                scale = np.where(self.live, 1.0, self.alpha)
                if fac_n != len(self.order):
                    fac, fac_n = self.fem.factor(scale), len(self.order)
                f, u0 = self.loads(t, True)
                u, react = self.fem.solve(fac, f, u0)
                sig = self.fem.stress(u, scale)
                if self.measure == "max_shear":
                    ratio = max_shear(sig) / self.yield_
                else:
                    ratio = 2 * max_shear(sig) / self.yield_
                ratio = np.where(self.live & self.breakable, ratio, -1.0)
                worst = float(ratio.max())
                if not np.all(np.isfinite(u)):
                    raise RuntimeError("not finite at event %d" % self.event)
                if self.model == "none":
                    break
                if done >= self.max_events:
                    self.warn("step %d: max_events reached" % step)
                    break
                if not self.decide(step, t, ratio, sig, react):
                    break
                done += 1
                self.event += 1
            self.ratio, self.u, self.sig = ratio, u, sig
            if not self.quiet:
                print("step %2d t %.4f events %3d destroyed %4d worst ratio %.4f cracks %d  [%.1f s]" %
                      (step, t, done, len(self.order), worst, len(self.cracks), time.time() - self.t0), file=sys.stderr)

    def decide(self, step, t, ratio, sig, react):
        if self.model == "A":
            e = int(np.argmax(ratio))
            if ratio[e] < 1:
                return False
            self.destroy(e)
            self.row(step, t, e, "mss", "", float(ratio[e]))
            return True
        # [11]
        F = np.zeros(3)
        for i in self.instruments:
            if i.kind != "expansion":
                continue
            if i.force is not None:
                F += self.factor_of(i, t) * i.force
            else:
                for n in i.nodes:
                    for k in i.axes:
                        F[k] += (react if READ["F"] == "current" else self.prist_react)[3 * n + k]
        states = [(cr, tip, self.tip_state(cr, tip, t, F)) for cr in self.cracks for tip in cr.tips if not tip.ended]
        moved = False
        self.live_before = self.live.copy()
        for cr, tip, st in states:
            if st["grows"] and (READ["end_K0"] == "v" or st["K"] > 0) and self.move(cr, tip, st, step, t):
                moved = True
        rec = {"step": step, "event": self.event, "t": t, "moved": moved, "tips": [st for *_, st in states]}
        if self.want_trace:
            self.trace.append(rec)
        if moved:
            return True
        touched = np.zeros(self.nn, bool)
        for cr in self.cracks:
            touched[self.m.T[cr.elements].ravel()] = True
        r = np.where(touched[self.m.T].any(axis=1), -1.0, ratio)
        e = int(np.argmax(r))
        rec["mss"] = (e, float(r[e]))
        if r[e] < 1:
            return False
        self.destroy(e)
        cr = self.born(e, sig[e])
        self.row(step, t, e, "mss", cr.id, float(r[e]))
        rec["born"] = {"id": cr.id, "kind": cr.kind, "path": cr.path}
        return True


HEADER = "step,event,element,criterion,crack,ratio,load_factor,tip,K,K_a,K_b,K_c,theta_deg,r,sigma0,beta_deg,a,b"


def fmt(x):
    if isinstance(x, (float, np.floating)):
        return repr(float(x))
    return str(x)


def plain(x):
    if isinstance(x, dict):
        return {str(k): plain(v) for k, v in x.items()}
    if isinstance(x, (list, tuple)):
        return [plain(v) for v in x]
    if isinstance(x, np.ndarray):
        return plain(x.tolist())
    if isinstance(x, np.generic):
        return plain(x.item())
    if isinstance(x, float) and not math.isfinite(x):
        return None
    return x


def cracks_json(sim):
    out = []
    if sim.model == "A":
        return out
    for c in sim.cracks:
        out.append({"id": c.id, "kind": c.kind, "mouth": plain(c.path[0]) if c.kind == "edge" else None,
                    "tips": [plain(t.p) for t in c.tips], "tips_ended": [t.ended for t in c.tips],
                    "length": path_length(c.path), "path": plain(c.path), "elements": plain(c.elements)})
    return out


def load_scene(path, sets=()):
    with open(path, "rb") as f:
        scene = tomllib.load(f)
    for s in sets:
        key, val = s.split("=", 1)
        try:
            val = tomllib.loads("v=" + val)["v"]
        except tomllib.TOMLDecodeError:
            pass
        d = scene
        parts = key.split(".")
        for k in parts[:-1]:
            d = d[int(k)] if isinstance(d, list) else d.setdefault(k, {})
        d[parts[-1]] = val
    return scene


def main():
    ap = argparse.ArgumentParser()
    ap.add_argument("scene")
    ap.add_argument("-o", required=True)
    ap.add_argument("--trace")
    ap.add_argument("--set", action="append", default=[])
    ap.add_argument("--permc", default="MMD")
    ap.add_argument("--reading", action="append", default=[], help="key=value of READ")
    ap.add_argument("--quiet", action="store_true")
    a = ap.parse_args()
    Fem.permc = a.permc
    for r in a.reading:
        k, v = r.split("=")
        assert k in READ, k
        READ[k] = v
    try:
        scene = load_scene(a.scene, a.set)
        sim = Sim(scene, os.path.dirname(os.path.abspath(a.scene)), a.quiet, bool(a.trace))
    except InputError as e:
        print("error: %s" % e, file=sys.stderr)
        return 3
    sim.run()
    d = os.path.dirname(os.path.abspath(a.o))
    os.makedirs(d, exist_ok=True)
    with open(a.o, "w") as f:
        f.write(HEADER + "\n")
        for r in sim.rows:
            f.write(",".join(fmt(x) for x in r) + "\n")
    with open(os.path.join(d, "cracks.json"), "w") as f:
        json.dump(cracks_json(sim), f, indent=1)
    with open(os.path.join(d, "warnings.txt"), "w") as f:
        f.write("".join(w + "\n" for w in sim.warnings))
    if a.trace:
        with open(a.trace, "w") as f:
            json.dump(plain(sim.trace), f)
    print("%s: destroyed %d, events %d, cracks %d" % (os.path.basename(a.scene), len(sim.order), sim.event,
                                                      len(cracks_json(sim))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
