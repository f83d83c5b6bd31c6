#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The program that measures accuracy can do what it likes: it cannot end the node, hold it up or outlive it.

The node runs from a folder of its own, in which the program beside it is a script of this test.
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import roslib.packages
import rospy
import rostest
from rigid_body_sim.msg import AccuracyStudy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, Listener, ask, call, wait  # noqa: E402

NODE = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]

# What the script does after `echo $$ > pid`.
SILENT = 'exec sleep 1000'
STUBBORN = 'trap "" TERM; while true; do :; done'
FAULTY = {'garbage': 'echo "%PDF-1.4"', 'null': 'echo null', 'a null inside': """echo '{"share": null, "study": null}'""",
          'a cut line': """printf '{"share": 0.5, "stu'""", 'another kind': """echo '{"share": "x", "study": [1]}'""",
          'nothing': 'exit 0', 'a crash': 'kill -SEGV $$', 'no end of line': "yes | tr -d '\\n'",
          'closed output': 'exec >&-; exec sleep 1000', 'no done': """echo '{"share": 0.5}'; exec sleep 1000"""}


def state_of(pid):
    """The letter that the system tells of a process; None where there is none."""
    try:
        with open('/proc/%d/stat' % pid, encoding='ascii') as file:
            return file.read().rsplit(')', 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return None


def children_of(pid):
    return subprocess.run(['ps', '-o', 'stat=', '--ppid', str(pid)], capture_output=True, text=True,
                          check=False).stdout.split()


class MeasuringTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        node = shutil.copy(NODE, self.folder)
        self.studies = Listener('/sim/accuracy', AccuracyStudy)
        self.addCleanup(self.studies.subscriber.unregister)
        self.node = subprocess.Popen([node, '__name:=sim', '_scene:=' + SMALL, '_paused:=true', '_status_line:=false'],
                                     env=dict(os.environ, TMPDIR=self.folder))
        self.addCleanup(self.end_node)
        wait(self.answers, 'the node is there')

    def end_node(self):
        self.node.kill()
        self.node.wait()

    def answers(self):
        try:
            return ask('list_bodies').success
        except rospy.ServiceException:
            return False

    def measure_with(self, script):
        """Starts a measurement by a script; the pid of the program."""
        program = os.path.join(self.folder, 'scene_accuracy')
        pid_file = os.path.join(self.folder, 'pid')
        with open(program + '.new', 'w', encoding='ascii') as file:
            file.write('#!/bin/bash\necho $$ > %s.new; mv %s.new %s\n%s\n' % (pid_file, pid_file, pid_file, script))
        os.chmod(program + '.new', 0o755)
        os.replace(program + '.new', program)
        if os.path.exists(pid_file):
            os.remove(pid_file)
        self.job = call('measure_accuracy').job
        wait(lambda: os.path.exists(pid_file), 'the program runs')
        with open(pid_file, encoding='ascii') as file:
            return int(file.read())

    def told(self):
        return wait(lambda: next((s for s in self.studies.all() if s.job == self.job and s.done), None), 'the study is done')

    def assert_gone(self, pid):
        """Reaped where the node lives; else that is the affair of the system's first process."""
        wait(lambda: state_of(pid) in ((None, 'Z') if self.node.poll() is not None else (None,)), 'the program is gone')

    def test_whatever_it_writes_the_node_tells_and_goes_on(self):
        for name, script in FAULTY.items():
            with self.subTest(name):
                pid = self.measure_with(script)
                self.assertIn('the measurement gave no result', self.told().trouble)
                self.assert_gone(pid)
                self.assertEqual(children_of(self.node.pid), [])
                self.assertIn('no result', ask('apply_accuracy', max_error=1.0).message)
        self.assertTrue(self.answers())

    def test_a_program_that_is_silent_without_working_is_ended(self):
        pid = self.measure_with(SILENT)
        deadline = time.monotonic() + 120
        while not any(s.done for s in self.studies.all()) and time.monotonic() < deadline:
            time.sleep(0.2)
        self.assertIn('did nothing for', self.told().trouble)
        self.assert_gone(pid)

    def test_one_that_ignores_sigterm_is_killed(self):
        for ends in (lambda: call('stop_accuracy'), lambda: self.measure_with(SILENT)):
            pid = self.measure_with(STUBBORN)
            ends()
            self.assert_gone(pid)
        call('stop_accuracy')
        self.assertIn('stopped', self.told().trouble)
        self.assertIn('no accuracy study', call('stop_accuracy').message)

    def test_a_program_that_cannot_be_run_is_told(self):
        refused = ask('measure_accuracy')
        self.assertFalse(refused.success)
        self.assertIn('cannot be run', refused.message)
        self.assertIn('cannot be run', ask('apply_accuracy', max_error=1.0).message)

    def test_it_ends_with_the_node_however_that_ends(self):
        for number, number_of_ends in ((signal.SIGTERM, 0), (signal.SIGINT, 0), (signal.SIGKILL, -signal.SIGKILL)):
            with self.subTest(number):
                if self.node.poll() is not None:
                    self.doCleanups()
                    self.setUp()
                pid = self.measure_with(STUBBORN)
                self.assertEqual(sorted(os.listdir(self.folder)), ['pid', 'scene_accuracy', 'simulator_node'])
                self.node.send_signal(number)
                self.assertEqual(self.node.wait(60), number_of_ends)
                self.assert_gone(pid)

    def test_the_real_one_ends_with_the_node_in_the_middle_of_a_step(self):
        os.symlink(os.path.join(os.path.dirname(NODE), 'scene_accuracy'), os.path.join(self.folder, 'scene_accuracy'))
        call('measure_accuracy', seconds=1000.0, window=10.0, windows=1000, max_cpu_seconds=1000.0)
        wait(lambda: self.studies.all() and self.studies.all()[-1].windows, 'it measures')
        pids = subprocess.run(['pgrep', '-P', str(self.node.pid)], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(len(pids), 1)
        self.node.kill()
        self.node.wait()
        self.assert_gone(int(pids[0]))


if __name__ == '__main__':
    rospy.init_node('measuring_test')
    rostest.rosrun('rigid_body_sim', 'measuring', MeasuringTest)
