#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""World: equal bits with C++, its verbs and what they refuse, its time, its copies and files."""
import copy
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import rigid_body_sim as rbs

BUILD = pathlib.Path(os.environ['RBS_BUILD'])
FIDELITIES = ('preview', 'interactive', 'accurate', 'reference')
SCENES = ('ball_hits_wall', 'boxes_on_slope', 'newtons_cradle', 'shapes', 'windy_day', 'harbour')
NAN = float('nan')


def world_of(name, steps=0):
    world = rbs.World(rbs.Scene.load(name))
    if steps:
        world.step(steps)
    return world


def small_world():
    """A box and a ball above a floor, in air."""
    return rbs.World(rbs.Scene([
        rbs.Body(rbs.Plane(), name='floor', kind='static'), rbs.Body(rbs.Box(), name='box', position=[0, 0, 1], mass=2),
        rbs.Body(rbs.Sphere(), name='ball', position=[3, 0, 1], mass=1)], air=rbs.Air()))


class EqualBitsTest(unittest.TestCase):
    def test_hashes_are_those_of_a_cpp_program(self):
        said = subprocess.run([BUILD / 'devel/lib/rigid_body_sim/state_hashes', '--steps', '100', *SCENES],
                              capture_output=True, text=True, check=True).stdout
        lines = [line.split() for line in said.splitlines()]
        self.assertEqual([line[:2] for line in lines], [[scene, fidelity] for scene in SCENES for fidelity in FIDELITIES])
        for name, fidelity, *hashes in lines:
            scene = rbs.Scene.load(name)
            scene.fidelity, scene.goal = fidelity, None
            world = rbs.World(scene)
            found = []
            for mark in (1, 10, 60, 100):
                world.step(mark - world.steps)
                found.append('%016x' % world.state_hash())
            self.assertEqual(found, hashes[:4], (name, fidelity))

    def test_one_call_of_n_steps_is_n_calls_and_threads_change_nothing(self):
        one, many, threads = world_of('mixed_rain'), world_of('mixed_rain'), world_of('mixed_rain')
        self.assertEqual(threads.threads, 1)
        threads.threads = 2
        one.step(30)
        threads.step(30)
        for _ in range(30):
            many.step()
        self.assertEqual({world.state_hash() for world in (one, many, threads)}, {one.state_hash()})
        self.assertEqual((one.steps, threads.threads, one.copy().threads), (30, 2, 1))
        self.assertAlmostEqual(one.time, 30 * one.scene.step)


class TimeTest(unittest.TestCase):
    def test_other_threads_of_python_run_during_a_step_and_the_world_refuses_them(self):
        world = world_of('tower')
        # A thread that has the lock keeps it for longer than the test, unless it gives it away.
        self.addCleanup(sys.setswitchinterval, sys.getswitchinterval())
        sys.setswitchinterval(1000.0)
        ticks, refused, ended = [0], [], []

        def tick():
            while not ended:
                ticks[0] += 1
                try:
                    world.positions  # noqa: B018
                except RuntimeError as error:
                    refused.append(str(error))
                time.sleep(0)  # gives it away

        thread = threading.Thread(target=tick)
        thread.start()
        try:
            for _ in range(1000):
                before = ticks[0]
                world.step(10)
                during = ticks[0] - before
                if during and refused:
                    break
        finally:
            ended.append(True)
            thread.join()
        self.assertGreater(during, 0)
        self.assertIn('busy', refused[0])
        self.assertGreater(world.time, 0.0)

    def interrupted(self, call):
        class Interrupt(Exception):
            pass

        def handler(*_):
            raise Interrupt

        old = signal.signal(signal.SIGALRM, handler)
        self.addCleanup(signal.signal, signal.SIGALRM, old)
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with self.assertRaises(Interrupt):
            call()

    def test_a_signal_ends_a_long_call_between_two_steps(self):
        world = world_of('ball_hits_wall')
        self.interrupted(lambda: world.step(10**12))
        same = world_of('ball_hits_wall', world.steps)
        self.assertEqual(world.state_hash(), same.state_hash())

    def test_a_signal_ends_a_rollout(self):
        scene = rbs.Scene.load('ball_hits_wall')
        self.interrupted(lambda: rbs.rollout([scene] * 3, 10**9, every=10**9, threads=2))

    def test_the_report_is_of_the_last_step(self):
        world = world_of('ball_hits_wall')
        self.assertEqual(world.report.contacts, 0)
        report = world.step(20)
        for name in ('pairs', 'overlap_tests', 'axis_queries', 'axes_kept', 'contacts', 'islands', 'flying', 'impacts',
                     'deferred_impacts', 'repeated', 'deepest_penetration', 'seconds', 'warnings'):
            self.assertEqual(getattr(report, name), getattr(world.report, name), name)
        self.assertEqual(report.flying + report.islands, 1)
        exact = world_of('boxes_on_slope')
        exact.set_fidelity('accurate')
        island = exact.step(10).residuals[0]
        self.assertLess(max(island.signorini, island.coulomb, island.dissipation), 1e-5)
        self.assertTrue(island.converged)

    def test_trouble_is_a_warning(self):
        world = rbs.World(rbs.Scene([rbs.Body(position=[0, 0, 0.001 * k]) for k in range(8)]))
        warnings = world.step().warnings
        self.assertEqual(warnings[0].kind, 'overlap')
        self.assertGreater(len(warnings[0].text), 20)

    def test_trouble_of_an_early_step_is_told_by_a_call_of_many(self):
        scene = rbs.Scene([rbs.Body(position=[0, 0, 0.001 * k]) for k in range(8)])
        single, many = rbs.World(scene), rbs.World(scene)
        told = []
        for _ in range(50):
            told += [warning for warning in single.step().warnings if warning not in told]
        self.assertTrue(told)
        self.assertEqual(single.report.warnings, ())
        self.assertEqual(list(many.step(50).warnings), told)
        self.assertEqual(many.report.warnings, ())

    def test_a_forked_process_uses_what_it_inherits(self):
        world = world_of('mixed_rain', 5)
        world.threads = 3
        world.step(20)
        after = world.copy()
        after.step(5)
        for what in ('world.step(5)', 'twin = world.copy(); twin.threads = 2; twin.step(5); world = twin', 'del world'):
            child = os.fork()
            if child == 0:
                names = {'world': world}
                world = None
                try:
                    signal.alarm(60)
                    exec(what, names)
                    os._exit(0 if 'world' not in names or names['world'].state_hash() == after.state_hash() else 1)
                except BaseException:
                    os._exit(2)
            self.assertEqual(os.waitpid(child, 0)[1], 0, what)
        world.step(5)
        self.assertEqual(world.state_hash(), after.state_hash())


class VerbsTest(unittest.TestCase):
    def setUp(self):
        self.world = small_world()

    def body(self, name):
        return self.world.bodies()[self.world.names.index(name)]

    def state(self, name):
        return self.world.states[self.world.names.index(name)]

    def test_bodies_come_and_go(self):
        world = self.world
        edits = world.edits
        cone = world.add_body(rbs.Body(rbs.Cone(), name='cone', position=[9, 0, 1]))
        more = world.add_bodies([rbs.Body(position=[k, 20, 1]) for k in range(2)])
        self.assertEqual((cone, more), (4, [5, 6]))
        self.assertEqual(world.ids.tolist(), [1, 2, 3, 4, 5, 6])
        self.assertEqual(world.edits, edits + 2)
        self.assertEqual((world.find('cone'), world.find('none')), (4, None))
        world.remove_body('cone')
        world.remove_body(np.uint64(5))
        self.assertEqual((world.ids.tolist(), len(world.names)), ([1, 2, 3, 6], 4))
        self.assertGreater(world.bodies_analysed, 0)
        world.clear()
        self.assertEqual((world.names, world.positions.shape, world.contacts().shape, world.ids.shape), ([], (0, 3), (0,), (0,)))

    def test_an_edit_changes_what_is_given_and_nothing_else(self):
        world = self.world
        world.edit_body('box', velocity=[1, 2, 3])
        world.edit_body('box', position=[5, 5, 5])
        world.edit_body('box', spin=[0, 0, 1])
        world.edit_body('box', orientation=[0, 0, 1, 1])
        half = 0.5 ** 0.5
        np.testing.assert_allclose(self.state('box'), [5, 5, 5, 0, 0, half, half, 1, 2, 3, 0, 0, 1], atol=1e-15)
        world.edit_body(2, name='cube', shape=rbs.Box([1, 1, 1]), mass=3, friction=0.1, restitution=0.2, drag_coefficient=0.3,
                        rolling_resistance=0.4, torsional_resistance=0.5, color=[0, 1, 0, 0.5], group=4, mask=5)
        cube = self.body('cube')
        self.assertEqual(cube[1:6], ('cube', rbs.Box((1.0, 1.0, 1.0)), 'dynamic', 3.0, 3.0))
        self.assertEqual(cube[7:], (0.1, 0.2, 0.3, 0.4, 0.5, (0.0, 1.0, 0.0, 0.5), 4, 5, False))
        np.testing.assert_allclose(cube.inertia, [0.5] * 3)
        world.edit_body('cube', density=500)
        self.assertEqual(self.body('cube').mass, 500.0)
        world.edit_body('cube', kind='static')
        self.assertEqual((self.body('cube').kind, self.state('cube')[7]), ('static', 0.0))

    def test_a_pose_and_a_free_place(self):
        position, orientation = self.world.pose('ball')
        self.assertEqual((position.tolist(), orientation.tolist()), ([3, 0, 1], [0, 0, 0, 1]))
        place = self.world.free_place(rbs.Sphere(0.5))
        self.assertGreater(place[2], 1.5)
        self.assertEqual(place[:2].tolist(), [0, 0])

    def test_forces_do_what_they_say(self):
        world = self.world
        world.set_gravity([0, 0, 0])
        world.set_air(None)
        world.apply_impulse('box', [2, 0, 0], [0, 0, 1])
        self.assertEqual(self.state('box')[7], 1.0)
        world.apply_wrench('ball', [0, 1, 0], [0, 0, 0], [3, 0, 1], 1.0)
        world.step(120)
        self.assertAlmostEqual(self.state('ball')[8], 1.0)
        for _ in range(2):  # the second replaces the first
            world.command_wrench('ball', [0, 1, 0], [0, 0, 0], self.state('ball')[:3], 1.0)
        world.step(60)
        self.assertAlmostEqual(self.state('ball')[8], 2.0)

    def test_a_grab_pulls_and_a_hold_moves(self):
        world = self.world
        world.set_gravity([0, 0, 0])
        world.grab('ball', [3, 0, 2], frequency=2, max_acceleration=100)
        world.hold('box', [0, 0, 3], [0, 0, 1, 0])
        world.step(120)
        self.assertAlmostEqual(self.state('ball')[2], 2.0, places=3)
        np.testing.assert_allclose(np.abs(self.state('box')[:7]), [0, 0, 3, 0, 0, 1, 0], atol=1e-6)
        world.release('ball')
        world.grab('ball', [3, 0, 2], point=[0.1, 0, 0])
        before = world.edits
        world.release_all()
        world.release_all()
        self.assertEqual(world.edits - before, 2)

    def test_surroundings(self):
        world = self.world
        world.set_wind(rbs.Wind([5, 0, 0]))
        world.set_fluid(rbs.Fluid(level=-1))
        world.set_fidelity(rbs.Setting('accurate', divisions=2))
        world.set_goal(rbs.Goal(max_step_ms=3))
        world.set_effects({'rolling': False})
        scene, snapshot = world.scene, world.snapshot()
        self.assertEqual(scene.bodies, [])
        for now in (scene, snapshot):
            self.assertEqual((now.fluid, now.fidelity, now.goal, now.effects), (
                rbs.Fluid(level=-1.0), rbs.Setting('accurate', divisions=2), rbs.Goal(max_step_ms=3.0), {'rolling': False}))
        self.assertEqual((scene.wind.velocity, snapshot.air_velocity.tolist()), ((5.0, 0.0, 0.0), [5, 0, 0]))
        world.set_air(None)
        world.set_fluid(None)
        world.set_goal(None)
        self.assertEqual((world.scene.wind, world.scene.fluid, world.scene.goal), (None, None, None))

    def test_a_journal_makes_every_change_again(self):
        world, journal = self.world, []
        other = world.copy()
        world.set_journal(journal.append)
        world.set_gravity([0, 0, -5])
        world.edit_body('box', friction=0.1)
        world.apply_impulse('ball', [0.1, 0.2, 0.3], [3, 0, 1])
        world.add_body(rbs.Body(rbs.Cone(), position=[9, 9, 9]))
        world.set_journal(None)
        for command in journal:
            other.execute(command)
        self.assertEqual([command.split(':')[0] for command in journal], ['set_gravity', 'edit_body', 'apply_impulse', 'add_bodies'])
        world.set_air(None)
        other.set_air(None)
        self.assertEqual((len(journal), other.state_hash()), (4, world.state_hash()))

    def test_a_journal_cannot_use_the_world_and_its_errors_stay_with_it(self):
        errors = []
        self.addCleanup(setattr, sys, 'unraisablehook', sys.unraisablehook)
        sys.unraisablehook = lambda unraisable: errors.append(unraisable.exc_value)
        self.world.set_journal(lambda command: self.world.step())
        self.world.set_gravity([0, 0, 0])
        self.assertEqual((self.world.scene.gravity.tolist(), self.world.steps), ([0, 0, 0], 0))
        self.assertIn('busy', str(errors[0]))
        self.world.set_journal(None)

    def test_what_is_wrong_is_refused_and_changes_nothing(self):
        world = self.world
        before = world.state_hash(), world.edits, world.steps
        three, zero = [0, 0, 1], [0, 0, 0]
        calls = {
            'n: 0': lambda: world.step(0),
            'n: -3': lambda: world.step(-3),
            'n: 1.5': lambda: world.step(1.5),
            "n: 'x'": lambda: world.step('x'),
            'threads: 0': lambda: setattr(world, 'threads', 0),
            'threads: 257': lambda: setattr(world, 'threads', 257),
            "body: 'nobody' .*the name of a body": lambda: world.remove_body('nobody'),
            r"body: '\\udcff' .*a text of Unicode": lambda: world.remove_body('\udcff'),
            r"fidelity: '\\udcff' .*a text of Unicode": lambda: world.set_fidelity('\udcff'),
            r"name: '\\udcff' .*a text of Unicode": lambda: world.edit_body('box', name='\udcff'),
            'body: 99 .*a body of this world': lambda: world.edit_body(99, friction=1),
            'body: -1': lambda: world.pose(-1),
            'body: 0 ': lambda: world.release(0),
            'body: None': lambda: world.release(None),
            r'impulse: shape \(2,\)': lambda: world.apply_impulse('box', [1, 2], zero),
            r'impulse: shape \(1, 3\)': lambda: world.apply_impulse('box', [[1, 2, 3]], zero),
            'impulse: .nan': lambda: world.apply_impulse('box', [NAN] * 3, zero),
            'point: .*inf': lambda: world.apply_impulse('box', zero, [0, 0, float('inf')]),
            'body: .*floor|dynamic': lambda: world.apply_impulse('floor', three, zero),
            'seconds: 0': lambda: world.apply_wrench('box', three, zero, zero, 0),
            'seconds: nan': lambda: world.command_wrench('box', three, zero, zero, NAN),
            "seconds: 'x'": lambda: world.apply_wrench('box', three, zero, zero, 'x'),
            'torque: ': lambda: world.apply_wrench('box', three, 5, zero, 1),
            'frequency: -1': lambda: world.grab('box', three, frequency=-1),
            'target: ': lambda: world.grab('box', 'up'),
            'orientation: ': lambda: world.hold('box', three, [0, 0, 0, 0]),
            'gravity: ': lambda: world.set_gravity([0, 0, NAN]),
            'air.density: -1': lambda: world.set_air(rbs.Air(-1)),
            'air: 3': lambda: world.set_air(3),
            'wind.gust: -1': lambda: world.set_wind(rbs.Wind(gust=-1)),
            'fluid.level: nan': lambda: world.set_fluid(rbs.Fluid(level=NAN)),
            "fidelity: 'best'": lambda: world.set_fidelity('best'),
            'fidelity.tolerance: 1': lambda: world.set_fidelity(rbs.Setting(tolerance=1)),
            'fidelity': lambda: world.set_goal(rbs.Goal(1, 1)),
            "effect: 'magic'": lambda: world.set_effects({'magic': True}),
            'effects: 3': lambda: world.set_effects(3),
            'body: 3 .*a Body': lambda: world.add_body(3),
            r'bodies\[1\]: 3': lambda: world.add_bodies([rbs.Body(), 3]),
            r'bodies\[1\].name: .box': lambda: world.add_bodies([rbs.Body(), rbs.Body(name='box')]),
            'bodies: 3': lambda: world.add_bodies(3),
            'friction: nan': lambda: world.edit_body('box', friction=NAN),
            'frction: 1 .*a field of Body: color, .*, friction, ': lambda: world.edit_body('box', frction=1),
            'mass and density': lambda: world.edit_body('box', mass=1, density=1),
            'name: .*ball': lambda: world.edit_body('box', name='ball'),
            'size': lambda: world.edit_body('box', shape=rbs.Sphere(-1)),
            "shape: 'ball'": lambda: world.edit_body('box', shape='ball'),
            'clearance: ': lambda: world.free_place(rbs.Box(), clearance=NAN),
            'body.size: ': lambda: world.free_place(rbs.Sphere(NAN)),
            'journal: 3': lambda: world.set_journal(3),
            'command:1: ': lambda: world.execute('jump: {}'),
            'direction: ': lambda: world.cast_ray(zero, zero),
            'max_distance: -1': lambda: world.cast_ray(zero, three, -1),
            "ignore: 'box'": lambda: world.cast_ray_through(zero, three, ignore='box'),
            'body_b: ': lambda: world.closest_points('box', 'box'),
            'body_a: 77': lambda: world.closest_points(77, 'box'),
            "body_b: 'x'": lambda: world.closest_points('box', 'x'),
            'margin: -1': lambda: world.overlaps(rbs.Box(), zero, margin=-1),
            'shape: None': lambda: world.overlaps(None, zero),
        }
        for text, call in calls.items():
            with self.assertRaisesRegex(rbs.InvalidInput, text):
                call()
            self.assertEqual((world.state_hash(), world.edits, world.steps), before, text)
        self.assertEqual(world.threads, 1)


class QueriesTest(unittest.TestCase):
    def test_a_world_and_its_snapshot_answer_alike(self):
        world = small_world()
        for asked in (world, world.snapshot()):
            hit = asked.cast_ray([-5, 0, 1], [1, 0, 0])
            self.assertEqual((hit.body, hit.point.tolist(), hit.normal.tolist(), hit.distance), (2, [-0.25, 0, 1], [-1, 0, 0], 4.75))
            self.assertIsNone(asked.cast_ray([-5, 0, 1], [1, 0, 0], max_distance=4))
            self.assertEqual([hit.body for hit in asked.cast_ray_through([-5, 0, 1], [2, 0, 0])], [2, 3])
            self.assertEqual(asked.cast_ray([-5, 0, 1], [1, 0, 0], ignore=['box']).body, 3)
            points = asked.closest_points('box', 3)
            self.assertAlmostEqual(points.distance, 2.5)
            np.testing.assert_allclose(points.point_b - points.point_a, points.distance * points.normal, atol=1e-12)
            self.assertEqual([near.body for near in asked.overlaps(rbs.Sphere(1), [0, 0, 1])], [1, 2])
            self.assertEqual([near.body for near in asked.overlaps(rbs.Sphere(1), [0, 0, 5], [0, 0, 0, 1], margin=3)], [2])


class KeptTest(unittest.TestCase):
    """Copies and files."""

    def check_same_future(self, world, other):
        self.assertEqual(other.state_hash(), world.state_hash())
        self.assertEqual((other.time, other.steps, other.names), (world.time, world.steps, world.names))
        world.step(50)
        self.assertNotEqual(other.state_hash(), world.state_hash())
        other.step(50)
        self.assertEqual(other.state_hash(), world.state_hash())

    def test_a_copy_has_the_same_future_and_is_independent(self):
        for make in (rbs.World.copy, copy.copy, copy.deepcopy, lambda world: pickle.loads(pickle.dumps(world)),
                     lambda world: rbs.World(world.capture())):
            world = world_of('shapes', 40)
            self.check_same_future(world, make(world))

    def test_answers_of_equal_worlds_are_equal(self):
        one, other = world_of('tower', 5), world_of('tower', 5)
        answers = [lambda world: world.bodies(), lambda world: world.totals(),
                   lambda world: world.cast_ray([0, 0, 50], [0, 0, -1]),
                   lambda world: world.closest_points(world.names[0], world.names[1])]
        for answer in answers:
            self.assertTrue(answer(one) == answer(other))
            self.assertFalse(answer(one) != answer(other))
        other.step()
        self.assertTrue(one.totals() != other.totals())
        self.assertFalse(one.totals() == other.totals())
        self.assertFalse(one.totals() == tuple(one.totals()))

    def test_a_file_resumes_the_run_with_its_forces(self):
        world = world_of('tower', 20)
        world.grab(world.names[-1], [1, 1, 5])
        world.apply_wrench(world.names[-2], [1, 0, 0], [0, 0, 0], [0, 0, 0], 9)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, 'state.yaml')
            world.save(file)
            with self.assertRaisesRegex(rbs.InvalidInput, 'overwrite'):
                world.save(file)
            world.save(file, overwrite=True)
            self.check_same_future(world, rbs.World.load(file))
            with self.assertRaisesRegex(rbs.InvalidInput, 'nothing_here'):
                rbs.World.load(pathlib.Path(folder, 'nothing_here.yaml'))

    def test_a_capture_may_leave_out_user_forces_and_a_scene_its_state(self):
        world = world_of('tower', 20)
        without = world.capture()
        world.grab(world.names[-1], [1, 1, 5])
        self.assertEqual(world.capture(user_forces=False).to_yaml(), without.to_yaml())
        self.assertNotEqual(world.capture().to_yaml(), without.to_yaml())
        self.assertTrue(without.is_saved_state)
        without.forget_state()
        self.assertEqual((without.is_saved_state, rbs.World(without).steps), (False, 0))

    def test_a_state_that_does_not_fit_its_bodies_is_refused(self):
        saved = world_of('tower', 20).capture()
        del saved.bodies[:]
        with self.assertRaisesRegex(rbs.InvalidInput, 'state'):
            rbs.World(saved)


class SumsTest(unittest.TestCase):
    def test_totals_and_stages(self):
        world = small_world()
        totals = world.totals()
        self.assertEqual((totals.kinetic_energy, totals.momentum.tolist()), (0.0, [0, 0, 0]))
        self.assertAlmostEqual(totals.potential_energy, 3 * 9.81)
        world.edit_body('ball', velocity=[1, 0, 0])
        self.assertEqual(world.totals().momentum.tolist(), [1, 0, 0])
        self.assertEqual(world.totals().angular_momentum.tolist(), [0, 1, 0])
        stages = {stage.name: stage for stage in world.pipeline()}
        self.assertTrue(stages['forces.gravity'].active)
        self.assertFalse(stages['forces.buoyancy'].active)
        self.assertIn('fluid', stages['forces.buoyancy'].reason)

    def test_a_run_is_compared_with_another(self):
        run, truth = small_world(), small_world()
        run.edit_body('box', position=[0, 0, 1.5])
        difference = run.snapshot().difference(truth.snapshot())
        self.assertEqual((difference.moved_body, difference.distance, difference.turned_body, difference.angle), ('box', 0.5, '', 0.0))
        truth.remove_body('ball')
        with self.assertRaisesRegex(rbs.InvalidInput, '^truth: other bodies'):
            run.snapshot().difference(truth.snapshot())


if __name__ == '__main__':
    unittest.main()
