#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The Python of a page, run: writes what its blocks print and draw into docs/python.md and docs/pictures.

The blocks of a page are one program, in their order. A block of text right below one of Python is what that prints. A picture
that a block saves under a name of docs/pictures is shown by the page.
"""
import contextlib
import io
import os
import pathlib
import re
import shutil
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Python that is no file of the package (test/docs/document.py), and the text below it.
BLOCK = re.compile(r'(?<!-->\n)^```python\n(?P<code>.*?)^```$(?:\n\n```text\n(?P<says>.*?)^```$)?', re.MULTILINE | re.DOTALL)


def run(text, folder):
    """Runs the blocks of a page in a folder. What each prints, in their order."""
    names, printed, before = {'__name__': '__main__'}, [], os.getcwd()
    os.chdir(folder)
    try:
        for block in BLOCK.finditer(text):
            # A traceback has the line of the page.
            code = '\n' * text.count('\n', 0, block.start('code')) + block.group('code')
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                exec(compile(code, 'the page', 'exec'), names)  # noqa: S102
            printed.append(output.getvalue())
    finally:
        os.chdir(before)
    return printed


def with_output(text, printed):
    """The page with what its blocks print below them."""
    outputs = iter(printed)

    def block(match):
        output = next(outputs)
        return '```python\n%s```' % match.group('code') + ('\n\n```text\n%s```' % output if output else '')
    return BLOCK.sub(block, text)


def main():
    page = ROOT / 'docs/python.md'
    text = page.read_text(encoding='utf-8')
    with tempfile.TemporaryDirectory() as folder:
        page.write_text(with_output(text, run(text, folder)), encoding='utf-8')
        for picture in pathlib.Path(folder).glob('*.png'):
            shutil.copy(picture, ROOT / 'docs/pictures')


if __name__ == '__main__':
    main()
