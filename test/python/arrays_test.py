#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of states and contact points: nothing is copied, nothing can be written, and they outlive their world."""
import gc
import unittest

import numpy as np
import rigid_body_sim as rbs


def world_with_contacts():
    world = rbs.World(rbs.Scene.load('tower'))
    world.step(10)
    return world


class ArraysTest(unittest.TestCase):
    NAMES = ('states', 'positions', 'orientations', 'velocities', 'angular_velocities', 'ids')

    def test_arrays_are_views_of_one_memory(self):
        world = world_with_contacts()
        n = len(world.names)
        for source in (world, world.snapshot()):
            states = source.states
            self.assertEqual(states.shape, (n, 13))
            for name, columns in dict(positions=[0, 1, 2], orientations=[3, 4, 5, 6], velocities=[7, 8, 9],
                                      angular_velocities=[10, 11, 12]).items():
                array = getattr(source, name)
                np.testing.assert_array_equal(array, states[:, columns])
                self.assertTrue(np.shares_memory(array, states))
            for name in self.NAMES:
                array = getattr(source, name)
                self.assertFalse(array.flags.owndata)
                self.assertTrue(np.shares_memory(array, getattr(source, name)))
        np.testing.assert_array_equal(world.states, world.snapshot().states)
        self.assertTrue(np.shares_memory(world.contacts(), world.contacts()))
        self.assertIs(world.snapshot(), world.snapshot())

    def test_nothing_can_be_written(self):
        world = world_with_contacts()
        for array in [getattr(world, name) for name in self.NAMES] + [world.contacts(), world.snapshot().contacts()]:
            with self.assertRaises(ValueError):
                array[0] = array[1]
            with self.assertRaises(ValueError):
                array.flags.writeable = True

    def test_an_array_is_of_its_moment_and_outlives_the_world(self):
        world = world_with_contacts()
        kept = [getattr(world, name) for name in self.NAMES] + [world.contacts(), world.snapshot().states, world.snapshot().contacts()]
        copies = [array.copy() for array in kept]
        world.step(50)
        self.assertFalse(np.array_equal(world.positions, kept[1]))
        self.assertFalse(np.shares_memory(world.positions, kept[1]))
        world.edit_body(world.names[-1], position=[0, 0, 9])
        self.assertEqual(world.positions[-1].tolist(), [0, 0, 9])
        del world
        gc.collect()
        others = [world_with_contacts() for _ in range(20)]  # takes the memory that was freed
        self.assertEqual(len({other.state_hash() for other in others}), 1)
        for array, copied in zip(kept, copies):
            np.testing.assert_array_equal(array, copied)

    def test_orientations_are_unit_quaternions_with_w_last(self):
        scene = rbs.Scene([rbs.Body(orientation=[0, 0, 2, 0])])
        self.assertEqual(rbs.World(scene).orientations.tolist(), [[0, 0, 1, 0]])

    def test_contacts_carry_the_weight(self):
        scene = rbs.Scene([rbs.Body(rbs.Plane(), name='floor', kind='static'),
                           rbs.Body(rbs.Box([1, 1, 1]), mass=3, position=[5, 0, 0.5])])
        world = rbs.World(scene)
        world.step(200)
        contacts = world.contacts()
        self.assertEqual(contacts.shape, (4,))
        self.assertEqual((set(contacts['body_a']), set(contacts['body_b'])), ({1}, {2}))
        impulse = contacts['normal_impulse'][:, None] * contacts['normal'] + contacts['friction_impulse']
        np.testing.assert_allclose(impulse.sum(axis=0), [0, 0, 3 * 9.81 / 60], atol=1e-6)
        np.testing.assert_allclose(contacts['position'][:, 2], 0, atol=1e-3)
        self.assertTrue(np.all(np.abs(contacts['separation']) < 1e-3))
        self.assertEqual(contacts['touching_steps'].tolist(), [200] * 4)
        np.testing.assert_array_equal(np.searchsorted(world.ids, contacts['body_b']), 1)
        np.testing.assert_array_equal(contacts, world.snapshot().contacts())

    def test_a_snapshot_has_all_of_the_world(self):
        world = world_with_contacts()
        snapshot = world.snapshot()
        self.assertEqual((snapshot.scene, snapshot.time, snapshot.steps, snapshot.step, snapshot.edits, snapshot.hash),
                         ('tower', world.time, 10, 1 / 60, world.edits, world.state_hash()))
        self.assertEqual((snapshot.names, [body.name for body in snapshot.bodies()]), (world.names, world.names))
        self.assertEqual((snapshot.report.contacts, snapshot.totals().kinetic_energy),
                         (world.report.contacts, world.totals().kinetic_energy))
        self.assertEqual([stage.name for stage in snapshot.pipeline()], [stage.name for stage in world.pipeline()])
        self.assertEqual(snapshot.gravity.tolist(), [0, 0, -9.81])
        self.assertEqual((len(snapshot.methods), snapshot.methods[0]), (len(world.names), ''))


if __name__ == '__main__':
    unittest.main()
