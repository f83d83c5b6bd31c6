# SPDX-License-Identifier: BSD-3-Clause
"""explain as a user meets it: numbers it refuses, and a long run that is interrupted."""
import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE = 120.0  # s


def program():
    """In the build that runs this test: its folder comes with the environment, else the one of this tree."""
    for prefix in os.environ.get('CMAKE_PREFIX_PATH', '').split(':') + [str(ROOT / 'build/devel')]:
        path = os.path.join(prefix, 'lib/rigid_body_sim/explain')
        if os.path.isfile(path):
            return path
    raise RuntimeError('explain is not built')


def explain(*arguments):
    return subprocess.run([program(), 'tower', *arguments], capture_output=True, text=True, timeout=PATIENCE)


class ExplainTest(unittest.TestCase):
    def test_a_number_of_steps_that_makes_no_sense_is_refused(self):
        for steps in ('-1', '1000001', '-9223372036854775808'):
            result = explain('--steps=' + steps)
            self.assertEqual((result.returncode, result.stdout), (2, ''), steps)
            self.assertIn('--steps', result.stderr)
            self.assertIn(steps, result.stderr)
            self.assertIn('0 to 1,000,000', result.stderr)
        for steps in ('', '1.5', 'many', '99999999999999999999'):
            result = explain('--steps=' + steps)
            self.assertEqual((result.returncode, result.stdout), (2, ''), steps)
            self.assertIn('steps', result.stderr)
            self.assertIn('up to 1,000,000', result.stderr)

    def test_as_many_steps_are_taken_as_were_asked_for(self):
        for steps in (1, 150):
            told = json.loads(explain('--json', '--steps', str(steps)).stdout)
            self.assertEqual(told['steps_taken'], steps)
            self.assertGreater(told['cpu_seconds_per_step'], 0.0)
        told = json.loads(explain('--json').stdout)
        self.assertEqual(told['steps_taken'], 0)
        self.assertNotIn('cpu_seconds_per_step', told)

    def test_an_interrupt_ends_it_with_what_it_has_measured(self):
        explaining = subprocess.Popen([program(), 'tower', '--steps', '1000000'], stdout=subprocess.PIPE, text=True)
        self.addCleanup(explaining.kill)
        time.sleep(1.0)  # so that there are some; a million take hours
        explaining.send_signal(signal.SIGINT)
        output, _ = explaining.communicate(timeout=PATIENCE)
        self.assertEqual(explaining.returncode, 130)
        self.assertRegex(output, r'contacts\.solve +\d+\.\d+ ms')
        self.assertRegex(output, r'Interrupted after \d+ of 1000000 steps')


if __name__ == '__main__':
    unittest.main()
