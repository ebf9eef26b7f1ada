# SPDX-License-Identifier: Apache-2.0
"""What bench/signals takes for a fault, reads from a run's log and watches a run by."""
import dataclasses
import json
import pathlib
import sys
import tempfile
import types
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path.insert(0, str(BENCH))
from suite import signals  # noqa: E402

QUIET = signals.Moment("quiet", signals.start, signals.start, results=True)
COMPLETE = signals.Moment("last", signals.start, signals.start, results=True, complete=True)
AGAIN = signals.Moment("again", signals.start, signals.start, results=True, again=True)
IMPORT = signals.Moment("import", signals.start, signals.start)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def ended_run(self, code=130, text=""):
        """A run that is over, with its result folder and its log."""
        out = self.folder / "out"
        out.mkdir(exist_ok=True)
        log = self.folder / "stderr.txt"
        log.write_text(text)
        return types.SimpleNamespace(out=out, log=log,
                                     process=types.SimpleNamespace(returncode=code))

    def results(self, run, steps=2, rows=2, interrupted=True):
        (run.out / "frames.csv").write_text("step\n" + "0\n" * rows)
        (run.out / "summary.json").write_text(
            json.dumps({"steps_done": steps, "interrupted": interrupted}))

    def live_run(self, *command):
        """One that is still there; killed with the test."""
        out = self.folder / "live"
        out.mkdir()
        run = signals.Run(command, out, self.folder / "live.txt")
        self.addCleanup(run.kill)
        return run


class Faults(Folder):
    def test_whole_results_are_none(self):
        run = self.ended_run()
        self.results(run)
        self.assertEqual(signals.faults(run, QUIET), [])
        self.results(run, interrupted=False)
        self.assertEqual(signals.faults(run, COMPLETE), [])

    def test_another_exit_code_comes_with_its_words(self):
        run = self.ended_run(code=-11, text="a crash\n")
        self.results(run)
        self.assertEqual(signals.faults(run, QUIET), ["exit code -11: a crash"])

    def test_half_written_files(self):
        run = self.ended_run()
        self.results(run)
        for name in ("result.vtu.7.partial", ".sunder-lock"):
            (run.out / name).write_text("")
        self.assertEqual(signals.faults(run, QUIET), ["left .sunder-lock, result.vtu.7.partial"])

    def test_results_that_are_not_whole(self):
        run = self.ended_run()
        self.assertEqual(signals.faults(run, QUIET), ["no whole results"])
        self.results(run, steps=3)
        self.assertEqual(signals.faults(run, QUIET), ["2 rows in frames.csv of 3 steps"])
        self.results(run, interrupted=False)
        self.assertEqual(signals.faults(run, QUIET), ["interrupted is False in summary.json"])
        self.results(run)
        self.assertEqual(signals.faults(run, COMPLETE), ["interrupted is True in summary.json"])

    def test_a_run_without_results_leaves_nothing(self):
        for moment in (AGAIN, IMPORT):
            run = self.ended_run()
            self.assertEqual(signals.faults(run, moment), [])
            self.results(run)
            self.assertEqual(signals.faults(run, moment), ["left frames.csv, summary.json"])
            for path in run.out.iterdir():
                path.unlink()
        of_a_body = dataclasses.replace(IMPORT, tets=2000)
        self.assertEqual(signals.faults(run, of_a_body), ["left an empty folder"])
        run.out.rmdir()
        for moment in (IMPORT, of_a_body):
            self.assertEqual(signals.faults(run, moment), [])


class Log(unittest.TestCase):
    def test_the_line_of_the_program_is_read(self):
        text = ("sunder: warning: odd\nsunder: stopped 0.42 s after the signal (0.3 s of processor "
                "time); writing results to out, another signal drops them\n")
        self.assertEqual(signals.told(text), (0.42, 0.3))
        self.assertIsNone(signals.told("sunder: interrupted in step 3 of 9\n"))


class Watching(Folder):
    def test_a_moment_that_never_came(self):
        run = self.live_run("sh", "-c", "echo no such mesh >&2")
        with self.assertRaisesRegex(signals.NoMoment, "over before its moment: no such mesh"):
            run.wait_until(signals.file("frames.csv"))

    def test_files_of_the_process(self):
        run = self.live_run("sleep", "60")
        self.assertFalse(signals.PREPARED(run))
        (run.out / f"frames.csv.{run.pid}.partial").write_text("")
        run.wait_until(signals.PREPARED)
        self.assertFalse(run.ended())
        self.assertLess(run.computed(), 5.0)

    def test_the_second_signal_follows_the_first(self):
        lingering = ("import signal, sys, time\n"
                     "came = []\n"
                     "signal.signal(signal.SIGINT, lambda *_: came.append(0))\n"
                     "print('ready', flush=True, file=sys.stderr)\n"
                     "while not came: time.sleep(.001)\n"
                     "time.sleep(1)\n"
                     "sys.exit(130)\n")
        run = self.live_run(sys.executable, "-c", lingering)
        run.wait_until(lambda r: "ready" in r.log.read_text())
        sent, send = [], run.process.send_signal
        run.process.send_signal = lambda number: (sent.append(number), send(number))
        row = signals.Row(AGAIN, 1.0)
        signals.Bench("none", self.folder).interrupt(run, row)
        self.assertEqual(run.process.returncode, 130)
        self.assertEqual(len(sent), 2)
        self.assertEqual(row.signals, 1)
        self.assertGreaterEqual(row.ended, signals.AGAIN)
        # It told no time, so all until its end counts.
        self.assertEqual(row.stopped, row.ended)

    def test_what_computes_over_a_second_is_a_fault(self):
        self.assertEqual(signals.too_late(signals.LIMIT, 0.1), [])
        self.assertEqual(len(signals.too_late(1.21, 0.1)), 1)
        self.assertRegex(signals.too_late(1.21, 0.1)[0],
                         r"^stopped 1\.21 s after it \(0\.10 s of processor\), over 1 s;")
        # What a run took comes to it, whatever that was.
        run = self.live_run(sys.executable, "-c", "import time; time.sleep(60)")
        row = signals.Row(IMPORT, 1.0)
        found = signals.Bench("none", self.folder).interrupt(run, row)
        self.assertEqual(found, signals.too_late(row.stopped, row.computed))


class Table(unittest.TestCase):
    def test_a_line_each_row_between_the_marks(self):
        moment = signals.Moment("frames, cg", signals.start, signals.start, tets=120000)
        row = signals.Row(moment, 4.0, signals=3, stopped=.5, computed=.33, ended=1.56)
        about = {"cpu": "a processor", "cores": 2, "date": "today", "commit": "0", "load_before": 1}
        lines = signals.markdown([row], about).splitlines()
        self.assertEqual((lines[0], lines[-1]), (signals.BEGIN, signals.END))
        self.assertIn("| frames, cg | 120,000 | 4.00 | 3 | 0.50 | 0.33 | 1.56 |", lines)
        self.assertNotIn("WRONG", signals.line(row))
        row.faults.append("left a file")
        self.assertIn("WRONG", signals.line(row))

    def test_every_moment_can_be_started(self):
        names = [(m.name, m.tets) for m in signals.MOMENTS]
        self.assertEqual(len(names), len(set(names)))
        for moment in signals.MOMENTS:
            self.assertIn(moment.format, signals.NAMES)
            scene = signals.SCENE.format(mesh="m", names=signals.NAMES[moment.format],
                                         force=moment.force, steps=moment.steps)
            self.assertEqual(scene.count("young"), 4)
            if not moment.tets:
                self.assertIn(moment.arguments[0], ("mesh", "reproduce"))


if __name__ == "__main__":
    unittest.main()
