# SPDX-License-Identifier: Apache-2.0
"""The stability study as heat maps: stress error by colour, verdicts by mark."""
import math

import matplotlib

from . import style
from .style import pyplot
from matplotlib.colors import LogNorm
from matplotlib.patches import Patch

FLOOR = 1e-17
_GOOD = LogNorm(1e-13, 1e-1)
_MARKS = {"polished": "p", "rounded": "r", "WRONG": "X"}
_TITLES = {"contrast": "contrast of E", "nu": "Poisson's ratio", "sliver": "sliver quality",
           "alpha": "alpha", "unit": "unit [mm]", "crack": "fractures along a crack",
           "scattered": "scattered fractures", "cut": "cut through", "island": "islands",
           "bridge": "one bridge left", "batch": "crack, elements an event",
           "scattered batch": "scattered, elements an event"}
_COLUMNS = {"crack": "fractures", "scattered": "fractures", "scattered batch": "batch"}


def _colours():
    colours = matplotlib.colormaps["viridis_r"].copy()
    colours.set_bad("#e3e3e3")
    return colours


def value_of(cell, knob):
    return cell[_COLUMNS.get(knob, knob)]


def text_of(value):
    """1e6 as a power of ten, 0.4999 as it is."""
    power = math.log10(value) if value > 0 else 0.5
    if abs(power - round(power)) < 1e-9 and abs(power) > 1.5:
        return f"$10^{{{round(power)}}}$"
    return f"{value:g}"


def _error(cell):
    if cell is None or cell["verdict"] == "refused":
        return math.nan
    return max(cell["stress_error"], FLOOR)


def _mark(axis, x, y, cell, size):
    mark = _MARKS.get(cell["verdict"]) if cell else None
    if mark:
        dark = cell["verdict"] != "WRONG" and cell["stress_error"] > 1e-7
        axis.text(x, y, mark, ha="center", va="center", fontsize=size,
                  color="red" if mark == "X" else "white" if dark else "black",
                  fontweight="bold" if mark == "X" else "normal")


def _explain(figure, image, axes):
    bar = figure.colorbar(image, ax=axes, fraction=0.03, pad=0.02, aspect=40)
    bar.set_label("largest stress error / largest stress, against fp64 direct")
    figure.legend(handles=[Patch(color="#e3e3e3", label="refused, with a reason"),
                           Patch(color="none", label="p: polished"),
                           Patch(color="none", label="r: limited by reading u out in fp32"),
                           Patch(color="none", label="X: WRONG")],
                  loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)


def singles(cells):
    """One difficulty at a time: a block of lines per difficulty, a column per method."""
    own = [c for c in cells if " x " not in c["study"]]
    if not own:
        return None
    methods = list(dict.fromkeys(c["method"] for c in own))
    studies = list(dict.fromkeys(c["study"] for c in own))
    lines = []  # (study, value or None)
    for study in studies:
        values = [None] if study in ("cut", "island", "bridge") else \
            dict.fromkeys(value_of(c, study) for c in own if c["study"] == study)
        lines += [(study, v) for v in values]
    at = {(c["study"], None if c["study"] in ("cut", "island", "bridge")
           else value_of(c, c["study"]), c["method"]): c for c in own}
    figure, axis = pyplot.subplots(figsize=(0.62 * len(methods) + 3.2, 0.21 * len(lines) + 1.8),
                                   layout="constrained")
    grid = [[_error(at.get((*line, m))) for m in methods] for line in lines]
    image = axis.imshow(grid, aspect="auto", cmap=_colours(), norm=_GOOD)
    for y, line in enumerate(lines):
        for x, method in enumerate(methods):
            _mark(axis, x, y, at.get((*line, method)), 7)
    axis.set_xticks(range(len(methods)), methods, rotation=40, ha="right", rotation_mode="anchor")
    axis.set_yticks(range(len(lines)), [_TITLES.get(s, s) if v is None or i == 0
                                        or lines[i - 1][0] != s else "" for i, (s, v)
                                        in enumerate(lines)], fontsize=8)
    for i, (study, value) in enumerate(lines):
        if value is not None:
            axis.text(-0.62, i, text_of(value), ha="right", va="center", fontsize=7.5,
                      clip_on=False)
        if i and lines[i - 1][0] != study:
            axis.axhline(i - 0.5, color="white", linewidth=2.5)
    axis.tick_params(axis="y", pad=34, length=0)
    axis.tick_params(axis="x", length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
    _explain(figure, image, axis)
    return style.svg(figure)


def pairs(cells):
    """Two difficulties at once: a line of small maps per pair, one per method."""
    own = [c for c in cells if " x " in c["study"]]
    if not own:
        return None
    methods = list(dict.fromkeys(c["method"] for c in own))
    studies = list(dict.fromkeys(c["study"] for c in own))
    figure, axes = pyplot.subplots(len(studies), len(methods), squeeze=False,
                                   figsize=(1.5 * len(methods) + 1.5, 1.9 * len(studies) + 0.8),
                                   layout="constrained")
    for line, study in zip(axes, studies):
        knobs = study.split(" x ")
        mine = [c for c in own if c["study"] == study]
        ys, xs = (list(dict.fromkeys(value_of(c, k) for c in mine)) for k in knobs)
        for axis, method in zip(line, methods):
            at = {(value_of(c, knobs[0]), value_of(c, knobs[1])): c for c in mine
                  if c["method"] == method}
            image = axis.imshow([[_error(at.get((y, x))) for x in xs] for y in ys], aspect="auto",
                                cmap=_colours(), norm=_GOOD)
            for i, y in enumerate(ys):
                for j, x in enumerate(xs):
                    _mark(axis, j, i, at.get((y, x)), 5)
            axis.set_xticks(range(len(xs)), [text_of(x) for x in xs], rotation=90, fontsize=5.5)
            axis.set_yticks(range(len(ys)), [text_of(y) for y in ys] if axis is line[0] else
                            [""] * len(ys), fontsize=6)
            axis.tick_params(length=0, pad=1.5)
            axis.set_xlabel(_TITLES.get(knobs[1], knobs[1]), fontsize=6, labelpad=1)
        line[0].set_ylabel(_TITLES.get(knobs[0], knobs[0]), fontsize=7.5)
    for axis, method in zip(axes[0], methods):
        axis.set_title(method.replace(" deferred", "\ndeferred").replace(" eager", "\neager")
                       .replace("cg ", "\ncg "), fontsize=7)
    _explain(figure, image, list(axes.flat))
    return style.svg(figure)
