# SPDX-License-Identifier: Apache-2.0
"""The accuracy that is promised, and the stability study's cells judged by it: `accuracy` is
"within", "beyond" or "not named"; `accuracy_reason` says why a cell is beyond."""
import math

# What the table names; outside of it a cell may be right, polished or refused with a reason.
CONTRAST, NU, SLIVER, ALPHA, FRACTURES = 1e4, 0.499, 1e-2, 1e-9, 200
# Largest error of u and of stress. A board that hangs on one element counts as torn along a crack.
FP64 = {"scattered": 1e-9, "crack": 1e-8, "bridge": 1e-8, "cut": 1e-5, "island": 1e-5}
FP32, FP32_EAGER, EAGER_FRACTURES = 1e-4, 1e-3, 10
ROUNDINGS = 4  # of u to fp32, at the ends of what is named: so much stress may cost
TOLERANCE = 1e-4  # of a frame: what the study runs with
CUTS = ("cut", "island")

TABLE = (["", "scattered", "along a crack, up to 200 fractures", "after a cut, attached part"],
         [["fp64", *(f"{FP64[p]:g}" for p in ("scattered", "crack", "cut"))],
          ["fp32", *[f"{FP32:g}"] * 3],
          ["fp32, eager", *[f"{FP32_EAGER:g} up to {EAGER_FRACTURES} fractures, then {FP32:g}, or "
                            "refused"] * 2, f"{FP32:g}, or refused"]])


def is_named(cell):
    along_a_crack = cell["pattern"] in ("crack", "bridge")
    return (cell["contrast"] <= CONTRAST and cell["nu"] <= NU and cell["sliver"] >= SLIVER
            and cell["alpha"] >= ALPHA and not (along_a_crack and cell["fractures"] > FRACTURES))


def promised(cell):
    """Largest error of u, and of stress."""
    words = cell["method"].split()
    if words[-1] == "fp64":
        return (FP64[cell["pattern"]],) * 2
    short = cell["fractures"] <= EAGER_FRACTURES and cell["pattern"] not in CUTS
    error = FP32_EAGER if "eager" in words and short else FP32
    extreme = cell["contrast"] >= CONTRAST or cell["nu"] >= NU
    return error, max(error, ROUNDINGS * cell["fp32_rounding"]) if extreme else error


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
    may_refuse = "eager" in cell["method"] and cell["method"].endswith("fp32")
    if cell["verdict"] == "refused":
        return ("within", "") if may_refuse else ("beyond", "refused: " + cell["reason"])
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
