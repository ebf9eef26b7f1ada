# SPDX-License-Identifier: Apache-2.0
"""The benchmark suite's own rules: noise, planted slow-downs, planted wrong answers, bad folders."""
import copy
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))
from suite import compare, page, plots, results  # noqa: E402


def row(name, scale=1.0, seed=1, error=1e-12, count=9):
    """A row with 2 % of noise and now and then a descheduled sample."""
    draw = random.Random(seed)
    samples = [scale * (1 + 0.02 * draw.random()) for _ in range(count - 1)] + [scale * 1.8]
    return {"program": "bench_engine", "name": name, "samples_ms": samples,
            "cpu_samples_ms": samples, "counters": {"error": error, "rank": 12.0}}


def cell(method="cpu factor deferred fp64", verdict="ok", stress_error=1e-11):
    return {"study": "crack", "contrast": 100.0, "nu": 0.4, "sliver": 1.0, "alpha": 1e-6,
            "unit": 1.0, "pattern": "crack", "fractures": 10.0, "method": method,
            "verdict": verdict, "u_error": 1e-12, "stress_error": stress_error, "residual": 1e-13,
            "estimate": 1e-12, "iterations": 0.0, "first_ms": 1.0, "median_ms": 0.5,
            "fp32_rounding": 1e-4, "reason": ""}


def outcome(rows, cells=()):
    return {"machine": {"cpu": "<test>"}, "rows": rows, "cells": list(cells)}


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

    def test_the_front_holds_what_nothing_beats(self):
        self.assertEqual(plots.pareto([(3, 1), (1, 5), (2, 6), (4, 2)]), [(1, 5), (3, 1)])


class Page(unittest.TestCase):
    def test_shows_every_figure_and_needs_no_network(self):
        made = outcome([row(n) for n in NAMES], [cell(), cell("cpu cg fp64", "refused")])
        text = page.page(made)
        self.assertEqual(text.count("<svg"), 3)
        self.assertIn("&lt;test&gt;", text)
        for tag in ("<script src", "<link", "<img src=\"http"):
            self.assertNotIn(tag, text)

    def test_draws_the_scenes_that_ran(self):
        text = ("scene,method,tolerance,frame_ms,u_error,stress_error,fractures,verdict,reason\n"
                "notch-b,cpu cg fp64,1e-4,2.5,1e-9,1e-8,51,ok,\n"
                'notch-b,cpu condensed deferred fp64,1e-4,,,,,refused,"not offered, choose"\n')
        points = results.points_of(text)
        self.assertIsNone(points[1]["frame_ms"])
        self.assertIn("notch-b", plots.scenes(points))
        self.assertIsNone(plots.scenes(points[1:]))

    def test_is_the_same_twice(self):
        made = outcome([row(n) for n in NAMES], [cell()])
        self.assertEqual(page.page(made), page.page(made))


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
