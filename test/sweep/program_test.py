#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps of programs: what they are given, what they leave, and what they can do to a sweep, which is nothing."""
import csv
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest
from unittest import mock

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from rigid_body_sim.sweep import carry, engines, tree  # noqa: E402
from rigid_body_sim.sweep.program import MOST_KEPT, command_of  # noqa: E402
from rigid_body_sim.sweep.reader import Reader  # noqa: E402
from rigid_body_sim.sweep.run import run_task  # noqa: E402
from rigid_body_sim.sweep.store import Store  # noqa: E402
from sweep_file import SweepCase  # noqa: E402

ECHO = '#!/usr/bin/python3\nimport json, sys\njson.dump(sys.argv[1:], sys.stdout)\n'


class ProgramCase(SweepCase):
    def program(self, text, name='p'):
        self.write(text, name).chmod(0o755)

    def plan(self, text):
        return Reader(str(self.write(text)), None).read()

    def record(self, text, number=0):
        return run_task(self.plan(text), number)

    def shell(self, script, rest=''):
        """The record of a program that is a script for sh."""
        self.program('#!/bin/sh\n' + script + '\n')
        return self.record('program: [./p]\n' + rest)

    def faults(self, text):
        with self.assertRaises(tree.Refused) as caught:
            self.plan(text)
        return [fault.replace(str(self.folder) + '/', '') for fault in caught.exception.faults]

    def assert_gone(self, name):
        """The process whose number a file holds has ended."""
        number, deadline = (self.folder / name).read_text().strip(), time.monotonic() + 20
        while os.path.exists(f'/proc/{number}') and time.monotonic() < deadline:
            with open(f'/proc/{number}/stat', encoding='utf-8') as stat:
                if stat.read().rsplit(')', 1)[1].split()[0] == 'Z':
                    return
            time.sleep(0.01)
        self.assertFalse(os.path.exists(f'/proc/{number}'))


class FileTest(ProgramCase):
    def test_values_are_arguments_whatever_they_hold(self):
        self.program(ECHO)
        odd = 'two words; "quotes" \'and\' $HOME `id` {b} *'
        text = ('program: [./p, "{a}", "-b={b}/{a}", "{c}", "{}", "{\\"k\\": {b}}", 7, "{seed}", "{number}"]\n'
                'vary: {a: [%s], b: [true, 1e-9, null], c: [[], [--x, 3]]}\n' % json.dumps(odd))
        plan = self.plan(text)
        for number, (b, c) in enumerate((b, c) for b in ('true', '1e-09', 'null') for c in ([], ['--x', '3'])):
            wanted = [odd, f'-b={b}/{odd}', *c, '{}', '{"k": %s}' % b, '7', str(plan.parameters(number)[0]), str(number)]
            self.assertEqual(command_of(plan, number), [str(self.folder / 'p'), *wanted])
            self.assertEqual(json.loads(run_task(plan, number)['output']), wanted)

    def test_a_program_is_found(self):
        self.program(ECHO)
        self.assertEqual(self.plan('program: [./p]').program['words'], [str(self.folder / 'p')])
        self.assertEqual(self.plan('program: [sh]').program['words'], ['/usr/bin/sh'])
        path = self.plan('program: [scene_accuracy]').program['words'][0]
        self.assertTrue(path.endswith('lib/rigid_body_sim/scene_accuracy') and os.access(path, os.X_OK), path)
        self.write('1', 'data')
        for words, said in (('./none', 'there is no program none'), ('none', 'and none of this name on the PATH'),
                            ('./data', 'data is not executable'), ('.', 'there is no program')):
            fault, = self.faults(f'program: ["{words}"]')
            self.assertIn('s.yaml:1: program[0]: ', fault)
            self.assertIn(said, fault)

    def test_every_fault_is_told_with_its_line(self):
        self.assertEqual(self.faults('''program: ["{x}", "{y}", "{a} {z}"]
scene: tower
duration: 3
stop: {at_rest: 1}
vary:
  a: [1]
  b: [2]
  seed: [3]
  c-d: [4]
measure:
  m: energy
  n: {json: 3}
  o/p: {json: a}
'''), ['s.yaml:2: scene: it means nothing to a program; \'program\' or \'scene\' says what is run',
       's.yaml:3: duration: it means nothing to a program; \'program\' or \'scene\' says what is run',
       's.yaml:4: stop: it means nothing to a program; \'program\' or \'scene\' says what is run',
       's.yaml:1: program[0]: {x}: the program itself does not vary',
       's.yaml:1: program[1]: {y}: nothing varies it (there are: a, b, seed, c-d, number)',
       's.yaml:1: program[2]: {z}: nothing varies it (there are: a, b, seed, c-d, number)',
       's.yaml:7: vary.b: no word of the program has {b}',
       's.yaml:8: vary.seed: each run has its own (allowed: a name other than seed, number)',
       's.yaml:9: vary.c-d: it is no placeholder (allowed: letters, digits and _, no digit first)',
       's.yaml:1: program[0]: there is no program {x}, and none of this name on the PATH'.replace(
           '{x}', os.path.join(os.path.dirname(self.plan('program: [scene_accuracy]').program['words'][0]), '{x}')),
       "s.yaml:11: measure.m: 'energy' (allowed: one of json, python, alone or with what it takes)",
       's.yaml:12: measure.n: 3 (allowed: a path, such as rows[0].error)',
       "s.yaml:13: measure.o/p: it is no name (allowed: any word without '/')"])
        for words in ('./p', '[]', '[[sh]]', '{a: b}'):
            self.assertIn('(allowed: a list of words, the program first)', self.faults(f'program: {words}')[0])

    def test_another_program_is_another_sweep(self):
        self.program(ECHO)
        before = self.plan('program: [./p]').fingerprint()
        self.assertEqual(self.plan('program: [./p]\nmax_seconds: 3').fingerprint(), before)
        self.program(ECHO + '\n')
        self.assertNotEqual(self.plan('program: [./p]').fingerprint(), before)


class RunTest(ProgramCase):
    def test_numbers_are_measured_in_json(self):
        self.write('def length(output, parameters):\n    return [len(output), parameters["x"]]\n', 'f.py')
        self.program('#!/bin/sh\necho "{\\"a\\": {\\"b\\": [1, $1, null]}, \\"rows\\": [{\\"name\\": \\"r\\", \\"e\\": true}]}"\n')
        record = self.record('program: [./p, "{x}"]\nvary: {x: [2.5]}\nmeasure: {b: {json: a.b}, one: {json: "a.b[1]"}, '
                             'e: {json: "rows[r].e"}, f: {python: f.py:length}}\n')
        self.assertEqual((record['status'], record['detail'], record['exit_status']), ('ok', '', 0))
        self.assertEqual(record['values']['b'].tolist()[:2], [1, 2.5])
        self.assertTrue(math.isnan(record['values']['b'][2]))
        self.assertEqual([float(record['values'][name]) for name in ('one', 'e')], [2.5, 1])
        self.assertEqual(record['values']['f'].tolist(), [len(record['output']), 2.5])
        self.assertGreater(record['cpu_seconds'], 0)

    def test_what_cannot_be_measured_is_told(self):
        measure = 'measure: {a: {json: "a[1]"}, b: {json: b}, c: {json: c}}\n'
        record = self.shell('echo \'{"a": [1], "c": "text"}\'', measure)
        self.assertEqual(record['status'], 'failed')
        for said in ('measure.a: Refused: a[1]: [1] of a list of 1', "measure.b: Refused: b: there is no key 'b'", 'measure.c: '):
            self.assertIn(said, record['detail'])
        self.assertIn('measure.a: JSONDecodeError', self.shell('echo a', measure)['detail'])

    def test_a_program_that_fails_says_why(self):
        record = self.shell('seq 1 20 >&2; echo \'{"a": 4}\'; exit 3', 'measure: {a: {json: a}, b: {json: b}}')
        self.assertEqual((record['status'], record['exit_status']), ('failed', 3))
        self.assertEqual(record['detail'], 'exit status 3: ' + '\n'.join(map(str, range(11, 21))))
        self.assertEqual(record['values']['a'], 4)
        record = self.shell('kill -SEGV $$')
        self.assertEqual((record['status'], record['exit_status']), ('failed', -signal.SIGSEGV))
        self.assertEqual(record['detail'], 'it was ended by signal 11')

    def test_a_program_that_hangs_is_ended_with_its_children(self):
        record = self.shell('trap "" TERM INT; sleep 1000 & echo $! > child; echo $$ > self; echo begun; wait; sleep 1000',
                            'max_seconds: 0.5')
        self.assertEqual((record['status'], record['detail']), ('overtime', 'it had not ended after 0.5 s'))
        self.assertEqual((record['output'], record['exit_status']), ('begun\n', -signal.SIGKILL))
        self.assert_gone('child')
        self.assert_gone('self')

    def test_nothing_is_left_of_a_program_that_ends_before_its_children(self):
        record = self.shell('sleep 1000 & echo $! > child; echo done')
        self.assertEqual((record['status'], record['output']), ('ok', 'done\n'))
        self.assert_gone('child')

    def test_long_outputs(self):
        record = self.shell('yes 123456789 | head -c 10000000; yes error | head -n 1000000 >&2; exit 1')
        self.assertEqual((record['status'], len(record['output'])), ('failed', MOST_KEPT))
        self.assertEqual(record['detail'], 'exit status 1: ' + '\n'.join(10 * ['error']))
        self.write('def f(output, parameters):\n    return len(output)\n', 'f.py')
        record = self.shell('yes 123456789 | head -c 10000000', 'measure: {n: {python: f.py:f}}')
        self.assertEqual((record['status'], record['values']['n']), ('ok', 10_000_000))
        record = self.shell('yes', 'max_seconds: 30')
        self.assertEqual((record['status'], record['detail']), ('failed', 'it printed more than 64 MiB'))

    def test_outputs_that_are_no_text(self):
        self.program("#!/bin/sh\nprintf 'a\\377\\000b\\303\\244'\nprintf 'c\\377\\000' >&2\nexit 1\n")
        self.write('program: [./p]\n')
        self.sound('--workers', '1')
        table = self.results()
        self.assertEqual(table['output'].tolist(), ['a\ufffd\ufffdb\u00e4'])
        self.assertEqual(table['detail'].tolist(), ['exit status 1: c\ufffd\ufffd'])

    def test_what_does_not_start_is_refused(self):
        self.program(ECHO)
        for value, said in (('\0', 'embedded null byte'), ('x' * 200_000, 'Argument list too long')):
            record = self.record('program: [./p, "{x}"]\nvary: {x: [%s]}' % json.dumps(value))
            self.assertEqual(record['status'], 'refused')
            self.assertIn(said, record['detail'])

    def test_it_runs_beside_its_file_and_reads_nothing(self):
        record = self.shell('pwd; cat; echo end')
        self.assertEqual(record['output'], f'{self.folder.resolve()}\nend\n')


class SweepTest(ProgramCase):
    TEXT = 'program: [./p, "{x}", "{y}"]\nvary: {x: {range: [0, 9], count: 10}, y: [a b, c]}\nmeasure: {k: {json: k}}\n'
    SCRIPT = '#!/bin/sh\n[ "$1" = 7 ] && { echo seven >&2; exit 3; }\n%s\necho "{\\"k\\": $1, \\"y\\": \\"$2\\"}"\n'

    def check(self):
        table = self.results()
        failed = [k // 2 == 7 for k in range(20)]
        self.assertEqual(table['status'].tolist(), ['failed' if f else 'ok' for f in failed])
        self.assertEqual(table['exit_status'].tolist(), [3 if f else 0 for f in failed])
        self.assertEqual([k for k in table['metrics/k'].tolist() if not math.isnan(k)], [k // 2 for k in range(20) if k // 2 != 7])
        self.assertEqual(json.loads(table['output'][4]), {'k': 2, 'y': 'a b'})
        self.assertEqual(table['parameters/y'].tolist(), ['a b', 'c'] * 10)
        self.assertFalse({'hash', 'steps', 'time', 'flags', 'stopped'} & set(table))
        with open(self.folder / 's.sweep/results.csv', encoding='utf-8', newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row['detail'] for row in rows[13:16]], ['', 'exit status 3: seven', 'exit status 3: seven'])
        self.assertEqual([row['exit_status'] for row in rows[13:16]], ['0', '3', '3'])
        self.assertNotIn('output', rows[0])

    def test_a_program_that_does_not_start_has_the_exit_status_of_a_shell(self):
        self.program('#!/no/such/interpreter\n')
        self.write('program: [./p]\nrepeats: 2\n')
        said = self.sweep('--workers', '1').stdout
        self.assertIn('2 refused', said)
        self.assertEqual(self.results()['exit_status'].tolist(), [127] * 2)

    def test_values_of_several_kinds_stay_apart(self):
        self.program(self.SCRIPT % '')
        self.write('program: [./p, "{x}", "{y}"]\nvary: {x: [1], y: [true, "true", null, a]}\n')
        self.sound('--workers', '1')
        self.assertEqual(self.results()['parameters/y'].tolist(), ['true', '"true"', 'null', 'a'])

    def test_one_process_and_two_give_the_same(self):
        self.program(self.SCRIPT % '')
        self.write(self.TEXT)
        for workers in ('1', '2'):
            said = self.sound('--workers', workers, '--output', self.folder / 's.sweep')
            self.assertIn('20 of 20 runs: 18 ok, 2 failed', said)
            self.assertIn('run 14 failed: exit status 3: seven\n  x = 7, y = "a b"\n', said)
            self.check()
            (self.folder / 's.sweep').rename(self.folder / ('by' + workers))
        self.assertIn('20 runs: 10 of x x 2 of y\n', self.sound('--dry-run'))
        said = self.sound('--only', '5')
        self.assertIn('  x = 2\n  y = "c"\nk: 2.\n{"k": 2, "y": "c"}\nexit status 0, in ', said)
        said = self.sweep('--only', '14')
        self.assertEqual(said.returncode, 1)
        self.assertIn('exit status 3', said.stdout)

    def test_long_programs_hold_up_no_estimate(self):
        self.program('#!/bin/sh\n[ $1 = 0 ] || sleep 1000\n')
        plan = self.plan('program: [./p, "{number}"]\nrepeats: 3\nmax_seconds: 5')
        engine = engines.Processes(1)
        self.addCleanup(engine.close)
        with mock.patch('rigid_body_sim.sweep.carry.PILOT_SECONDS', 0.5):
            records = carry.pilot(plan, range(3), engine)
        self.assertEqual([record['status'] for record in records], ['ok', 'overtime', 'overtime'])
        self.assertEqual(records[1]['detail'], 'it had not ended after 0.5 s')

    def test_gnu_parallel_gives_the_same(self):
        if not shutil.which('parallel'):
            self.skipTest('GNU parallel is not installed (Debian: parallel)')
        self.program(self.SCRIPT % '')
        self.write(self.TEXT)
        self.sound('--hosts', self.write('2/:\n', 'hosts'))
        self.check()

    def test_ctrl_c_ends_programs_and_resume_goes_on(self):
        for workers in ('1', '2'):
            with self.subTest(workers=workers):
                subprocess.run(['rm', '-rf', self.folder / 's.sweep', self.folder / 'self'], check=True)
                self.program(self.SCRIPT % 'echo $$ >> $1$2.pid; [ "$1" != 4 ] || [ -e go ] || { sleep 1000 & echo $! > child; wait; }')
                self.write(self.TEXT)
                code, said = self.interrupted(lambda: (self.folder / '4a b.pid').exists() and self.parts(),
                                              '--workers', workers)
                self.assertEqual(code, 130, said)
                self.assert_gone('4a b.pid')
                self.assert_gone('child')
                recorded = Store(self.folder / 's.sweep').status()
                self.assertTrue(recorded)
                (self.folder / 'go').touch()
                self.sound('--resume', '--workers', workers)
                self.check()
                for k in recorded:
                    self.assertEqual(len((self.folder / f'{k // 2}{("a b", "c")[k % 2]}.pid').read_text().split()), 1)
                for path in [*self.folder.glob('*.pid'), self.folder / 'go']:
                    path.unlink()

    def test_nothing_is_left_of_a_sweep_that_is_killed(self):
        for workers in (1, 2):
            with self.subTest(workers=workers):
                self.program('#!/bin/sh\nsleep 1000 & echo $! > child$$; echo $PPID > new$$; mv new$$ worker$$; wait\n')
                self.write('program: [./p]\nrepeats: 2\n')
                process = subprocess.Popen(self.command('--workers', str(workers)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                while len(list(self.folder.glob('worker*'))) < workers and process.poll() is None:
                    time.sleep(0.01)
                process.kill()
                process.wait()
                names = [path.name for kind in ('child*', 'worker*') for path in self.folder.glob(kind)]
                self.assertEqual(len(names), 2 * workers)
                for name in names:
                    self.assert_gone(name)
                    (self.folder / name).unlink()

    def test_nothing_is_left_where_a_worker_ends_as_its_program_begins(self):
        self.program('#!/bin/sh\necho $$ > "child$$"; kill -9 $PPID; exec sleep 1000\n')
        self.write('program: [./p]\nrepeats: 12\n')
        self.sweep('--workers', '2')
        children = [path.name for path in self.folder.glob('child*')]
        self.assertGreaterEqual(len(children), 12)
        for child in children:
            self.assert_gone(child)

    def test_another_program_is_not_mixed_with_the_results_of_the_old(self):
        self.program(self.SCRIPT % '')
        self.write(self.TEXT)
        self.sound('--workers', '1')
        self.program(self.SCRIPT % 'true')
        done = self.sweep('--resume')
        self.assertEqual(done.returncode, 2)
        self.assertIn('holds a sweep of another file or program', done.stderr)


if __name__ == '__main__':
    unittest.main()
