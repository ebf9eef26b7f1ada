# SPDX-License-Identifier: Apache-2.0
"""The page: machine, figures, tables; one file that opens without a network."""
import collections
import html
import pathlib

from . import plots, results

STYLE = """
body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:78em;padding:0 1em;color:#222}
table{border-collapse:collapse;font-size:13px}td,th{padding:.15em .6em;text-align:right;
border-bottom:1px solid #ddd}td:first-child,th:first-child{text-align:left}
.wide{overflow-x:auto}svg{max-width:100%;height:auto}.WRONG{color:#b00;font-weight:bold}
dt{font-weight:600}dd{margin:0 0 .3em 1.5em;white-space:pre-wrap}
"""


def _table(head, lines):
    def row(values, tag):
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(v))}</{tag}>" for v in values) + "</tr>"
    body = "".join(row(line, "td") for line in lines)
    return f'<div class="wide"><table>{row(head, "th")}{body}</table></div>'


def _number(value):
    return "" if value is None else f"{value:.4g}"


def _machine(about):
    items = []
    for key, value in about.items():
        text = "\n".join(value) if isinstance(value, list) else str(value)
        items.append(f"<dt>{html.escape(key)}</dt><dd>{html.escape(text)}</dd>")
    return "<dl>" + "".join(items) + "</dl>"


def _rows(rows):
    parts = []
    for program in dict.fromkeys(r["program"] for r in rows):
        own = [r for r in rows if r["program"] == program]
        counters = sorted({c for r in own for c in r["counters"]})
        lines = [[r["name"], _number(results.minimum(r)), _number(results.median(r)),
                  _number(min(r["cpu_samples_ms"], default=None)), len(r["samples_ms"]),
                  *(_number(r["counters"].get(c)) for c in counters)] for r in own]
        parts.append(f"<h3>{program}</h3>" + _table(
            ["row", "min ms", "median ms", "CPU ms", "samples", *counters], lines))
    return "".join(parts)


def _verdicts(cells):
    counts = collections.Counter((c["method"], c["verdict"]) for c in cells)
    words = ["ok", "polished", "rounded", "refused", "WRONG"]
    lines = [[m, *(counts[m, w] for w in words),
              _number(max((c["stress_error"] for c in cells
                           if c["method"] == m and c["verdict"] != "refused"), default=None))]
             for m in dict.fromkeys(c["method"] for c in cells)]
    refusals = sorted({(c["method"], c["reason"]) for c in cells if c["verdict"] == "refused"})
    return (_table(["method", *words, "largest stress error"], lines)
            + ("<h3>Refusals</h3>" + _table(["method", "reason"], refusals) if refusals else ""))


def _figure(title, text, svg):
    return f"<h2>{title}</h2><p>{text}</p>" + (svg or "<p>No row of this run shows it.</p>")


def page(outcome):
    rows, cells = outcome["rows"], outcome["cells"]
    return "".join([
        '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Sunder: error against run time'
        f"</title><style>{STYLE}</style><h1>Error against run time</h1>",
        _machine(outcome["machine"]),
        _figure("Inverse reconstruction", "Update and solution after one event of k connected "
                "elements, one thread, fp64. Dashed: CHOLMOD (METIS where it has it, OpenBLAS with "
                "one thread), measured in the same run.", plots.reconstruction(rows)),
        _figure("The intact inverse", "Dense inverse of the intact stiffness, one thread, fp64; "
                "dashed: OpenBLAS and Eigen, measured in the same run.", plots.inversion(rows)),
        _figure("Error against run time", "Every method on the study's board: stress error against "
                "a fresh fp64 factorisation refined in extended precision.",
                plots.error_against_time(cells)),
        _figure("Error against run time on scenes", "Every method at tolerances 1e-2, 1e-4 and 1e-8; "
                "runs that break other elements than the reference are left out here and listed in "
                "scenes.csv.", plots.scenes(outcome.get("points", []))),
        _figure("Stability", "One difficulty at a time, then pairs. Grey: refused with a reason.",
                plots.heat_map(cells)),
        _figure("Size", "Dotted: the time in which the machine copies what the backend holds.",
                plots.scaling(rows)),
        "<h2>Verdicts</h2>", _verdicts(cells),
        "<h2>All rows</h2>", _rows(rows), "</html>\n"])


def write(folder, outcome):
    results.write_text(pathlib.Path(folder) / "index.html", page(outcome))
