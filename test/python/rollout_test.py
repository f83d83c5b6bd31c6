#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""rollout(): equal to single runs, for every number of threads."""
import unittest

import numpy as np
import rigid_body_sim as rbs


def scenes():
    result = [rbs.Scene.load(name) for name in ('ball_hits_wall', 'boxes_on_slope', 'newtons_cradle', 'shapes')]
    for k in range(8):
        scene = rbs.Scene.load('ball_hits_wall')
        scene.bodies[-1].velocity = [3 + 0.1 * k, 0, 0]
        result.append(scene)
    started = rbs.World(result[3])
    started.step(7)
    return [*result, started.capture()]


class RolloutTest(unittest.TestCase):
    def test_equal_to_single_runs_for_every_number_of_threads(self):
        steps, every = 60, 20
        runs = {threads: rbs.rollout(scenes(), steps, every, threads) for threads in (1, 2, 3)}
        most = max(len(scene.bodies) for scene in scenes())
        self.assertEqual((runs[1].states.shape, runs[1].times.shape), ((13, 4, most, 13), (13, 4)))
        for k, scene in enumerate(scenes()):
            world, n = rbs.World(scene), len(scene.bodies)
            for sample in range(steps // every + 1):
                if sample:
                    world.step(every)
                np.testing.assert_array_equal(runs[1].states[k, sample, :n], world.states)
                self.assertTrue(np.isnan(runs[1].states[k, sample, n:]).all())
                self.assertEqual(runs[1].times[k, sample], world.time)
            self.assertEqual(runs[1].hashes[k], world.state_hash())
        for threads in (2, 3):
            for mine, single in zip(runs[threads], runs[1]):
                np.testing.assert_array_equal(mine, single)

    def test_every_step_is_a_sample_unless_asked_otherwise(self):
        scene = rbs.Scene.load('ball_hits_wall')
        states, times, hashes, flags = rbs.rollout([scene], 5)
        self.assertEqual(flags, ((),))
        self.assertEqual((states.shape, times.shape, hashes.shape), ((1, 6, 3, 13), (1, 6), (1,)))
        self.assertEqual(rbs.rollout(iter([scene]), steps=6, every=6).states.shape, (1, 2, 3, 13))

    def test_a_run_in_which_a_body_was_stopped_is_flagged(self):
        sound, lost = rbs.Scene.load('ball_hits_wall'), rbs.Scene.load('ball_hits_wall')
        lost.bodies[-1].position = [9.9e8, 0, 0]
        lost.bodies[-1].velocity = [9.9e5, 0, 0]
        lost.step = 1
        flags = rbs.rollout([sound, lost, sound], 120, 120, 2).flags
        self.assertEqual(flags[0], ())
        self.assertIn('non_finite', flags[1])
        self.assertEqual(flags[2], ())

    def test_equal_rollouts_compare_as_equal_also_where_they_hold_nothing(self):
        scenes = [rbs.Scene.load('tower'), rbs.Scene.load('ball_hits_wall')]  # of unequal size: NaN where a body is missing
        one, other = rbs.rollout(scenes, 3), rbs.rollout(scenes, 3)
        self.assertTrue(np.isnan(one.states).any())
        self.assertTrue(one == other)
        self.assertTrue(one != rbs.rollout(scenes, 4))

    def test_a_scene_does_not_change(self):
        scene = scenes()[-1]
        text = scene.to_yaml()
        self.assertEqual(len(set(rbs.rollout([scene, scene], 9, 9, 2).hashes)), 1)
        self.assertEqual(scene.to_yaml(), text)

    def test_the_first_faulty_scene_is_named_by_its_number(self):
        many = scenes()
        many[5].bodies[0].friction = -1
        many[5].step = 0
        many[7].bodies[0].friction = -2
        for threads in (1, 2, 3):
            with self.assertRaises(rbs.InvalidInput) as caught:
                rbs.rollout(many, 20, threads=threads)
            self.assertEqual([problem.path for problem in caught.exception.problems],
                             ['scenes[5].step', 'scenes[5].bodies[0].material.friction'])

    def test_the_first_is_named_whichever_thread_is_faster(self):
        def faulty(bodies):
            """Its fault is found the later the more bodies it has."""
            scene = rbs.Scene([rbs.Body(position=[3 * k, 0, 0]) for k in range(bodies)])
            scene.bodies[-1].mass = -1
            return scene

        for many in [[faulty(30000), faulty(1)], [faulty(10000), faulty(30000)]] * 3:
            with self.assertRaisesRegex(rbs.InvalidInput, r'^scenes\[0\]'):
                rbs.rollout(many, 1, threads=2)

    def test_what_is_wrong_is_refused(self):
        scene = rbs.Scene()
        for text, call in {
                'scenes: none': lambda: rbs.rollout([], 1), 'scenes: 3': lambda: rbs.rollout(3, 1),
                r'scenes\[1\]: 3 .*a Scene': lambda: rbs.rollout([scene, 3], 1), 'steps: 0': lambda: rbs.rollout([scene], 0),
                'steps: -1': lambda: rbs.rollout([scene], -1), 'every: 0': lambda: rbs.rollout([scene], 1, 0),
                'every: 2 .*1 to 1': lambda: rbs.rollout([scene], 1, 2),
                'every: 3 .*a divisor of steps, 10': lambda: rbs.rollout([scene], 10, 3),
                'threads: 0': lambda: rbs.rollout([scene], 1, 1, 0), 'threads: -1': lambda: rbs.rollout([scene], 1, 1, -1),
                "threads: 'all'": lambda: rbs.rollout([scene], 1, threads='all')}.items():
            with self.assertRaisesRegex(rbs.InvalidInput, text):
                call()

    def test_more_results_than_there_is_memory_raise(self):
        scene = rbs.Scene([rbs.Body(position=[0, 0, k]) for k in range(100)])
        with self.assertRaises((MemoryError, ValueError)):
            rbs.rollout([scene] * 100, 10**9)


if __name__ == '__main__':
    unittest.main()
