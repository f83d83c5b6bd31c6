#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What accuracy costs: measured beside the running simulation, estimated live, applied, sought, and shown."""
import json
import math
import os
import signal
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from rigid_body_sim.msg import AccuracyStudy, BodyChange, BodyDetails
from visualization_msgs.msg import Marker, MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, Listener, StatusListener, ask, body, call, wait  # noqa: E402


def at(x, y, z):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))


def push_the_crate():
    """Something for settings to differ about: a box that slides."""
    call('load_scene', name=SMALL)
    call('set_body', name='crate', twist=[Twist(Vector3(-5, 0, 0), Vector3())])


class AccuracyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.status = StatusListener()
        cls.studies = Listener('/sim/accuracy', AccuracyStudy)
        cls.ghost = Listener('/sim/ghost', MarkerArray)

    def setUp(self):
        call('pause')
        push_the_crate()

    def measured(self, **request):
        job = call('measure_accuracy', **request).job
        return wait(lambda: next((s for s in self.studies.all() if s.job == job and s.done), None), 'the study is done')

    def test_the_running_scene_is_measured_and_goes_on_meanwhile(self):
        before = self.status.fresh().hash
        call('resume')
        study = self.measured(seconds=1.0, windows=2)
        self.assertGreater(self.status.fresh().steps, 0)
        call('pause')
        self.assertNotEqual(self.status.fresh().hash, before)
        self.assertEqual(study.trouble, '')
        self.assertTrue(study.complete)
        self.assertEqual(study.windows, 2)
        self.assertLessEqual(study.shortest, study.window)
        self.assertAlmostEqual(study.window, 0.25)
        costs = {cost.name: cost for cost in study.settings}
        for name in ('preview', 'interactive', 'accurate', 'reference'):
            self.assertGreater(costs[name].step_ms, 0.0)
        self.assertGreater(costs['preview'].error, 10 * costs['accurate'].error)
        self.assertGreaterEqual(costs['preview'].worst_error, costs['preview'].error)

    def test_a_measured_setting_is_applied(self):
        refused = ask('apply_accuracy', max_error=1e-3, max_step_ms=1.0)
        self.assertFalse(refused.success)
        self.assertIn('both max_error and max_step_ms (allowed: exactly one of them)', refused.message)
        self.assertIn('neither max_error nor max_step_ms', ask('apply_accuracy').message)
        study = self.measured(seconds=0.5, windows=1)
        within = [cost for cost in study.settings if cost.error <= 1e-3]
        cheapest = min(within, key=lambda cost: cost.step_ms)
        self.assertEqual(call('apply_accuracy', max_error=1e-3).fidelity, cheapest.name)
        self.assertEqual(self.status.fresh().fidelity, cheapest.name)
        self.assertIn('none of the measured solver settings has at most', ask('apply_accuracy', max_step_ms=1e-9).message)

    def test_the_velocity_of_a_conveyor_is_of_the_scene(self):
        call('edit_bodies', changes=[BodyChange(name='floor', kind='kinematic')])
        self.measured(seconds=0.5, windows=1)
        call('edit_bodies', changes=[BodyChange(name='crate', twist=[Twist(linear=Vector3(1, 0, 0))])])
        self.assertTrue(ask('apply_accuracy', max_error=1e3).success)  # of a dynamic body it is a state
        call('edit_bodies', changes=[BodyChange(name='floor', twist=[Twist(linear=Vector3(8, 0, 0))])])
        self.assertIn("the velocity of 'floor' was changed", ask('apply_accuracy', max_error=1e3).message)
        call('undo')
        self.assertTrue(ask('apply_accuracy', max_error=1e3).success)

    def test_what_was_measured_does_not_outlive_its_scene(self):
        study = self.measured(seconds=0.5, windows=1)
        self.assertEqual((study.scene, study.stale), ('small', ''))

        def stale_when(word):
            return wait(lambda: word in self.studies.all()[-1].stale, '~accuracy tells of ' + word)

        def holds():
            wait(lambda: self.studies.all()[-1].stale == '', 'it holds')
            self.assertTrue(ask('apply_accuracy', max_error=1e3).success)

        def refused(word):
            before = self.status.fresh().fidelity
            self.assertIn(word, ask('apply_accuracy', max_error=1e3).message)
            self.assertEqual(self.status.fresh().fidelity, before)
            stale_when(word)

        call('step', n=5)
        call('move_body', name='crate', pose=at(0, 3, 0.25))
        call('set_fidelity', fidelity='preview')
        holds()  # states and the dial do not count
        call('edit_bodies', changes=[BodyChange(name='crate', collision_mask=[0])])
        refused("'crate' was changed")  # it falls through the floor
        call('undo')
        holds()
        call('load_scene', name='tower')
        refused("'tower' was loaded")
        late = Listener('/sim/accuracy', AccuracyStudy)
        wait(lambda: late.all() and 'tower' in late.all()[-1].stale, 'who comes late is told, too')
        call('load_scene', name=SMALL)
        holds()
        call('delete_body', name='crate')
        refused("'crate' was deleted")
        call('reset')
        holds()
        call('set_gravity', gravity=Vector3(0, 0, -1.6))
        refused('gravity was changed')
        call('reset')
        call('resize_body', name='crate', factor=2.0)
        refused("'crate' was changed")
        call('reset')
        call('set_effects', force_off=['friction'])
        refused('the effects were changed')
        call('reset')
        holds()

    def test_a_measurement_can_be_stopped_and_replaced(self):
        call('measure_accuracy', seconds=1000.0, window=10.0, windows=1000, max_cpu_seconds=1000.0)
        second = call('measure_accuracy', seconds=1000.0, window=10.0, windows=1000, max_cpu_seconds=1000.0).job
        wait(lambda: any(s.job == second for s in self.studies.all()), 'the second one runs')
        self.assertIn('stopped', call('stop_accuracy').message)
        last = wait(lambda: next((s for s in self.studies.all() if s.job == second and s.done), None), 'it is done')
        self.assertFalse(last.complete)
        self.assertIn('no accuracy study', call('stop_accuracy').message)

    def test_what_makes_no_sense_is_refused(self):
        for request in (dict(seconds=-1.0), dict(window=float('nan')), dict(windows=1001), dict(max_cpu_seconds=-1.0)):
            self.assertIn('allowed', ask('measure_accuracy', **request).message)
        for service in ('seek_accuracy', 'apply_accuracy'):
            for request in (dict(), dict(max_error=-1.0), dict(max_error=float('nan')), dict(max_step_ms=-1.0)):
                self.assertFalse(ask(service, **request).success, request)
        before = self.status.fresh()
        for request in (dict(preset='exact'), dict(divisions=1001), dict(sub_steps=1001), dict(tolerance=-1e-6),
                        dict(tolerance=float('nan')), dict(tolerance=1.0)):
            self.assertFalse(ask('tune_fidelity', **request).success, request)
        after = self.status.fresh()
        self.assertEqual((before.fidelity, before.hash), (after.fidelity, after.hash))

    def test_the_dial_is_tuned_by_numbers(self):
        pose = body('crate').pose
        self.assertEqual(call('tune_fidelity', preset='preview', divisions=2, sub_steps=4).fidelity,
                         'preview, 2 divisions, 4 sub-steps')
        self.assertEqual(body('crate').pose, pose)
        self.assertEqual(self.status.fresh().fidelity, 'preview, 2 divisions, 4 sub-steps')
        call('step', n=3)
        self.assertEqual(call('tune_fidelity', tolerance=1e-4).fidelity, 'preview, tolerance 0.0001')

    def test_the_error_is_estimated_on_request(self):
        call('step', n=20)
        self.assertEqual(len(self.status.fresh().estimate), 0)
        self.assertFalse(self.status.fresh().estimates_error)
        call('estimate_error', data=True)
        self.assertTrue(self.status.fresh().estimates_error)
        call('step', n=20)
        estimate, = self.status.fresh().estimate
        self.assertEqual((estimate.fidelity, estimate.beside), ('interactive', 'interactive, 2 divisions'))
        self.assertGreater(estimate.distance, 0.0)
        self.assertGreater(estimate.beside_ms, 0.0)
        call('load_scene', name=SMALL)
        self.assertTrue(self.status.fresh().estimates_error)  # another scene does not change it
        call('estimate_error', data=False)
        self.assertFalse(self.status.fresh().estimates_error)
        call('step', n=1)
        self.assertEqual(len(self.status.fresh().estimate), 0)

    def test_a_goal_turns_the_dial_and_says_why(self):
        call('set_fidelity', fidelity='preview')
        self.assertIn('beginning with preview', call('seek_accuracy', max_error=1e-6).message)
        call('step', n=60)
        status = self.status.fresh()
        self.assertEqual(status.fidelity, 'interactive')  # which solves what slides alone exactly
        self.assertRegex(status.dial_reason, '^interactive: preview.* has an error of .* mm/s, which is above')
        self.assertEqual(status.max_error, 1e-6)
        call('set_fidelity', fidelity='preview')
        self.assertEqual(self.status.fresh().max_error, 0.0)
        self.assertEqual(self.status.fresh().dial_reason, '')  # it was that of the goal
        call('step', n=60)
        self.assertEqual(self.status.fresh().fidelity, 'preview')
        call('seek_accuracy', max_error=1e-6)
        call('step', n=60)
        self.assertNotEqual(self.status.fresh().dial_reason, '')
        call('load_scene', name=SMALL)
        self.assertEqual(self.status.fresh().dial_reason, '')

    def test_the_ghost_is_the_reference_run(self):
        call('set_fidelity', fidelity='preview')
        call('show_ghost', data=True)
        self.addCleanup(call, 'show_ghost', data=False)
        names = {(m.ns, m.id): m for a in [self.ghost.next('the ghost is there')] for m in a.markers}
        self.assertTrue(all(0.0 < m.color.a < 0.5 for m in names.values()))
        start = body('crate').pose.position.x
        call('step', n=30)
        # Exact: x = v t + mu g t^2 / 2.
        exact = start - 5 * 0.5 + 0.5 * 0.6 * 9.81 * 0.25

        def ghosts():
            return [m.pose.position for a in self.ghost.all() for m in a.markers if m.action == Marker.ADD]

        wait(lambda: any(abs(p.x - exact) < 2e-4 for p in ghosts()), 'the ghost is where the closed form says')
        self.assertGreater(abs(body('crate').pose.position.x - exact), 1e-3)
        call('move_body', name='crate', pose=at(0, 3, 0.25))
        wait(lambda: any(abs(p.y - 3.0) < 1e-3 for p in ghosts()), 'the ghost follows an edit')
        self.ghost.clear()
        call('show_ghost', data=False)
        wait(lambda: any(m.action == Marker.DELETE for a in self.ghost.all() for m in a.markers), 'the ghost is gone')

    def test_the_details_tell_how_far_each_body_is_from_the_ghost(self):
        call('set_fidelity', fidelity='preview')
        details = Listener('/sim/body_details', BodyDetails)
        self.addCleanup(details.subscriber.unregister)
        first = wait(details.all, 'the details come')[0]
        self.assertEqual((list(first.reference_distances), first.reference_age), ([], 0.0))
        call('show_ghost', data=True)
        self.addCleanup(call, 'show_ghost', data=False)
        start = body('crate').pose.position.x
        wait(lambda: details.all()[-1].reference_distances, 'the runs are compared')
        call('step', n=30)
        crate = body('crate')
        now = crate.pose.position
        exact = start - 5 * 0.5 + 0.5 * 0.6 * 9.81 * 0.25  # x = v t + mu g t^2 / 2
        error = math.dist((now.x, now.y, now.z), (exact, 0.0, 0.25))
        self.assertGreater(error, 1e-3)

        def distance(message):
            return dict(zip(message.ids, message.reference_distances)).get(crate.description.id, -1.0)

        wait(lambda: abs(distance(details.all()[-1]) - error) < 2e-4, 'the distance is that from the closed form')
        last = details.all()[-1]
        self.assertEqual(last.reference_age, 0.0)
        self.assertEqual(len(last.reference_distances), len(last.ids))
        self.assertEqual(min(last.reference_distances), 0.0)  # the floor
        call('move_body', name='crate', pose=at(0, 3, 0.25))
        wait(lambda: distance(details.all()[-1]) == 0.0, 'an edit begins anew')
        call('show_ghost', data=False)
        call('step', n=1)
        wait(lambda: not details.all()[-1].reference_distances, 'there is no reference run any more')

    def test_the_distances_come_also_where_the_ghost_is_behind(self):
        details = Listener('/sim/body_details', BodyDetails)
        self.addCleanup(details.subscriber.unregister)
        call('load_scene', name='kapla')
        call('show_ghost', data=True)
        self.addCleanup(call, 'show_ghost', data=False)
        wait(lambda: details.all() and details.all()[-1].reference_distances, 'the runs are compared')
        call('step', n=60)
        late = wait(lambda: [d for d in details.all() if d.reference_age > 0.0], 'it is late, but compared')
        self.assertTrue(all(d.reference_distances for d in late))
        call('load_scene', name=SMALL)

    def test_the_status_tells_how_far_the_ghost_is_behind(self):
        self.assertEqual(len(self.status.fresh().ghost_lag), 0)
        call('step', n=1)
        call('show_ghost', data=True)
        self.addCleanup(call, 'show_ghost', data=False)
        wait(lambda: list(self.status.fresh().ghost_lag) == [0.0], 'it is up to date')
        # Steps that are taken as fast as can be, of a scene that is dear at reference.
        call('load_scene', name='kapla')
        self.status.clear()
        call('step', n=100)
        told = wait(lambda: [status for status in self.status.all() if sum(status.ghost_lag) > 0.0], 'it falls behind')
        self.assertTrue(all(status.ghost_lag[0] <= status.time for status in told))
        call('load_scene', name=SMALL)
        wait(lambda: list(self.status.fresh().ghost_lag) == [0.0], 'it begins anew')
        call('show_ghost', data=False)
        self.assertEqual(len(self.status.fresh().ghost_lag), 0)

    def test_the_client_prints_the_cost_of_each_setting(self):
        client = roslib.packages.find_node('rigid_body_sim', 'rbs')[0]
        done = subprocess.run([client, 'accuracy', '--seconds', '0.5', '--windows', '1'], capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ('preview', 'interactive, 2 divisions', 'reference', 'ms a step'):
            self.assertIn(word, done.stdout)
        self.assertRegex(subprocess.run([client, 'apply', '--max-error', '0.01'], capture_output=True, text=True,
                                        timeout=60).stdout, '^solver settings')

    def test_a_scene_file_is_measured_without_a_node(self):
        program = roslib.packages.find_node('rigid_body_sim', 'scene_accuracy')[0]

        def run(*arguments):
            return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=120)

        done = run(SMALL, '--windows', '1', '--max-error', '0.001')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('Cheapest within 1 mm a second:', done.stdout)
        self.assertEqual(run('nowhere').returncode, 1)
        for option, value in (('windows', '0'), ('windows', '-4294967295'), ('windows', '1e30'), ('windows', '2.5'),
                              ('seconds', '-1'), ('seconds', 'nan'), ('window', 'inf'), ('window', '1e+300'),
                              ('max-seconds', '0'), ('max-seconds', '-inf'), ('from', '-1'), ('from', 'nan'),
                              ('max-error', '-1'), ('max-step-ms', 'x')):
            done = run(SMALL, '--%s=%s' % (option, value))
            self.assertEqual((done.returncode, done.stdout), (2, ''), (option, value))
            self.assertIn(value, done.stderr)
        self.assertEqual(run().returncode, 2)
        with open(SMALL, encoding='utf-8') as file:
            done = subprocess.run([program, '-', '--windows', '1'], stdin=file, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_ctrl_c_prints_what_is_known(self):
        program = roslib.packages.find_node('rigid_body_sim', 'scene_accuracy')[0]
        endless = ['--seconds', '1000', '--windows', '1000', '--max-seconds', '1000']
        running = subprocess.Popen([program, SMALL, '--progress'] + endless, stdout=subprocess.PIPE, text=True)
        while json.loads(running.stdout.readline())['study']['windows'] == 0:
            pass
        running.send_signal(signal.SIGINT)
        last = json.loads(running.communicate(timeout=60)[0].splitlines()[-1])
        self.assertEqual(running.returncode, 130)
        self.assertTrue(last['done'])
        self.assertEqual(last['study']['trouble'], '')
        self.assertTrue(all(cost['step_ms'] > 0 for cost in last['study']['settings']))


if __name__ == '__main__':
    rospy.init_node('accuracy_test')
    rostest.rosrun('rigid_body_sim', 'accuracy', AccuracyTest)
