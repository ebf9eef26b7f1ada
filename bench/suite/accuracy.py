# SPDX-License-Identifier: Apache-2.0
"""The accuracy that is promised, and the stability study's cells judged by it: `accuracy` is
"within", "beyond" or "not named"; `accuracy_reason` says why a cell is beyond."""
import math

# What the table names; outside of it a cell may be right, polished or refused with a reason.
CONTRAST, NU, SLIVER, ALPHA, FRACTURES = 1e4, 0.499, 1e-2, 1e-9, 200
# Largest error of u and of stress. A board that hangs on one element counts as torn along a crack.
FP64 = {"scattered": 1e-9, "crack": 1e-8, "bridge": 1e-8, "cut": 1e-5, "island": 1e-5}
FP32 = 1e-4
ROUNDINGS = 4  # of u to fp32, at the ends of what is named: so much stress may cost
TOLERANCE = 1e-4  # of a frame: what the study runs with
# Ways that results of earlier versions hold and that are offered no more.
DROPPED = ("condensed eager", "eager fp32")

TABLE = (["", "scattered", "along a crack, up to 200 fractures", "after a cut, attached part"],
         [["fp64", *(f"{FP64[p]:g}" for p in ("scattered", "crack", "cut"))],
          ["fp32", *[f"{FP32:g}"] * 3]])


def is_named(cell):
    if cell.get("volume") == "pooled":  # the table is of elements by themselves
        return False
    along_a_crack = cell["pattern"] in ("crack", "bridge")
    if any(way in cell["method"] for way in DROPPED):
        return False
    return (cell["contrast"] <= CONTRAST and cell["nu"] <= NU and cell["sliver"] >= SLIVER
            and cell["alpha"] >= ALPHA and not (along_a_crack and cell["fractures"] > FRACTURES))


def promised(cell):
    """Largest error of u, and of stress."""
    if cell["method"].endswith("fp64"):
        return (FP64[cell["pattern"]],) * 2
    extreme = cell["contrast"] >= CONTRAST or cell["nu"] >= NU
    return FP32, max(FP32, ROUNDINGS * cell["fp32_rounding"]) if extreme else FP32


def _cause(cell, stress):
    if cell["method"].endswith("fp32") and cell["fp32_rounding"] > stress:
        return f"rounding the exact u to fp32 alone costs {cell['fp32_rounding']:.2g} of stress"
    if stress < cell["estimate"] <= TOLERANCE:
        return (f"the frame's own check saw {cell['estimate']:.2g}, within its tolerance of "
                f"{TOLERANCE:g}")
    return f"the frame's own check saw {cell['estimate']:.2g}"


def judged(cell):
    """("within" | "beyond" | "not named", reason)."""
    if not is_named(cell):
        return "not named", ""
    if cell["verdict"] == "refused":
        return "beyond", "refused: " + cell["reason"]
    u, stress = promised(cell)
    if cell["u_error"] <= u and cell["stress_error"] <= stress:
        return "within", ""
    if not (math.isfinite(cell["u_error"]) and math.isfinite(cell["stress_error"])):
        return "beyond", "no number"
    return "beyond", (f"u {cell['u_error']:.2g}, stress {cell['stress_error']:.2g} where "
                      f"{stress:.2g} is promised: {_cause(cell, stress)}")


def add(cells):
    """Renews the judgement of the cells."""
    for cell in cells:
        cell["accuracy"], cell["accuracy_reason"] = judged(cell)
    return cells
