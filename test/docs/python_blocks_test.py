#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The Python of the pages: every block runs, prints what the page shows, and draws its pictures."""
import pathlib
import re
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / 'scripts'))
from python_page import BLOCK, run, with_output  # noqa: E402

PAGES = sorted(page for page in ROOT.glob('docs/*.md') if BLOCK.search(page.read_text(encoding='utf-8')))


class PythonBlocksTest(unittest.TestCase):
    maxDiff = None

    def test_the_tutorial_is_among_them(self):
        self.assertIn(ROOT / 'docs/python.md', PAGES)

    def test_what_pages_show_is_what_comes_out(self):
        for page in PAGES:
            text = page.read_text(encoding='utf-8')
            with tempfile.TemporaryDirectory() as folder:
                self.assertEqual(with_output(text, run(text, folder)), text, page.name)
                drawn = sorted(picture.name for picture in pathlib.Path(folder).glob('*.png'))
            self.assertEqual(drawn, sorted(re.findall(r'\(pictures/(python_\w+\.png)\)', text)))
            for picture in drawn:
                self.assertTrue((ROOT / 'docs/pictures' / picture).is_file(), picture)

    def test_a_block_that_prints_something_else_is_found(self):
        text = '```python\nx = 1 + 1\nprint(x)\n```\n\n```text\n3\n```\n'
        self.assertEqual(with_output(text, run(text, '.')), text.replace('3', '2'))
        with self.assertRaises(ZeroDivisionError):
            run('```python\n1 / 0\n```\n', '.')
        self.assertEqual(run('<!-- a.py -->\n```python\n1 / 0\n```\n', '.'), [])


if __name__ == '__main__':
    unittest.main()
