#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the simulator has come to outlives it: kept at its end, offered at its next start, taken with resume:=true."""
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import Twist, Vector3

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, StatusListener, ask, call, wait  # noqa: E402

PROGRAM = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]


class Node:
    """A simulator with its state in a file, as a context manager that leaves none behind."""

    def __init__(self, file, resume=False):
        self.log = tempfile.TemporaryFile('w+')
        # A service or message of the node before must not answer for this one.
        wait(lambda: '/sim' not in self.nodes(), 'the node before is gone')
        self.process = subprocess.Popen(
            [PROGRAM, '__name:=sim', '_state_file:=' + file, '_resume:=%s' % resume],
            env=dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED='1'), stdout=self.log, stderr=subprocess.STDOUT)

    @staticmethod
    def nodes():
        publishers, _, services = rospy.get_master().getSystemState()[2]
        return {node for entry in publishers + services for node in entry[1]}

    def __enter__(self):
        wait(lambda: self.process.poll() is not None or '/sim' in self.nodes(), 'the node is there or has ended')
        if self.process.poll() is not None:
            raise AssertionError('the node has ended with %d: %s' % (self.process.poll(), self.said()))
        rospy.wait_for_service('/sim/list_bodies', 30)
        return self

    def __exit__(self, *error):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        # What was killed has not told the master.
        subprocess.run(['rosnode', 'cleanup'], input=b'y\n', stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def end(self, number):
        self.process.send_signal(number)
        return self.process.wait(60)

    def said(self):
        self.log.seek(0)
        return self.log.read()


class ResumeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.status = StatusListener()

    def setUp(self):
        folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.file = os.path.join(folder.name, 'states', 'sim.yaml')

    def edit_and_end(self, number, name='kept'):
        """Makes a moving body, takes steps and ends the node; returns the hash of the state at the end."""
        with Node(self.file) as node:
            call('spawn_body', name=name, twist=Twist(Vector3(1, 0, 0), Vector3(0, 0, 1)))
            call('step', n=20)
            last = self.status.fresh()
            self.assertEqual(node.end(number), 0, node.said())
            self.assertIn('saved \'small\' at ', node.said())
            return last.hash

    @staticmethod
    def ask_for_a_million_steps():
        try:
            ask('step', n=1000000)
        except rospy.ServiceException:
            pass  # the node may be gone before it has answered

    def assert_usual_scene(self, node, *words):
        self.assertNotIn('kept', call('list_bodies').names)
        for word in words:
            self.assertIn(word, node.said())

    def test_each_signal_that_asks_a_node_to_end_keeps_the_state_bit_for_bit(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            with self.subTest(number):
                last = self.edit_and_end(number)
                with Node(self.file, resume=True) as node:
                    self.assertEqual(self.status.fresh().hash, last)
                    self.assertIn('resumed \'small\' at ', node.said())
                    self.assertFalse(ask('undo').success)
                os.remove(self.file)

    def test_without_resume_the_state_is_offered_and_the_usual_scene_is_loaded(self):
        self.edit_and_end(signal.SIGTERM)
        with Node(self.file) as node:
            self.assert_usual_scene(node, self.file, 'resume:=true')

    def test_a_state_that_was_not_taken_gives_way_only_to_edits_and_stays_beside_them(self):
        self.edit_and_end(signal.SIGTERM)
        with open(self.file) as file:
            first = file.read()
        with Node(self.file) as node:
            call('step', n=1)
            node.end(signal.SIGTERM)
        with open(self.file) as file:
            self.assertEqual(file.read(), first)
        second = self.edit_and_end(signal.SIGTERM, 'later')
        with open(os.path.join(os.path.dirname(self.file), 'sim.previous.yaml')) as file:
            self.assertEqual(file.read(), first)
        with Node(self.file, resume=True):
            self.assertEqual(self.status.fresh().hash, second)

    def test_time_that_goes_on_is_kept_and_an_untouched_scene_is_not(self):
        with Node(self.file) as node:
            node.end(signal.SIGTERM)
        self.assertFalse(os.path.exists(self.file))
        with Node(self.file) as node:
            call('step', n=3)
            node.end(signal.SIGTERM)
        with Node(self.file, resume=True):
            self.assertEqual(self.status.fresh().steps, 3)

    def test_a_kill_leaves_the_state_of_before(self):
        last = self.edit_and_end(signal.SIGTERM)
        with Node(self.file, resume=True) as node:
            call('clear')
            node.end(signal.SIGKILL)
        with Node(self.file, resume=True):
            self.assertEqual(self.status.fresh().hash, last)
        self.assertEqual(os.listdir(os.path.dirname(self.file)), ['sim.yaml'])

    def test_a_million_steps_under_way_are_ended_and_what_they_came_to_is_kept(self):
        with Node(self.file) as node:
            steps = threading.Thread(target=self.ask_for_a_million_steps)
            steps.start()
            wait(lambda: self.status.fresh().steps > 0, 'the steps are under way')
            self.assertEqual(node.end(signal.SIGTERM), 0, node.said())
            steps.join()
        with Node(self.file, resume=True):
            self.assertGreater(self.status.fresh().steps, 0)

    def test_a_damaged_or_foreign_file_is_refused_with_the_reason(self):
        self.edit_and_end(signal.SIGTERM)
        with open(self.file) as file:
            whole = file.read()
        lines = whole.splitlines(keepends=True)
        with open(SMALL) as file:
            foreign = file.read()
        damages = {
            'empty': '', 'cut': ''.join(lines[:-1]), 'cut in the middle': whole[:len(whole) // 2],
            'a digit changed': whole.replace('1', '2', 1), 'a line gone': ''.join(lines[:5] + lines[6:]),
            'something added': whole + 'name: other\n', 'a scene': foreign, 'no text': '\0\xff' * 1000
        }
        for what, text in damages.items():
            with self.subTest(what):
                with open(self.file, 'w') as file:
                    file.write(text)
                with Node(self.file, resume=True) as node:
                    self.assert_usual_scene(node, 'not resumed: ' + self.file, 'loaded \'small\' instead')

    def test_resume_without_a_state_loads_the_usual_scene_and_says_so(self):
        for file, where in ((self.file, 'in ' + self.file), ('none', '~state_file is none')):
            with Node(file, resume=True) as node:
                self.assert_usual_scene(node, 'no saved session', where + ': \'small\' starts anew')
                self.assertNotIn('ERROR', node.said())

    def test_where_nothing_can_be_written_the_reason_is_told_and_the_node_ends(self):
        with open(os.path.join(self.folder, 'states'), 'w') as file:
            file.write('where the folder should be')
        with Node(self.file) as node:
            call('step', n=1)
            self.assertEqual(node.end(signal.SIGTERM), 0)
            self.assertIn('the state was not saved: ', node.said())
            self.assertIn(self.folder, node.said())

    def test_none_keeps_nothing(self):
        with Node('none') as node:
            call('clear')
            node.end(signal.SIGTERM)
            self.assertNotIn('saved', node.said())

    def test_a_relative_path_is_refused(self):
        node = Node('sim.yaml')
        self.addCleanup(node.__exit__)
        self.assertEqual(node.process.wait(60), 1)
        self.assertIn('~state_file', node.said())


if __name__ == '__main__':
    rospy.init_node('resume_test')
    rostest.rosrun('rigid_body_sim', 'resume', ResumeTest)
