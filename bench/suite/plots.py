# SPDX-License-Identifier: Apache-2.0
"""Figures of the page, each as SVG text."""
import io
import math
import re

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "sunder"  # same input, same bytes
matplotlib.rcParams["svg.fonttype"] = "none"
from matplotlib import pyplot  # noqa: E402
from matplotlib.colors import LogNorm  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

from .results import minimum  # noqa: E402

FLOOR = 1e-17  # errors of zero on a logarithmic axis
_CASE = ("contrast", "nu", "sliver", "alpha", "unit", "pattern", "fractures")


def _svg(figure):
    out = io.StringIO()
    figure.savefig(out, format="svg", bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)
    text = out.getvalue()
    return text[text.index("<svg"):]


def reconstruction(rows):
    """Update and solution after an event of k elements, per method and mesh size."""
    parsed = []
    for row in rows:
        found = re.match(r"(\w+)/(\d+)/k(\d+)", row["name"])
        if row["program"] == "bench_engine" and found and row["samples_ms"]:
            parsed.append((found[1], int(found[2]), int(found[3]), minimum(row)))
    ks = sorted({p[2] for p in parsed})
    if not ks:
        return None
    methods = sorted({p[0] for p in parsed})
    figure, axes = pyplot.subplots(1, len(ks), figsize=(4.2 * len(ks), 3.6), sharey=True,
                                   squeeze=False)
    for axis, k in zip(axes[0], ks):
        for i, method in enumerate(methods):
            points = sorted((p[1], p[3]) for p in parsed if p[0] == method and p[2] == k)
            if points:
                axis.loglog(*zip(*points), marker="o", color=f"C{i}", label=method,
                            linestyle="--" if method.startswith("cholmod") else "-")
        axis.set(title=f"k = {k}", xlabel="tetrahedra")
        axis.grid(True, which="major", alpha=0.3)
    axes[0][0].set_ylabel("update and solution [ms], minimum")
    handles = {h.get_label(): h for a in axes[0] for h in a.get_lines()}
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncols=3,
                  bbox_to_anchor=(0.5, 0.0))
    return _svg(figure)


def scaling(rows):
    """Set-up, quiet and fracture frame and memory against the number of tetrahedra."""
    parsed = []
    for row in rows:
        found = re.match(r"scaling/([^/]+)/(\d+)", row["name"])
        if found and row["samples_ms"]:
            parsed.append((found[1], int(found[2]), dict(row["counters"], fracture_ms=minimum(row))))
    if not parsed:
        return None
    panels = (("setup_ms", "set-up [ms]"), ("quiet_ms", "quiet frame [ms]"),
              ("fracture_ms", "fracture frame [ms]"), ("MiB", "memory [MiB]"))
    figure, axes = pyplot.subplots(1, 4, figsize=(15, 3.6))
    for axis, (key, title) in zip(axes, panels):
        for i, method in enumerate(dict.fromkeys(p[0] for p in parsed)):
            own = sorted((p for p in parsed if p[0] == method), key=lambda p: p[1])
            axis.loglog([p[1] for p in own], [p[2][key] for p in own], marker="o", color=f"C{i}",
                        label=method)
            if key == "quiet_ms":
                axis.loglog([p[1] for p in own], [p[2]["floor_ms"] for p in own], linestyle=":",
                            color=f"C{i}")
        axis.set(title=title, xlabel="tetrahedra")
        axis.grid(True, which="major", alpha=0.3)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="upper center", ncols=4,
                  bbox_to_anchor=(0.5, 0.0))
    return _svg(figure)


def inversion(rows):
    """The intact inverse by each method, per number of unknowns."""
    parsed = []
    for row in rows:
        found = re.match(r"inversion/(\w+)/\d+", row["name"])
        if found and row["samples_ms"]:
            parsed.append((found[1], row["counters"]["unknowns"], minimum(row)))
    if not parsed:
        return None
    figure, axis = pyplot.subplots(figsize=(5, 3.6))
    for method in dict.fromkeys(p[0] for p in parsed):
        points = sorted(p[1:] for p in parsed if p[0] == method)
        axis.loglog(*zip(*points), marker="o", label=method,
                    linestyle="-" if method == "sunder" else "--")
    axis.set(xlabel="unknowns", ylabel="inverse [ms], minimum")
    axis.grid(True, which="major", alpha=0.3)
    axis.legend(fontsize=8)
    return _svg(figure)


def pareto(points):
    """Points (time, error) that no other beats in both, by time."""
    front, best = [], math.inf
    for point in sorted(points):
        if point[1] < best:
            front.append(point)
            best = point[1]
    return front


def error_against_time(cells):
    """Stress error against the time of a frame, a panel for each pattern of fracture."""
    easy = [c for c in cells if c["study"] in ("crack", "scattered", "cut", "bridge", "island")
            and c["verdict"] != "refused"]
    panels = sorted({c["pattern"] for c in easy})
    if not panels:
        return None
    methods = sorted({c["method"] for c in easy})
    figure, axes = pyplot.subplots(1, len(panels), figsize=(3.4 * len(panels), 3.6), sharey=True,
                                   squeeze=False)
    for axis, pattern in zip(axes[0], panels):
        here = [c for c in easy if c["pattern"] == pattern]
        for i, method in enumerate(methods):
            points = [(c["median_ms"], max(c["stress_error"], FLOOR)) for c in here
                      if c["method"] == method]
            if points:
                axis.loglog(*zip(*points), linestyle="", color=f"C{i}", label=method,
                            marker="o" if method.startswith("cpu") else "s")
        axis.step(*zip(*pareto([(c["median_ms"], max(c["stress_error"], FLOOR)) for c in here])),
                  where="post", color="black", linewidth=1, label="Pareto front")
        axis.set(title=pattern, xlabel="frame [ms], median")
        axis.grid(True, which="major", alpha=0.3)
    axes[0][0].set_ylabel("stress error against fp64 direct")
    handles = {h.get_label(): h for a in axes[0] for h in a.get_lines()}
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncols=4,
                  bbox_to_anchor=(0.5, 0.0))
    return _svg(figure)


def scenes(points):
    """Stress error of a scene's last frame against the time of its frames, a panel a scene."""
    good = [p for p in points if p["verdict"] in ("ok", "polished")]
    names = sorted({p["scene"] for p in good})
    if not names:
        return None
    methods = sorted({p["method"] for p in good})
    columns = min(4, len(names))
    lines = -(-len(names) // columns)
    figure, axes = pyplot.subplots(lines, columns, figsize=(3.6 * columns, 3.2 * lines),
                                   squeeze=False, layout="constrained")
    for axis in axes.flat[len(names):]:
        axis.remove()
    for axis, name in zip(axes.flat, names):
        here = [(p["method"], p["frame_ms"], max(p["stress_error"], FLOOR)) for p in good
                if p["scene"] == name]
        for i, method in enumerate(methods):
            own = [p[1:] for p in here if p[0] == method]
            if own:
                axis.loglog(*zip(*own), linestyle="", color=f"C{i}", label=method,
                            marker="o" if method.startswith("cpu") else "s")
        axis.step(*zip(*pareto([p[1:] for p in here])), where="post", color="black", linewidth=1)
        axis.set_title(name, fontsize=9)
        axis.grid(True, which="major", alpha=0.3)
    figure.supxlabel("frame [ms], median of the steps", fontsize=9)
    figure.supylabel("stress error of the last frame", fontsize=9)
    handles = {h.get_label(): h for a in figure.axes for h in a.get_lines()
               if not h.get_label().startswith("_")}
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncols=3, fontsize=8,
                  bbox_to_anchor=(0.5, 0.0))
    return _svg(figure)


def _label(cell):
    value = cell.get(cell["study"])
    if " x " in cell["study"]:
        return ", ".join(f"{k} {cell['fractures' if k == 'crack' else k]:g}"
                         for k in cell["study"].split(" x "))
    if cell["study"] in ("crack", "scattered"):
        return f"{cell['study']} {cell['fractures']:g}"
    return cell["study"] if value is None or isinstance(value, str) else f"{cell['study']} {value:g}"


def heat_map(cells):
    """Stress error of every cell; what is no plain answer is marked."""
    if not cells:
        return None
    methods = list(dict.fromkeys(c["method"] for c in cells))
    cases = list(dict.fromkeys((c["study"], *(c[k] for k in _CASE)) for c in cells))
    at = {((c["study"], *(c[k] for k in _CASE)), c["method"]): c for c in cells}
    grid = [[at[case, m]["stress_error"] if (case, m) in at and at[case, m]["verdict"] != "refused"
             else math.nan for m in methods] for case in cases]
    grid = [[max(v, FLOOR) if v == v else v for v in line] for line in grid]
    figure, axis = pyplot.subplots(figsize=(0.75 * len(methods) + 2, 0.2 * len(cases) + 1.5))
    colours = matplotlib.colormaps["viridis_r"].copy()
    colours.set_bad("#dddddd")
    image = axis.imshow(grid, aspect="auto", cmap=colours, norm=LogNorm(1e-14, 1))
    marks = {"polished": "p", "rounded": "r", "WRONG": "X"}
    for y, case in enumerate(cases):
        for x, method in enumerate(methods):
            mark = marks.get(at[case, method]["verdict"]) if (case, method) in at else None
            if mark:
                axis.text(x, y, mark, ha="center", va="center", fontsize=7,
                          color="red" if mark == "X" else "white")
    axis.set_xticks(range(len(methods)), methods, rotation=60, ha="right", fontsize=7)
    axis.set_yticks(range(len(cases)), [_label(at_any(at, case, methods)) for case in cases],
                    fontsize=6)
    figure.colorbar(image, label="stress error against fp64 direct", fraction=0.04)
    axis.legend(handles=[Patch(color="#dddddd", label="refused"),
                         Patch(color="none", label="p polished, r limited by fp32 read-out, X wrong")],
                loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=7, ncols=2, frameon=False)
    return _svg(figure)


def at_any(at, case, methods):
    return next(at[case, m] for m in methods if (case, m) in at)
