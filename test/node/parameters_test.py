#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Arguments and parameters of the node: what is refused, what is told, and what starts no node at all."""
import os
import signal
import subprocess
import sys
import unittest

import roslib.packages
import rosgraph
import rospy
import rostest
import yaml

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, call, wait  # noqa: E402

NODE = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]


def answer(*arguments):
    return subprocess.run([NODE, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60,
                          check=False)


def fault_of(name, value, allowed):
    """Empty if this value of a parameter is refused, with its name, the value and what is allowed."""
    done = answer('__name:=refused', '_scene:=' + SMALL, '_%s:=%s' % (name, value))
    rospy.delete_param('/refused')
    told = done.returncode == 1 and '~' + name in done.stdout and value in done.stdout and allowed in done.stdout
    return '' if told else '~%s %s: %d, %s' % (name, value, done.returncode, done.stdout)


class ParametersTest(unittest.TestCase):
    def serves(self):
        """Whether the simulator that this test was started with is still there."""
        return call('list_bodies').names == ['floor', 'crate', 'ball']

    def test_asking_for_help_starts_no_node(self):
        done = answer('--help')
        self.assertEqual(done.returncode, 0)
        for name in ('~scene', '~fidelity', '~tf_prefix', 'preview, interactive, accurate or reference'):
            self.assertIn(name, done.stdout)
        self.assertEqual((answer('-h').stdout, answer('--help', '__name:=sim').stdout), (done.stdout, done.stdout))
        self.assertRegex(answer('--version').stdout, r'^rigid_body_sim \d+\.\d+\.\d+\n$')
        self.assertTrue(self.serves())

    def test_unknown_arguments_are_refused_before_a_node_starts(self):
        for wrong in (['--hlp'], ['tower'], ['scene=tower'], ['--help', 'me'], ['--version', '_seed:=1', 'x']):
            done = answer(*wrong)
            self.assertEqual(done.returncode, 2, wrong)
            self.assertIn('--help', done.stdout)
        self.assertTrue(self.serves())

    def test_every_parameter_has_a_type_and_a_range(self):
        wrong = [('seed', 'abc', 'whole number'), ('seed', '-2', '-1 to 2147483647'), ('seed', '1.5', 'whole number'),
                 ('speed', 'fast', 'a number from 0'), ('speed', '-1', 'a number from 0'), ('speed', '1e+07', '1e+06'),
                 ('paused', 'maybe', 'true or false'), ('paused', '1', 'true or false'),
                 ('publish_clock', 'no', 'true or false'), ('status_line', '0', 'true or false'),
                 ('threads', '-1', 'a whole number from 0 to 256'), ('threads', '10000', 'a whole number from 0 to 256'),
                 ('fidelity', 'best', 'preview, interactive, accurate or reference'), ('fidelity', '3', 'preview'),
                 ('tf', 'some', 'all or none'), ('tf', 'true', 'all or none'), ('tf_prefix', '7', 'a text'),
                 ('diagnostic_period', '1e+10', '0.01 to 1e+06'), ('diagnostic_period', '0', '0.01 to 1e+06'),
                 ('scenes', '5', 'a text'), ('scene', '3', 'a text')]
        self.assertEqual([fault for fault in (fault_of(*case) for case in wrong) if fault], [])

    def test_a_relative_scene_is_refused_with_the_folder_that_it_begins_in(self):
        done = answer('__name:=refused', '_scene:=./nowhere.yaml')
        rospy.delete_param('/refused')
        self.assertEqual(done.returncode, 1)
        self.assertIn('./nowhere.yaml: no such file', done.stdout)
        self.assertIn('a relative path begins in ' + os.getcwd(), done.stdout)

    def test_a_period_that_no_clock_holds_does_not_end_the_node(self):
        rospy.set_param('/sim/diagnostic_period', 1e10)
        wait(lambda: rospy.get_param('/sim/diagnostic_period') == 1.0, 'the period is set back')
        self.assertTrue(self.serves())

    def test_all_faults_are_told_at_once_and_long_ones_are_cut(self):
        done = answer('__name:=refused', '_seed:=' + 'x' * 10000, '_tf:=some')
        rospy.delete_param('/refused')
        self.assertIn('~seed', done.stdout)
        self.assertIn('~tf', done.stdout)
        self.assertLess(len(done.stdout), 1000)

    def test_unknown_parameters_are_told_with_the_nearest_name(self):
        node = subprocess.Popen([NODE, '__name:=unknown', '_scene:=' + SMALL, '_publish_clock:=false', '_sede:=5',
                                 '_zzzzzzzzzzzz:=5'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        master = rosgraph.Master('/parameters_test')
        wait(lambda: any(name == '/unknown/list_bodies' for name, _ in master.getSystemState()[2]), 'the node is there')
        node.send_signal(signal.SIGINT)
        said = node.communicate(timeout=60)[0]
        rospy.delete_param('/unknown')
        self.assertEqual(node.returncode, 0)
        self.assertIn('unknown parameter ~sede (5) has no effect; did you mean ~seed?', said)
        self.assertIn('unknown parameter ~zzzzzzzzzzzz (5) has no effect; parameters: scene,', said)
        self.assertEqual(said.count('unknown parameter'), 2)

    def test_the_launch_file_takes_paths_as_the_shell_does_and_numbers_as_texts(self):
        for given, wanted in (('tower', 'tower'), ('5', '5'), ('/a/b.yaml', '/a/b.yaml'), ('~/my scene.yaml', '/home/me/my scene.yaml'),
                              ('b.yaml', '/here/b.yaml'), ('./b', '/here/./b'), ('../b.yaml', '/here/../b.yaml')):
            dumped = subprocess.run(['roslaunch', '--dump-params', 'rigid_body_sim', 'sim.launch', 'gui:=false', 'scene:=' + given,
                                     'world_frame:=5', 'tf_prefix:=7'], env=dict(os.environ, HOME='/home/me', PWD='/here'),
                                    stdout=subprocess.PIPE, text=True, timeout=60, check=True).stdout
            parameters = yaml.safe_load(dumped)
            self.assertEqual([parameters['/sim/' + name] for name in ('scene', 'world_frame', 'tf_prefix')], [wanted, '5', '7'])

    def test_a_recording_has_any_name(self):
        for given, wanted in (('', ''), ("it's.bag", "/here/it's.bag"), ('/a b/"c"\\ü.bag', '/a b/"c"\\ü.bag'), ('~/x.bag', '~/x.bag')):
            printed = subprocess.run(['roslaunch', '--args', 'record', 'rigid_body_sim', 'record.launch', 'file:=' + given],
                                     env=dict(os.environ, PWD='/here'), stdout=subprocess.PIPE, text=True, timeout=60, check=True).stdout
            self.assertIn(' --simulator /sim --file %s __name' % wanted, printed)

    def test_a_simulator_without_a_clock_leaves_the_time_of_the_others_alone(self):
        launch = subprocess.Popen(['roslaunch', 'rigid_body_sim', 'sim.launch', 'gui:=false', 'scene:=' + SMALL, 'use_sim_time:=false',
                                   'tf_prefix:=other/'], env=dict(os.environ, ROS_NAMESPACE='other'), start_new_session=True)
        self.addCleanup(launch.wait)
        self.addCleanup(launch.send_signal, signal.SIGINT)
        rospy.wait_for_service('/other/sim/list_bodies', 60)
        self.assertIs(rospy.get_param('/use_sim_time'), True)


if __name__ == '__main__':
    rospy.init_node('parameters_test')
    rostest.rosrun('rigid_body_sim', 'parameters', ParametersTest)
