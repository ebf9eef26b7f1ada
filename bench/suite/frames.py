# SPDX-License-Identifier: Apache-2.0
"""Tables of docs/frames.md: where a frame goes, from the rows of bench_frame_parts."""
import re

from .tables import number

PROGRAM = "bench_frame_parts"
BEGIN, END = "<!-- tables of bench/frames -->", "<!-- end of tables -->"

PARTS = (("forward_us", "forward: columns of the event, along their path"),
         ("update_us", "update of the small matrices"),
         ("project_us", "B^T X f"),
         ("refine_us", "forces of the damage, refined once"),
         ("backward_us", "u = X (f + B x): backward, or columns of X"),
         ("stress_us", "stress of all elements"),
         ("residual_us", "K u and its residual"),
         ("summary_us", "worst ratios"))
# Title of a table; its groups of columns by the rows' names.
TABLES = (("The first frames of a tear, one element each",
           (("inverse_first", "inverse"), ("factor_first", "factor"))),
          ("The fullest frames before a new base, and those after 640 fractures, on a factor",
           (("factor_fullest", "fullest"), ("after_640", "after 640"))),
          ("One event of 1, 10 and 100 connected elements of an intact body, on its factor",
           (("event_1", "1"), ("event_10", "10"), ("event_100", "100"))))
STAGES = (("update_us", "update"), ("waited_us", "waited for a base"),
          ("solve_us", "solution, its stress and check"), ("stress_us", "worst ratios"),
          ("processor_us", "of which processor time"))
FRAMES = (("first", "first 5"), ("median", "median"), ("slowest", "slowest hundredth"),
          ("last", "last 100"))


def _found(rows, kind):
    """[(name, tetrahedra, counters)] in the program's order."""
    found = []
    for row in rows:
        parts = re.fullmatch(rf"{kind}/(\w+)/(\d+)", row["name"])
        if row["program"] == PROGRAM and row["samples_ms"] and parts:
            found.append((parts[1], int(parts[2]), row["counters"]))
    return found


def _us(value):
    return f"{value:,.0f}"


def _part_table(rows, groups):
    """Head and lines, or None: a column per group and size."""
    found = _found(rows, "frame_parts")
    columns = [(f"{title}: {tets:,}", c) for name, title in groups
               for own, tets, c in found if own == name]
    if not columns:
        return None
    lines = [[words, *(_us(c[key]) for _, c in columns)] for key, words in PARTS]
    # Of the least times of the parts, so that they add up.
    lines.append(["all", *(_us(sum(c[key] for key, _ in PARTS)) for _, c in columns)])
    lines.append(["columns of B", *(_us(c["columns"]) for _, c in columns)])
    lines.append(["factor [MB]", *(number(c["factor_MB"]) for _, c in columns)])
    return ["part", *(title for title, _ in columns)], lines


def _cascade_table(rows):
    lines = []
    for route, tets, c in _found(rows, "frame_cascade"):
        for frame, words in FRAMES:
            lines.append([f"{route} {tets:,}, {words}", _us(c[f"{frame}_all_us"]),
                          *(_us(c[f"{frame}_{key}"]) for key, _ in STAGES)])
    if not lines:
        return None
    return ["frames", "all", *(words for _, words in STAGES)], lines


def _measures_table(rows):
    lines = [[f"{field} {tets:,}", f"{c['pass_us']:,.1f}", f"{c['bounds_us']:,.1f}",
              f"{c['search_us']:,.1f}", f"{100 * c['share']:,.0f} %"]
             for field, tets, c in _found(rows, "measures")]
    if not lines:
        return None
    return ["field", "stress pass", "bounds in it", "search after it", "of the pass"], lines


def tables(rows):
    """[(title, head, lines)] of what has been measured; times in microseconds."""
    made = [(title, _part_table(rows, groups)) for title, groups in TABLES]
    made.append(("640 fractures one by one, by the library's backend, the next base made beside it",
                 _cascade_table(rows)))
    made.append(("Largest strain and rotation beside the stress pass, one thread",
                 _measures_table(rows)))
    return [(title, *table) for title, table in made if table]


def markdown(rows, machine):
    """The document's section between its marks."""
    lines = [BEGIN, "", f"{machine['cpu']}, {machine['cores']} cores, {machine['date']}, commit "
             f"{machine['commit']}, load {machine['load_before']} before the run; microseconds."]
    for title, head, body in tables(rows):
        lines += ["", f"{title}:", "", f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
        lines += [f"| {' | '.join(map(str, line))} |" for line in body]
    return "\n".join([*lines, "", END])
