#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What documents promise of themselves: a README that one reads, paragraphs that one understands at
the first reading, and a map that names files which are there.   docs_test.py SOURCE"""
import pathlib
import re
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(sys.argv.pop() if len(sys.argv) > 1 else ".").resolve()
README_WORDS, PARAGRAPH_WORDS = 900, 120


def documents():
    listed = subprocess.run(["git", "-C", SOURCE, "ls-files", "*.md"], capture_output=True, text=True)
    found = listed.stdout.split() if listed.returncode == 0 else []
    paths = [SOURCE / name for name in found] or list(SOURCE.glob("*.md")) + list(
        SOURCE.glob("docs/*.md"))
    return [p for p in paths if "results" not in p.parts]


def paragraphs(text):
    """Blocks of prose: no tables, no code."""
    text = re.sub(r"^```.*?^```", "\n", text, flags=re.S | re.M)
    for block in re.split(r"\n\s*\n", text):
        lines = [line for line in block.splitlines() if not line.startswith(("|", "<!--", "#"))]
        # An item of a list is a paragraph of its own.
        for part in re.split(r"\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines)):
            yield part.strip()


class Documents(unittest.TestCase):
    def test_the_readme_is_short(self):
        words = len((SOURCE / "README.md").read_text(encoding="utf-8").split())
        self.assertLessEqual(words, README_WORDS)

    def test_paragraphs_are_short(self):
        self.assertGreater(len(documents()), 5)
        long = []
        for path in documents():
            for text in paragraphs(path.read_text(encoding="utf-8")):
                if len(text.split()) > PARAGRAPH_WORDS:
                    long.append(f"{path.relative_to(SOURCE)}: {len(text.split())} words: {text[:60]}")
        self.assertEqual(long, [])

    def test_every_file_of_the_map_is_there(self):
        text = (SOURCE / "docs/architecture.md").read_text(encoding="utf-8")
        named = [n for n in re.findall(r"`([\w./-]+)`", text) if "/" in n and "NAME" not in n]
        self.assertGreater(len(named), 40)
        self.assertEqual([n for n in named if not (SOURCE / n).exists()], [])

    def test_every_stage_of_ci_is_told_of_with_its_seconds(self):
        script = (SOURCE / ".ci/run").read_text(encoding="utf-8")
        stages = re.search(r"^stages=\((.*?)\)$", script, flags=re.M)[1].split()
        self.assertTrue({"test", "windows", "arm"} <= set(stages))
        head = script[:script.index("set -euo pipefail")]
        table = (SOURCE / "CONTRIBUTING.md").read_text(encoding="utf-8")
        for stage in stages:
            self.assertIn(f"\nstage_{stage}() {{", script)
            self.assertRegex(head, rf"\n#     {stage} +\w")
            if stage != "format":  # a second
                self.assertRegex(table, rf"\n\| `{stage}` \|.*\d")

    def test_links_lead_somewhere(self):
        dead = []
        for path in documents():
            for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8")):
                if not (path.parent / target).exists():
                    dead.append(f"{path.relative_to(SOURCE)} -> {target}")
        self.assertEqual(dead, [])


if __name__ == "__main__":
    unittest.main()
