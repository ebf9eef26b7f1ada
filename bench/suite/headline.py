# SPDX-License-Identifier: Apache-2.0
"""The figures that the README quotes: what, figure, command; and its aims (targets.py). Computed
from a results folder."""
from . import plots, results, tables, targets
from .tables import PAPER_2, PAPER_3, number, paper_rows

BEGIN, END = "<!-- figures of ", "<!-- end of figures -->"


def _least(rows, name):
    """Least time of a row [ms], or None."""
    for row in rows:
        if row["name"] == name and row["samples_ms"]:
            return results.minimum(row)
    return None


def _all(values, shown):
    return None if any(v is None for v in values) else " / ".join(shown(v) for v in values)


def _program(rows):
    times = [_least(rows, f"whole_run/board_pull_{m}") for m in "ab"]
    return ("board-pull-a / -b, start of the program to all files",
            _all(times, lambda v: f"{v / 1e3:.2f} s"), "bench_program")


def _decide(rows):
    times = [_least(rows, f"decide/{k}") for k in ("formula", "field")]
    return (f"decide which element ruptures, formula / field K (the paper: {PAPER_3['total'][1]} s)",
            _all(times, lambda v: f"{number(1e3 * v)} us"), "bench_field_sif")


def _reconstruction_of_the_paper(rows):
    ran = paper_rows(rows).get("B, expansion")
    what = (f"one reconstruction, model B (the paper: {PAPER_2['total'][1]} s): update and "
            "displacement / everything anew")
    if not ran:
        return what, None, "bench_paper"
    c = ran["counters"]
    anew = sum(v for k, v in c.items() if k.startswith("anew_"))
    return what, f"{number(c['update_ms'] + c['solve_ms'])} / {number(anew)} ms", "bench_paper"


def _c_interface(rows):
    shares = [next((r["counters"].get("share") for r in rows if r["name"] == f"frame/{n}"), None)
              for n in (4, 18)]
    return ("a frame through the C interface against C++, 96 / 1944 tetrahedra",
            _all(shares, lambda v: f"{100 * v:+.1f} %"), "bench_c_abi")


def _against_best(rows, body):
    """After each event the best of ours over the best of the others, whichever that is."""
    ours, best = {}, tables.best_peers(rows)
    for found, event, method, row in plots.reconstruction_rows(rows):
        if found == body and method.startswith("cpu") and row["samples_ms"]:
            ours[event] = min(results.minimum(row), ours.get(event, float("inf")))
    shares = [f"{number(ours[event] / best[body, event][1], 2)} of {best[body, event][0]}"
              if event in ours and (body, event) in best else None
              for event in ("k1", "k10", "k100")]
    return (f"frame after 1 / 10 / 100 connected elements break, {body} tetrahedra, best route on "
            "one thread, as a share of the best peer after that event",
            _all(shares, str), f"bench_reconstruction --benchmark_filter='{body}/k'")


def _patch(rows, tets):
    at = {route: next((r["counters"] for r in rows if r["samples_ms"]
                       and r["name"] == f"needs/patch_tears_{route}/{tets}"), None)
          for route in ("factor", "condensed")}
    what = (f"frame with a fracture in a patch of about 1,000 unknowns, {tets} tetrahedra, factor / "
            "condensed")
    command = f"bench_needs --benchmark_filter='patch_tears.*/{tets}/'"
    if not all(at.values()):
        return what, None, command
    times = " / ".join(number(at[r]["min_ms"]) for r in at)
    return (what, f"{times} ms; the condensed inverse holds "
            f"{number(at['condensed']['inverse_MiB'], 2)} MiB", command)


def _largest(rows):
    sizes = [(r["counters"]["unknowns"], r) for r in rows if r["samples_ms"]
             and r["name"].startswith("scaling/cpu factor")]
    if not sizes:
        return "the largest board, factor route", None, "bench_scaling"
    row = max(sizes, key=lambda s: s[0])[1]
    c = row["counters"]
    tets = int(row["name"].split("/")[-1])
    return (f"a board of {tets:,} tetrahedra, factor route: set-up / quiet frame / frame "
            "with a fracture / memory",
            f"{number(c['setup_ms'] / 1e3)} s / {number(c['quiet_ms'])} ms / "
            f"{number(results.minimum(row))} ms / {number(c['MiB'])} MiB",
            f"bench_scaling --benchmark_filter='factor.*/{tets}'")


def _stability(cells, mode):
    if not cells:
        return "stability", None, ""
    count = {w: sum(c["verdict"] == w for c in cells)
             for w in ("ok", "polished", "rounded", "refused", "WRONG")}
    good = count["ok"] + count["polished"] + count["rounded"]
    return ("cells of the stability study: right / refused with a reason / wrong",
            f"{good} / {count['refused']} / {count['WRONG']}", f"bench_stability FILE {mode}")


def _accuracy(cells, mode):
    if not cells:
        return "accuracy", None, ""
    counts = [sum(c["accuracy"] == w for c in cells) for w in ("within", "beyond", "not named")]
    return ("the same cells by the table of accuracy: within / beyond / not named by it",
            " / ".join(map(str, counts)), f"bench/run --{mode}")


def figures(outcome):
    """[(what, figure, command)] of what this run has measured."""
    rows = outcome["rows"]
    found = [_program(rows), _reconstruction_of_the_paper(rows), _decide(rows), _c_interface(rows),
             *(_against_best(rows, b) for b in ("board 1944", "board 7776", "board 30246",
                                                  "board 119286", "block 7986")),
             *(_patch(rows, n) for n in (1944, 30246, 119286)),
             _largest(rows), *(made(outcome["cells"], outcome["machine"].get("mode", "full"))
                               for made in (_stability, _accuracy))]
    return [f for f in found if f[1] is not None]


def markdown(outcome, folder):
    """The README's section between its marks."""
    about = outcome["machine"]
    lines = [f"{BEGIN}{folder} -->", "",
             f"{about['cpu']}, {about['cores']} cores, {about['date']}, commit {about['commit']}, "
             f"load {about['load_before']} before the run. All of it: `{folder}/index.html`.", "",
             "| what | figure | command in build/bench/ |", "|---|---|---|"]
    lines += [f"| {what} | {figure} | `{command}` |" for what, figure, command in figures(outcome)]
    lines += ["", f"| {' | '.join(targets.HEAD)} |", "|---|---|---|---|---|"]
    lines += [f"| {what} | {aim} | {figure} | {missed or 'none'} | `{command}` |"
              for what, aim, figure, missed, command in targets.targets(outcome)]
    return "\n".join([*lines, "", END])
