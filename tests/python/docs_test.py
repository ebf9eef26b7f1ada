# SPDX-License-Identifier: Apache-2.0
"""The example of docs/python.md runs as it stands, and tears."""
import contextlib
import io
import os
import pathlib
import re
import tempfile
import unittest

from support import SOURCE


class Example(unittest.TestCase):
    def test_from_a_mesh_to_a_torn_picture(self):
        text = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
        code = re.search(r"<!-- example -->\n```python\n(.*?)```", text, flags=re.S)[1]
        lines = [line for line in code.splitlines() if line.strip()]
        self.assertLessEqual(len(lines), 20)
        said, before = io.StringIO(), pathlib.Path.cwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(said):
                    exec(compile(code, "docs/python.md", "exec"), {})
            finally:
                os.chdir(before)
            self.assertEqual((pathlib.Path(folder) / "torn.png").read_bytes()[:4], b"\x89PNG")
        torn, count = map(int, re.match(r"(\d+) of (\d+) elements torn", said.getvalue()).groups())
        self.assertEqual(count, 6 * (20 * 8 - 2))
        self.assertGreater(torn, 0)
        self.assertLess(torn, count / 2)


if __name__ == "__main__":
    unittest.main()
