#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""docs/tolerances.md lists the tolerances of the core as they are, and no name stands for two values."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORE = ROOT / 'src/core'
NUMBERS = {'kPi', 'kInfinity', 'kGolden', 'kDegree', 'kEpsilon'}  # of mathematics: no tolerances


def in_code():
    """(file, name, value) of each constant of type double."""
    found = []
    for path in sorted(CORE.rglob('*.[ch]*')):
        for declaration in re.findall(r'constexpr double ([^;]*);', path.read_text()):
            for name, value in re.findall(r'(k[A-Z]\w*) = ([^,]+(?:\([^)]*\))?)', declaration):
                if name not in NUMBERS:
                    value = value.replace('std::numeric_limits<double>::epsilon()', 'ε').replace('kEpsilon', 'ε').replace('kPi', 'π')
                    found.append((str(path.relative_to(CORE)), name, ' '.join(value.split())))
    return found


def on_page():
    rows = re.findall(r'^\| `(k\w+)` \| ([^|]*) \| [^|]* \| `([^`]*)` \|', (ROOT / 'docs/tolerances.md').read_text(), re.MULTILINE)
    return [(where, name, value) for name, value, where in rows]


class TolerancesTest(unittest.TestCase):

    def test_page_and_code_say_the_same(self):
        self.assertGreater(len(in_code()), 100)
        self.assertEqual(sorted(on_page()), sorted(in_code()))

    def test_a_name_stands_for_one_value(self):
        values = {}
        for where, name, value in in_code():
            self.assertEqual(values.setdefault(name, value), value, '%s in %s: use another name' % (name, where))


if __name__ == '__main__':
    unittest.main()
