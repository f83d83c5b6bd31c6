#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The command-line client: what it prints, and its exit codes."""
import contextlib
import importlib.util
import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from importlib.machinery import SourceFileLoader
from unittest import mock

import rosgraph
import roslib.packages
import rospy
import rostest
from rigid_body_sim.msg import Status

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import PATIENCE, SMALL, body, call, wait  # noqa: E402

RBS = roslib.packages.find_node('rigid_body_sim', 'rbs')[0]


def rbs(*arguments, cwd=None, **environment):
    given = [a if isinstance(a, bytes) else str(a) for a in arguments]
    return subprocess.run([RBS, *given], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60, cwd=cwd,
                          env=dict(os.environ, **environment))


def program():
    """The client as a module."""
    loader = SourceFileLoader('rbs', roslib.packages.get_pkg_dir('rigid_body_sim') + '/src/tools/rbs')
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader('rbs', loader))
    loader.exec_module(module)
    return module


class NodeThatHangs:
    """What a simulator looks like that takes calls and never answers: its services, as the master knows them."""
    name = '/hangs'

    def __init__(self):
        self.server = socket.create_server(('localhost', 0))
        self.server.settimeout(PATIENCE)
        self.uri = 'rosrpc://localhost:%d' % self.server.getsockname()[1]
        self.services = [self.name + '/' + service for service in ('list_bodies', 'step', 'load_scene', 'measure_accuracy')]
        self.master = rosgraph.Master(self.name)
        for service in self.services:
            self.master.registerService(service, self.uri, 'http://localhost:1')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
        self.forget()

    def close(self):
        self.server.close()

    def forget(self):
        for service in self.services:
            self.master.unregisterService(service, self.uri)


class ClientTest(unittest.TestCase):
    def setUp(self):
        call('pause')
        call('load_scene', name=SMALL)

    def done(self, *arguments):
        result = rbs(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    @staticmethod
    def time():
        """Of the simulation, s."""
        return rospy.wait_for_message('/sim/status', Status, PATIENCE).time

    def test_bodies_are_listed_made_moved_and_deleted(self):
        self.assertEqual(self.done('list').split(), ['floor', 'crate', 'ball'])
        self.done('spawn', '--name', 'top', '--shape', 'sphere', '--size', 0.2, '--at', 0, 1, 2, '--friction', 0)
        self.assertEqual(body('top').description.material.friction, (0.0, ))
        self.done('move', 'top', '--at', 0, -1, 3)
        self.assertEqual(body('top').pose.position.y, -1.0)
        self.done('resize', 'top', '--factor', 2)
        self.assertAlmostEqual(body('top').description.size.x, 0.4)
        self.done('set', 'top', '--mass', 2, '--velocity', 1, 0, 0)
        self.assertAlmostEqual(body('top').description.mass, 2.0)
        self.done('push', 'top', 2, 0, 0)
        self.assertAlmostEqual(body('top').twist.linear.x, 2.0)
        self.done('delete', 'top')
        self.assertNotIn('top', self.done('list'))

    def test_many_bodies_are_duplicated_and_deleted_as_one_edit_and_one_is_renamed(self):
        self.done('rename', 'crate', 'box')
        self.assertEqual(self.done('list').split(), ['floor', 'box', 'ball'])
        self.assertEqual(rbs('rename', 'box', 'ball').returncode, 1)
        copies = self.done('duplicate', 'box', 'ball', '--count', 2, '--offset', 0, 2, 0).split()
        self.assertEqual(len(copies), 4)
        place = body(copies[1]).pose.position.y - body('box').pose.position.y
        self.assertAlmostEqual(place, 4.0)
        self.done('delete', *copies)
        self.assertEqual(self.done('list').split(), ['floor', 'box', 'ball'])
        self.done('undo')
        self.assertEqual(len(self.done('list').split()), 7)
        self.assertEqual(rbs('delete', 'box', 'nobody').returncode, 1)
        self.assertEqual(rbs('delete').returncode, 2)
        self.assertIn('box', self.done('list'))

    def test_effects_are_forced_and_detected_again(self):
        self.assertIn('forced off: friction', self.done('effects', '--off', 'friction'))
        self.assertIn('contacts.friction', self.done('status'))
        self.assertIn('all effects are detected', self.done('effects', '--auto', 'friction'))
        self.assertNotEqual(rbs('effects', '--off', 'magnetism').returncode, 0)

    def test_a_scene_file_is_explained_without_running_it(self):
        explain = roslib.packages.find_node('rigid_body_sim', 'explain')[0]

        def run(*arguments):
            return subprocess.run([explain, *arguments], capture_output=True, text=True, timeout=60)

        text = run(SMALL).stdout
        self.assertIn('forces.gravity', text)
        self.assertIn('9.81 m/s^2 on 2 bodies', text)
        stages = {stage['name']: stage for stage in json.loads(run(SMALL, '--json').stdout)['stages']}
        self.assertFalse(stages['forces.drag']['active'])
        self.assertIn('air', stages['forces.drag']['reason'])
        answer = json.loads(run('windy_day', '--json', '--steps', '3', '--off', 'drag').stdout)
        stages = {stage['name']: stage for stage in answer['stages']}
        self.assertIn('forced off', stages['forces.drag']['reason'])
        self.assertGreater(stages['islands.advance']['seconds_per_step'], 0.0)
        self.assertGreater(answer['cpu_seconds_per_step'], 0.0)
        self.assertNotIn('cpu_seconds_per_step', json.loads(run(SMALL, '--json').stdout))
        self.assertIn('of CPU time in a run that reads nothing', run(SMALL, '--steps', '3').stdout)
        self.assertIn('without drag: in 0.25', answer['neglected'][0])
        for wrong in (['nowhere'], [SMALL, '--on', 'magnetism'], [SMALL, '--fidelity', 'best'], []):
            refused = run(*wrong)
            self.assertEqual(refused.returncode, 2, wrong)

    def test_questions_are_answered(self):
        self.done('move', 'ball', '--at', 0, 0, 5)
        ray = ('ray', '--from', 0, 0, 9, '--along', 0, 0, -1)
        self.assertEqual(self.done(*ray).split()[0], 'ball')
        self.assertEqual([line.split()[0] for line in self.done(*ray, '--all', '--ignore', 'crate').splitlines()],
                         ['ball', 'floor'])
        self.assertIn('nothing', self.done(*ray, '--max', 1))
        hits = json.loads(self.done('--json', *ray))['hits']
        self.assertAlmostEqual(hits[0]['distance'] + body('ball').description.size.x / 2, 4.0)
        self.assertIn('apart', self.done('closest', 'ball', 'floor'))
        self.assertLess(json.loads(self.done('--json', 'closest', 'ball', 'floor'))['normal']['z'], 0.0)
        self.assertEqual(self.done('overlaps', '--at', 0, 0, 5, '--size', 0.1).split()[0], 'ball')
        self.assertIn('no body', self.done('overlaps', '--at', 0, 0, 50))
        corner = ('--points', 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
        self.assertEqual(self.done('overlaps', '--at', 0, 0, 5, *corner).split()[0], 'ball')
        self.assertEqual(rbs('ray', '--from', 0, 0, 0, '--along', 0, 0, 0).returncode, 1)

    def test_hulls_are_made_of_points_and_meshes(self):
        self.done('spawn', '--name', 'corner', '--points', 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1, '--scale', 2)
        self.assertAlmostEqual(body('corner').description.mass, 1000 * 8 / 6)
        mesh = os.path.join(os.path.dirname(SMALL), '..', '..', 'scenes', 'meshes', 'dodecahedron.obj')
        self.done('spawn', '--name', 'gem', '--mesh', os.path.relpath(mesh))
        self.assertEqual(len(body('gem').description.vertices), 20)
        self.assertNotEqual(rbs('spawn', '--points', 0, 0, 0, 1).returncode, 0)

    def test_time_is_steered(self):
        self.assertAlmostEqual(json.loads(self.done('--json', 'step', 60))['time'], 1.0)
        self.done('reset')
        self.assertEqual(json.loads(self.done('--json', 'status'))['steps'], 0)
        self.assertIn("undone: reset 'small'", self.done('undo'))
        self.assertEqual(json.loads(self.done('--json', 'status'))['steps'], 60)
        self.done('redo')
        self.assertEqual(json.loads(self.done('--json', 'status'))['steps'], 0)

    def test_the_status_says_that_a_reference_run_is_drawn(self):
        self.assertNotIn('reference run', self.done('status'))
        self.done('ghost', 'on')
        wait(lambda: 'reference run: drawn' in self.done('status'), 'the status says so')
        self.done('ghost', 'off')
        wait(lambda: 'reference run' not in self.done('status'), 'it is gone')

    def test_answers_come_as_json(self):
        answer = json.loads(self.done('--json', 'get', 'crate'))
        self.assertEqual(answer['body']['description']['name'], 'crate')

    def test_general_options_stand_before_a_command_or_after_it(self):
        node = '--json --node sim_rare --timeout 50'.split()
        self.assertEqual(self.done(*node, 'list'), self.done('list', *node))
        self.assertEqual(self.done(*node, 'list'), self.done(*node[:3], 'list', *node[3:]))
        self.assertEqual(rbs('--node', 'nowhere', 'list', '--timeout', 0.1).returncode, 3)

    def test_numbers_below_zero_are_taken_in_every_notation(self):
        self.assertIn('(-0.001, -0.5, -50) m/s^2', self.done('gravity', '-1e-3', '-.5', '-5e1'))
        self.assertIn('(-20, -0.05, -1) m', self.done('move', 'ball', '--at', '-2E1', '-.5e-1', '-1.'))
        self.done('set', 'ball', '--spin', '-1e-3', '-1e+0', '-0e0', '--velocity', '-1e1', '0', '0')
        self.done('push', 'ball', '-1e0', '-1e0', '-1e0', '--point', '-1e-3', '0', '0')
        self.assertEqual(rbs('speed', '-1e0').returncode, 1)
        self.assertIn('finite', rbs('push', 'ball', '-inf', 0, 0).stderr)

    def test_people_read_six_digits_and_programs_all(self):
        self.done('set', 'ball', '--mass', 64 / 3)
        self.assertIn('mass: 21.3333\n', self.done('get', 'ball'))
        self.assertAlmostEqual(json.loads(self.done('get', 'ball', '--json'))['body']['description']['mass'], 64 / 3, 12)

    def test_lengths_have_a_unit_that_suits_them(self):
        for metres, text in ((2.0, '2 m'), (0.0031, '3.1 mm'), (2e-6, '2 um'), (3e-9, '3 nm'), (2.8e-14, '2.8e-14 m'), (0.0, '0 m')):
            self.assertEqual(program().length(metres), text)

    def test_a_refusal_is_exit_code_1_and_says_why(self):
        result = rbs('load', 'towr')
        self.assertEqual(result.returncode, 1)
        self.assertIn('tower', result.stderr)
        self.assertEqual(result.stdout, '')

    def test_bad_arguments_are_exit_code_2(self):
        self.assertEqual(rbs('fly').returncode, 2)
        self.assertEqual(rbs('move', 'crate').returncode, 2)

    def test_absurd_arguments_are_refused_without_a_traceback(self):
        for expected, arguments in [
            (2, ['step', '--', '-1']), (2, ['step', 5000000000]), (2, ['step', 2000000]), (2, ['step', '1.5']),
            (2, ['step', 'x']), (2, ['spawn', '--size', 1, 2]), (2, ['spawn', '--points', 1, 2]),
            (2, ['tune', '--divisions', -1]), (2, ['tune', '--sub-steps', 1e9]), (2, ['tune', '--divisions', 2 ** 32]),
            (1, ['tune', '--divisions', 2 ** 32 - 1]), (2, ['accuracy', '--windows', -5]), (2, ['accuracy', '--windows', 1001]), (2, ['spawn', '--group', 2 ** 32]),
            (1, ['speed', 'nan']), (1, ['speed', '--', '-1']), (1, ['speed', 'inf']), (1, ['speed', '1e999']),
            (1, ['push', 'ball', 'nan', 0, 0]), (1, ['gravity', '1e300', 0, 0]), (1, ['wrench', 'ball', '--seconds', 'nan']),
            (1, ['move', 'ball', '--at', 'inf', 0, 0]), (1, ['spawn', '--mass', 'nan']), (2, ['spawn', '--yaw', 'inf']),
            (2, ['spawn', '--yaw', 30]), (2, ['spawn', '--size', 0]),
            (1, ['resize', 'ball', '--factor=-inf']), (1, ['tune', '--tolerance', 'nan']), (1, ['set-wind', 'nan', 0, 0]),
            (1, ['ray', '--from', 0, 0, 'nan', '--along', 0, 0, 1]), (1, ['overlaps', '--at', 0, 0, 0, '--margin', 'nan']),
            (1, ['seek', '--max-error', 'nan']), (1, ['get', 'x' * 100000]), (1, ['spawn', '--name', 'a b']),
            (2, ['--timeout', 'nan', 'list']), (2, ['--timeout', '-1', 'list']), (2, ['get', b'\xff']), (2, []),
            (2, ['step', 0]), (2, ['duplicate', 'ball', '--count', 0]), (2, ['set', 'ball', '--mass', 0]),
            (2, ['resize', 'ball', '--factor', 0.0]), (2, ['seek']), (2, ['apply']), (2, ['seek', '--max-error', 0]),
            (2, ['spawn', '--kind', 'flying']), (1, ['set', 'ball']), (1, ['load-state', '/dev/null']),
        ]:
            result = rbs(*arguments)
            self.assertEqual(result.returncode, expected, '%s: %s' % (arguments, result.stderr))
            self.assertNotIn('Traceback', result.stderr, arguments)
            self.assertTrue(0 < len(result.stderr) < 3000, arguments)

    def test_paths_are_those_of_the_shell(self):
        with tempfile.TemporaryDirectory() as folder:
            def there(*arguments):
                result = rbs(*arguments, cwd=folder)
                self.assertEqual(result.returncode, 0, result.stderr)

            there('save-scene', 'scene')
            there('save-state', './state.yaml')
            self.assertEqual(sorted(os.listdir(folder)), ['scene.yaml', 'state.yaml'])
            there('load', 'scene.yaml')
            there('load', '../%s/scene.yaml' % os.path.basename(folder))
            there('load', './scene')
            self.assertNotIn('load_state', rbs('load', './scene', cwd=folder).stdout)
            for command in (('load', './state'), ('load-with-seed', './state', 3)):
                self.assertIn('load_state', rbs(*command, cwd=folder).stdout)
            there('load-state', 'state')
            self.assertEqual(rbs('save-scene', 'scene', cwd=folder).returncode, 1)
            there('save-scene', 'scene', '--overwrite')
            there('save-state', 'scene', '--overwrite')
            self.assertEqual(rbs('save-scene', '.', cwd=folder).returncode, 1)
            self.assertEqual(rbs('load', 'scene', cwd=folder).returncode, 1)  # a name of the catalogue

    def test_kinds_and_collision_groups_are_given(self):
        self.done('spawn', '--name', 'belt', '--kind', 'kinematic', '--velocity', 1, 0, 0, '--at', 0, 5, 3, '--group', '0x4',
                  '--mask', 3)
        belt = body('belt').description
        self.assertEqual((belt.kind, belt.collision_group, belt.collision_mask), ('kinematic', 4, 3))
        self.done('set', 'belt', '--kind', 'dynamic', '--group', 1, '--mask', '0xffffffff')
        belt = body('belt').description
        self.assertEqual((belt.kind, belt.collision_group, belt.collision_mask), ('dynamic', 1, 0xffffffff))
        self.done('set', 'belt', '--static', 'yes')
        self.assertEqual(body('belt').description.kind, 'static')

    def test_colors_are_given(self):
        def shown(name):
            color = body(name).description.color
            return [round(value, 6) for value in (color.r, color.g, color.b, color.a)]

        self.done('spawn', '--name', 'black', '--color', 0, 0, 0)
        self.assertEqual(shown('black'), [0, 0, 0, 1])
        self.done('set', 'black', '--color', 1, 0.5, 0.25)
        self.assertEqual(shown('black'), [1, 0.5, 0.25, 1])
        self.done('set', 'black', '--mass', 2)
        self.assertEqual(shown('black'), [1, 0.5, 0.25, 1])
        self.assertIn('blue from 0 to 1', rbs('set', 'black', '--color', 0, 0, 2).stderr)

    def test_options_that_contradict_each_other_are_named_together(self):
        for command, one, other in (('set ball', '--kind dynamic', '--static yes'), ('spawn', '--kind dynamic', '--static'),
                                    ('seek', '--max-error 1', '--max-step-ms 1'), ('apply', '--max-error 1', '--max-step-ms 1')):
            for given in ((one, other), (other, one)):
                result = rbs(*' '.join((command, *given)).split())
                self.assertEqual(result.returncode, 2, result.stderr)
                for option in (one, other):
                    self.assertIn(option.split()[0], result.stderr.splitlines()[-1])

    def test_the_help_of_effects_names_them_all(self):
        text = self.done('effects', '--help')
        names = rbs('effects', '--on', 'magnetism').stderr.split('allowed:')[1].strip(' )\n').split(', ')
        self.assertGreater(len(names), 5)
        for name in names:
            self.assertIn(name, text)
        self.assertEqual(re.sub(r'\s+', ' ', text).split('one of: ')[1].rstrip('. '), ', '.join(names))

    def test_a_reader_that_has_read_enough_is_no_error(self):
        for command in ('status', 'scenes', 'list', '--json status', '--help'):
            line = 'set -o pipefail; "%s" %s | true' % (RBS, command)
            result = subprocess.run(['bash', '-c', line], capture_output=True, text=True, timeout=60)
            self.assertEqual((result.returncode, result.stderr), (0, ''), command)

    def test_ctrl_c_ends_it_whatever_the_node_does(self):
        with NodeThatHangs() as node:
            for command in (['list'], ['step', '5'], ['load', 'tower'], ['accuracy']):
                process = subprocess.Popen([RBS, '--node', node.name, '--timeout', '100', *command], stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                calls = [node.server.accept()[0] for _ in range(2)]  # the first only asks whether anybody is there
                process.send_signal(signal.SIGINT)
                _, errors = process.communicate(timeout=20)
                said = 'rbs: interrupted: the steps may go on until rbs pause\n' if command[0] == 'step' else ''
                self.assertEqual((process.returncode, errors), (130, said), command)
                for connection in calls:
                    connection.close()

    def test_ctrl_c_ends_the_steps_that_were_asked_for(self):
        before = self.time()
        process = subprocess.Popen([RBS, 'step', '1000000'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait(lambda: self.time() > before, 'the steps are taken')
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130)
        self.assertIn('interrupted: paused at ', errors)
        self.assertEqual(self.time(), self.time())
        self.done('step')

    def test_an_answer_that_cannot_be_written_is_no_missing_simulator(self):
        with open('/dev/full', 'w') as full:
            result = subprocess.run([RBS, 'list'], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual((result.returncode, result.stderr), (1, 'rbs: cannot write the answer: No space left on device\n'))

    def test_a_node_that_gives_no_sign_of_life_is_exit_code_3(self):
        with NodeThatHangs() as node:
            for command in (['list'], ['step', '5'], ['load', 'tower'], ['accuracy']):
                begin = time.monotonic()
                result = rbs('--node', node.name, '--timeout', 0.5, *command)
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertIn('has neither answered nor sent a status for ', result.stderr)
                self.assertLess(time.monotonic() - begin, 30)

    def test_a_node_that_works_is_waited_for(self):
        before = self.time()
        process = subprocess.Popen([RBS, '--timeout', '2', 'step', '1000000'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        wait(lambda: self.time() > before, 'the steps are taken')
        time.sleep(6)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130)

    def test_a_node_that_was_killed_is_exit_code_3(self):
        node = NodeThatHangs()
        node.close()  # and is still known to the master
        for command in (['list'], ['status'], ['accuracy']):
            result = rbs('--node', node.name, '--timeout', 0.5, *command)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertNotIn('Traceback', result.stderr)
        node.forget()

    def test_no_simulator_is_exit_code_3_and_says_which_there_are_or_how_to_start_one(self):
        for command in ('list', 'status'):
            result = rbs('--node', 'nowhere', '--timeout', 0.5, command)
            self.assertEqual(result.returncode, 3)
            self.assertIn('/sim, /sim_rare. Choose one with --node', result.stderr)
        for command in ('list', 'status'):  # and no master either
            result = rbs('--timeout', 0.5, command, ROS_MASTER_URI='http://localhost:1')
            self.assertEqual(result.returncode, 3)
            self.assertIn('roslaunch', result.stderr)
        for uri in ('nonsense', 'http://', 'http://nowhere.invalid:11311'):
            result = rbs('--timeout', 0.5, 'list', ROS_MASTER_URI=uri)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertNotIn('Traceback', result.stderr)
        for node in ('a b', '//', 'caf\xe9', ''):
            result = rbs('--node', node, '--timeout', 0.5, 'list')
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertNotIn('Traceback', result.stderr)

    def test_the_help_gives_units(self):
        for command, unit in (('push', 'N s'), ('spawn', 'kg/m3'), ('gravity', 'm/s2')):
            self.assertIn(unit, self.done(command, '--help'))

    def test_the_help_names_the_numbers_of_a_tuple(self):
        client = program()
        for command in re.findall(r'^    (\S+)', self.done('--help').split('COMMAND\n')[1], re.MULTILINE):
            with mock.patch('sys.argv', ['rbs', command, '--help']), contextlib.redirect_stdout(io.StringIO()) as text:
                self.assertRaises(SystemExit, client.arguments)
            self.assertNotRegex(text.getvalue(), r'\b(\w+) \1\b', command)
            if command in ('push', 'gravity', 'set-wind'):
                self.assertIn(' X Y Z\n', text.getvalue())


if __name__ == '__main__':
    rospy.init_node('client_test')
    rostest.rosrun('rigid_body_sim', 'client', ClientTest)
