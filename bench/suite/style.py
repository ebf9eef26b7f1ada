# SPDX-License-Identifier: Apache-2.0
"""What all figures share: one look per method, axes, SVG text."""
import io

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({
    "svg.hashsalt": "sunder",  # same input, same bytes
    "svg.fonttype": "none",
    "font.family": ["DejaVu Sans", "sans-serif"],
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8,
})
from matplotlib import pyplot  # noqa: E402

# Colour-blind safe (Okabe and Ito): one colour per base and update, on every device.
_BASES = {"inverse eager": "#D55E00", "inverse deferred": "#0072B2",
          "condensed eager": "#56B4E9", "condensed deferred": "#CC79A7",
          "factor deferred": "#009E73", "cg": "#E69F00"}
_DEVICES = {"cpu fp64": ("o", "-"), "vulkan fp64": ("s", "--"), "vulkan fp32": ("^", ":")}
_PEERS = {"cholmod updown_solve": ("v", "#222222"), "cholmod updown": ("^", "#555555"),
          "cholmod supernodal refactor": ("s", "#555555"),
          "cholmod simplicial refactor": ("D", "#888888"),
          "eigen SimplicialLDLT refactor": ("p", "#888888"),
          "eigen SimplicialLDLT inverse": ("h", "#aaaaaa"),
          "openblas potrf potri": ("X", "#222222"), "eigen LLT inverse": ("P", "#888888"),
          "eigen PartialPivLU inverse": ("*", "#aaaaaa"), "stale-factor PCG": (">", "#666666"),
          "Jacobi PCG": ("<", "#aaaaaa"),
          "newton cholmod": ("s", "#222222"), "newton pcg jacobi": ("<", "#aaaaaa"),
          "newton pcg ichol": (">", "#888888"), "projective lbfgs": ("D", "#555555"),
          "warped stiffness": ("^", "#777777")}
# At finite deformation; with "promise" it ends by its own estimate of the error.
_FINITE = {"sunder": ("o", "#009E73"), "sunder promise": ("*", "#0072B2")}


def is_peer(method):
    return not method.startswith(("cpu", "vulkan", "sunder"))


def look(method):
    """Line of a method or peer; the same in every figure."""
    if is_peer(method):
        marker, colour = _PEERS.get(method, ("x", "#888888"))
        return {"color": colour, "marker": marker, "linestyle": (0, (4, 2)), "linewidth": 0.9,
                "markersize": 4.5, "label": method}
    if method in _FINITE:
        marker, colour = _FINITE[method]
        return {"color": colour, "marker": marker, "linestyle": "-", "linewidth": 1.5,
                "markersize": 4.5, "label": method}
    device, *base, precision = method.split()
    marker, line = _DEVICES.get(f"{device} {precision}", ("d", "-."))
    return {"color": _BASES.get(" ".join(base), "#000000"), "marker": marker, "linestyle": line,
            "linewidth": 1.5, "markersize": 4.5, "label": method,
            "markerfacecolor": "white" if device == "vulkan" else _BASES.get(" ".join(base))}


def panels(count, columns, width=3.7, height=3.1, **options):
    """Figure with `count` axes in rows of `columns`."""
    columns = max(1, min(columns, count))
    lines = -(-count // columns)
    figure, axes = pyplot.subplots(lines, columns, figsize=(width * columns, height * lines),
                                   squeeze=False, layout="constrained", **options)
    for axis in axes.flat[count:]:
        axis.remove()
    return figure, list(axes.flat[:count])


def logarithmic(axis, title="", xlabel="", ylabel=""):
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set(title=title, xlabel=xlabel, ylabel=ylabel)
    axis.grid(True, which="major", color="#dddddd", linewidth=0.6)
    axis.set_axisbelow(True)


def sizes_as_ticks(axis, sizes):
    """The sizes that were measured, instead of powers of ten."""
    def text(size):
        return f"{size / 1e6:.3g}M" if size >= 1e6 else f"{size / 1e3:.2g}k" \
            if size < 1e5 else f"{size / 1e3:.0f}k"
    axis.set_xticks(sizes, [text(s) for s in sizes])
    axis.set_xticks([], minor=True)


def shared_legend(figure, columns=4):
    """One legend below all axes, each label once."""
    handles = {h.get_label(): h for axis in figure.axes for h in axis.get_lines()
               if not h.get_label().startswith("_")}
    handles = dict(sorted(handles.items(), key=lambda item: (is_peer(item[0]), item[0])))
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncols=columns,
                  bbox_to_anchor=(0.5, 0.0))


def svg(figure):
    out = io.StringIO()
    figure.savefig(out, format="svg", bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)
    text = out.getvalue()
    return text[text.index("<svg"):]
