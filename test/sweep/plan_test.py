#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a sweep file becomes: its tasks, beside tasks that were worked out by hand; and its faults."""
import collections
import os
import statistics
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from rigid_body_sim.sweep import tree  # noqa: E402
from rigid_body_sim.sweep.plan import Plan, checked_numbers  # noqa: E402
from rigid_body_sim.sweep.reader import Reader  # noqa: E402
from sweep_file import ROOT, SweepCase  # noqa: E402


class TreeTest(unittest.TestCase):
    def test_scalars_are_what_the_scene_reader_takes_them_for(self):
        text = '[1, -2, 1e-3, .5, 0x1F, off, yes, "1", null, true, 1.5e3, .inf, -, 1_0]'
        self.assertEqual(tree.read(text, 'f')[0],
                         [1, -2, 1e-3, 0.5, 31, 'off', 'yes', '1', None, True, 1500.0, '.inf', '-', '1_0'])

    def test_places_have_their_lines(self):
        value, lines = tree.read('a: 1\nb:\n  - c: 2\n    d: [3,\n      4]\n', 'f')
        self.assertEqual(value, {'a': 1, 'b': [{'c': 2, 'd': [3, 4]}]})
        self.assertEqual((lines['a',], lines['b', 0, 'd'], lines['b', 0, 'd', 1]), (1, 4, 5))

    def test_what_is_no_plain_tree_is_refused_with_its_line(self):
        for text, said in (('a: 1\na: 2', 'f:2: a; the key stands twice'), ('a: &x 1\nb: *x', 'f:2: *x; aliases'),
                           ('a: [1\nb: 2', 'f:2: '), ('a: {b[c].d: 1}', 'within braces a path with [ ] stands in quotes'),
                           ('? [1]\n: 2', 'f:1: a key that is a list')):
            with self.assertRaises(tree.Refused) as caught:
                tree.read(text, 'f')
            self.assertIn(said, str(caught.exception))

    def test_values_are_put_at_paths(self):
        scene = {'bodies': [{'name': 'a/b', 'velocity': [1, 2, 3]}, {'name': 'c'}], 'fidelity': 'accurate'}
        for path, where, value in (('bodies[a/b].velocity[1]', lambda s: s['bodies'][0]['velocity'], [1, 9, 3]),
                                   ('bodies[1].friction', lambda s: s['bodies'][1], {'name': 'c', 'friction': 9}),
                                   ('air.density', lambda s: s['air'], {'density': 9}), ('fidelity', lambda s: s['fidelity'], 9)):
            self.assertEqual(where(tree.replaced(scene, path, 9)), value)
        self.assertEqual(scene, {'bodies': [{'name': 'a/b', 'velocity': [1, 2, 3]}, {'name': 'c'}], 'fidelity': 'accurate'})

    def test_paths_that_lead_nowhere_are_refused(self):
        scene = {'bodies': [{'name': 'a'}], 'fidelity': 'accurate'}
        for path, said in (('bodies[b].mass', "no entry is named 'b' (there are: a)"), ('bodies[3].mass', '[3] of a list of 1'),
                           ('bodies[a].velocity[0]', "there is no list 'velocity'"),
                           ('fidelity.sub_steps', 'follows what has no keys'),
                           ('step[0]', "there is no list 'step'"), ('fidelity[0]', 'follows what is no list'), ('', 'is no path'),
                           ('[0]', 'is no path'), ('a..b', 'is no path'), ('a[', 'is no path')):
            with self.assertRaises(tree.Refused, msg=path) as caught:
                tree.replaced(scene, path, 1)
            self.assertIn(said, str(caught.exception))


class PlanTest(SweepCase):
    def plan(self, text):
        return Reader(str(self.write(text)), lambda name: str(ROOT / 'scenes' / (name + '.yaml'))).read()

    def faults(self, text):
        with self.assertRaises(tree.Refused) as caught:
            self.plan(text)
        return [fault.replace(str(self.folder) + '/', '') for fault in caught.exception.faults]

    def test_combinations_are_numbered_like_an_odometer(self):
        plan = self.plan('''
scene: tower
steps: 1
repeats: 2
vary:
  step: [0.01, 0.02]
  bodies[floor].friction: {range: [0, 1], count: 3}
  gravity: [[0, 0, -1]]
''')
        wanted = [(step, friction, [0, 0, -1]) for step in (0.01, 0.02) for friction in (0.0, 0.5, 1.0) for _ in range(2)]
        self.assertEqual(plan.count, 12)
        self.assertEqual([tuple(plan.parameters(k)[1].values()) for k in range(12)], wanted)
        self.assertEqual(plan.task(9).scene['bodies'][0]['friction'], 0.5)
        self.assertEqual(plan.task(9).scene['step'], 0.02)
        self.assertEqual(plan.task(9).scene['name'], 'tower')

    def test_ranges_have_their_ends_and_whole_numbers_stay_whole(self):
        plan = self.plan('''
scene: tower
steps: 1
vary:
  fidelity.sub_steps: {range: [1, 9], count: 5}
  bodies[floor].friction: {log_range: [0.01, 10], count: 4}
  bodies[floor].restitution: {range: [1, 0], count: 3}
  seed: {range: [1, 2], count: 3}
''')
        values = [axis.values for axis in plan.axes]
        self.assertEqual(repr(values[0]), '[1, 3, 5, 7, 9]')
        self.assertEqual((values[1][0], values[1][3]), (0.01, 10))
        self.assertAlmostEqual(values[1][1], 0.1, 15)
        self.assertAlmostEqual(values[1][2], 1.0, 14)
        self.assertEqual(values[2], [1.0, 0.5, 0])
        self.assertEqual(values[3], [1.0, 1.5, 2])

    def test_draws_follow_from_the_seed_and_the_number_alone(self):
        text = '''
scene: tower
steps: 1
seed: 42
repeats: 1000
vary:
  bodies[floor].friction: {uniform: [1, 3]}
  step: [0.01, 0.02]
  bodies[floor].restitution: {normal: [0.5, 0.1]}
  bodies[box].density: {log_uniform: [1, 10000]}
  seed: {integers: [5, 8]}
'''
        plan = self.plan(text)
        # Words of numpy.random.SeedSequence(42, spawn_key=(number,)), as NumPy 1.24 has given them.
        self.assertEqual(plan.parameters(0)[0], 16138347438539916964)
        backwards = [plan.parameters(k) for k in reversed(range(2000))]
        forwards = [Plan.from_text(plan.text()).parameters(k) for k in range(2000)]
        self.assertEqual(backwards[::-1], forwards)
        self.assertEqual(len({seed for seed, _ in forwards}), 2000)
        columns = {path: [parameters[path] for _, parameters in forwards] for path in forwards[0][1]}
        self.assertEqual(columns['step'], [0.01] * 1000 + [0.02] * 1000)
        # Each bound is at least 4 standard deviations of what it bounds.
        friction = columns['bodies[floor].friction']
        self.assertTrue(1 < min(friction) < 1.02 and 2.98 < max(friction) < 3)
        self.assertAlmostEqual(statistics.mean(friction), 2, delta=0.06)
        restitution = columns['bodies[floor].restitution']
        self.assertAlmostEqual(statistics.mean(restitution), 0.5, delta=0.01)
        self.assertAlmostEqual(statistics.stdev(restitution), 0.1, delta=0.007)
        density = columns['bodies[box].density']
        self.assertAlmostEqual(sum(d < 100 for d in density), 1000, delta=90)
        self.assertTrue(1 <= min(density) and max(density) <= 10000)
        counts = collections.Counter(columns['seed'])
        self.assertEqual(sorted(counts), [5, 6, 7, 8])
        self.assertTrue(all(abs(n - 500) < 80 for n in counts.values()), counts)

    def test_another_seed_draws_other_values(self):
        text = 'scene: tower\nsteps: 1\nrepeats: 9\nseed: %d\nvary: {"bodies[floor].friction": {uniform: [0, 1]}}\n'
        one, two = self.plan(text % 1), self.plan(text % 2)
        self.assertNotEqual(one.parameters(3), two.parameters(3))
        self.assertNotEqual(one.fingerprint(), two.fingerprint())
        self.assertEqual(one.fingerprint(), self.plan(text % 1 + 'max_seconds: 7\n').fingerprint())

    def test_a_scene_may_take_the_seed_of_its_run(self):
        plan = self.plan('scene: tower\nsteps: 1\nrepeats: 3\nvary: {seed: run_seed, step: {uniform: [0.01, 0.02]}}\n')
        seed, parameters = plan.parameters(2)
        self.assertEqual(parameters['seed'], seed)
        self.assertEqual(plan.task(2).scene['seed'], seed)
        other = self.plan('scene: tower\nsteps: 1\nrepeats: 3\nvary: {step: {uniform: [0.01, 0.02]}}\n')
        self.assertEqual(other.parameters(2)[1]['step'], parameters['step'])

    def test_the_length_of_a_run(self):
        self.assertEqual(self.plan('scene: tower\nduration: 2\n').steps(1 / 60), 120)
        self.assertEqual(self.plan('scene: tower\nsteps: 7\n').steps(0.01), 7)

    def test_values_are_tried_before_with_the_others_at_their_first(self):
        plan = self.plan('scene: tower\nsteps: 1\nrepeats: 100\nvary: {step: [0.01, 0.02, 0.03], fidelity: [preview, accurate]}\n')
        self.assertEqual(checked_numbers(plan), [0, 100, 200, 400])

    def test_meshes_are_found_from_elsewhere(self):
        plan = self.plan('scene: {bodies: [{shape: hull, mesh: m.obj}, {shape: hull, mesh: package://p/m.obj}]}\nsteps: 1\n')
        self.assertEqual([body['mesh'] for body in plan.tree['scene']['bodies']], [str(self.folder / 'm.obj'), 'package://p/m.obj'])

    def test_every_fault_is_told_with_its_line(self):
        self.assertEqual(self.faults('''scene: 7
duration: -1
repeets: 3
seed: x
vary:
  step: []
  a..b: [1]
  gravity: {range: [0, 1]}
  density: {log_range: [0, 1], count: 3}
  mass: {normal: [1, 0]}
  seed: {integers: [3, 2]}
  friction: 3
  restitution: {range: [1, 1], count: 5}
  spin: {uniform: [0, 1], count: 5}
stop: {never: 1, at_rest: -1}
measure:
  a: speed
  b: {final_pose: 3}
  c: {states: {evry: 3}}
  d: {python: none.py:f}
  e/f: energy
  g: {energy: 3}
'''), [
            's.yaml:3: repeets: unknown key; keys: scene program seed duration steps repeats vary stop measure max_seconds',
            's.yaml:2: duration: -1 (allowed: a number above 0, in s)',
            's.yaml:1: scene: 7 (allowed: a name of the catalogue, the path of a scene, or a scene)',
            "s.yaml:4: seed: 'x' (allowed: a whole number from 0 to 18446744073709551615)",
            's.yaml:6: vary.step: an empty list (allowed: at least one value)',
            "s.yaml:7: vary.a..b: 'a..b' is no path (allowed: keys and entries, such as bodies[ball].velocity[0])",
            's.yaml:8: vary.gravity.count: None (allowed: a whole number from 2 to 1000000)',
            's.yaml:9: vary.density.log_range: [0, 1] (allowed: two different numbers above 0)',
            's.yaml:10: vary.mass.normal: [1, 0] (allowed: a mean and a standard deviation above 0)',
            's.yaml:11: vary.seed.integers: [3, 2] (allowed: a smaller and a larger whole number)',
            's.yaml:12: vary.friction: 3 (allowed: a list, run_seed, or a mapping with one of range, log_range, uniform, '
            'log_uniform, normal, integers)',
            's.yaml:13: vary.restitution.range: [1, 1] (allowed: two different numbers)',
            "s.yaml:14: vary.spin.count: a distribution is drawn from once a run; 'repeats' says how often",
            's.yaml:15: stop.never: unknown key; keys: at_rest fell python',
            's.yaml:15: stop.at_rest: speed: -1 (allowed: a number above 0)',
            "s.yaml:17: measure.a: 'speed' (allowed: one of final_position, final_pose, final_velocity, stood, energy, energy_change, "
            'penetration, time_to_rest, distance_to_reference, states, python, alone or with what it takes)',
            "s.yaml:18: measure.b: 3 (allowed: the name of a body, a list of names, or 'all')",
            's.yaml:19: measure.c: evry; unknown key; keys: every bodies',
            's.yaml:20: measure.d: none.py cannot be read: No such file or directory',
            "s.yaml:21: measure.e/f: it is no name (allowed: any word without '/')",
            's.yaml:22: measure.g: 3 (allowed: nothing)'])

    def test_a_trillion_runs_are_refused(self):
        axis = '{range: [0, 1], count: 1000000}'
        self.assertEqual(self.faults(f'scene: tower\nsteps: 1\nvary:\n  step: {axis}\n  seed: {axis}\n'),
                         ['s.yaml:3: vary: 1,000,000 of step x 1,000,000 of seed x 1 repeats are 1,000,000,000,000 runs '
                          '(allowed: 10,000,000)'])

    def test_faulty_functions_are_refused(self):
        self.write('import nothing_of_this_name\n', 'a.py')
        self.write('def f(:\n', 'b.py')
        self.write('x = 1\n', 'c.py')
        said = self.faults('scene: tower\nsteps: 1\n'
                           'measure: {a: {python: a.py:f}, b: {python: b.py:f}, c: {python: c.py:f}, d: {python: f}}\n')
        for fault, text in zip(said, ("ModuleNotFoundError: No module named 'nothing_of_this_name' (a.py, line 1)", 'SyntaxError',
                                      "there is no function 'f'", "'f' (allowed: FILE.py:FUNCTION)")):
            self.assertIn(text, fault)
        self.assertEqual(len(said), 4)


if __name__ == '__main__':
    unittest.main()
