# SPDX-License-Identifier: Apache-2.0
"""Figures of run time against size, each as SVG text; None when no row of the run shows it."""
import re

from . import style
from .results import minimum


def reconstruction_rows(rows):
    """[(body, event, method, row)] of bench_reconstruction; event: k1, k10, k100, to640."""
    found = []
    for row in rows:
        parts = row["name"].split("/")
        if parts[0] == "reconstruction" and len(parts) == 4:
            found.append((parts[1], parts[2], parts[3], row))
    return found


def tets_of(body):
    return int(body.split()[-1])


def reconstruction(rows):
    """Frame after an event of k elements against the size of the board."""
    ran = [(b, e, m, r) for b, e, m, r in reconstruction_rows(rows)
           if r["samples_ms"] and b.startswith("board") and e != "to640"]
    if not ran:
        return None
    events = sorted({e for _, e, _, _ in ran}, key=lambda e: int(e[1:]))
    figure, axes = style.panels(len(events), 3, 4.3, 3.9, sharey=True)
    for axis, event in zip(axes, events):
        for method in dict.fromkeys(m for _, _, m, _ in ran):
            points = sorted((tets_of(b), minimum(r)) for b, e, m, r in ran
                            if m == method and e == event)
            if points:
                axis.plot(*zip(*points), **style.look(method))
        elements = "1 element breaks" if event == "k1" else f"{event[1:]} connected elements break"
        style.logarithmic(axis, elements, "tetrahedra")
        style.sizes_as_ticks(axis, sorted({tets_of(b) for b, _, _, _ in ran}))
    axes[0].set_ylabel("update, solution, stress [ms]")
    style.shared_legend(figure, 4)
    return style.svg(figure)


def accumulated(rows):
    """First, median, last and worst frame of 640 fractures."""
    ran = [(b, m, r) for b, e, m, r in reconstruction_rows(rows)
           if e == "to640" and r["samples_ms"]]
    if not ran:
        return None
    bodies = sorted({b for b, _, _ in ran}, key=tets_of)
    figure, axes = style.panels(len(bodies), 2, 5.6, 3.4)
    keys = ("first_ms", None, "last_ms", "worst_ms")
    for axis, body in zip(axes, bodies):
        for _, method, row in (x for x in ran if x[0] == body):
            values = [minimum(row) if k is None else row["counters"][k] for k in keys]
            axis.plot(range(4), values, **style.look(method))
        axis.set_xticks(range(4), ["first 5", "median", "last 100", "worst"])
        axis.set_yscale("log")
        axis.set(title=body + " tetrahedra", ylabel="frame [ms]")
        axis.grid(True, axis="y", color="#dddddd", linewidth=0.6)
    style.shared_legend(figure, 4)
    return style.svg(figure)


def scaling(rows):
    """Set-up, quiet and fracture frame and memory against the number of tetrahedra."""
    parsed = []
    for row in rows:
        found = re.match(r"scaling/([^/]+)/(\d+)", row["name"])
        if found and row["samples_ms"]:
            parsed.append((found[1], int(found[2]), dict(row["counters"], fracture_ms=minimum(row))))
    if not parsed:
        return None
    titles = (("setup_ms", "set-up", "ms"), ("quiet_ms", "quiet frame", "ms"),
              ("fracture_ms", "frame with one fracture", "ms"), ("MiB", "memory held", "MiB"))
    figure, axes = style.panels(4, 2, 5.6, 3.7)
    for axis, (key, title, unit) in zip(axes, titles):
        for method in dict.fromkeys(p[0] for p in parsed):
            own = sorted((p[1], p[2]) for p in parsed if p[0] == method)
            axis.plot([n for n, _ in own], [c[key] for _, c in own], **style.look(method))
        if key.endswith("quiet_ms") or key == "fracture_ms":
            _floor(axis, parsed)
        style.logarithmic(axis, title, "tetrahedra", unit)
        style.sizes_as_ticks(axis, sorted({n for _, n, _ in parsed}))
    style.shared_legend(figure, 3)
    return style.svg(figure)


def _floor(axis, parsed):
    """The least of the methods' memory-traffic floors per size."""
    sizes = sorted({n for _, n, _ in parsed})
    least = [min(c["floor_ms"] for _, n, c in parsed if n == size) for size in sizes]
    axis.fill_between(sizes, least, [v / 1e3 for v in least], color="#bbbbbb", alpha=0.35,
                      linewidth=0)
    axis.plot(sizes, least, color="#666666", linewidth=1,
              label="memory-traffic floor: least memory held / copy rate")
    axis.set_ylim(bottom=min(least) / 2)


def inversion(rows):
    """The intact inverse by each method, per number of unknowns."""
    parsed = []
    for row in rows:
        found = re.match(r"inversion/([^/]+)/\d+", row["name"])
        if found and row["samples_ms"]:
            parsed.append((found[1], row["counters"]["unknowns"], minimum(row)))
    if not parsed:
        return None
    figure, (axis,) = style.panels(1, 1, 6.4, 3.6)
    for method in dict.fromkeys(p[0] for p in parsed):
        points = sorted(p[1:] for p in parsed if p[0] == method)
        look = style.look("cpu inverse deferred fp64" if method == "sunder" else method)
        axis.plot(*zip(*points), **dict(look, label=method))
    style.logarithmic(axis, "", "unknowns", "inverse [ms]")
    style.shared_legend(figure, 3)
    return style.svg(figure)


def finite_rows(rows):
    """[(tetrahedra, "frame" or "event", tolerance, threads, method, row)] of bench_finite."""
    found = []
    for row in rows:
        parts = row["name"].split("/")
        if parts[0] == "finite" and len(parts) == 6:
            found.append((int(parts[1]), parts[2], float(parts[3]), int(parts[4]), parts[5], row))
    return found


def finite(rows):
    """A frame and an event at finite deformation against the size of the board, residual 1e-4."""
    ran = [r for r in finite_rows(rows) if r[5]["samples_ms"] and r[2] == 1e-4]
    groups = sorted({(r[3], r[1]) for r in ran}, key=lambda g: (g[0], g[1] == "event"))
    if not groups:
        return None
    figure, axes = style.panels(len(groups), 2, 5.2, 3.6, sharey=True)
    for axis, (threads, what) in zip(axes, groups):
        own = [r for r in ran if (r[3], r[1]) == (threads, what)]
        for method in dict.fromkeys(r[4] for r in own):
            axis.plot(*zip(*sorted((r[0], r[5]["counters"]["median_ms"]) for r in own
                                   if r[4] == method)), **style.look(method))
        style.logarithmic(axis, f"{what}, {threads} thread{'s' if threads > 1 else ''}",
                          "tetrahedra", "median [ms]")
        style.sizes_as_ticks(axis, sorted({r[0] for r in own}))
    style.shared_legend(figure, 4)
    return style.svg(figure)
