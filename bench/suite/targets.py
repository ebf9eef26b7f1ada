# SPDX-License-Identifier: Apache-2.0
"""What the library aims at, beside what a results folder holds of it: (what, aim, figure, missed,
command). Every figure is a column of a row or a count; `missed` names where it is over its aim."""
import re

from . import plots, results
from .tables import number

EVENTS = (1, 10, 100)


def _ran(rows, program):
    return {r["name"]: r["counters"] for r in rows if r["program"] == program and r["samples_ms"]}


def _judged(what, places, command, shown=lambda v: number(v, 2), unit=""):
    """places: [(name, value or None, aim)]. None when a value is missing."""
    if not places or any(value is None for _, value, _ in places):
        return None
    def close(value, aim):  # a miss is to be seen
        return value > aim and shown(value) == shown(aim)
    aims = list(dict.fromkeys(shown(aim) for _, _, aim in places))
    missed = [name for name, value, aim in places if not value <= aim]
    figures = [number(v, 4) if close(v, aim) else shown(v) for _, v, aim in places]
    return (what, " / ".join(aims) + unit, " / ".join(figures) + unit, ", ".join(missed), command)


def _of_rows(ran, names, column):
    return [ran.get(name, {}).get(column) for name in names]


def _few_loads(ran, tets):
    values = _of_rows(ran, [f"sunder_inverse_deferred/{tets}/k{k}" for k in (1, 10)],
                      "over_updown_solve")
    return _judged(f"1 / 10 connected elements of {tets:,} tetrahedra, dense inverse, few loaded "
                   "unknowns: share of CHOLMOD updown_solve",
                   list(zip(("1", "10"), values, (0.1, 0.1))),
                   f"bench_engine --benchmark_filter='/{tets}/k'")


def _on_the_factor(ran, tets):
    values = _of_rows(ran, [f"sunder_factor_deferred/{tets}/k{k}" for k in EVENTS], "over_best")
    return _judged(f"1 / 10 / 100 connected elements of {tets:,} tetrahedra, on the factor: share "
                   "of the best library",
                   list(zip(map(str, EVENTS), values, (1 / 2, 1 / 4, 1 / 8))),
                   f"bench_engine --benchmark_filter='/{tets}/k'", lambda v: number(v, 3))


def _refactor(rows):
    """The worst of both deferred routes and all events, by body."""
    worst = {}
    for body, event, method, row in plots.reconstruction_rows(rows):
        own = method in ("cpu inverse deferred fp64", "cpu factor deferred fp64")
        share = row["counters"].get("over_refactor")
        if own and event != "to640" and share is not None:
            worst[body] = max(share, worst.get(body, 0))
    bodies = sorted(worst, key=lambda b: (b.split()[0] != "board", plots.tets_of(b)))
    return _judged(f"update, solution and stress after up to 100 elements ({', '.join(bodies)}), "
                   "the slower deferred route: share of the best library's refactorisation",
                   [(b, worst[b], 1) for b in bodies],
                   "bench_reconstruction --benchmark_filter='/k1.*/c'")


def _cascades(ran, fractures, column, what, name):
    """A row per number of fractures, by route and body."""
    found = {}
    for row, counters in ran.items():
        parts = re.fullmatch(rf"{name}_(\w+)/(\d+)/?{fractures}", row)
        if parts and column in counters:
            found[parts[1], int(parts[2])] = counters[column]
    places = [(f"{route} {tets:,}", found[route, tets], 2)
              for route, tets in sorted(found, key=lambda p: (p[0] != "inverse", p))]
    titles = ", ".join(place[0] for place in places)
    return places, f"{what} ({titles})"


def _of_cascade(ran, fractures, column, what):
    places, title = _cascades(ran, fractures, column, what, "cascade")
    return _judged(title, places, f"bench_engine --benchmark_filter='cascade.*/{fractures}'")


def _patch_cascade(ran):
    places, title = _cascades(ran, "", "p99_over_median_ms", "99th percentile of 640 frames that "
                              "tear a patch over the median", "needs/patch_cascade")
    return _judged(title, places, "bench_needs --benchmark_filter=patch_cascade")


def _instruments(ran):
    row = ran.get("instrument_forces/1944", {})
    return _judged("forces of the instruments while 640 elements of 1,944 break, 99th percentile",
                   [("1,944", row.get("p99_us"), 50)],
                   "bench_engine --benchmark_filter=instrument", unit=" us")


def _stress(ran):
    sizes = [n for n in (1944, 7776, 30246) if f"stress_threads/{n}/1" in ran]
    return _judged(f"stress of an element ({', '.join(f'{n:,}' for n in sizes)} tetrahedra), one "
                   "thread; a fifth of 65 ns",
                   [(f"{n:,}", ran[f"stress_threads/{n}/1"].get("ns_per_tet"), 13) for n in sizes],
                   "bench_engine --benchmark_filter=stress", unit=" ns")


def _board_frame(rows):
    own = [results.least(r) for body, event, method, r in plots.reconstruction_rows(rows)
           if (body, event) == ("board 1944", "k1") and method.startswith("cpu") and r["samples_ms"]]
    return _judged("frame with one fracture, 1,944 tetrahedra, one CPU thread, best route",
                   [("1,944", min(own, default=None), 0.1)],
                   "bench_reconstruction --benchmark_filter='board 1944/k1/cpu'", unit=" ms")


def _lavapipe(ran):
    found = []
    for frame, aim in (("quiet", 0.15), ("fracture", 0.5)):
        for precision in ("fp32", "fp64"):
            value = ran.get(f"board_{frame}_frame/{precision}", {}).get("min_ms")
            found.append((f"{frame} {precision}", value, aim))
    return _judged("quiet frame, fp32 / fp64, and with a fracture, fp32 / fp64, Vulkan on this "
                   "machine's device", found, "bench_vulkan --benchmark_filter=board_.*frame",
                   unit=" ms")


_FINITE_COMMAND = "bench_finite --benchmark_filter='finite/(1944|30246)/.*/1e-04/2/'"


def _of_finite(rows, method, threads=2):
    """{(tetrahedra, "frame" or "event"): counters} at residual 1e-4; none of a method that missed
    every step."""
    return {(tets, what): row["counters"]
            for tets, what, tolerance, n, name, row in plots.finite_rows(rows)
            if (tolerance, n, name) == (1e-4, threads, method) and row["samples_ms"]}


def _finite(rows):
    """Lines of the aims at finite deformation."""
    promise, equal = _of_finite(rows, "sunder promise"), _of_finite(rows, "sunder")
    aims = {(1944, "frame"): 0.6, (30246, "frame"): 20, (1944, "event"): 1.5, (30246, "event"): 45}
    there = [key for key in aims if key in promise]
    names = [f"{tets:,} {what}" for tets, what in there]
    titles = ", ".join(names)
    yield _judged(f"finite deformation, promise 1e-4, 2 threads, median ({titles})",
                  [(n, promise[k].get("median_ms"), aims[k]) for n, k in zip(names, there)],
                  _FINITE_COMMAND, unit=" ms")
    for what, column, aim in (("median", "back_solves", 8),
                              ("99th percentile", "p99_back_solves", 16)):
        yield _judged(f"finite deformation, back-solves of a step, {what} ({titles})",
                      [(n, promise[k].get(column), aim) for n, k in zip(names, there)],
                      _FINITE_COMMAND)
    there = sorted(equal)
    names = [f"{tets:,} {what}" for tets, what in there]
    yield _judged("finite deformation at equal residuals of 1e-4, 2 threads: share of the best "
                  f"peer's median ({', '.join(names)})",
                  [(n, equal[k].get("over_best"), 0.2) for n, k in zip(names, there)],
                  _FINITE_COMMAND)


def _accuracy(cells):
    if not cells:
        return None
    named = [c["accuracy"] for c in cells if c["accuracy"] != "not named"]
    return _judged(f"cells of the stability study beyond the table of accuracy, of {len(named)} "
                   "that it names", [("the cells listed on the page", named.count("beyond"), 0)],
                   "bench/run --full")


HEAD = ("aim", "at most", "figure", "missed at", "command in build/bench/")


def targets(outcome):
    """[(what, aim, figure, missed, command)] of what this run has measured."""
    rows = outcome["rows"]
    engine = _ran(rows, "bench_engine")
    found = [*(_few_loads(engine, n) for n in (1944, 7776, 30246)),
             *(_on_the_factor(engine, n) for n in (7776, 30246, 119286)),
             _refactor(rows),
             _of_cascade(engine, 640, "last_over_first_ms",
                         "640 fractures one by one: last frames over first"),
             *(_of_cascade(engine, n, "p99_over_median_ms",
                           f"{n} fractures one by one: 99th percentile over median frame")
               for n in (200, 640)),
             _patch_cascade(_ran(rows, "bench_needs")),
             _instruments(engine), _stress(engine), _board_frame(rows),
             _lavapipe(_ran(rows, "bench_vulkan")), *_finite(rows), _accuracy(outcome["cells"])]
    return [t for t in found if t is not None]
