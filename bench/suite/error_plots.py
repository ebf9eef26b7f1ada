# SPDX-License-Identifier: Apache-2.0
"""Figures of error against run time, each as SVG text; None when the run has no such point."""
import math

from . import style

FLOOR = 1e-15  # smaller errors, zero included, are drawn here
_PATTERNS = ("crack", "scattered", "cut", "bridge", "island")


def pareto(points):
    """Points (time, error) that no other beats in both, by time."""
    front, best = [], math.inf
    for point in sorted(points):
        if point[1] < best:
            front.append(point)
            best = point[1]
    return front


def _panel(axis, points, title):
    """points: [(method, time, error)]; the front as steps."""
    for method in sorted({p[0] for p in points}):
        look = dict(style.look(method), linestyle="")
        axis.plot(*zip(*[p[1:] for p in points if p[0] == method]), **look)
    front = pareto([p[1:] for p in points])
    axis.step(*zip(*front), where="post", color="black", linewidth=1, label="Pareto front",
              zorder=1)
    style.logarithmic(axis, title)


def _figure(groups, columns, xlabel, ylabel):
    """groups: {title: [(method, time, error)]}."""
    figure, axes = style.panels(len(groups), columns)
    for axis, (title, points) in zip(axes, groups.items()):
        _panel(axis, points, title)
    figure.supxlabel(xlabel, fontsize=9)
    figure.supylabel(ylabel, fontsize=9)
    style.shared_legend(figure, 4)
    return style.svg(figure)


def error_against_time(cells):
    """A panel for each pattern of fracture of the study's board."""
    groups = {}
    for pattern in _PATTERNS:
        points = [(c["method"], c["median_ms"], max(c["stress_error"], FLOOR)) for c in cells
                  if c["study"] == pattern and c["verdict"] != "refused"]
        if points:
            groups[pattern] = points
    if not groups:
        return None
    return _figure(groups, 3, "frame [ms], median of the events",
                   "stress error against fp64 direct")


def scenes(points):
    """A panel for each scene: stress error of its last frame."""
    good = [p for p in points if p["verdict"] in ("ok", "polished", "rounded", "WRONG")]
    groups = {name: [(p["method"], p["frame_ms"], max(p["stress_error"], FLOOR)) for p in good
                     if p["scene"] == name] for name in sorted({p["scene"] for p in good})}
    if not groups:
        return None
    return _figure(groups, 4, "frame [ms], median of the steps", "stress error of the last frame")


def finite_laws(rows):
    """A panel for each law: worst stress error of the steps, a point for each tolerance."""
    groups = {}
    for row in rows:
        parts = row["name"].split("/")
        if parts[0] == "finite_error" and len(parts) == 4 and row["samples_ms"]:
            counters = row["counters"]
            groups.setdefault(parts[1], []).append(
                (parts[3], counters["median_ms"], max(counters["error_stress"], FLOOR)))
    if not groups:
        return None
    return _figure(groups, 3, "event [ms], median", "largest stress error against Newton's end")


def convergence(meshes):
    """Discretisation error against tetrahedra, and against time."""
    if not meshes:
        return None
    figure, axes = style.panels(2, 2, 4.8, 3.4, sharey=True)
    colours = dict(zip(dict.fromkeys(m["case"] for m in meshes), ("#0072B2", "#D55E00", "#009E73")))
    for axis, key, label in zip(axes, ("tets", "ms"), ("tetrahedra", "from the mesh to u [ms]")):
        for case, colour in colours.items():
            points = [(m[key], 100 * max(m["error"], FLOOR)) for m in meshes if m["case"] == case]
            axis.plot(*zip(*points), marker="o", markersize=4.5, color=colour, label=case)
        style.logarithmic(axis, "", label)
    axes[0].set_ylabel("error of the displacement [%]")
    style.shared_legend(figure, 3)
    return style.svg(figure)
