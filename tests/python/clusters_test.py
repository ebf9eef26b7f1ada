# SPDX-License-Identifier: Apache-2.0
"""The script for Slurm and the rules for Snakemake of docs/python.md run as they stand there, with fewer
values to vary, and come to the table of one sweep. What Slurm does with a script's head is done here:
a task for each number of the array, with its numbers in the environment. Snakemake is Debian's."""
import csv
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from support import SCENES, SOURCE, program

FEWER = (("1:3:100", "1:3:5"), ("-80:-120:41", "-80:-120:4"))  # 20 runs, by 16 parts
CLOCK = re.compile(r"ms.*|back_solves")


def rows(path):
    """A table's rows without what depends on the clock."""
    with open(path, newline="", encoding="utf-8") as file:
        return [{k: v for k, v in row.items() if not CLOCK.fullmatch(k)} for row in csv.DictReader(file)]


class Clusters(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        scene = (SCENES / "board-pull-a.toml").read_text(encoding="utf-8")
        scene = scene.replace("meshes/", f"{SCENES}/meshes/").replace("steps = 50", "steps = 20")
        (self.work / "scene.toml").write_text(scene, encoding="utf-8")
        path = f"{pathlib.Path(os.environ['SUNDER_PROGRAM']).parent}:{os.environ['PATH']}"
        self.environment = {**os.environ, "PATH": path}

    def documented(self, mark, name):
        """Writes a text of docs/python.md, with fewer values, and returns it."""
        text = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
        text = re.search(rf"<!-- {mark} -->\n```\n(.*?)```", text, flags=re.S)[1]
        for many, few in FEWER:
            self.assertIn(many, text)
            text = text.replace(many, few)
        (self.work / name).write_text(text, encoding="utf-8")
        return text

    def ran(self, *command, **more):
        done = subprocess.run(command, cwd=self.work, env={**self.environment, **more}, capture_output=True,
                              text=True, check=False, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def is_the_table_of_one_sweep(self):
        vary = [word for (_, few), key in zip(FEWER, ("material.upper.yield", "instrument.0.force.1"))
                for word in ("--vary", f"{key}={few}")]
        if not (self.work / "one").exists():
            one = program("sweep", self.work / "scene.toml", *vary, "--quiet", "--out", self.work / "one")
            self.assertEqual(one.returncode, 0, one.stderr)
        expected = rows(self.work / "one/sweep.csv")
        self.assertEqual(len(expected), 20)
        self.assertGreater(len({row["destroyed"] for row in expected}), 1)
        self.assertEqual(rows(self.work / "out/yields/sweep.csv"), expected)

    def test_an_array_of_slurm(self):
        text = self.documented("slurm", "array.sh")
        self.assertTrue(text.startswith("#!/bin/bash\n"), "sbatch takes no other script")
        first, last = map(int, re.search(r"#SBATCH --array=(\d+)-(\d+)\n", text).groups())
        processors = re.search(r"#SBATCH --cpus-per-task=(\d+)\n", text)[1]
        for task in range(first, last + 1):
            self.ran("bash", "array.sh", SLURM_ARRAY_TASK_ID=str(task), SLURM_ARRAY_TASK_COUNT=str(last),
                     SLURM_CPUS_PER_TASK=processors)
        merge, replaced = re.subn(r"--part \S+(.*) --resume", r"--merge\1", text)
        self.assertEqual(replaced, 1)
        self.assertIn("20 of 20 runs", self.ran("bash", "-c", merge, SLURM_CPUS_PER_TASK=processors))
        self.is_the_table_of_one_sweep()
        # A task that had ended is there when it is started again, and one whose results went is made.
        (self.work / "out/yields/part-2-of-16/sweep.rows").unlink()
        for task in "12":
            self.ran("bash", "array.sh", SLURM_ARRAY_TASK_ID=task, SLURM_ARRAY_TASK_COUNT=str(last),
                     SLURM_CPUS_PER_TASK=processors)
        self.ran("bash", "-c", merge, SLURM_CPUS_PER_TASK=processors)
        self.is_the_table_of_one_sweep()

    def test_rules_of_snakemake(self):
        self.documented("snakemake", "Snakefile")
        self.ran("snakemake", "--cores", "2")
        self.is_the_table_of_one_sweep()
        # Nothing is done twice.
        before = (self.work / "out/yields/sweep.csv").stat().st_mtime_ns
        self.ran("snakemake", "--cores", "2")
        self.assertEqual((self.work / "out/yields/sweep.csv").stat().st_mtime_ns, before)


if __name__ == "__main__":
    unittest.main()
