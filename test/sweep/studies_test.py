#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Studies that ride on sweeps: what was done is not done again, and what fails is a result."""
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import sys
import unittest
from unittest import mock

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from rigid_body_sim.sweep import study  # noqa: E402
from sweep_file import ROOT, SweepCase  # noqa: E402

# Two cases at two settings; B2 crashes at the second. Each run leaves a line in `runs`.
SUITE = '''#!/bin/bash
[ "$1" = --list ] && { for case in A1 B2; do for setting in fast exact; do echo "$case $setting The case $case"; done; done; exit; }
echo "$*" >> %s/runs
[ "$*" = "--residuals --json --full --case B2 --fidelity exact" ] && kill -SEGV $$
echo '{"number": "'${*: -3:1}'", "title": "T", "text": "It is.", "setting": "'${*: -1}'", "rows": [{"metric": "m", "unit": "m",
  "measured": 1e-7, "reference": 0, "bound": 1e-6, "holds": true}]}'
'''
PAGE = '<!-- measured: summary -->\n<!-- end -->\n<!-- measured: cases -->\n<!-- end -->\n'


def program_of(name):
    """A script as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / 'scripts' / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    with mock.patch('sys.dont_write_bytecode', True):
        loader.exec_module(module)
    return module


class StudyTest(SweepCase):
    def test_runs_are_made_once(self):
        self.write('#!/bin/sh\necho $1 | tee -a runs\n', 'p').chmod(0o755)
        file = str(self.folder / 'new/s.yaml')
        tree = {'program': ['../p', '{x}'], 'vary': {'x': [['a'], ['b c']]}}
        self.assertEqual(study.records(file), [])
        for _ in range(2):
            self.assertEqual(study.carry(file, tree, ['--workers', '1']), 0)
            self.assertEqual([(r['number'], r['parameters'], r['status'], r['exit_status'], r['output'], r['detail'])
                              for r in study.records(file)],
                             [(k, {'x': [x]}, 'ok', 0, x + '\n', '') for k, x in enumerate(('a', 'b c'))])
        self.assertEqual((self.folder / 'new/runs').read_text(), 'a\nb c\n')
        self.assertEqual(study.carry(file, {**tree, 'repeats': 2}, ['--workers', '1']), 2)  # these would be others
        self.assertEqual(len(study.records(file)), 2)


class StabilityTest(SweepCase):
    def setUp(self):
        super().setUp()
        self.suite = self.write(SUITE % self.folder, 'suite')
        self.suite.chmod(0o755)
        self.page = self.write(PAGE, 'page.md')
        self.report = program_of('stability_report')
        self.report.PAGE = self.page

    def stability(self, *arguments):
        """What the suite was asked, and the rows of the page."""
        with mock.patch('sys.argv', ['stability', str(self.suite), str(self.folder / 'kept'), '--workers', '1', *arguments]):
            with self.assertRaises(SystemExit) as ended:
                self.report.main()
        self.assertEqual(ended.exception.code, 0)
        runs = self.folder / 'runs'
        asked = runs.read_text().splitlines() if runs.exists() else []
        runs.unlink(missing_ok=True)
        rows = [line for line in self.page.read_text().splitlines() if line.startswith(('| A1', '| B2'))]
        return [line.replace('--residuals --json ', '') for line in asked], rows

    def test_all_cases_are_measured_once(self):
        asked, rows = self.stability()
        self.assertEqual(asked, [f'--full --case {case} --fidelity {setting}' for case in ('A1', 'B2') for setting in ('fast', 'exact')])
        self.assertEqual(rows[:3], [f'| {case} | 1 of 1 hold | m: 1e-07 m (asked 1e-06) |' for case in ('A1 | fast', 'A1 | exact', 'B2 | fast')])
        self.assertEqual(rows[3], '| B2 | exact | 0 of 1 hold | **runs to its end: no** |')
        self.assertEqual(self.stability(), ([], rows))
        self.assertEqual(len(self.stability('--fresh')[0]), 4)

    def test_chosen_cases_leave_the_others_on_the_page(self):
        _, rows = self.stability()
        asked, again = self.stability('--case', 'A1', '--fidelity', 'exact')
        self.assertEqual((asked, again), (['--full --case A1 --fidelity exact'], rows))
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            asked, again = self.stability('--quick', '--case', 'B2')
        self.assertEqual(asked, ['--case B2 --fidelity fast', '--case B2 --fidelity exact'])
        self.assertEqual(again, rows)  # the page stays as it is: quick runs of A1 are not known
        self.assertIn('| B2 | fast | 1 of 1 hold |', printed.getvalue())
        self.assertIn('2 of 4 runs are known', printed.getvalue())

    def test_a_new_suite_is_measured_anew(self):
        self.stability()
        plan = self.folder / 'kept/full.sweep/plan.json'
        later = plan.stat().st_mtime + 10
        os.utime(self.suite, (later, later))
        self.assertEqual(len(self.stability()[0]), 4)

    def test_unknown_names_are_refused(self):
        with mock.patch('sys.argv', ['stability', str(self.suite), str(self.folder / 'kept'), '--case', 'C3']), \
                mock.patch('sys.stderr') as said, self.assertRaises(SystemExit) as ended:
            self.report.main()
        self.assertEqual(ended.exception.code, 2)
        self.assertIn('known: A1, B2; fast, exact', json.dumps([str(call) for call in said.write.call_args_list]))


if __name__ == '__main__':
    unittest.main()
