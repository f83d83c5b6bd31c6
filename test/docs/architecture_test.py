#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""docs/architecture.md shows the two tables of the step and the states of a pair as the code has them.

`architecture_test.py --write` brings the page up to date.
"""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORE = ROOT / 'src/core'
PAGE = ROOT / 'docs/architecture.md'


def stages():
    """The stages of pipeline.cpp: name, and the function that runs it."""
    text = (CORE / 'step/pipeline.cpp').read_text()
    rows = re.findall(r'Stage\{"([\w.]+)",\s*[\w:<>]+,\s*([\w:]+)', text)
    return ''.join('%-24s%s\n' % row for row in rows)


def comment(path, first, last):
    """The lines of a comment from the one that begins with `first` to the one that has `last`."""
    lines = [line[2:].removeprefix(' ') for line in (CORE / path).read_text().split('\n') if line.startswith('//')]
    begin = next(k for k, line in enumerate(lines) if line.strip().startswith(first))
    end = next(k for k, line in enumerate(lines) if k >= begin and last in line)
    return ''.join(line[2:] + '\n' for line in lines[begin:end + 1])


def arrows_of_diagram():
    """The arrows of the comment in pair_state.h, as (from, to)."""
    text = comment('state/pair_state.h', 'Candidate ', 'restart.h')
    states = set(re.findall(r'^(\w+) +--|-> (\w+)', text, re.MULTILINE))
    states = {name for pair in states for name in pair if name}
    arrows = set(re.findall(r'^(\w+) +--\w+\(\)-+> *(\w+)', text, re.MULTILINE))
    (exception, everywhere), = re.findall(r'^any but (\w+) --\w+\(\)-+> *(\w+)', text, re.MULTILINE)
    return arrows | {(name, everywhere) for name in states - {exception, everywhere}}


def arrows_of_code():
    """Those that PairState::hasArrow() allows."""
    text = (CORE / 'state/pair_state.h').read_text()
    states = re.search(r'enum class At : char \{([^}]*)\}', text).group(1).replace(' ', '').split(',')
    body = text[text.index('static constexpr bool hasArrow'):text.index('void go(At to)')]
    arrows = set()
    for name, value in re.findall(r'case At::(\w+):\s+return ([^;]*);', body):
        if value.startswith('to !='):
            arrows |= {(name, other) for other in states if other != name}
        else:
            arrows |= {(name, other) for other in re.findall(r'At::(\w+)', value)}
    return arrows


BLOCKS = {
    'stages': stages,
    'inner step': lambda: comment('solver/inner_step.h', 'row ', 'store '),
    'pair state': lambda: comment('state/pair_state.h', 'Candidate ', 'restart.h'),
}


def with_blocks(text):
    for name, make in BLOCKS.items():
        pattern = re.compile(r'(<!-- of the code: %s -->\n```text\n).*?(```)' % name, re.DOTALL)
        if not pattern.search(text):
            raise ValueError('no block "%s" in %s' % (name, PAGE))
        text = pattern.sub(lambda match, block=make(): match.group(1) + block + match.group(2), text)
    return text


class ArchitectureTest(unittest.TestCase):

    def test_the_page_shows_the_code(self):
        text = PAGE.read_text()
        self.assertEqual(stages().count('\n'), (CORE / 'step/pipeline.cpp').read_text().count('    Stage{"'))
        self.assertEqual(text, with_blocks(text), 'run test/docs/architecture_test.py --write')

    def test_the_states_of_a_pair_go_where_the_diagram_says(self):
        self.assertEqual(sorted(arrows_of_code()), sorted(arrows_of_diagram()))
        self.assertIn(('Touching', 'Missed'), arrows_of_code())


if __name__ == '__main__':
    if '--write' in sys.argv:
        PAGE.write_text(with_blocks(PAGE.read_text()))
    else:
        unittest.main()
