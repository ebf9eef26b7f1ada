# SPDX-License-Identifier: Apache-2.0
"""The page: machine, figures, tables; one file that opens without a network."""
import html
import pathlib
import re

from . import accuracy, checks, error_plots, headline, heat_map, plots, results, tables, targets

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:76em;padding:0 1em;color:#222}
h2{margin-top:2em;border-bottom:2px solid #eee}nav a{margin-right:1em}
table{border-collapse:collapse;font-size:13px;margin:.5em 0 1em}
td,th{padding:.15em .7em;text-align:right;border-bottom:1px solid #e4e4e4;vertical-align:bottom}
td:first-child,th:first-child,td[colspan]{text-align:left}.wide td{white-space:nowrap}
.words td,.words th{text-align:left}.words td:nth-child(2){min-width:14em}
.wide{overflow-x:auto}svg{max-width:100%;height:auto;display:block}
.bad{color:#b00;font-weight:600}details{margin:.4em 0}summary{cursor:pointer}
dt{font-weight:600}dd{margin:0 0 .2em 1.5em;white-space:pre-wrap}
"""


def _table(head, lines, kind="wide"):
    head = list(head)
    def row(values, tag):
        # A line that ends early ends in words: they take the rest of it.
        rest = len(head) - len(values) + 1
        cells = [f"<{tag}>{html.escape(str(v))}</{tag}>" for v in values]
        if rest > 1:
            cells[-1] = cells[-1].replace("<td", f'<td colspan="{rest}"', 1)
        return "<tr>" + "".join(cells) + "</tr>"
    body = "".join(row(line, "td") for line in lines)
    return f'<div class="{kind}"><table>{row(head, "th")}{body}</table></div>'


def _details(title, content):
    return f"<details><summary>{html.escape(title)}</summary>{content}</details>"


def _machine(about):
    items = []
    for key, value in about.items():
        text = "\n".join(value) if isinstance(value, list) else str(value)
        items.append(f"<dt>{html.escape(key)}</dt><dd>{html.escape(text)}</dd>")
    return "<dl>" + "".join(items) + "</dl>"


class Page:
    """Sections in order, each with a link at the top; figures by file name."""

    def __init__(self):
        self.parts, self.links, self.figures = [], [], {}

    def section(self, title):
        name = title.lower().replace(" ", "-")
        self.links.append(f'<a href="#{name}">{title}</a>')
        self.parts.append(f'<h2 id="{name}">{title}</h2>')

    def text(self, words):
        self.parts.append(f"<p>{words}</p>")

    def add(self, part):
        self.parts.append(part)

    def figure(self, name, svg):
        if svg is None:
            self.text("No row of this run shows it.")
            return
        self.figures[name] = svg
        # Ids of one figure must not meet those of another in the same document.
        svg = re.sub(r'(id="|href="#|url\(#)', lambda m: m[1] + name + "-", svg)
        self.parts.append(svg)


def _problems(page, outcome):
    found = checks.problems(outcome, outcome["machine"].get("mode") == "full")
    if found:
        page.add('<p class="bad">Not good in this run:</p><ul class="bad">'
                 + "".join(f"<li>{html.escape(p)}</li>" for p in found) + "</ul>")


def _paper(page, rows):
    page.section("The paper's tables")
    page.text("The paper's board of 1954 tetrahedra; the paper's seconds (3.2 GHz Xeon) beside ours "
              "in ms. <em>All anew</em> is the paper's way on this machine: matrices, inverse and "
              "displacement again after every fracture. Sunder keeps the matrices and carries the "
              "fracture as a correction of low rank: inverse matrix is then the update of what "
              "carries the damage, element update the displacement with its check. Median over the "
              "steps in which something broke.")
    for title, made in (("Table 2, one reconstruction", tables.paper_2(rows)),
                        ("Table 3, deciding which element ruptures", tables.paper_3(rows))):
        page.add(f"<h3>{title}</h3>" + (_table(*made) if made else "<p>Not measured.</p>"))


def _peers_alone(entries):
    outside = sum(e["within"] == "no" for e in entries)
    noisy = sum(e["within"] == "too noisy" for e in entries)
    return ("<h3>Peers alone</h3><p>Each peer's event beside the others, as above, and alone, in "
            f"turns: {len(entries) - outside - noisy} of {len(entries)} agree within 25 % or their "
            "own noise" + (f", {outside} do not" if outside else "")
            + (f", {noisy} were too noisy to tell" if noisy else "") + ".</p>"
            + _details("Each of them", _table(*tables.peers_alone(entries))))


def _reconstruction(page, outcome):
    rows = outcome["rows"]
    page.section("Inverse reconstruction")
    page.text("One event of k connected elements of a crack, then displacement and stress of all "
              "elements under the same load. One thread; a Vulkan device that is a software "
              "renderer takes all cores. Solid: CPU; open symbols: Vulkan; grey, dashed: what a "
              "user would pick instead. Sunder's solution includes the check of its own error. "
              "Peers get their matrices and update vectors ready made, and stress by the library's "
              "plain function. Errors are taken against a fresh CHOLMOD factor, refined once.")
    page.figure("reconstruction", plots.reconstruction(rows))
    for title, head, lines in tables.reconstruction(rows):
        page.add(_details(title, _table(head, lines)))
    page.add("<h3>640 fractures one by one</h3>")
    page.figure("accumulated", plots.accumulated(rows))
    page.add("<h3>Settings of the peers</h3>"
             + _table(["peer", "settings"], outcome["peers"].items(), "words"))
    if outcome["alone"]:
        page.add(_peers_alone(outcome["alone"]))
    page.add("<h3>The intact inverse</h3>")
    page.text("All columns of the inverse, fp64, one thread.")
    page.figure("inversion", plots.inversion(rows))


def _finite(page, outcome):
    rows = outcome["rows"]
    page.section("Finite deformation")
    page.text("The board pulled at its corner by 36 N, corotated: strained by 29 % at 1,954 tetrahedra, "
              "buckled out of its plane. From there frames of 1 % more, and events of nine elements "
              "at the tip of the tear, frames 60 times a second, all methods to the same residual "
              "(1e-4 of the forces that act) with the same element code; sunder promise ends by its "
              "estimate of the error of stress instead. CPU is that of all threads within a step. "
              "A step that a method does not find within its cap is counted, and its time is none.")
    page.figure("finite", plots.finite(rows))
    for title, head, lines in tables.finite(rows):
        page.add(_details(title, _table(head, lines)))
    page.text("Error of stress against run time, 1,944 tetrahedra, events; a point for each "
              "tolerance.")
    page.figure("finite-error", error_plots.finite_laws(rows))
    settings = outcome.get("finite_peers")
    if settings:
        page.add("<h3>Settings of the methods</h3>"
                 + _table(["method", "settings"], settings.items(), "words"))


def _errors(page, outcome):
    page.section("Error against run time")
    page.text("Every method on the study's board of 600 tetrahedra, a panel for each pattern of "
              "fracture; a point for each number of fractures. Black: what no other method beats "
              "in both.")
    page.figure("error-board", error_plots.error_against_time(outcome["cells"]))
    page.add("<h3>Scenes</h3>")
    page.text("Every method at tolerances 1e-2, 1e-4 and 1e-8, each scene to its end; error of the "
              "last frame against conjugate gradients in fp64, refined to 1e-10 (errors under 1e-15 "
              "are drawn there). A run over its "
              "time, or one that breaks other elements, is counted below and not drawn.")
    page.figure("error-scenes", error_plots.scenes(outcome["points"]))
    if outcome["points"]:
        page.add(_table(*tables.scene_verdicts(outcome["points"])))
    page.add("<h3>Mesh size</h3>")
    page.text("Discretisation error of one displacement: a cantilever against Timoshenko's beam, "
              "Cook's membrane (plane stress) against the published value, the board of Table 1 "
              "against its own limit. Linear tetrahedra, the route that the library chooses.")
    page.figure("mesh-size", error_plots.convergence(outcome["meshes"]))


def _accuracy(page, cells):
    page.add("<h3>By the table of accuracy</h3>")
    page.text("Largest error of displacement (2-norm) and of stress (largest) that is promised, up "
              f"to a contrast of {accuracy.CONTRAST:g}, a Poisson's ratio of {accuracy.NU:g}, "
              f"slivers of {accuracy.SLIVER:g} and alpha of {accuracy.ALPHA:g}; at these contrasts "
              f"and ratios fp32 may cost {accuracy.ROUNDINGS} times the stress that rounding the "
              "exact displacement costs. A board that hangs on its last element is judged as one "
              "torn along a crack. What is not named may be right, polished or refused.")
    page.add(_table(*accuracy.TABLE))
    page.add(_table(*tables.accuracy_of_methods(cells)))
    head, lines = tables.beyond(cells)
    if lines:
        page.add(f"<p>Beyond it, {len(lines)} cells:</p>" + _table(head, lines, "words"))
    else:
        page.text("No cell is beyond it.")


def _stability(page, cells):
    page.section("Stability")
    page.text("One difficulty at a time, then pairs, on a board of 600 tetrahedra torn in events "
              "of ten where nothing else is said. Yardstick: a fresh fp64 factorisation refined in extended precision. A "
              "number that is off by more than the tolerance (1e-4) and is neither polished nor "
              "refused is WRONG.")
    alone = [c for c in cells if c.get("volume") != "pooled"]
    page.figure("stability", heat_map.singles(alone))
    page.figure("stability-pairs", heat_map.pairs(alone))
    if not cells:
        return
    page.add(_table(*tables.verdicts(alone)))
    pooled = [c for c in cells if c.get("volume") == "pooled"]
    if pooled:
        page.text("Pooled volume, at ratios to .4999 under each of the other difficulties:")
        page.add(_table(*tables.verdicts(pooled)))
    _accuracy(page, cells)
    refusals = sorted({(c["method"], c["reason"]) for c in cells if c["verdict"] == "refused"})
    if refusals:
        page.add(_details("Reasons of the refusals",
                          _table(["method", "reason"], refusals, "words")))


def _finite_stability(page, steps):
    if not steps:
        return
    page.section("Stability at finite deformation")
    page.text("A board of 216 tetrahedra between two hands that hold its edges as solids: stretched "
              "to twice its length, turned as a whole, twisted and folded to 180 degrees in steps of "
              "30, pulled ten lengths away in one step and back, pushed through the other hand in "
              "one step, torn. Then all contrasts with all ratios and slivers; pooled volume, fibres, an "
              "interface that is also taken away in thirds, and all three, by each way that computes "
              "them. Yardstick: Newton's method in "
              "extended precision, from where the step ended. Refused: with a reason, and the state "
              "before it can be solved again. Unfinished: the path to rest goes on after 400 "
              "frames.")
    page.add(_table(*tables.finite_verdicts(steps)))
    head, lines = tables.finite_refusals(steps)
    if lines:
        page.add(_details(f"{len(lines)} of {len(steps)} steps that are not right",
                          _table(head, lines, "words")))


def _finite_fractures(page, rows):
    if not rows:
        return
    page.section("Fractures at finite deformation")
    page.text("The paper's board pulled until it has turned so far, then torn along a crack, one by one "
              "and in batches, converged to 1e-10 (state); and torn by what the default tolerance says "
              "is weakest (sequence). Reference: Newton's method with a factor of the exact tangent "
              "each iteration, from where the solver ended.")
    page.add(_table(*tables.fracture_verdicts(rows)))


def page(outcome):
    """(HTML, {figure name: SVG})."""
    made = Page()
    rows = outcome["rows"]
    _problems(made, outcome)
    made.section("Figures of the README")
    made.add(_table(["what", "figure", "command in build/bench/"], headline.figures(outcome),
                    "words"))
    made.section("Aims")
    made.add(_table(targets.HEAD, [(*t[:3], t[3] or "none", t[4]) for t in targets.targets(outcome)],
                    "words"))
    _paper(made, rows)
    _reconstruction(made, outcome)
    _finite(made, outcome)
    _errors(made, outcome)
    _stability(made, outcome["cells"])
    _finite_stability(made, outcome.get("steps", []))
    _finite_fractures(made, outcome.get("fractures", []))
    made.section("Size")
    made.text("Board of one layer of cells. Grey: times that no route can reach which reads all "
              "it holds, by the machine's measured copy rate. Dense inverses end where n squared "
              "numbers take gigabytes or, eager, each fracture rewrites them; conjugate gradients "
              "on a software renderer end at 120k tetrahedra, where a frame takes half a minute. "
              "What a torn patch costs in a body of any size is under bench_needs.")
    made.figure("scaling", plots.scaling(rows))
    made.section("All rows")
    for program, head, lines in tables.every_row(rows):
        made.add(_details(f"{program}: {len(lines)} rows", _table(head, lines)))
    made.section("Machine")
    made.add(_machine(outcome["machine"]))
    made.add(_table(["program", "what", "s", "CPU s", "commit"],
                    [[p["name"], p["about"], p["seconds"], p["cpu_seconds"],
                      p.get("commit") or outcome["machine"].get("commit", "")]
                     for p in outcome["programs"]], "words"))
    text = "".join(['<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Sunder: error '
                    f"against run time</title><style>{STYLE}</style><h1>Error against run time"
                    f"</h1><nav>{''.join(made.links)}</nav>", *made.parts, "</html>\n"])
    return text, made.figures


def write(folder, outcome):
    text, figures = page(outcome)
    results.write_text(pathlib.Path(folder) / "index.html", text)
    for name, svg in figures.items():
        results.write_text(pathlib.Path(folder) / f"{name}.svg", svg)
