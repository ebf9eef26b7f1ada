# SPDX-License-Identifier: Apache-2.0
"""Tables of the page: lines of words, made of rows, cells and meshes."""
import collections
import math

from . import plots, results, style


def number(value, digits=3):
    """Three significant digits, without a power of ten where that reads better."""
    if value is None or value != value:
        return ""
    if value == 0 or 1e-3 <= abs(value) < 1e8:
        return f"{float(f'{value:.{digits}g}'):,g}".replace(",", " ")
    return f"{value:.{digits - 1}e}"


def _frame(row):
    return results.minimum(row) if row["samples_ms"] else None


def best_peers(rows):
    """{(body, event): (method, ms)} of bench_reconstruction."""
    best = {}
    for body, event, method, row in plots.reconstruction_rows(rows):
        if style.is_peer(method) and row["samples_ms"]:
            key, own = (body, event), (method, results.minimum(row))
            best[key] = min(best.get(key, own), own, key=lambda pair: pair[1])
    return best


def reconstruction(rows):
    """[(title, head, lines)]: a table per body and event."""
    best = best_peers(rows)
    groups = collections.defaultdict(list)
    for body, event, method, row in plots.reconstruction_rows(rows):
        groups[body, event].append((method, row))
    columns = ("setup_ms", "update_ms", "solve_ms", "stress_ms")
    many = ("first_ms", "last_ms", "worst_ms")
    tables = []
    for (body, event), methods in groups.items():
        own = many if event == "to640" else columns
        head = ["", *(c.replace("_ms", " [ms]").replace("setup", "set-up") for c in own),
                "median frame [ms]" if event == "to640" else "frame [ms]", "MiB", "error of u",
                "error of stress", "/ best peer"]
        lines = []
        for method, row in methods:
            if row.get("failure"):
                lines.append([method, row["failure"]])
                continue
            c, frame = row["counters"], _frame(row)
            peer = best.get((body, event))
            lines.append([method, *(number(c.get(k)) for k in own), number(frame),
                          number(c.get("MiB")), number(c.get("error_u"), 2),
                          number(c.get("error_stress"), 2),
                          number(frame / peer[1]) if peer else ""])
        name = "640 elements, one by one" if event == "to640" else \
            f"{event[1:]} connected element{'s' if event != 'k1' else ''}"
        tables.append((f"{body} tetrahedra, {name}", head, lines))
    return tables


def finite(rows):
    """[(title, head, lines)]: a table per size, tolerance and number of threads."""
    groups = collections.defaultdict(lambda: collections.defaultdict(dict))
    for tets, what, tolerance, threads, method, row in plots.finite_rows(rows):
        groups[tets, tolerance, threads][method][what] = row
    columns = (("min_ms", "least"), ("median_ms", "median"), ("cpu_ms", "CPU"), ("p99_ms", "p99"),
               ("back_solves", "back-solves"), ("p99_back_solves", "p99"), ("factors", "factors"),
               ("over_best", "/ best peer"))
    head = ["", *(f"{what}: {title}" for what in ("frame", "event") for _, title in columns),
            "not found"]
    tables = []
    for (tets, tolerance, threads), methods in sorted(groups.items()):
        lines = []
        for method, kinds in methods.items():
            line, missed = [method], []
            for what in ("frame", "event"):
                row = kinds.get(what, {"counters": {}})
                c, failure = row["counters"], row.get("failure")
                line += [failure or number(c.get(columns[0][0])),
                         *("" if failure else number(c.get(k)) for k, _ in columns[1:])]
                if c.get("missed", 0) > 0:
                    missed.append(f"{what}s {c['missed']:g} of {c['steps']:g}")
            lines.append([*line, ", ".join(missed)])
        tables.append((f"{tets:,} tetrahedra, residual {tolerance:g}, {threads} "
                       f"thread{'s' if threads > 1 else ''} [ms]", head, lines))
    return tables


# Tables 2 and 3 of the paper [s], 3.2 GHz Xeon: columns A; B expansion; B expansion and pressure.
PAPER_2 = {"stiffness matrix": ("1.43", "1.40", "1.41"),
           "stress-displacement matrix": ("9.37", "9.33", "9.70"),
           "inverse matrix": ("55.2", "54.8", "56.7"),
           "element update": ("3.44", "3.48", "3.62"), "total": ("69.4", "69.0", "71.5")}
PAPER_3 = {"stress distribution": ("", "0.03"), "stress intensity": ("", "2.81"),
           "comparison": ("", "0.01"), "update": ("", "0.01"), "total": ("0.03", "2.86")}
PAPER_COLUMNS = ("A", "B, expansion", "B, expansion + pressure")


def paper_rows(rows):
    return {r["name"].split("/", 1)[1]: r for r in rows
            if r["name"].startswith("paper/") and r["samples_ms"]}


def paper_2(rows):
    """Head and lines of Table 2, or None: paper [s], our way, the paper's way by us [ms]."""
    ran = paper_rows(rows)
    if not all(c in ran for c in PAPER_COLUMNS):
        return None
    counters = [ran[c]["counters"] for c in PAPER_COLUMNS]
    anew = {"stiffness matrix": ["anew_stiffness_ms"],
            "stress-displacement matrix": ["anew_stress_displacement_ms"],
            "inverse matrix": ["anew_inverse_ms"], "element update": ["anew_displacement_ms"]}
    anew["total"] = [k for keys in anew.values() for k in keys]
    ours = {"stiffness matrix": [], "stress-displacement matrix": [],
            "inverse matrix": ["update_ms"], "element update": ["solve_ms"],
            "total": ["update_ms", "solve_ms"]}
    head = ["", *(f"paper, {c} [s]" for c in PAPER_COLUMNS),
            *(f"all anew, {c} [ms]" for c in PAPER_COLUMNS),
            *(f"Sunder, {c} [ms]" for c in PAPER_COLUMNS)]
    lines = [[name, *PAPER_2[name],
              *(number(sum(c[k] for k in anew[name])) for c in counters),
              *(number(sum(c[k] for k in ours[name])) if ours[name] else "kept"
                for c in counters)] for name in PAPER_2]
    lines.append(["once, before the first frame", "", "", "", "", "", "",
                  *(number(c["prepare_ms"]) for c in counters)])
    return head, lines


def paper_3(rows):
    """Head and lines of Table 3, or None."""
    ran = paper_rows(rows)
    columns = [c for c in (*PAPER_COLUMNS, "B, field") if c in ran]
    if len(columns) < 4:
        return None
    counters = [ran[c]["counters"] for c in columns]
    ours = {"stress distribution": ["stress_ms"],
            "stress intensity": ["decide_ms"], "comparison": None, "update": None,
            "total": ["stress_ms", "decide_ms"]}
    head = ["", "paper, A [s]", "paper, B [s]", *(f"Sunder, {c} [ms]" for c in columns)]
    lines = [[name, *PAPER_3[name],
              *("(above)" if keys is None else number(sum(c[k] for k in keys))
                for c in counters)] for name, keys in ours.items()]
    return head, lines


def verdicts(cells):
    """Head and lines: how often each verdict, by method."""
    counts = collections.Counter((c["method"], c["verdict"]) for c in cells)
    words = ["ok", "polished", "rounded", "refused", "WRONG"]
    lines = [[m, *(counts[m, w] for w in words),
              number(max((c["stress_error"] for c in cells
                          if c["method"] == m and c["verdict"] != "refused"), default=None), 2)]
             for m in dict.fromkeys(c["method"] for c in cells)]
    return ["method", *words, "largest stress error"], lines


def accuracy_of_methods(cells):
    """Head and lines: how often each judgement by the table of accuracy, by method."""
    counts = collections.Counter((c["method"], c["accuracy"]) for c in cells)
    words = ["within", "beyond", "not named"]
    return (["method", *words],
            [[m, *(counts[m, w] for w in words)] for m in dict.fromkeys(c["method"]
                                                                        for c in cells)])


def beyond(cells):
    """Head and lines: every cell that is beyond its accuracy, and why."""
    keys = ("contrast", "nu", "sliver", "alpha", "unit")
    lines = [[c["study"], ", ".join(f"{k} {c[k]:g}" for k in keys),
              f"{c['fractures']:g} by {c['batch']:g}", c["method"], c["accuracy_reason"]]
             for c in cells if c["accuracy"] == "beyond"]
    return ["study", "difficulty", "fractures", "method", "why"], lines


STEP_VERDICTS = ("right", "over", "unfinished", "refused", "no yardstick", "WRONG")


def finite_verdicts(steps):
    """Head and lines: verdicts of the steps by difficulty, motion and law."""
    groups = collections.defaultdict(list)
    for s in steps:
        groups[s["study"], s["motion"], s["law"]].append(s)
    lines = []
    for key, own in groups.items():
        errors = [s["stress_error"] for s in own if s["verdict"] == "right"]
        lines.append([*key, *(sum(s["verdict"] == v for s in own) for v in STEP_VERDICTS),
                      number(max(errors, default=None), 2)])
    return ["difficulty", "motion", "law", *STEP_VERDICTS, "largest stress error of those right"], \
        lines


def finite_refusals(steps):
    """Head and lines: every step that is not right, and why."""
    return (["difficulty", "law", "contrast, nu, sliver", "added", "method", "motion", "amount",
             "verdict", "reason"],
            [[s["study"], s["law"], f"{s['contrast']:g}, {s['nu']:g}, {s['sliver']:g}", s["added"],
              s["method"], s["motion"], f"{s['amount']:g}", s["verdict"], s["reason"]]
             for s in steps if s["verdict"] != "right"])


def fracture_verdicts(rows):
    """Head and lines: states and sequences of fractures by law and rotation."""
    words = ["right", "refused", "no reference", "WRONG"]
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row["part"], row["law"], row["degrees"]].append(row)
    lines = []
    for (part, law, degrees), own in groups.items():
        lines.append([part, law, number(degrees, 3), number(own[0]["newtons"], 3),
                      number(max(r["gone"] for r in own), 3),
                      *(sum(r["verdict"] == w for r in own) for w in words),
                      *(number(max((r[e] for r in own if r["verdict"] == "right"
                                    and not math.isnan(r[e])), default=None), 2)
                        for e in ("u_error", "stress_error"))])
    return (["what", "law", "largest rotation [deg]", "force [N]", "gone", *words,
             "largest error of u", "of stress"], lines)


def scene_verdicts(points):
    """Head and lines: what became of the runs of each method over all scenes and tolerances."""
    words = ["ok", "polished", "rounded", "other fractures", "over budget", "refused", "WRONG"]
    counts = collections.Counter((p["method"], p["verdict"]) for p in points)
    return (["method", *words],
            [[m, *(counts[m, w] for w in words)] for m in dict.fromkeys(p["method"]
                                                                        for p in points)])


def every_row(rows):
    """[(program, head, lines)]."""
    tables = []
    for program in dict.fromkeys(r["program"] for r in rows):
        own = [r for r in rows if r["program"] == program]
        counters = sorted({c for r in own for c in r["counters"]})
        lines = [[r["name"], number(_frame(r), 4),
                  number(results.median(r), 4) if r["samples_ms"] else r.get("failure", ""),
                  number(min(r["cpu_samples_ms"], default=None), 4), len(r["samples_ms"]),
                  *(number(r["counters"].get(c), 4) for c in counters)] for r in own]
        tables.append((program, ["row", "min ms", "median ms", "CPU ms", "samples", *counters],
                       lines))
    return tables


def peers_alone(entries):
    """(head, lines): each peer beside the others and alone."""
    lines = [[f"{e['body']}, {e['event']}, {e['method']}", e["how"],
              *(number(float(e[k])) for k in ("together_ms", "alone_ms", "ratio")), e["within"]]
             for e in entries]
    return ["", "alone is", "beside others [ms]", "alone [ms]", "ratio", "within noise"], lines
