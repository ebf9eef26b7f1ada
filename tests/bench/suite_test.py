# SPDX-License-Identifier: Apache-2.0
"""The benchmark suite's own rules: noise, planted slow-downs, planted wrong answers, bad folders."""
import copy
import html
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))
from suite import (accuracy, alone, checks, compare, error_plots, frames, headline, heat_map,  # noqa: E402
                   page, plots, programs, ratios, results, tables, targets)


def row(name, scale=1.0, seed=1, error=1e-12, count=9):
    """A row with 2 % of noise and now and then a descheduled sample."""
    draw = random.Random(seed)
    samples = [scale * (1 + 0.02 * draw.random()) for _ in range(count - 1)] + [scale * 1.8]
    return {"program": "bench_engine", "name": name, "samples_ms": samples,
            "cpu_samples_ms": samples, "counters": {"error": error, "rank": 12.0}}


def cell(method="cpu factor deferred fp64", verdict="ok", stress_error=1e-11, **what):
    made = {"study": "crack", "contrast": 100.0, "nu": 0.4, "sliver": 1.0, "alpha": 1e-6,
            "unit": 1.0, "pattern": "crack", "fractures": 10.0, "batch": 10.0, "method": method,
            "verdict": verdict, "u_error": 1e-12, "stress_error": stress_error, "residual": 1e-13,
            "estimate": 1e-12, "iterations": 0.0, "first_ms": 1.0, "median_ms": 0.5,
            "fp32_rounding": 1e-4, "reason": ""}
    (judged,) = accuracy.add([dict(made, **what)])
    return judged


def outcome(rows, cells=(), points=(), meshes=(), alone=()):
    return {"machine": {"cpu": "<test>", "cores": 2, "date": "today", "commit": "0", "devices": [],
                        "load_before": 0.1}, "rows": rows, "cells": list(cells),
            "points": list(points), "meshes": list(meshes), "alone": list(alone), "programs": [], "failures": [],
            "peers": {"cholmod updown_solve": "its settings"}}


def torn(method, event="k1", scale=1.0, body="board 1944"):
    made = row(f"reconstruction/{body}/{event}/{method}", scale)
    made["counters"] = {"setup_ms": 3.0, "update_ms": 0.5, "solve_ms": 0.4, "stress_ms": 0.1,
                        "MiB": 2.0, "error_u": 1e-12, "error_stress": 1e-11, "first_ms": 1.0,
                        "last_ms": 2.0, "worst_ms": 3.0}
    return made


def finite(method, what="frame", tets=1944, ms=1.0, **counters):
    """A row of bench_finite, two threads, residual 1e-4."""
    made = row(f"finite/{tets}/{what}/1e-04/2/{method}", ms)
    own = {"min_ms": 0.5 * ms, "median_ms": ms, "cpu_ms": ms, "back_solves": 6.0,
           "p99_back_solves": 20.0, "factors": 0.5, "missed": 0.0, "steps": 24.0}
    return dict(made, program="bench_finite", counters=dict(own, **counters))


def finite_error(method):
    made = row(f"finite_error/corotated/1e-04/{method}")
    return dict(made, program="bench_finite", counters={"median_ms": 1.0, "error_stress": 1e-5})


def finite_step(verdict="right", reason=""):
    return {"study": "nu", "law": "corotated", "contrast": 1.0, "nu": 0.499, "sliver": 1.0,
            "added": "", "method": "cpu", "motion": "twist", "amount": 90.0, "verdict": verdict, "u_error": 1e-6,
            "stress_error": 1e-5, "estimate": 1e-5, "back_solves": 9.0, "calls": 0.0,
            "strain": 0.4, "rotation_deg": 92.0, "inverted": 0.0, "reason": reason}


def every_part():
    """One row, cell or point for every figure of the page."""
    study = dict(cell(), study="contrast x nu")
    size = dict(row("scaling/cpu factor deferred fp64/1944"),
                counters={"setup_ms": 9.0, "quiet_ms": 0.1, "floor_ms": 0.01, "MiB": 3.0,
                          "unknowns": 2166.0})
    inverse = dict(row("inversion/sunder/486"), counters={"unknowns": 600.0, "error": 1e-12})
    rows = [torn("cholmod updown_solve", scale=4.0), torn("cpu factor deferred fp64"),
            torn("cpu factor deferred fp64", "to640"), size, inverse, finite("sunder"),
            finite("newton cholmod", ms=6.0), finite_error("sunder")]
    points = [{"scene": "notch-b", "method": "cpu cg fp64", "tolerance": 1e-4, "frame_ms": 2.5,
               "u_error": 1e-9, "stress_error": 1e-8, "fractures": 51.0, "verdict": "ok",
               "reason": ""}]
    meshes = [{"case": "cantilever", "tets": n, "value": 0.7, "error": 1 / n, "ms": n / 100}
              for n in (480.0, 3840.0)]
    peers = [{"body": "board 1944", "event": "k1", "method": "cholmod updown_solve",
              "how": "a process of its own", "together_ms": "4", "alone_ms": "4.1",
              "ratio": "1.025", "within": "yes"}]
    return outcome(rows, [cell(), study], points, meshes, peers)


def kinds(old, new):
    return [f.kind for f in compare.compare(old, new)]


NAMES = [f"sunder_factor_deferred/{n}/k{k}" for n in (1944, 7776) for k in (1, 10)]


class Comparison(unittest.TestCase):
    def test_noise_alone_is_no_finding(self):
        old = outcome([row(n, seed=1) for n in NAMES], [cell()])
        new = outcome([row(n, seed=2) for n in NAMES], [cell(stress_error=2e-11)])
        self.assertEqual(kinds(old, new), [])

    def test_a_planted_slow_down_of_a_fifth_is_caught(self):
        old = outcome([row(n, seed=1) for n in NAMES])
        new = copy.deepcopy(old)
        new["rows"][2] = row(NAMES[2], scale=1.2, seed=2)
        findings = compare.compare(old, new)
        self.assertEqual([(f.kind, f.name) for f in findings], [("slower", NAMES[2])])
        self.assertTrue(compare.bad(findings))
        self.assertEqual(kinds(new, old), ["faster"])

    def test_a_planted_wrong_answer_is_caught(self):
        old = outcome([row(n) for n in NAMES], [cell()])
        wrong_row, wrong_cell = copy.deepcopy(old), copy.deepcopy(old)
        wrong_row["rows"][0]["counters"]["error"] = 1e-3
        wrong_cell["cells"][0] = cell(verdict="WRONG", stress_error=0.3)
        self.assertEqual(kinds(old, wrong_row), ["wrong"])
        self.assertEqual(kinds(old, wrong_cell), ["wrong"])

    def test_an_error_that_grows_within_the_tolerance_is_caught(self):
        self.assertEqual(kinds(outcome([], [cell()]), outcome([], [cell(stress_error=5e-5)])),
                         ["wrong"])

    def test_an_error_that_is_no_number_is_caught(self):
        new = row(NAMES[0], error=float("nan"))
        self.assertEqual(kinds(outcome([row(NAMES[0])]), outcome([new])), ["wrong"])

    def test_what_is_gone_counts_and_what_is_new_does_not(self):
        self.assertTrue(compare.bad(compare.compare(outcome([row("a"), row("b")]),
                                                    outcome([row("a")]))))
        self.assertFalse(compare.bad(compare.compare(outcome([row("a")]),
                                                     outcome([row("a"), row("b")]))))

    def test_too_few_samples_are_not_judged(self):
        old, new = outcome([row("a", count=2)]), outcome([row("a", scale=3, count=2)])
        self.assertEqual(kinds(old, new), ["unjudged"])


class Rows(unittest.TestCase):
    def test_repetitions_become_samples_in_milliseconds(self):
        run = {"name": "a", "run_name": "a", "run_type": "iteration", "real_time": 2.0,
               "cpu_time": 1.0, "time_unit": "us", "iterations": 5, "error": 3e-9}
        mean = dict(run, run_type="aggregate", aggregate_name="mean")
        rows = results.rows_of("p", {"benchmarks": [run, dict(run, real_time=4.0), mean]})
        self.assertEqual(len(rows), 1)
        self.assertEqual(rows[0]["samples_ms"], [0.002, 0.004])
        self.assertEqual(rows[0]["counters"], {"error": 3e-9})

    def test_rows_stand_in_the_programs_order_however_they_ran(self):
        def run(name, family, instance=0):
            return {"name": name, "run_name": name, "run_type": "iteration", "real_time": 2.0,
                    "cpu_time": 1.0, "time_unit": "ms", "iterations": 1, "family_index": family,
                    "per_family_instance_index": instance}
        ran = [run("d", 2), run("b", 0, 1), run("a", 0), run("c", 1), run("b", 0, 1)]
        rows = results.rows_of("p", {"benchmarks": ran})
        self.assertEqual([r["name"] for r in rows], ["a", "b", "c", "d"])

    def test_of_repetitions_the_least_time_and_the_largest_error_count(self):
        run = {"name": "a", "run_name": "a/iterations:1/manual_time", "run_type": "iteration",
               "real_time": 2.0, "cpu_time": 1.0, "time_unit": "ms", "iterations": 1,
               "solve_ms": 3.0, "error_u": 1e-9, "rank": 6.0}
        again = dict(run, solve_ms=2.0, error_u=1e-10, rank=12.0)
        (made,) = results.rows_of("p", {"benchmarks": [run, again]})
        self.assertEqual(made["name"], "a")
        self.assertEqual(made["counters"], {"solve_ms": 2.0, "error_u": 1e-9, "rank": 12.0})
        bad = results.rows_of("p", {"benchmarks": [dict(run, error_u=float("nan")), again]})
        self.assertNotEqual(bad[0]["counters"]["error_u"], bad[0]["counters"]["error_u"])

    def test_the_front_holds_what_nothing_beats(self):
        self.assertEqual(error_plots.pareto([(3, 1), (1, 5), (2, 6), (4, 2)]), [(1, 5), (3, 1)])

    def test_the_best_peer_is_what_ratios_refer_to(self):
        rows = [torn("cholmod updown", scale=8.0), torn("cholmod updown_solve", scale=4.0),
                torn("cpu factor deferred fp64")]
        ((title, head, lines),) = tables.reconstruction(rows)
        self.assertEqual(title, "board 1944 tetrahedra, 1 connected element")
        self.assertEqual(head[-1], "/ best peer")
        self.assertEqual([round(float(line[-1]), 1) for line in lines], [2.0, 1.0, 0.2])


def timed(name, program="bench_engine", samples=(), **counters):
    return {"program": program, "name": name, "samples_ms": list(samples), "cpu_samples_ms": [],
            "counters": counters}


class Ratios(unittest.TestCase):
    def ratios(self, rows):
        return [{k: v for k, v in r["counters"].items() if "over" in k or k == "share"}
                for r in ratios.add(rows)]

    def test_are_of_the_least_times_of_all_repetitions_whatever_ran_first(self):
        own = timed("sunder_factor_deferred/7776/k1", samples=[5, 4], min_ms=3.0)
        updown = timed("cholmod_updown/7776/k1", samples=[9, 8], min_ms=6.0)
        refactor = timed("cholmod_refactor/7776/k1", samples=[40], min_ms=30.0)
        other_event = timed("cholmod_updown/7776/k10", min_ms=1.0)
        forced = timed("forced_factor_deferred/7776/k1", min_ms=2.0)
        expected = {"over_updown": 0.5, "over_refactor": 0.1, "over_best": 0.5}
        for rows in ([own, updown, refactor, other_event, forced],
                     [forced, other_event, refactor, updown, own]):
            made = self.ratios(rows)
            self.assertEqual(made[rows.index(forced)], {})
            self.assertEqual(made[rows.index(own)], expected)
            self.assertEqual(made[rows.index(other_event)], {"over_updown": 1, "over_best": 1})

    def test_a_ratio_of_an_earlier_run_does_not_stay(self):
        row = timed("sunder_factor_deferred/7776/k1", min_ms=3.0, over_updown=7.0, share=1.0,
                    p99_over_median_ms=9.0)
        self.assertEqual(self.ratios([row]), [{}])

    def test_the_best_is_any_peer_of_the_event(self):
        rows = [torn("cpu factor deferred fp64", scale=2.0), torn("stale-factor PCG", scale=4.0),
                torn("cholmod supernodal refactor", scale=8.0)]
        made = self.ratios(rows)[0]
        self.assertAlmostEqual(made.pop("over_best"), 0.5, 1)
        self.assertAlmostEqual(made.pop("over_refactor"), 0.25, 1)
        self.assertEqual(made, {"last_over_first_ms": 2.0})

    def test_of_a_rows_own_times(self):
        rows = [timed("cascade_factor/1944/640", median_ms=2.0, p99_ms=5.0),
                timed("needs/nothing_tears/1944", "bench_needs", min_ms=2.0, quiet_ms=2.0,
                      predicted_quiet_ms=3.0, predicted_fracture_ms=0.0),
                timed("frame/4", "bench_c_abi", us_c=6.0, us_cpp=5.0),
                timed("board/fp32", "bench_vulkan", min_ms=6.0, reference_ms=2.0)]
        (cascade, needs, through_c, vulkan) = self.ratios(rows)
        self.assertEqual(cascade, {"p99_over_median_ms": 2.5})
        self.assertEqual(needs, {"predicted_quiet_over_measured": 1.5})
        self.assertAlmostEqual(through_c["share"], 0.2)
        self.assertEqual(vulkan, {"over_reference": 3.0})

    def test_repetitions_leave_the_least_of_each_time(self):
        run = {"name": "a", "run_name": "a", "run_type": "iteration", "real_time": 2.0,
               "cpu_time": 1.0, "time_unit": "ms", "iterations": 1, "us_c": 3.0, "p99_us": 4.0,
               "at_50_ms": 2.0, "columns": 5.0}
        again = dict(run, us_c=4.0, p99_us=3.0, at_50_ms=3.0, columns=6.0)
        (made,) = results.rows_of("p", {"benchmarks": [run, again]})
        self.assertEqual(made["counters"], {"us_c": 3, "p99_us": 3, "at_50_ms": 2, "columns": 6})


def engine_event(tets, k, ms, updown_solve, refactor):
    return [timed(f"{name}/{tets}/k{k}", samples=[value], min_ms=value) for name, value in
            (("sunder_factor_deferred", ms), ("sunder_inverse_deferred", ms),
             ("cholmod_updown_solve", updown_solve), ("cholmod_refactor", refactor))]


class Targets(unittest.TestCase):
    def of(self, rows, words):
        (found,) = [t for t in targets.targets(outcome(ratios.add(rows))) if words in t[0]]
        return found[1:4]

    def test_on_the_factor_the_best_library_counts(self):
        rows = [r for k, updown_solve in ((1, 4.0), (10, 9.0), (100, 90.0))
                for r in engine_event(7776, k, 2.0, updown_solve, 10.0)]
        self.assertEqual(self.of(rows, "on the factor"),
                         ("0.5 / 0.25 / 0.125", "0.5 / 0.222 / 0.2", "100"))
        self.assertEqual(self.of(rows, "dense inverse"), ("0.1", "0.5 / 0.22", "1, 10"))

    def test_nothing_is_said_of_what_lacks_a_row(self):
        rows = engine_event(7776, 1, 2.0, 4.0, 10.0)
        self.assertEqual(targets.targets(outcome(ratios.add(rows))), [])

    def test_the_slower_deferred_route_is_compared_with_a_refactorisation(self):
        rows = [torn("cpu inverse deferred fp64", "k100", 3.0), torn("cpu cg fp64", "k100", 9.0),
                torn("cpu factor deferred fp64", "k100", 1.0),
                torn("cholmod supernodal refactor", "k100", 2.0)]
        aim, figure, missed = self.of(rows, "refactorisation")
        self.assertEqual((aim, missed), ("1", "board 1944"))
        self.assertAlmostEqual(float(figure), 1.5, 1)

    def test_cascades_and_instruments(self):
        cascade = timed("cascade_inverse/1944/640", samples=[9.0], first_ms=1.0, last_ms=4.0,
                        median_ms=2.0, p99_ms=4.001)
        patch = timed("needs/patch_cascade_condensed/1944", "bench_needs", samples=[2.0],
                      median_ms=2.0, p99_ms=3.0)
        haptic = timed("instrument_forces/1944", samples=[1.0], p99_us=60.0, median_us=2.0)
        rows = [cascade, patch, haptic]
        self.assertEqual(self.of(rows, "last frames"), ("2", "4", "inverse 1,944"))
        # A miss that rounds to its aim is still seen.
        self.assertEqual(self.of(rows, "one by one: 99th"), ("2", "2.001", "inverse 1,944"))
        self.assertEqual(self.of(rows, "patch"), ("2", "1.5", ""))
        self.assertEqual(self.of(rows, "instruments"), ("50 us", "60 us", "1,944"))


class Accuracy(unittest.TestCase):
    def judged(self, *words, **what):
        return cell(*words, **what)["accuracy"]

    def test_in_double_precision_each_pattern_has_its_error(self):
        for pattern, error in (("scattered", 1e-9), ("crack", 1e-8), ("bridge", 1e-8),
                               ("cut", 1e-5), ("island", 1e-5)):
            for method in ("cpu factor deferred fp64", "vulkan inverse eager fp64"):
                self.assertEqual(self.judged(method, "ok", error, pattern=pattern), "within")
                self.assertEqual(self.judged(method, "ok", 1.1 * error, pattern=pattern), "beyond")
                self.assertEqual(self.judged(method, pattern=pattern, u_error=1.1 * error),
                                 "beyond")

    def test_in_single_precision_rounding_counts_at_the_ends_of_what_is_named(self):
        deferred = "vulkan inverse deferred fp32"
        self.assertEqual(self.judged(deferred, "ok", 1e-4), "within")
        self.assertEqual(self.judged(deferred, "rounded", 3e-4), "beyond")
        self.assertEqual(self.judged(deferred, "rounded", 3e-4, contrast=1e4), "within")
        self.assertEqual(self.judged(deferred, "rounded", 3e-4, nu=0.499), "within")
        self.assertEqual(self.judged(deferred, "WRONG", 5e-4, nu=0.499), "beyond")

    def test_what_the_table_does_not_name_is_not_judged(self):
        for what in ({"contrast": 1e5}, {"nu": 0.4999}, {"sliver": 1e-3}, {"alpha": 1e-10},
                     {"fractures": 640.0}):
            self.assertEqual(self.judged(stress_error=0.3, **what), "not named")
        self.assertEqual(self.judged(pattern="scattered", fractures=640.0), "within")

    def test_ways_that_are_offered_no_more_are_not_judged(self):
        for method in ("vulkan inverse eager fp32", "cpu condensed eager fp64"):
            self.assertEqual(self.judged(method, "WRONG", 9e-4), "not named")

    def test_a_refusal_of_what_is_named_is_beyond(self):
        refused = cell("cpu cg fp64", "refused", float("nan"), reason="no room")
        self.assertEqual((refused["accuracy"], refused["accuracy_reason"]),
                         ("beyond", "refused: no room"))

    def test_a_cell_beyond_says_why(self):
        single = cell("vulkan cg fp32", "rounded", 0.02, fp32_rounding=1.4)
        self.assertIn("rounding the exact u to fp32 alone costs 1.4", single["accuracy_reason"])
        seen = cell(stress_error=2e-8, estimate=3e-8)
        self.assertIn("check saw 3e-08, within its tolerance of 0.0001", seen["accuracy_reason"])
        self.assertIn("check saw 1e-12", cell(stress_error=2e-8)["accuracy_reason"])
        self.assertEqual(cell(stress_error=float("nan"))["accuracy_reason"], "no number")
        self.assertEqual(cell()["accuracy_reason"], "")

    def test_the_page_counts_them_and_lists_what_is_beyond(self):
        cells = [cell(), cell(contrast=1e6), cell("cpu cg fp64", stress_error=2e-8)]
        made = outcome([torn("cholmod updown_solve")], cells)
        text = page.page(made)[0]
        self.assertIn("Beyond it, 1 cells", text)
        self.assertIn(html.escape(cells[2]["accuracy_reason"]), text)
        self.assertIn("No cell is beyond it", page.page(outcome([], cells[:2]))[0])
        self.assertIn(("1 / 1 / 1"), [f[1] for f in headline.figures(made)])
        (aim,) = [t for t in targets.targets(made) if "of 2 that it names" in t[0]]
        self.assertEqual(aim[2:4], ("1", "the cells listed on the page"))

    def test_a_cell_that_leaves_it_is_a_finding_of_a_comparison(self):
        old, new = cell(stress_error=9e-9), cell(stress_error=1.1e-8)
        self.assertEqual(kinds(outcome([], [old]), outcome([], [new])), ["wrong"])

    def test_events_of_other_sizes_are_other_cells(self):
        cells = [cell(study="batch", batch=n) for n in (1.0, 10.0, 100.0)]
        self.assertEqual(kinds(outcome([], cells[:1]), outcome([], cells)), ["new", "new"])
        self.assertIn("elements an event", heat_map.singles(cells))

    def test_cells_of_pooled_volume_have_a_table_of_their_own(self):
        pooled = cell("cpu cg fp64", volume="pooled", study="pooled cut", contrast=1.0, nu=0.0)
        self.assertEqual(pooled["accuracy"], "not named")
        by_itself = page.page(outcome([], [cell(), cell(nu=0.49)]))[0]
        self.assertNotIn("Pooled volume", by_itself)
        text, figures = page.page(outcome([], [cell(), cell(nu=0.49), pooled]))
        self.assertIn("Pooled volume", text)
        self.assertNotIn("pooled cut", figures["stability"])

    def test_cells_of_before_there_was_a_choice_tore_by_ten(self):
        old = {k: v for k, v in cell().items() if k != "batch"}
        self.assertEqual(results.cells_of(results.table_csv([old]))[0]["batch"], 10)


class Checks(unittest.TestCase):
    def bad(self, **parts):
        return checks.problems(dict(every_part(), **parts))

    def test_a_good_run_has_no_problem(self):
        self.assertEqual(self.bad(), [])

    def test_wrong_cells_failures_and_numbers_that_are_none_are_problems(self):
        nan = float("nan")
        peer = torn("cholmod updown_solve")
        lost = dict(torn("cpu cg fp64"), samples_ms=[], failure="not definite")
        told = dict(lost, failure="refused: backend cpu offers no such route")
        off = dict(torn("cpu cg fp64"), program="bench_reconstruction")
        off["counters"]["error_stress"] = 1e-3
        no_number = torn("cpu cg fp64")
        no_number["counters"]["error_u"] = nan
        for text, parts in (("WRONG", {"cells": [cell(verdict="WRONG", stress_error=0.3)]}),
                            ("is nan", {"cells": [cell(stress_error=nan)]}),
                            ("not definite", {"rows": [peer, lost]}),
                            ("promised 0.0001", {"rows": [peer, off]}),
                            ("error_u is nan", {"rows": [peer, no_number]}),
                            ("no row of this run", {"rows": [torn("cpu cg fp64")]}),
                            ("no peers", {"peers": {}}),
                            ("not built", {"failures": ["bench_engine is not built"]})):
            (found,) = self.bad(**parts)
            self.assertIn(text, found)
        self.assertEqual(self.bad(rows=[peer, told]), [])


    def test_a_random_hand_leaves_numbers_and_neo_hookean_inverts_nothing(self):
        def hand(law, **counters):
            made = dict(row(f"motion_hand/{law}/iterations:1/manual_time"), program="bench_motion")
            return dict(made, counters=dict({"nan": 0.0, "inverted": 0.0}, **counters))
        good = every_part()["rows"]
        self.assertEqual(self.bad(rows=good + [hand("neo-hookean"), hand("corotated", inverted=9.0)]), [])
        for text, bad in (("nan in 1 steps", hand("corotated", nan=1.0)),
                          ("inverted in 3 steps", hand("neo-hookean", inverted=3.0))):
            (found,) = self.bad(rows=good + [bad])
            self.assertIn(text, found)

    def test_a_full_run_has_motion_in_short_steps_and_of_large_bodies(self):
        rows = [s.rows for p, s in programs.planned("full") if p.name == "bench_motion"]
        for name in ("motion/30246/dt 200/sunder", "motion/1944/dt 1000/newton cholmod/1e-04",
                     "motion_rest/1944", "motion_hand/neo-hookean"):
            self.assertEqual(sum(bool(re.search(r, name)) for r in rows), 1, name)


class FiniteDeformation(unittest.TestCase):
    def test_shares_are_of_the_median_by_the_clock_and_in_processor_time(self):
        rows = [finite("sunder", ms=2.0, cpu_ms=3.0), finite("newton cholmod", ms=8.0, cpu_ms=6.0),
                finite("projective lbfgs", ms=10.0, cpu_ms=5.0),
                finite("newton cholmod", tets=7776, ms=1.0)]
        own, best, *_ = [r["counters"] for r in ratios.add(rows)]
        self.assertEqual((own["over_best"], own["over_best_cpu"]), (0.25, 0.6))
        self.assertEqual(best["over_best"], 1)

    def test_a_peer_that_finds_no_end_is_shown_and_is_no_fault(self):
        lost = dict(finite("newton pcg jacobi"), samples_ms=[], failure="not in 50 iterations")
        lost["counters"] = {"missed": 2.0, "steps": 2.0}
        ours = dict(lost, name=finite("sunder")["name"])
        self.assertEqual(checks._row_problems(lost), [])
        self.assertEqual(len(checks._row_problems(ours)), 1)
        ((_, head, lines),) = tables.finite([finite("sunder"), lost])
        self.assertEqual([len(line) for line in lines], [len(head)] * 2)
        self.assertEqual((lines[1][1], lines[1][-1]), ("not in 50 iterations", "frames 2 of 2"))
        self.assertIn("sunder", plots.finite([finite("sunder"), lost]))

    def test_aims(self):
        rows = ratios.add([finite("sunder", ms=2.0), finite("newton cholmod", ms=8.0),
                           finite("sunder promise", ms=1.0), finite("sunder promise", "event"),
                           finite("sunder promise", tets=7776, ms=99.0)])
        said = {t[0]: t[1:4] for t in targets.targets(outcome(rows))}
        promise, median, worst, share = said.values()
        self.assertEqual(promise, ("0.6 / 1.5 ms", "1 / 1 ms", "1,944 frame"))
        self.assertEqual(median, ("8", "6 / 6", ""))
        self.assertEqual(worst, ("16", "20 / 20", "1,944 frame, 1,944 event"))
        self.assertEqual(share, ("0.2", "0.25", "1,944 frame"))

    def test_a_wrong_step_is_a_problem_and_one_that_is_refused_says_why(self):
        steps = [finite_step(), finite_step("refused", "no equilibrium"), finite_step("WRONG")]
        (found,) = checks.problems(dict(every_part(), steps=steps))
        self.assertIn("twist 90: WRONG", found)
        self.assertEqual(tables.finite_verdicts(steps)[1],
                         [["nu", "twist", "corotated", 1, 0, 0, 1, 0, 1, "1.0e-05"]])
        self.assertIn("no equilibrium", page.page(dict(outcome([]), steps=steps))[0])
        read = results.steps_of(results.table_csv(steps))
        self.assertEqual(read, steps)


    def test_fractures_are_counted_and_a_wrong_one_is_a_problem(self):
        def fracture(verdict, stress_error):
            return {"part": "state", "law": "corotated", "how": "batches", "verdict": verdict,
                    "degrees": 30.0, "newtons": 42.0, "gone": 10.0, "u_error": 1e-10,
                    "stress_error": stress_error, "back_solves": 29.0, "factors": 1.0}
        rows = [fracture("right", 2e-10), fracture("WRONG", 0.5)]
        (found,) = checks.problems(dict(every_part(), fractures=rows))
        self.assertIn("30 degrees, 10 gone: WRONG", found)
        self.assertEqual(tables.fracture_verdicts(rows)[1],
                         [["state", "corotated", "30", "42", "10", 1, 0, 0, 1, "1.0e-10",
                           "2.0e-10"]])
        self.assertIn("Fractures at finite deformation",
                      page.page(dict(outcome([]), fractures=rows))[0])
        self.assertEqual(results.fractures_of(results.table_csv(rows)), rows)


class FreshMachine(unittest.TestCase):
    """A machine without the peers' packages: programs that stand for its own come first in PATH and
    write down how they were called."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sunder-fresh-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.calls = self.folder / "calls"
        self.stand_in("dpkg-query", "case \"$*\" in *suitesparse* | *openblas-dev*) exit 1 ;; esac\n"
                                    "echo install ok installed")
        self.stand_in("sudo", '"$@"')
        self.stand_in("apt-get", "exit 0")

    def stand_in(self, name, body):
        path = self.folder / "bin" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'#!/bin/bash\necho "{name} $*" >> {self.calls}\n{body}\n')
        path.chmod(0o755)

    def bench_run(self, *words):
        path = f"{self.folder / 'bin'}:{os.environ['PATH']}"
        done = subprocess.run([BENCH / "run", "--build", self.folder / "build", "--out",
                               self.folder / "out", *words], env=dict(os.environ, PATH=path),
                              capture_output=True, text=True, timeout=60)
        calls = self.calls.read_text().splitlines() if self.calls.exists() else []
        return done, [c for c in calls if not c.startswith(("dpkg-query", "sudo"))]

    def test_what_is_missing_is_installed_before_anything_is_built(self):
        self.stand_in("cmake", "echo 'CHOLMOD is missing' >&2; exit 1")
        done, calls = self.bench_run()
        self.assertEqual(done.returncode, 3)
        self.assertEqual(calls[0], "apt-get update -qq")
        self.assertEqual(calls[1].split()[-2:], ["libsuitesparse-dev", "libopenblas-dev"])
        self.assertTrue(calls[2].startswith("cmake -S"), calls)
        self.assertIn("-DSUNDER_BENCH_PEERS=ON", calls[2])
        # The configuration said no: nothing is built, nothing measured.
        self.assertEqual(len(calls), 3)
        self.assertIn("CHOLMOD is missing", done.stderr)
        self.assertFalse((self.folder / "out" / "index.html").exists())

    def test_what_cannot_be_installed_ends_it_at_the_start(self):
        self.stand_in("apt-get", "exit 100")
        self.stand_in("cmake", "exit 0")
        done, calls = self.bench_run()
        self.assertEqual((done.returncode, calls), (3, ["apt-get update -qq"]))
        self.assertIn("the peers cannot be measured", done.stderr)

    def test_a_program_that_is_not_built_ends_it_before_the_first_measurement(self):
        self.stand_in("cmake", "exit 0")  # builds nothing
        done, _ = self.bench_run()
        self.assertEqual(done.returncode, 3)
        self.assertIn("bench_reconstruction", done.stderr)
        self.assertIn("nothing is measured", done.stderr)
        self.assertEqual(list((self.folder / "out").iterdir()), [])

    def test_the_plan_and_a_page_drawn_again_install_nothing(self):
        done, calls = self.bench_run("--plan")
        self.assertEqual((done.returncode, calls), (0, []))
        done, calls = self.bench_run("--draw", str(self.folder / "nothing"))
        self.assertEqual((done.returncode, calls), (3, []))

    def configured(self, *words):
        done = subprocess.run(["cmake", "-DCMAKE_SYSTEM_PREFIX_PATH=/nowhere",
                               "-DCMAKE_DISABLE_FIND_PACKAGE_benchmark=ON", *words, "-P",
                               BENCH / "peers.cmake"], capture_output=True, text=True, timeout=60)
        return done.returncode, " ".join(done.stderr.split())

    def test_the_configuration_names_what_is_missing_and_what_to_do(self):
        code, said = self.configured("-DSUNDER_BENCH_PEERS=ON")
        self.assertNotEqual(code, 0)
        for words in ("CHOLMOD (libsuitesparse-dev), OpenBLAS (libopenblas-dev)",
                      "Google Benchmark (libbenchmark-dev)", "scripts/install-packages bench",
                      "-DSUNDER_BENCH_PEERS=OFF"):
            self.assertIn(words, said)
        code, said = self.configured("-DSUNDER_BENCH_PEERS=OFF")
        self.assertNotEqual(code, 0)
        self.assertIn("missing here: Google Benchmark (libbenchmark-dev).", said)

    def test_every_library_that_a_bench_program_links_is_installed(self):
        done = subprocess.run(["bash", "-c", f"dpkg-query() {{ false; }}; apt-get() {{ :; }}; "
                               f"sudo() {{ :; }}; env() {{ :; }}; . {BENCH.parent}/scripts/install-packages"
                               " bench"], capture_output=True, text=True, timeout=60)
        names = done.stdout.removeprefix("installing: ").split()
        for name in ("g++", "cmake", "ninja-build", "libbenchmark-dev", "libsuitesparse-dev",
                     "libopenblas-dev", "python3-numpy", "python3-matplotlib"):
            self.assertIn(name, names)


class BestPeer(unittest.TestCase):
    def figure(self, rows):
        (found,) = [f for f in headline.figures(outcome(rows)) if f[0].startswith("frame after")]
        return found

    def test_the_table_names_the_best_peer_of_each_event_whichever_it_is(self):
        own = [("cpu factor deferred fp64", 1.0, 2.0, 6.2), ("cpu inverse deferred fp64", 2, 1, 9)]
        peers = [("cholmod updown_solve", 4.0, 2.5, 10.7), ("cholmod updown", 5.0, 2.0, 11.0),
                 ("eigen SimplicialLDLT refactor", 4.1, 4.2, 4.3)]
        rows = [torn(method, event, ms) for method, *times in own + peers
                for event, ms in zip(("k1", "k10", "k100"), times)]
        what, figure, _ = self.figure(rows)
        self.assertIn("share of the best peer", what)
        self.assertEqual([part.split(" of ")[1] for part in figure.split(" / ")],
                         ["cholmod updown_solve", "cholmod updown",
                          "eigen SimplicialLDLT refactor"])
        # Against CHOLMOD's update alone the last would read as a win: 6.2 / 10.7 = .58.
        for part, expected in zip(figure.split(" / "), (0.25, 0.5, 1.44)):
            self.assertAlmostEqual(float(part.split(" of ")[0]), expected, delta=0.05)

    def test_without_a_peer_after_an_event_there_is_no_figure(self):
        rows = [torn("cpu factor deferred fp64"), torn("cholmod updown_solve")]
        self.assertEqual([f for f in headline.figures(outcome(rows))
                          if f[0].startswith("frame after")], [])


class Modes(unittest.TestCase):
    def test_every_mode_runs_every_program(self):
        self.assertEqual({p.name for p, _ in programs.planned("quick")},
                         {p.name for p, _ in programs.planned("full")})

    def test_some_programs_alone_are_no_run_without_peers(self):
        self.assertEqual([p.name for p, _ in programs.planned("full", ["bench_finite"])],
                         ["bench_finite", "bench_finite"])
        part = outcome([row("a")])
        part["machine"]["only"] = ["bench_finite"]
        part["peers"] = {}
        self.assertEqual(checks.problems(part), [])

    def test_quick_is_planned_under_five_minutes(self):
        self.assertLess(sum(s.seconds for _, s in programs.planned("quick")), 300)

    def test_a_program_that_is_not_built_is_a_failure(self):
        with tempfile.TemporaryDirectory() as folder:
            made = programs.run_all(folder, "quick")
        self.assertIn("bench_engine is not built", made["failures"])

    def test_two_run_at_once_and_their_results_stand_in_the_programs_order(self):
        meet = """#!/bin/sh
touch $(dirname $0)/here-%s
n=0
until [ -e $(dirname $0)/here-%s ]; do n=$((n+1)); [ $n -gt 200 ] && exit 3; sleep 0.05; done
"""
        with tempfile.TemporaryDirectory() as folder:
            bench = pathlib.Path(folder) / "bench"
            bench.mkdir()
            for name, other, more in (
                    ("bench_stability", "bench_convergence", "sleep 0.3; exit 4\n"),
                    ("bench_convergence", "bench_stability",
                     "echo case,method,tets,value,error,ms > $1; echo Cook,cpu,500,23,0.01,7 >> $1\n")):
                (bench / name).write_text(meet % (name, other) + more)
                (bench / name).chmod(0o755)
            made = programs.run_all(folder, "quick", jobs=2)
        self.assertIn("bench_stability ended with 4: ", made["failures"])  # 3: it has met nobody
        self.assertEqual([(p["name"], p.get("failed", False)) for p in made["programs"]],
                         [("bench_stability", True), ("bench_convergence", False)])
        self.assertEqual(len(made["meshes"]), 1)

    def test_a_run_that_was_ended_goes_on_where_it_was(self):
        saved = []
        with tempfile.TemporaryDirectory() as folder:
            bench = pathlib.Path(folder) / "bench"
            bench.mkdir()
            study, broken = bench / "bench_convergence", bench / "bench_stability"
            study.write_text("#!/bin/sh\necho case,method,tets,value,error,ms > $1\n"
                             "echo Cook,cpu,500,23,0.01,7 >> $1\n")
            broken.write_text("#!/bin/sh\nexit 3\n")
            for program in (study, broken):
                program.chmod(0o755)
            first = programs.run_all(folder, "quick",
                                     save=lambda done: saved.append(len(done["programs"])))
            self.assertEqual([(p["name"], p.get("failed", False)) for p in first["programs"]],
                             [("bench_stability", True), ("bench_convergence", False)])
            study.write_text("#!/bin/sh\nexit 4\n")  # not run again
            text = results.table_csv([cell()])
            broken.write_text(f"#!/bin/sh\ncat > $1 <<END\n{text}END\n")
            again = programs.run_all(folder, "quick", outcome=first)
        self.assertEqual(saved, [1, 2])
        self.assertEqual(len(again["meshes"]), 1)
        self.assertEqual([c["verdict"] for c in again["cells"]], ["ok"])
        self.assertFalse(any("bench_stability ended" in f for f in again["failures"]))


# Stands in for bench_reconstruction: 10 ms together, alone 11, but 20 for the peer called "slow".
FAKE_SUITE = """#!/usr/bin/python3
import json, pathlib, re, sys
words = dict(w.split("=", 1) for w in sys.argv if "=" in w)
if words:
    body, event, names = re.fullmatch(r"(.*)/(k\\d+)/(.*)/", words["--benchmark_filter"]).groups()
    def ms(name):
        return 10 if names.startswith("(") else 20 if name == "slow" else 11
    runs = [{"run_name": f"reconstruction/{body}/{event}/{name}/iterations:1", "time_unit": "ms",
             "real_time": ms(name), "cpu_time": 1, "update_ms": 6, "solve_ms": 2}
            for name in names.strip("()").split("|")]
    pathlib.Path(words["--benchmark_out"]).write_text(json.dumps({"benchmarks": runs}))
"""


class PeersAlone(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.build = pathlib.Path(self.folder.name)
        (self.build / "bench").mkdir()
        for name, text in (("bench_reconstruction", FAKE_SUITE),
                           ("bench_peers_alone", "#!/bin/sh\nprintf 'fine\\t8.5\\t9\\n'\n")):
            program = self.build / "bench" / name
            program.write_text(text)
            program.chmod(0o755)

    def test_one_that_is_slower_alone_is_found(self):
        made = alone.measure(self.build, "board 486", "k1", ["fine", "slow"], 3)
        self.assertEqual([(e["method"], e["how"][:7], e["ratio"], e["within"]) for e in made],
                         [("fine", "a proce", "1.1", "yes"), ("fine", "without", "1.062", "yes"),
                          ("slow", "a proce", "2", "no")])

    def test_a_wide_interval_tells_nothing(self):
        verdicts = [alone._verdict(*r) for r in ((1.2, 0.5, 9), (1.6, 1.3, 1.9), (1.4, 1.2, 1.8),
                                                 (1.4, 0.8, 2.5), (0.5, 0.4, 0.7))]
        self.assertEqual(verdicts, ["yes", "no", "yes", "too noisy", "no"])

    def test_the_command_keeps_and_shows_them(self):
        made = outcome([torn("fine", body="board 486"), torn("slow", body="board 486")])
        results.write(self.build / "results", made)
        done = subprocess.run([BENCH / "peers-alone", self.build / "results", "--build", self.build,
                               "--turns", "3"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (1, ""))
        self.assertEqual(len(results.read(self.build / "results")["alone"]), 3)
        shown = (self.build / "results" / "index.html").read_text(encoding="utf-8")
        self.assertIn("2 of 3 agree within 25 % or their own noise, 1 do not", shown)


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text, cls.figures = page.page(every_part())

    def test_shows_every_figure_and_needs_no_network(self):
        text, figures = self.text, self.figures
        self.assertEqual(set(figures), {"reconstruction", "accumulated", "inversion", "error-board",
                                        "error-scenes", "mesh-size", "stability",
                                        "stability-pairs", "scaling", "finite",
                                        "finite-error"})
        self.assertEqual(text.count("<svg"), len(figures))
        self.assertIn("&lt;test&gt;", text)
        for tag in ("<script src", "<link", "<img src=\"http"):
            self.assertNotIn(tag, text)

    def test_says_what_is_not_good(self):
        made = outcome([torn("cholmod updown_solve")], [cell(verdict="WRONG", stress_error=0.3)])
        self.assertIn("Not good in this run", page.page(made)[0])
        self.assertNotIn("Not good in this run", self.text)

    def test_draws_the_scenes_that_ran(self):
        text = ("scene,method,tolerance,frame_ms,u_error,stress_error,fractures,verdict,reason\n"
                "notch-b,cpu cg fp64,1e-4,2.5,1e-9,1e-8,51,ok,\n"
                "notch-b,vulkan cg fp64,1e-4,900,,,3,over budget,\n"
                'notch-b,cpu condensed deferred fp64,1e-4,,,,,refused,"not offered, choose"\n')
        points = results.points_of(text)
        self.assertIsNone(points[2]["frame_ms"])
        self.assertIn("notch-b", error_plots.scenes(points))
        self.assertIsNone(error_plots.scenes(points[1:]))
        self.assertEqual(tables.scene_verdicts(points)[1][1], ["vulkan cg fp64", 0, 0, 0, 0, 1, 0, 0])

    def test_marks_verdicts_in_the_heat_map(self):
        self.assertIn("WRONG", heat_map.singles([cell()]))
        self.assertIsNone(heat_map.pairs([cell()]))
        self.assertEqual([heat_map.text_of(v) for v in (1e6, 0.49999, 10)],
                         ["$10^{6}$", "0.49999", "10"])

    def test_is_the_same_twice(self):
        self.assertEqual(page.page(every_part())[0], self.text)

    def test_every_figure_of_the_readme_is_on_the_page(self):
        made = every_part()
        self.assertGreater(len(headline.figures(made)), 1)
        for _, figure, _ in headline.figures(made):
            self.assertIn(figure, self.text)
            self.assertIn(figure, headline.markdown(made, "folder"))
        self.assertIn("at most", self.text)


class Figures(unittest.TestCase):
    def test_its_figures_are_those_of_the_folder_it_names_and_stand_on_its_page(self):
        root = BENCH.parent
        text = (root / "docs/figures.md").read_text(encoding="utf-8")
        folder = text.split(headline.BEGIN)[1].split(" -->")[0]
        made = results.read(root / folder)
        self.assertIn(headline.markdown(made, folder), text)
        shown = (root / folder / "index.html").read_text(encoding="utf-8")
        for _, figure, _ in headline.figures(made):
            self.assertIn(html.escape(figure), shown)
        self.assertGreater(len(targets.targets(made)), 9)
        for entry in targets.targets(made):
            self.assertIn("".join(f"<td>{html.escape(e or 'none')}</td>" for e in entry), shown)


def parts_row(which, tets, first):
    counters = {key: first + i for i, (key, _) in enumerate(frames.PARTS)}
    return timed(f"frame_parts/{which}/{tets}", frames.PROGRAM, [1.0], columns=9.0, factor_MB=1.7,
                 all_us=0.0, **counters)


class Frames(unittest.TestCase):
    def rows(self):
        stages = [key for key, _ in frames.STAGES] + ["all_us"]
        cascade = {f"{frame}_{key}": 1000.0 * i + j for i, (frame, _) in enumerate(frames.FRAMES)
                   for j, key in enumerate(stages)}
        return [parts_row("factor_first", 1944, 10.0), parts_row("after_640", 119286, 2000.0),
                parts_row("event_10", 1944, 30.0),
                timed("frame_cascade/condensed/1944", frames.PROGRAM, [1.0], **cascade),
                timed("stress_plain/1944", "bench_engine", [1.0])]

    def test_a_table_for_each_kind_of_frame_with_parts_that_add_up(self):
        first, later, events, cascade = frames.tables(self.rows())
        self.assertEqual(first[1], ["part", "factor: 1,944"])
        by_part = dict(first[2])
        self.assertEqual(by_part["all"], str(sum(range(10, 18))))
        self.assertEqual(dict(later[2])["worst ratios"], "2,007")
        self.assertEqual(events[1], ["part", "10: 1,944"])
        self.assertEqual([line[0] for line in cascade[2]],
                         [f"condensed 1,944, {w}" for w in ("first 5", "median",
                                                            "slowest hundredth", "last 100")])
        self.assertEqual(cascade[2][2], ["condensed 1,944, slowest hundredth", "2,005", "2,000",
                                         "2,001", "2,002", "2,003", "2,004"])
        self.assertEqual(frames.tables(self.rows()[:1])[0], first)

    def test_the_measures_of_deformation_have_a_table_beside_the_stress_pass(self):
        rows = [timed("measures/sheared/7776", frames.PROGRAM, [1.0], pass_us=90.0, bounds_us=1.0,
                      search_us=17.0, share=0.2)]
        (_, _, body), = frames.tables(rows)
        self.assertEqual(body, [["sheared 7,776", "90.0", "1.0", "17.0", "20 %"]])

    def test_the_document_has_the_marks_and_names_the_command(self):
        text = (BENCH.parent / "docs" / "frames.md").read_text(encoding="utf-8")
        self.assertEqual((text.count(frames.BEGIN), text.count(frames.END)), (1, 1))
        self.assertIn("bench/frames --build DIR --write", text)

    def test_a_section_is_renewed_between_its_marks(self):
        about = {"cpu": "<test>", "cores": 2, "date": "today", "commit": "0", "load_before": 0.1}
        text = frames.markdown(self.rows(), about)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "frames.md")
            file.write_text(f"before\n{frames.BEGIN}\nold\n{frames.END}\nafter\n")
            results.renew_section(file, text, frames.BEGIN, frames.END)
            self.assertEqual(file.read_text(), f"before\n{text}\nafter\n")
            file.write_text("no marks")
            with self.assertRaises(ValueError):
                results.renew_section(file, text, frames.BEGIN, frames.END)

    def test_the_command_takes_rows_from_a_folder_or_says_that_there_are_none(self):
        with tempfile.TemporaryDirectory() as folder:
            for rows, code in ((self.rows(), 0), ([row("a")], 3)):
                results.write(folder, outcome(rows))
                done = subprocess.run([BENCH / "frames", "--results", folder], text=True,
                                      capture_output=True)
                self.assertEqual(done.returncode, code)
                self.assertIn(*(("factor: 1,944", done.stdout) if code == 0 else
                                ("no row of bench_frame_parts", done.stderr)))
            self.assertEqual(subprocess.run([BENCH / "frames"], capture_output=True).returncode, 2)


class Program(unittest.TestCase):
    def run_compare(self, *folders):
        return subprocess.run([str(BENCH / "compare"), *folders], capture_output=True, text=True)

    def test_exit_codes(self):
        with tempfile.TemporaryDirectory() as folder:
            old, slow = pathlib.Path(folder, "old"), pathlib.Path(folder, "slow")
            results.write(old, outcome([row("a")], [cell()]))
            results.write(slow, outcome([row("a", scale=1.2)], [cell()]))
            self.assertEqual(self.run_compare(old, old).returncode, 0)
            done = self.run_compare(old, slow)
            self.assertEqual(done.returncode, 1)
            self.assertIn("slower    a: time x 1.2", done.stdout)

    def test_a_folder_that_is_none_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "results.json").write_text(json.dumps([1]))
            for bad in (folder, folder + "/nowhere"):
                done = self.run_compare(bad, bad)
                self.assertEqual(done.returncode, 3)
                self.assertIn("results.json", done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
