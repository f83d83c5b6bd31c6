#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every service: what it does, and what it refuses."""
import concurrent.futures
import math
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
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from rigid_body_sim.msg import BodyChange, BodySpec, BodyStates, Event, Material, Status
from rigid_body_sim.srv import Step
from std_msgs.msg import ColorRGBA

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import PATIENCE, SMALL, Listener, StatusListener, ask, body, call, wait  # noqa: E402

NAN, INF = float('nan'), float('inf')


CORNER = [Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(0, 0, 1)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def at(x, y, z):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))


class ServicesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.status = StatusListener()
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def setUp(self):
        call('pause')
        call('load_scene', name=SMALL)

    def file(self, name, text=None):
        path = os.path.join(self.folder.name, name)
        if text is not None:
            with open(path, 'w') as file:
                file.write(text)
        return path

    def fault_of(self, words, service, **request):
        """Empty if the request is refused with all these words in the message and the world stays what it is."""
        before = self.status.fresh().hash
        answer = ask(service, **request)
        what = '%s %s: "%s" ' % (service, request, answer.message)
        if answer.success:
            return [what + 'was not refused']
        changed = [what + 'changed the world'] if self.status.fresh().hash != before else []
        return changed + [what + 'lacks ' + word for word in words if word not in answer.message]

    def assert_refused(self, words, service, **request):
        self.assertEqual(self.fault_of(words, service, **request), [])

    # --- bodies

    def test_an_empty_spawn_drops_a_box_at_a_free_place(self):
        answer = call('spawn_body')
        made = body(answer.name)
        self.assertEqual(made.description.shape, 'box')
        self.assertAlmostEqual(made.description.mass, 125.0)
        self.assertGreater(made.pose.position.z, 0.75)  # above the crate, which is in the way

    def test_a_body_is_spawned_as_it_was_asked_for(self):
        call('spawn_body', name='top', shape='sphere', size=Vector3(0.2, 0, 0), pose=at(0, 1, 2), mass=3.0,
             twist=Twist(Vector3(1, 0, 0), Vector3(0, 0, 5)), material=Material(friction=[0.0], restitution=[0.5]))
        top = body('top')
        self.assertAlmostEqual(top.description.mass, 3.0)
        self.assertEqual(top.description.material.friction, (0.0, ))
        self.assertEqual((top.pose.position.y, top.pose.position.z), (1.0, 2.0))
        self.assertEqual(top.twist.angular.z, 5.0)

    def test_a_plane_is_spawned_through_the_origin_and_has_no_density(self):
        message = call('spawn_body', shape='plane', is_static=True, name='pl').message
        self.assertIn('through the origin', message)
        self.assertNotIn('free place', message)
        self.assertNotIn('density', message)

    def test_an_event_tells_of_each_edit_of_a_body(self):
        events = Listener('/sim/events', Event)
        try:
            wait(lambda: events.subscriber.get_num_connections() > 0, 'the simulator sends events')
            for edit, text in [(dict(new_name='box'), "renamed from 'crate'"), (dict(mass=3.0), 'mass 3 kg'),
                               (dict(color=ColorRGBA(1, 0, 0, 1)), ''), (dict(collision_mask=[7]), ''),
                               (dict(material=Material(drag_coefficient=[0.3])), '')]:
                name = 'crate' if 'new_name' in edit else 'box'
                call('edit_bodies', changes=[BodyChange(name=name, **edit)])
                wait(lambda: any(event.kind == 'edited' and event.body == 'box' and text in event.text for event in events.all()),
                     'an event of %s' % edit)
                events.clear()
        finally:
            events.subscriber.unregister()

    def test_every_shape_is_spawned_with_its_mass(self):
        for shape, size, volume in [
            ('capsule', Vector3(0.2, 0.2, 1.0), math.pi * 0.01 * 0.8 + 4 / 3 * math.pi * 0.001),
            ('cylinder', Vector3(0.2, 0, 1.0), math.pi * 0.01),
            ('cone', Vector3(0.6, 0.6, 1.0), math.pi * 0.03),
        ]:
            call('spawn_body', name=shape, shape=shape, size=size)
            made = body(shape).description
            self.assertEqual(made.shape, shape)
            self.assertAlmostEqual(made.mass, 1000 * volume)
            self.assertAlmostEqual(made.size.y, size.x)
            self.assertAlmostEqual(made.size.z, 1.0)
            self.assertEqual(len(made.vertices), 0)

    def test_a_hull_is_spawned_where_its_points_are(self):
        call('spawn_body', name='corner', shape='hull', points=CORNER, scale=2.0, pose=at(10, 0, 0))
        corner = body('corner')
        self.assertAlmostEqual(corner.description.mass, 1000 * 8 / 6)
        p = corner.pose.position  # its centre of mass, a quarter of the way from the right corner to the others
        self.assertAlmostEqual(max(abs(p.x - 10.5), abs(p.y - 0.5), abs(p.z - 0.5)), 0)
        self.assertEqual(len(corner.description.vertices), 4)
        q = corner.pose.orientation
        turn = (q.x, q.y, q.z)
        for v in corner.description.vertices:
            # v + 2 q x (q x v + w v), for a quaternion (q, w)
            t = [2 * c for c in cross(turn, (v.x, v.y, v.z))]
            w = [a + q.w * b + c for a, b, c in zip((v.x, v.y, v.z), t, cross(turn, t))]
            there = [w[0] + p.x - 10, w[1] + p.y, w[2] + p.z]
            self.assertLess(min(math.dist(there, (2 * c.x, 2 * c.y, 2 * c.z)) for c in CORNER), 1e-12)

    def test_a_hull_without_a_pose_finds_a_place(self):
        call('spawn_body', name='one', shape='hull', points=[Point(p.x, p.y, p.z + 50) for p in CORNER])
        call('spawn_body', name='two', shape='hull', points=CORNER)
        self.assertGreater(body('one').pose.position.z, 0.75)
        self.assertLess(body('one').pose.position.z, 3.0)
        self.assertGreater(body('two').pose.position.z, body('one').pose.position.z)

    def test_a_hull_is_spawned_of_a_mesh_file(self):
        mesh = 'package://rigid_body_sim/scenes/meshes/dodecahedron.obj'
        call('spawn_body', name='near', shape='hull', mesh=mesh)
        made = body('near').description
        self.assertEqual(len(made.vertices), 20)
        edge = 0.3 * 4 / (math.sqrt(3) * (1 + math.sqrt(5)))
        self.assertAlmostEqual(made.mass / 1000 / ((15 + 7 * math.sqrt(5)) / 4 * edge ** 3), 1.0, delta=1e-6)
        call('spawn_body', name='large', shape='hull', mesh=mesh, scale=10.0)
        self.assertAlmostEqual(body('large').description.mass / made.mass, 1000.0, delta=1e-9)
        triangle = self.file('corner.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n')
        call('spawn_body', name='corner', shape='hull', mesh=triangle)
        self.assertAlmostEqual(body('corner').description.mass, 1000 / 6, delta=1e-9)

    def test_shapes_are_resized_along_their_axes(self):
        call('spawn_body', name='can', shape='cylinder', size=Vector3(0.2, 0.2, 1.0))
        call('resize_body', name='can', size=Vector3(0.4, 0, 0))
        size = body('can').description.size
        self.assertEqual((size.x, size.y, size.z), (0.4, 0.4, 1.0))
        call('spawn_body', name='corner', shape='hull', points=CORNER)
        before = body('corner').description
        call('resize_body', name='corner', size=Vector3(0, 3 * before.size.y, 0))
        after = body('corner').description
        self.assertAlmostEqual(after.mass, 3 * before.mass)
        self.assertAlmostEqual(after.size.x, before.size.x)
        self.assertAlmostEqual(after.size.y, 3 * before.size.y)
        call('resize_body', name='corner', factor=2.0)
        self.assertAlmostEqual(body('corner').description.mass, 24 * before.mass)

    def test_a_pose_can_be_given_in_the_frame_of_a_body(self):
        call('move_body', name='crate', pose=Pose(Point(1, 2, 3), Quaternion(0, 0, math.sqrt(0.5), math.sqrt(0.5))))
        call('spawn_body', name='beside', pose=at(1, 0, 0), frame_id='crate')
        place = body('beside').pose.position
        self.assertAlmostEqual(place.x, 1.0)
        self.assertAlmostEqual(place.y, 3.0)

    def test_a_thousand_bodies_come_in_one_call_or_none_at_all(self):
        bodies = [BodySpec(size=Vector3(0.1, 0, 0), shape='sphere', pose=at(k % 40, k // 40, 5)) for k in range(1000)]
        self.assertEqual(len(call('spawn_bodies', bodies=bodies).names), 1000)
        bodies[700].mass = -1.0
        self.assert_refused(['bodies[700]', 'mass'], 'spawn_bodies', bodies=bodies)

    def test_many_bodies_are_changed_in_one_edit(self):
        call('edit_bodies', changes=[
            BodyChange(name='crate', new_name='chest', pose=[at(0, 0, 3)], size=[Vector3(0, 2, 0)], density=10.0,
                       material=Material(friction=[0.25]), color=ColorRGBA(1, 0, 0, 0.5), collision_group=[6]),
            BodyChange(name='ball', kind='kinematic', twist=[Twist(Vector3(1, 0, 0), Vector3(0, 0, 2))], mass=7.0,
                       collision_mask=[0])])
        chest, ball = body('chest'), body('ball')
        self.assertEqual(chest.pose.position, Point(0, 0, 3))
        self.assertEqual(chest.description.size, Vector3(0.5, 2, 0.5))
        self.assertAlmostEqual(chest.description.mass, 5.0)
        self.assertEqual((chest.description.material.friction, chest.description.collision_group), ((0.25,), 6))
        self.assertEqual(chest.description.color, ColorRGBA(1, 0, 0, 0.5))
        self.assertEqual((ball.description.kind, ball.description.collision_mask), ('kinematic', 0))
        self.assertEqual(ball.twist, Twist(Vector3(1, 0, 0), Vector3(0, 0, 2)))
        self.assertAlmostEqual(ball.description.mass, 7.0)
        call('undo')
        self.assertEqual(call('list_bodies').names, ['floor', 'crate', 'ball'])
        self.assertEqual(body('ball').description.kind, 'dynamic')

    def test_a_change_of_many_bodies_is_refused_as_a_whole(self):
        good = BodyChange(name='crate', mass=3.0)
        cases = [
            (['changes', 'at least one'], []),
            (['unknown body', 'bal', 'ball'], [good, BodyChange(name='bal', mass=1.0)]),
            (['crate', 'each body once'], [good, good]),
            (["changes[1] ('ball')", 'nothing to change'], [good, BodyChange(name='ball')]),
            (["changes[1] ('ball').material.friction", '-1'],
             [good, BodyChange(name='ball', material=Material(friction=[-1.0]))]),
            (["changes[1] ('ball').name", "'crate'", 'no other body'], [good, BodyChange(name='ball', new_name='crate')]),
            (["changes[1] ('ball')", 'nan'], [good, BodyChange(name='ball', pose=[at(NAN, 0, 0)])]),
            (["changes[0] ('ball').pose", '2 entries'], [BodyChange(name='ball', pose=[at(1, 0, 0), at(2, 0, 0)])]),
            (["changes[1] ('floor')", 'plane'], [good, BodyChange(name='floor', size=[Vector3(1, 1, 1)])]),
            (["changes[0] ('ball').kind", "'stone'"], [BodyChange(name='ball', kind='stone')]),
            (["changes[0] ('ball')", 'mass and density'], [BodyChange(name='ball', mass=1.0, density=1.0)])]
        faults = [self.fault_of(words, 'edit_bodies', changes=changes) for words, changes in cases]
        self.assertEqual([fault for fault in faults if fault], [])

    def test_a_scene_is_loaded_with_another_seed(self):
        def wind_after(seed):
            call('load_scene_with_seed', name='windy_day', seed=seed)
            call('step', n=30)
            return call('list_bodies').hash
        first, second = wind_after(1), wind_after(2 ** 64 - 1)
        self.assertNotEqual(first, second)
        self.assertEqual(wind_after(1), first)
        self.assert_refused(['nowhere'], 'load_scene_with_seed', name='nowhere', seed=1)

    def test_what_is_forced_is_in_the_status(self):
        call('set_effects', force_off=['friction'], force_on=['rolling'])
        now = self.status.fresh()
        self.assertEqual((now.forced_off, now.forced_on), (['friction'], ['rolling']))
        parts = [stage.part_of for stage in now.pipeline if stage.name == 'contacts.friction']
        self.assertEqual(parts, ['islands.advance'])
        call('set_effects', detect=['friction', 'rolling'])
        self.assertEqual(self.status.fresh().forced_off, [])

    def test_many_bodies_are_deleted_in_one_edit(self):
        self.assertIn('2 bodies', call('delete_bodies', names=['ball', 'crate']).message)
        self.assertEqual(call('list_bodies').names, ['floor'])
        call('undo')
        self.assertEqual(call('list_bodies').names, ['floor', 'crate', 'ball'])
        self.assert_refused(['at least one'], 'delete_bodies', names=[])
        self.assert_refused(['unknown body', 'bull', 'ball'], 'delete_bodies', names=['crate', 'bull'])
        self.assert_refused(['crate', 'each body once'], 'delete_bodies', names=['crate', 'ball', 'crate'])

    def test_bodies_are_duplicated(self):
        call('set_body', name='ball', twist=[Twist(Vector3(0, 1, 0), Vector3())], material=Material(friction=[0.1]))
        names = call('duplicate_bodies', names=['ball', 'crate'], count=3, offset=Vector3(0, 0, 2)).names
        self.assertEqual(len(set(names)), 6)
        for k, name in enumerate(names):
            copy, original = body(name), body('ball' if k < 3 else 'crate')
            self.assertAlmostEqual(copy.pose.position.z, original.pose.position.z + 2 * (k % 3 + 1))
            self.assertEqual((copy.twist, copy.description.material, copy.description.size),
                             (original.twist, original.description.material, original.description.size))
        call('undo')
        above = body(call('duplicate_bodies', names=['ball']).names[0])  # with zeros: one copy, just above
        self.assertAlmostEqual(above.pose.position.z, 0.2 + 1.01 * 0.4)
        self.assert_refused(['plane', 'offset'], 'duplicate_bodies', names=['floor', 'ball'])
        self.assert_refused(['offset', 'finite'], 'duplicate_bodies', names=['ball'], offset=Vector3(NAN, 0, 0))
        self.assert_refused(['count', '100,000'], 'duplicate_bodies', names=['ball', 'crate'], count=50001)
        self.assert_refused(['position'], 'duplicate_bodies', names=['ball'], count=2, offset=Vector3(1e300, 0, 0))
        self.assert_refused(['unknown body'], 'duplicate_bodies', names=['bill'])

    def test_bodies_are_deleted_one_by_one_and_all_together(self):
        call('delete_body', name='crate')
        self.assertNotIn('crate', call('list_bodies').names)
        call('clear')
        self.assertEqual(list(call('list_bodies').names), [])

    def test_the_mass_follows_a_resize(self):
        mass = body('crate').description.mass
        call('resize_body', name='crate', factor=2.0)
        self.assertAlmostEqual(body('crate').description.mass, 8 * mass)
        call('resize_body', name='crate', size=Vector3(1, 1, 1))
        self.assertAlmostEqual(body('crate').description.mass, 1000.0)

    def test_a_moved_body_is_where_it_was_put(self):
        call('set_body', name='ball', twist=[Twist(Vector3(1, 0, 0), Vector3())])
        call('move_body', name='ball', pose=at(3, 3, 3), keep_velocity=True)
        self.assertEqual(body('ball').twist.linear.x, 1.0)
        call('move_body', name='ball', pose=at(4, 3, 3))
        self.assertEqual(body('ball').pose.position.x, 4.0)
        self.assertEqual(body('ball').twist.linear.x, 0.0)

    def test_properties_are_set_and_the_others_stay(self):
        call('set_body', name='crate', mass=10.0, material=Material(restitution=[0.3]))
        crate = body('crate').description
        self.assertAlmostEqual(crate.mass, 10.0)
        self.assertEqual(crate.material.restitution, (0.3, ))
        self.assertEqual(crate.material.friction, (0.6, ))
        call('set_body', name='crate', is_static=[True])
        self.assertEqual(body('crate').description.kind, 'static')

    def test_an_impulse_changes_velocity_and_spin_by_its_lever(self):
        call('move_body', name='ball', pose=at(0, 0, 5))
        mass = body('ball').description.mass
        call('apply_impulse', name='ball', impulse=Vector3(mass, 0, 0), point=[Point(0, 0, 5.2)])
        ball = body('ball')
        self.assertAlmostEqual(ball.twist.linear.x, 1.0)
        self.assertAlmostEqual(ball.twist.angular.y, 0.2 / (0.4 * 0.2 * 0.2))

    def test_a_force_acts_for_its_time(self):
        call('set_gravity', gravity=Vector3())
        call('move_body', name='ball', pose=at(0, 0, 5))
        mass = body('ball').description.mass
        call('apply_wrench', name='ball', force=Vector3(0, mass, 0), seconds=0.5)
        call('step', n=60)
        self.assertAlmostEqual(body('ball').twist.linear.y, 0.5, delta=1e-9)

    # --- the dial

    def test_the_dial_turns_without_a_jump_and_says_what_changed(self):
        call('step', n=240)
        pose = body('crate').pose
        for fidelity in ('preview', 'accurate', 'reference', 'interactive'):
            answer = call('set_fidelity', fidelity=fidelity)
            self.assertTrue(any('contacts.solve' in line and fidelity in line for line in answer.changes), answer)
            self.assertEqual(body('crate').pose, pose)
            self.assertEqual(self.status.fresh().fidelity, fidelity)

    def test_effects_are_forced_and_say_what_that_neglects(self):
        call('move_body', name='ball', pose=at(0, 0, 5))
        pose = body('ball').pose
        answer = call('set_effects', force_off=['gravity'])
        self.assertEqual(answer.message, 'forced off: gravity')
        self.assertTrue(any(line.startswith('forces.gravity off: forced off, neglecting: 9.81') for line in answer.changes))
        self.assertIn("'ball' deviates by", answer.neglected[0])
        self.assertAlmostEqual(float(answer.neglected[0].split(' by ')[1].split(' m')[0]), 0.5 * 9.81 * 0.25 ** 2, delta=1e-3)
        self.assertEqual(body('ball').pose, pose)
        call('step', n=10)
        self.assertEqual(body('ball').pose, pose)
        stage = next(stage for stage in self.status.fresh().pipeline if stage.name == 'forces.gravity')
        self.assertFalse(stage.active)
        answer = call('set_effects', force_on=['buoyancy'], detect=['gravity'])
        self.assertEqual(answer.message, 'forced on: buoyancy')
        self.assertTrue(any(line.startswith('forces.buoyancy on: forced on, although the scene has no fluid')
                            for line in answer.changes))
        self.assertEqual(call('set_effects', detect=['buoyancy']).message, 'all effects are detected')

    def test_the_status_certifies_what_rests(self):
        call('set_fidelity', fidelity='reference')
        call('step', n=240)
        islands = self.status.fresh().residuals
        self.assertGreater(len(islands), 0)
        for island in islands:
            self.assertGreater(island.contacts, 0)
            self.assertTrue(island.converged)
            self.assertLess(max(island.signorini, island.coulomb, island.dissipation), 1e-11)

    # --- questions

    def test_a_ray_meets_the_bodies_on_it_in_order(self):
        call('move_body', name='ball', pose=at(0, 0, 5))
        radius = body('ball').description.size.x / 2
        answer = call('cast_ray', origin=Point(0, 0, 9), direction=Vector3(0, 0, -2))
        self.assertEqual([hit.body for hit in answer.hits], ['ball'])
        self.assertAlmostEqual(answer.hits[0].distance, 4 - radius, delta=1e-12)
        self.assertAlmostEqual(answer.hits[0].position.z, 5 + radius, delta=1e-12)
        self.assertAlmostEqual(answer.hits[0].normal.z, 1.0)
        answer = call('cast_ray', origin=Point(0, 0, 9), direction=Vector3(0, 0, -2), all=True)
        self.assertEqual([hit.body for hit in answer.hits], ['ball', 'crate', 'floor'])
        answer = call('cast_ray', origin=Point(0, 0, 9), direction=Vector3(0, 0, -2), ignore=['ball'])
        self.assertEqual([hit.body for hit in answer.hits], ['crate'])
        answer = call('cast_ray', origin=Point(0, 0, 9), direction=Vector3(0, 0, -2), max_distance=1.0)
        self.assertEqual(answer.hits, [])

    def test_a_ray_can_start_from_a_body_and_along_its_axes(self):
        call('move_body', name='ball', pose=Pose(Point(0, 0, 5), Quaternion(1, 0, 0, 0)))  # z looks down
        down = dict(direction=Vector3(0, 0, 1), frame_id='ball')
        hit = call('cast_ray', **down).hits[0]
        self.assertEqual((hit.body, hit.distance, hit.normal.z), ('ball', 0.0, 1.0))
        self.assertEqual(call('cast_ray', ignore=['ball'], **down).hits[0].body, 'crate')

    def test_closest_points_of_two_bodies(self):
        call('move_body', name='ball', pose=at(0, 0, 5))
        radius = body('ball').description.size.x / 2
        answer = call('closest_points', body_a='ball', body_b='floor')
        self.assertAlmostEqual(answer.distance, 5 - radius, delta=1e-12)
        self.assertAlmostEqual(answer.point_a.z, 5 - radius, delta=1e-12)
        self.assertAlmostEqual(answer.point_b.z, 0.0, delta=1e-12)
        self.assertEqual(answer.normal.z, -1.0)
        call('move_body', name='ball', pose=at(0, 0, 0.9 * radius))
        self.assertAlmostEqual(call('closest_points', body_a='ball', body_b='floor').distance, -0.1 * radius, delta=1e-12)

    def test_the_bodies_in_a_place(self):
        call('move_body', name='ball', pose=at(0, 0, 5))
        radius = body('ball').description.size.x / 2
        place = dict(shape='sphere', size=Vector3(2, 0, 0), pose=at(0, 0, 7))
        self.assertEqual(call('overlaps', **place).bodies, [])
        answer = call('overlaps', margin=1.0, **place)
        self.assertEqual(answer.bodies, ['ball'])
        self.assertAlmostEqual(answer.distances[0], 1 - radius, delta=1e-12)
        self.assertEqual(call('overlaps', size=Vector3(9, 9, 9)).bodies, ['floor', 'crate'])
        inside = call('overlaps', pose=at(0, 0, 0.1), frame_id='ball', size=Vector3(0.01, 0, 0), shape='sphere')
        self.assertEqual(inside.bodies, ['ball'])

    def test_a_place_can_be_a_hull(self):
        call('move_body', name='ball', pose=at(0, 0, 5))
        radius = body('ball').description.size.x / 2
        # Its slanted face is in the plane x + y + z = 4, the ball's centre 1/sqrt(3) above it
        place = dict(shape='hull', points=CORNER, scale=2.0, pose=at(-1, -1, 4), margin=1.0)
        answer = call('overlaps', **place)
        self.assertEqual(answer.bodies, ['ball'])
        self.assertAlmostEqual(answer.distances[0], 1 / math.sqrt(3) - radius, delta=1e-12)
        mesh = 'package://rigid_body_sim/scenes/meshes/dodecahedron.obj'
        self.assertEqual(call('overlaps', shape='hull', mesh=mesh, pose=at(0, 0, 5)).bodies, ['ball'])

    def test_questions_change_nothing(self):
        before = self.status.fresh().hash
        call('cast_ray', direction=Vector3(0, 0, 1), all=True)
        call('closest_points', body_a='ball', body_b='floor')
        call('overlaps')
        self.assertEqual(self.status.fresh().hash, before)

    # --- surroundings

    def test_the_wind_is_switched_on_with_air_and_off_again(self):
        self.assertIn('air', call('enable_wind', data=True).message)
        self.assertTrue(self.status.fresh().wind)
        call('enable_wind', data=False)
        self.assertFalse(self.status.fresh().wind)

    def test_the_wind_blows_as_it_was_set(self):
        call('set_wind', velocity=Vector3(3, 0, 0), gust=0.0)
        call('move_body', name='ball', pose=at(0, 0, 50))
        call('step', n=60)
        self.assertGreater(body('ball').twist.linear.x, 0.0)

    def test_zero_gravity_is_a_value(self):
        call('set_gravity', gravity=Vector3())
        call('move_body', name='ball', pose=at(0, 0, 5))
        call('step', n=10)
        self.assertEqual(body('ball').pose.position.z, 5.0)

    # --- time

    def test_step_takes_exactly_n_steps_and_answers_when_they_are_done(self):
        before = self.status.fresh()
        answer = call('step', n=100)
        self.assertAlmostEqual(answer.time, before.time + 100 / 60.0)
        self.assertEqual(self.status.fresh().steps, before.steps + 100)
        call('step')
        self.assertEqual(self.status.fresh().steps, before.steps + 101)

    def test_a_long_request_for_steps_holds_up_nothing_and_can_be_ended(self):
        answers = []
        client = threading.Thread(target=lambda: answers.append(ask('step', n=1000000)))
        client.start()
        begun = self.status.next('the steps are counted down', lambda s: s.steps_left > 0)
        self.assertTrue(begun.paused)
        call('spawn_body', name='guest', pose=at(8, 8, 8))
        refusal = ask('step', n=1)
        later = self.status.next('the steps are counted down', lambda s: 0 < s.steps_left < begun.steps_left)
        self.assertGreater(later.time, begun.time)
        self.assertFalse(refusal.success)
        self.assertIn('one request at a time', refusal.message)
        call('pause')
        client.join()
        self.assertFalse(answers[0].success)
        self.assertIn('ended by pause', answers[0].message)
        self.assertLess(answers[0].taken, 1000000)
        status = self.status.fresh()
        self.assertEqual((status.steps, status.steps_left), (answers[0].taken, 0))
        self.assertEqual(call('step', n=3).taken, 3)

    def test_an_interrupt_ends_the_node_in_the_middle_of_a_request_for_steps(self):
        program = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]
        node = subprocess.Popen([program, '__name:=mortal', '_paused:=true', '_publish_clock:=false', '_tf:=none',
                                 '_scene:=' + SMALL])
        self.addCleanup(node.kill)
        status = Listener('/mortal/status', Status)
        rospy.wait_for_service('/mortal/step', PATIENCE)
        answers = []

        def step():
            try:
                answers.append(rospy.ServiceProxy('/mortal/step', Step)(n=1000000).taken)
            except rospy.ServiceException:  # the node was gone before the answer was out
                answers.append(0)
        client = threading.Thread(target=step)
        client.start()
        status.next('the steps are counted down', lambda s: s.steps_left > 0)
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(PATIENCE), 0)
        client.join()
        self.assertLess(answers[0], 1000000)

    def test_step_needs_a_pause(self):
        call('resume')
        answer = ask('step', n=1)
        self.assertFalse(answer.success)
        self.assertIn('pause', answer.message)

    def test_pause_resume_and_toggle(self):
        call('resume')
        self.assertFalse(self.status.fresh().paused)
        call('toggle_pause')
        self.assertTrue(self.status.fresh().paused)
        call('toggle_pause')
        self.assertFalse(self.status.fresh().paused)
        call('pause')
        steps = self.status.fresh().steps
        self.assertEqual(self.status.fresh().steps, steps)

    def test_reset_restores_the_state_to_the_last_bit(self):
        before = self.status.fresh().hash
        call('spawn_body')
        call('delete_body', name='ball')
        call('enable_wind', data=True)
        call('step', n=30)
        self.assertNotEqual(self.status.fresh().hash, before)
        call('reset')
        after = self.status.fresh()
        self.assertEqual(after.hash, before)
        self.assertEqual((after.time, after.steps), (0.0, 0))

    def test_every_edit_is_undone_and_made_again(self):
        edits = [('spawn_body', dict(name='new', pose=at(0, 0, 9))),
                 ('spawn_bodies', dict(bodies=[BodySpec(name='a', pose=at(3, 0, 9)), BodySpec(name='b', pose=at(6, 0, 9))])),
                 ('move_body', dict(name='crate', pose=at(0, 1, 5))),
                 ('resize_body', dict(name='crate', factor=2.0)),
                 ('set_body', dict(name='ball', mass=7.0)),
                 ('apply_impulse', dict(name='ball', impulse=Vector3(0, 0, 1))),
                 ('enable_wind', dict(data=True)),
                 ('set_wind', dict(velocity=Vector3(1, 2, 0))),
                 ('set_gravity', dict(gravity=Vector3(0, 0, -1))),
                 ('set_effects', dict(force_off=['drag'])),
                 ('delete_body', dict(name='new')),
                 ('clear', {}),
                 ('load_scene', dict(name=SMALL))]
        hashes = [self.status.fresh().hash]
        for service, request in edits:
            call(service, **request)
            self.assertTrue(self.status.fresh().undo, service)
            call('step', n=2)
            hashes.append(self.status.fresh().hash)
        before = [hashes.pop()]
        for service, _ in reversed(edits):
            told = self.status.fresh().undo
            self.assertNotRegex(told, r'\bis\b', 'what was done, not what is so no more')
            self.assertEqual(call('undo').message, 'undone: ' + told, service)
            before.append(hashes.pop())
            self.assertEqual(self.status.fresh().hash, before[-1], service)
        for service, _ in edits:
            before.pop()
            call('redo')
            self.assertEqual(self.status.fresh().hash, before[-1], service)
        self.assert_refused(['nothing to redo', 'an undo first'], 'redo')

    def test_undo_leaves_the_clock_the_pace_and_the_solver_settings(self):
        call('set_speed', factor=2.0)
        call('spawn_body')
        call('step', n=30)
        call('set_fidelity', fidelity='preview')
        before = self.status.fresh()
        call('undo')
        after = self.status.fresh()
        self.assertEqual((after.steps, after.fidelity, after.requested_speed, after.paused), (0, 'preview', 2.0, True))
        self.assertGreater(after.header.stamp, before.header.stamp)
        call('set_speed', factor=1.0)

    def test_an_undo_keeps_the_wind_that_was_switched_off(self):
        call('set_wind', velocity=Vector3(1, 2, 0))
        call('enable_wind', data=False)
        call('spawn_body')
        call('undo')
        self.assertIn('wind (1, 2, 0) m/s', call('enable_wind', data=True).message)

    def test_status_tells_what_no_file_holds(self):
        self.assertFalse(self.status.fresh().unsaved)
        call('spawn_body', name='new')
        self.assertTrue(self.status.fresh().unsaved)
        call('save_scene', file=self.file('edited.yaml'))
        self.assertFalse(self.status.fresh().unsaved)
        call('delete_body', name='new')
        self.assertTrue(self.status.fresh().unsaved)
        self.assertFalse(ask('save_state', file='/nowhere/state.yaml').success)
        self.assertTrue(self.status.fresh().unsaved)
        call('undo')
        self.assertFalse(self.status.fresh().unsaved)

    def test_speed_zero_runs_as_fast_as_possible(self):
        call('set_speed', factor=0.0)
        call('resume')
        wait(lambda: self.status.fresh().achieved_speed > 3.0, 'it runs at more than three times real time')
        call('set_speed', factor=1.0)

    # --- scenes and states

    def test_every_scene_of_the_catalogue_loads_and_steps(self):
        scenes = call('list_scenes')
        wanted = {'ball_hits_wall', 'boxes_on_slope', 'playground', 'tower', 'dominoes', 'pyramid', 'newtons_cradle',
                  'bullet_and_paper', 'shapes', 'spinning_box', 'sphere_rain', 'mixed_rain', 'windy_day'}
        self.assertLessEqual(wanted, set(scenes.names))
        for name, what in zip(scenes.names, scenes.properties):
            self.assertTrue(what, name)
            call('load_scene', name=name)
            call('step', n=2)

    def test_each_of_many_loads_at_once_is_answered_with_its_own_scene(self):
        names = ['sphere_rain', 'tower', 'gas', 'dominoes', 'newtons_cradle', 'pyramid']
        for _ in range(3):
            with concurrent.futures.ThreadPoolExecutor(len(names)) as pool:
                answers = list(pool.map(lambda name: ask('load_scene', name=name), names))
            for name, answer in zip(names, answers):
                self.assertTrue(answer.success, answer.message)
                self.assertIn("loaded '%s'" % name, answer.message)

    def test_a_saved_scene_and_a_saved_state_come_back(self):
        call('spawn_body', name='extra')
        call('spawn_body', name='corner', shape='hull', points=CORNER)
        call('step', n=20)
        scene, state = self.file('scene.yaml'), self.file('state.yaml')
        call('save_scene', file=scene)
        call('save_state', file=state)
        hash_then = self.status.fresh().hash
        call('step', n=20)
        hash_later = self.status.fresh().hash
        call('load_state', file=state)
        self.assertEqual(self.status.fresh().hash, hash_then)
        call('step', n=20)
        self.assertEqual(self.status.fresh().hash, hash_later)
        call('load_scene', name=scene)
        self.assertIn('extra', call('list_bodies').names)

    # --- refusals

    def test_bad_numbers_are_refused_and_change_nothing(self):
        # Not subtests: rostest does not count their failures.
        call('spawn_body', name='can', shape='cylinder')
        call('spawn_body', name='corner', shape='hull', points=CORNER)
        v = Vector3
        faults = []
        call('spawn_body', name='wall', shape='plane', is_static=True, pose=at(0, 0, -1))
        for words, service, request in [
            (['mass', '-1'], 'spawn_body', dict(mass=-1.0)),
            (['mass'], 'spawn_body', dict(mass=NAN)),
            (['mass', 'density'], 'spawn_body', dict(mass=1.0, density=1.0)),
            (['size'], 'spawn_body', dict(size=v(-1, 1, 1))),
            (['size'], 'spawn_body', dict(size=v(1e12, 1, 1))),
            (['friction', '-0.1'], 'spawn_body', dict(material=Material(friction=[-0.1]))),
            (['friction'], 'spawn_body', dict(material=Material(friction=[INF]))),
            (['friction'], 'spawn_body', dict(material=Material(friction=[0.1, 0.2]))),
            (['restitution', '1.5'], 'spawn_body', dict(material=Material(restitution=[1.5]))),
            (['position'], 'spawn_body', dict(pose=at(NAN, 0, 0))),
            (['orientation'], 'spawn_body', dict(pose=Pose(Point(1, 0, 0), Quaternion(NAN, 0, 0, 1)))),
            (['shape', 'banana'], 'spawn_body', dict(shape='banana')),
            (['size'], 'spawn_body', dict(shape='cylinder', size=v(1, 2, 1))),
            (['size', 'round'], 'spawn_body', dict(shape='capsule', size=v(1, 1, 0.5))),
            (['size'], 'spawn_body', dict(shape='cone', size=v(1, 1, NAN))),
            (['points', 'mesh'], 'spawn_body', dict(shape='hull')),
            (['points', 'mesh'], 'spawn_body', dict(shape='hull', points=CORNER, mesh='/a.stl')),
            (['hull'], 'spawn_body', dict(shape='box', points=CORNER)),
            (['size'], 'spawn_body', dict(shape='hull', points=CORNER, size=v(1, 1, 1))),
            (['scale', '-1'], 'spawn_body', dict(shape='hull', points=CORNER, scale=-1.0)),
            (['scale'], 'spawn_body', dict(shape='hull', points=CORNER, scale=NAN)),
            (['points'], 'spawn_body', dict(shape='hull', points=CORNER, scale=1e300)),
            (['3 points'], 'spawn_body', dict(shape='hull', points=CORNER[:3])),
            (['points[1]', 'nan'], 'spawn_body', dict(shape='hull', points=[Point(), Point(NAN, 0, 0)] + CORNER)),
            (['same place'], 'spawn_body', dict(shape='hull', points=5 * [Point(1, 2, 3)])),
            (['line'], 'spawn_body', dict(shape='hull', points=[Point(k, k, k) for k in range(5)])),
            (['plane'], 'spawn_body', dict(shape='hull', points=[Point(k, k * k, 1) for k in range(5)])),
            (['/nowhere.stl'], 'spawn_body', dict(shape='hull', mesh='/nowhere.stl')),
            (['relative.stl', 'absolute'], 'spawn_body', dict(shape='hull', mesh='relative.stl')),
            (['package'], 'spawn_body', dict(shape='hull', mesh='package://no_such_package/a.stl')),
            (['broken.stl'], 'spawn_body', dict(shape='hull', mesh=self.file('broken.stl', 'solid broken\nfacet'))),
            (['size'], 'resize_body', dict(name='can', size=v(1, 2, 1))),
            (['size'], 'resize_body', dict(name='corner', size=v(1, -2, 1))),
            (['size'], 'resize_body', dict(name='corner', size=v(1e-7, 0, 0))),
            (['points'], 'resize_body', dict(name='corner', factor=1e-9)),
            (['plane'], 'resize_body', dict(name='floor', size=v(1, 1, 1))),
            (['crate'], 'spawn_body', dict(name='crate')),
            (['name'], 'spawn_body', dict(name='two words')),
            (['nobody', 'tf knows no frame of this name'], 'spawn_body', dict(frame_id='nobody', pose=at(1, 0, 0))),
            (['velocity', '[inf, 0, 0]'], 'spawn_body', dict(twist=Twist(v(INF, 0, 0), v()))),
            (['cratee', 'crate'], 'delete_body', dict(name='cratee')),
            (['factor', '-2'], 'resize_body', dict(name='crate', factor=-2.0)),
            (['factor'], 'resize_body', dict(name='crate', factor=NAN)),
            (['factor'], 'resize_body', dict(name='crate')),
            (['size'], 'resize_body', dict(name='crate', size=v(1, -1, 1))),
            (['nobody'], 'resize_body', dict(name='nobody', factor=2.0)),
            (['position', 'inf'], 'move_body', dict(name='crate', pose=at(0, INF, 0))),
            (['position', '[0, -inf, 2]'], 'spawn_body', dict(pose=at(0, -INF, 2))),
            (['velocity', '[inf, 0, 0]'], 'set_body', dict(name='crate', twist=[Twist(v(INF, 0, 0), v())])),
            (['impulse', '[0, inf, 0]'], 'apply_impulse', dict(name='crate', impulse=v(0, INF, 0))),
            (['point', '[0, inf, '], 'apply_impulse', dict(name='crate', impulse=v(1, 0, 0), point=[Point(0, INF, 0)])),
            (['torque', '[0, 0, inf]'], 'apply_wrench', dict(name='crate', torque=v(0, 0, INF), seconds=1.0)),
            (['mass', ': nan '], 'spawn_body', dict(mass=-NAN)),
            (['nobody'], 'move_body', dict(name='nobody')),
            (['mass'], 'set_body', dict(name='crate', mass=-3.0)),
            (['restitution'], 'set_body', dict(name='crate', material=Material(restitution=[NAN]))),
            (['nobody'], 'set_body', dict(name='nobody', mass=1.0)),
            (['impulse'], 'apply_impulse', dict(name='crate', impulse=v(NAN, 0, 0))),
            (['floor'], 'apply_impulse', dict(name='floor', impulse=v(1, 0, 0))),
            (['seconds'], 'apply_wrench', dict(name='crate', force=v(1, 0, 0), seconds=0.0)),
            (['seconds'], 'apply_wrench', dict(name='crate', force=v(1, 0, 0), seconds=-1.0)),
            (['force', '[inf, 0, 0]'], 'apply_wrench', dict(name='crate', force=v(INF, 0, 0), seconds=1.0)),
            (['velocity'], 'set_wind', dict(velocity=v(NAN, 0, 0))),
            (['gust'], 'set_wind', dict(gust=-1.0)),
            (['gravity'], 'set_gravity', dict(gravity=v(0, 0, NAN))),
            (['effect', 'magnetism', 'gravity', 'drag'], 'set_effects', dict(force_on=['magnetism'])),
            (['drag', 'twice'], 'set_effects', dict(force_on=['drag'], force_off=['drag'])),
            (['fidelity', 'best', 'accurate'], 'set_fidelity', dict(fidelity='best')),
            (['speed', '-1'], 'set_speed', dict(factor=-1.0)),
            (['speed', 'nan'], 'set_speed', dict(factor=NAN)),
            (['1,000,000'], 'step', dict(n=2000000)),
            (['nobody'], 'get_body', dict(name='nobody')),
            (['direction', '[0, 0, 0]'], 'cast_ray', dict()),
            (['direction', 'nan'], 'cast_ray', dict(direction=v(NAN, 0, 0))),
            (['origin', 'inf'], 'cast_ray', dict(direction=v(1, 0, 0), origin=Point(INF, 0, 0))),
            (['max_distance', '-1', '0: without end'], 'cast_ray', dict(direction=v(1, 0, 0), max_distance=-1.0)),
            (['max_distance', 'nan'], 'cast_ray', dict(direction=v(1, 0, 0), max_distance=NAN)),
            (['nobody'], 'cast_ray', dict(direction=v(1, 0, 0), frame_id='nobody')),
            (['cratee', 'crate'], 'cast_ray', dict(direction=v(1, 0, 0), ignore=['cratee'])),
            (['nobody'], 'closest_points', dict(body_a='nobody', body_b='crate')),
            (['name'], 'closest_points', dict(body_a='crate')),
            (['body_a: empty', 'body_b: empty'], 'closest_points', dict()),
            (['changes: empty'], 'edit_bodies', dict()),
            (['bodies[1].frame_id', 'nope'], 'spawn_bodies', dict(bodies=[BodySpec(), BodySpec(frame_id='nope')])),
            (['name: ', 'a name of the catalogue, or an absolute path'], 'load_scene', dict(name='tower.yaml')),
            (['of a length of at most'], 'set_gravity', dict(gravity=v(8e6, 0, -8e6))),
            (['body_b', 'crate'], 'closest_points', dict(body_a='crate', body_b='crate')),
            (['body_b', 'plane'], 'closest_points', dict(body_a='floor', body_b='wall')),
            (['banana'], 'overlaps', dict(shape='banana')),
            (['size'], 'overlaps', dict(size=v(-1, 1, 1))),
            (['position'], 'overlaps', dict(pose=at(NAN, 0, 0))),
            (['margin', '-0.1'], 'overlaps', dict(margin=-0.1)),
            (['margin', 'nan'], 'overlaps', dict(margin=NAN)),
            (['nobody'], 'overlaps', dict(frame_id='nobody')),
            (['points', 'mesh'], 'overlaps', dict(shape='hull')),
            (['place', 'points', 'hull'], 'overlaps', dict(points=CORNER)),
            (['points', 'nan'], 'overlaps', dict(shape='hull', points=CORNER[:3] + [Point(NAN, 0, 0)])),
        ]:
            faults += self.fault_of(words, service, **request)
        self.assertEqual(faults, [])

    def test_bad_files_are_refused_whole_and_change_nothing(self):
        faults = []
        good = '- {name: floor, shape: plane, kind: static}\n'
        for words, text in [
            (['bad.yaml:2', 'colour'], 'bodies:\n  - {name: a, colour: red}\n'),
            (['bad.yaml:1', 'gravitation'], 'gravitation: 3\nbodies: []\n'),
            (['bad.yaml:3', 'mass'], 'bodies:\n  ' + good + '  - {name: a, mass: -4}\n'),
            (['bad.yaml'], 'bodies: [[[[{'),
            (['bad.yaml'], '\x00\x01\x02'),
            (['bad.yaml'], 'a: &a [x, x]\nb: &b [*a, *a]\nbodies: [*b, *b]\n'),
            (['bad.yaml:2', '100000'], 'bodies:\n  - {name: a, repeat: {count: [1000, 1000, 1000], spacing: [1, 1, 1]}}\n'),
            (['bad.yaml:3', 'name'], 'bodies:\n  - {name: a}\n  - {name: a}\n'),
            (['step'], 'step: .nan\nbodies: []\n'),
        ]:
            faults += self.fault_of(words, 'load_scene', name=self.file('bad.yaml', text))
            faults += self.fault_of(['bad.yaml'], 'load_state', file=self.file('bad.yaml'))
        self.assertEqual(faults, [])
        self.assert_refused(['towr', 'tower'], 'load_scene', name='towr')
        self.assert_refused(['/nowhere'], 'load_scene', name='/nowhere/scene.yaml')
        self.assert_refused(['/nowhere'], 'load_state', file='/nowhere/state.yaml')
        self.assert_refused(['/nowhere'], 'save_state', file='/nowhere/state.yaml')
        self.assert_refused(['absolute'], 'save_scene', file='relative.yaml')

    def test_paths_are_what_they_say_or_refused(self):
        faults = []
        folder = self.folder.name
        for words, service, request in [
            (['folder'], 'save_scene', dict(file=folder)),
            (['folder'], 'save_scene', dict(file=folder + '/')),
            (['control'], 'save_scene', dict(file=folder + '/a.yaml\0.png')),
            (['control'], 'save_state', dict(file=folder + '/a\nb.yaml')),
            (['control'], 'load_state', dict(file=SMALL + '\0')),
            (['control'], 'load_scene', dict(name=SMALL + '\0')),
            (['absolute'], 'load_scene', dict(name='../scenes/tower.yaml')),
            (['absolute'], 'load_scene', dict(name='small.yaml')),
            (['not a scene'], 'load_scene', dict(name='/etc/passwd')),
            (['not a scene'], 'load_scene', dict(name=self.file('secret.yaml', 'name: secret\npassword: secret\n'))),
            (['no such file'], 'load_state', dict(file='/etc/passwd')),
            (['File name too long'], 'save_scene', dict(file=folder + '/' + 300 * 'x')),
            (['byte 0'], 'spawn_body', dict(shape='hull', mesh='/\0.obj')),
        ]:
            faults += self.fault_of(words, service, **request)
        self.assertEqual(faults, [])
        for file in ('/etc/passwd', self.file('secret.yaml')):
            message = ask('load_scene', name=file).message
            self.assertFalse('root:' in message or "'secret'" in message or 'password' in message, message)
        self.assertEqual(os.listdir(folder + '/..').count(os.path.basename(folder) + '.yaml'), 0)

    def test_a_file_is_overwritten_only_when_asked_and_whole(self):
        scene = self.file('kept.yaml', 'mine\n')
        os.chmod(scene, 0o640)
        for service in ('save_scene', 'save_state'):
            self.assert_refused(['overwrite'], service, file=scene)
            self.assert_refused(['overwrite'], service, file=scene[:-len('.yaml')])
        with open(scene) as file:
            self.assertEqual(file.read(), 'mine\n')
        before = set(os.listdir(self.folder.name))
        call('save_scene', file=scene, overwrite=True)
        self.assertEqual(set(os.listdir(self.folder.name)), before)  # nothing is left beside it
        self.assertEqual(os.stat(scene).st_mode & 0o777, 0o640)
        call('load_scene', name=scene)

    def test_a_file_keeps_the_ending_yml(self):
        path = self.file('short.yml')
        call('save_scene', file=path)
        self.assertEqual([name for name in os.listdir(self.folder.name) if name.startswith('short')], ['short.yml'])
        call('load_scene', name=path)

    def test_saving_follows_no_links(self):
        target, link, hanging = self.file('target.yaml', 'mine\n'), self.file('link.yaml'), self.file('hanging.yaml')
        os.symlink(target, link)
        os.symlink(self.file('nowhere'), hanging)
        for path in (link, hanging):
            self.assert_refused(['overwrite'], 'save_scene', file=path)
            self.assert_refused(['regular'], 'save_scene', file=path, overwrite=True)
        foreseen = self.file('new.yaml.part')
        os.symlink(target, foreseen)
        call('save_scene', file=self.file('new.yaml'))
        with open(target) as file:
            self.assertEqual(file.read(), 'mine\n')
        self.assertFalse(os.path.exists(self.file('nowhere')))

    def test_of_two_saves_at_once_one_is_refused_and_the_other_whole(self):
        for number in range(10):
            path = self.file('race_%d.yaml' % number)
            with concurrent.futures.ThreadPoolExecutor(4) as pool:
                answers = list(pool.map(lambda _: ask('save_state', file=path), range(4)))
            self.assertEqual([answer.success for answer in answers].count(True), 1)
            call('load_state', file=path)

    def test_names_that_would_break_tf_or_the_shell_are_refused(self):
        faults = []
        for name in ('world', '/a', 'a/', 'a//b', '-x', '--json', 'a b', 'a.b', '7up', 'a\0b', 'caf\xe9', 65 * 'a'):
            faults += self.fault_of(['name'], 'spawn_body', name=name)
            faults += self.fault_of(['name'], 'spawn_bodies', bodies=[BodySpec(name='good'), BodySpec(name=name)])
            text = 'bodies:\n  - {name: "%s"}\n' % name.replace('\0', '\\0')
            faults += self.fault_of(['named.yaml', 'name'], 'load_scene', name=self.file('named.yaml', text))
        faults += self.fault_of(['name'], 'spawn_bodies', bodies=[BodySpec(name='twin'), BodySpec(name='twin')])
        self.assertEqual(faults, [])

    def test_refusals_stay_short_whatever_they_refuse(self):
        long = 100000 * 'n'
        for service, request in (('spawn_body', dict(name=long)), ('spawn_body', dict(shape=long)),
                                 ('spawn_body', dict(kind=long)), ('spawn_body', dict(shape='hull', mesh='/' + long)),
                                 ('spawn_body', dict(frame_id=long, pose=at(1, 0, 0))), ('delete_body', dict(name=long)),
                                 ('cast_ray', dict(direction=Vector3(1, 0, 0), ignore=[long])),
                                 ('closest_points', dict(body_a=long, body_b='crate')), ('load_scene', dict(name=long)),
                                 ('load_scene', dict(name='/' + long)), ('save_scene', dict(file='/' + long)),
                                 ('set_effects', dict(force_on=[long])), ('set_fidelity', dict(fidelity=long)),
                                 ('tune_fidelity', dict(preset=long)), ('set_body', dict(name='crate', kind=long))):
            answer = ask(service, **request)
            self.assertFalse(answer.success, service)
            self.assertLess(len(answer.message), 1500, service)

    def test_numbers_are_told_as_they_were_sent(self):
        turned = Pose(Point(0, 0, 9), Quaternion(0.5, 0.5, 0.5, 0.5))
        call('move_body', name='crate', pose=turned)
        for service, request in (('apply_impulse', dict(name='crate', impulse=Vector3(INF, 0, 0))),
                                 ('apply_wrench', dict(name='crate', torque=Vector3(INF, 0, 0), seconds=1.0)),
                                 ('apply_wrench', dict(name='crate', force=Vector3(INF, 0, 0), seconds=1.0)),
                                 ('apply_impulse', dict(name='crate', point=[Point(INF, 0, 0)])),
                                 ('spawn_body', dict(pose=at(INF, 0, 0))),
                                 ('spawn_body', dict(twist=Twist(Vector3(INF, 0, 0), Vector3()))),
                                 ('overlaps', dict(pose=at(INF, 0, 0)))):
            message = ask(service, frame_id='crate', **request).message
            self.assertIn('inf, 0, 0', message)
            self.assertNotIn('nan', message)

    def test_kinematic_bodies_and_collision_groups(self):
        call('spawn_body', name='belt', kind='kinematic', pose=at(0, 5, 3), twist=Twist(Vector3(1, 0, 0), Vector3()))
        made = body('belt').description
        self.assertEqual((made.kind, made.collision_group, made.collision_mask), ('kinematic', 1, 0xffffffff))
        call('step', n=60)
        self.assertAlmostEqual(body('belt').pose.position.x, 1.0)
        call('set_body', name='belt', twist=[Twist(Vector3(0, 2, 0), Vector3())])
        call('step', n=60)
        self.assertAlmostEqual(body('belt').pose.position.y, 7.0)
        call('set_body', name='belt', kind='dynamic')
        self.assertEqual(body('belt').twist.linear.y, 2.0)
        call('set_body', name='belt', kind='static')
        self.assertEqual((body('belt').description.kind, body('belt').twist.linear.y), ('static', 0.0))

        call('spawn_body', name='ghost', collision_group=[4], collision_mask=[0], pose=at(0, 9, 0.3))
        self.assertEqual((body('ghost').description.collision_group, body('ghost').description.collision_mask), (4, 0))
        call('step', n=60)
        self.assertLess(body('ghost').pose.position.z, -3.0)  # through the floor
        call('move_body', name='ghost', pose=at(0, 9, 0.3))
        call('set_body', name='ghost', collision_mask=[2])
        call('step', n=60)
        self.assertLess(body('ghost').pose.position.z, -3.0)  # the floor's group is 1
        call('move_body', name='ghost', pose=at(0, 9, 0.3))
        call('set_body', name='ghost', collision_mask=[0xffffffff], collision_group=[1])
        call('step', n=60)
        self.assertGreater(body('ghost').pose.position.z, 0.2)
        faults = []
        for words, service, request in [
            (['kind', 'flying'], 'spawn_body', dict(kind='flying')),
            (['is_static', 'kind'], 'spawn_body', dict(kind='kinematic', is_static=True)),
            (['collision_group', '2 entries'], 'spawn_body', dict(collision_group=[1, 2])),
            (['velocity', 'static'], 'spawn_body', dict(kind='static', twist=Twist(Vector3(1, 0, 0), Vector3()))),
            (['kind', 'plane'], 'spawn_body', dict(shape='plane', kind='dynamic')),
            (['kind', 'flying'], 'set_body', dict(name='crate', kind='flying')),
            (['is_static', 'kind'], 'set_body', dict(name='crate', kind='static', is_static=[False])),
            (['collision_mask', '2 entries'], 'set_body', dict(name='crate', collision_mask=[1, 2])),
        ]:
            faults += self.fault_of(words, service, **request)
        self.assertEqual(faults, [])

    def test_the_simulation_goes_on_while_a_large_mesh_is_read(self):
        rows = ''.join('v %d %d %d\n' % (k % 97, k % 89, k % 83) for k in range(990000))
        mesh = self.file('large.obj', rows)
        call('resume')
        states = Listener('/sim/body_states', BodyStates)
        states.next('the bodies move')
        states.clear()
        answer = ask('spawn_body', shape='hull', mesh=mesh, pose=at(0, 0, 500))
        stamps = {message.header.stamp for message in states.all()}
        self.assertTrue(answer.success, answer.message)
        call('pause')
        self.assertGreater(len(stamps), 3)


if __name__ == '__main__':
    rospy.init_node('services_test')
    rostest.rosrun('rigid_body_sim', 'services', ServicesTest)
