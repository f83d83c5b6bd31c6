#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a run measures, beside closed forms; how it stops; and the program as people call it: refusals, --dry-run, --only,
charts."""
import contextlib
import csv
import hashlib
import io
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import h5py  # noqa: E402
import numpy  # noqa: E402
from rigid_body_sim import Scene, World  # noqa: E402
from rigid_body_sim.sweep import carry, charts, command  # noqa: E402
from rigid_body_sim.sweep.reader import Reader  # noqa: E402
from rigid_body_sim.sweep.run import record_of, run_chunk, run_task  # noqa: E402
from rigid_body_sim.sweep.store import Store  # noqa: E402
from rigid_body_sim.sweep.tree import Refused  # noqa: E402
from sweep_file import PROGRAM, SweepCase  # noqa: E402

# A ball falls through empty space: 1 kg, from 100 m, at 3 m/s along x.
FALL = 'scene: {bodies: [{name: ball, shape: sphere, mass: 1, position: [0, 0, 100], velocity: [3, 0, 0], spin: [0, 0, 1]}]}\n'
# A box slides over a floor and stops after v/(mu g), and so much further as v^2/(2 mu g).
SLIDE = '''scene:
  bodies:
    - {name: floor, shape: plane, kind: static, friction: 0.5}
    - {name: box, size: [2, 2, 0.2], position: [0, 0, 0.1], velocity: [2, 0, 0], friction: 0.5}
  fidelity: accurate
'''
TIPPING = '''scene:
  bodies:
    - {name: floor, shape: plane, kind: static}
    - {name: stands, size: [0.5, 0.5, 1], position: [0, 0, 0.5]}
    - {name: tips, size: [0.2, 0.2, 1], position: [3, 0, 0.52], rotation: {axis: [0, 1, 0], degrees: 20}}
'''


class RunTest(SweepCase):
    def plan(self, text):
        return Reader(str(self.write(text)), None).read()

    def record(self, text, number=0):
        return run_task(self.plan(text), number)

    def values(self, text, number=0):
        record = self.record(text, number)
        self.assertEqual((record['status'], record['detail']), ('ok', ''))
        return record['values']

    def test_a_part_that_comes_while_parts_are_gathered_waits_for_the_next_time(self):
        class Busy(Store):
            def survey(self, names=None):
                found = super().survey(names)
                if len(self.part_names()) == 1:
                    self.keep([run_task(plan, 1)])
                return found

        plan = self.plan(FALL + 'duration: 0.1\nrepeats: 2\nmeasure: {energy: energy}\n')
        store = Busy(self.folder / 's.sweep')
        store.begin(plan)
        store.keep([run_task(plan, 0)])
        for numbers in ([0], [0, 1]):
            self.assertEqual(sorted(store.gather(plan, {})), numbers)
            self.assertEqual(self.results()['number'].tolist(), numbers)

    def test_free_fall(self):
        found = self.values(FALL + '''duration: 2
measure:
  position: {final_position: ball}
  pose: {final_pose: ball}
  velocity: {final_velocity: ball}
  energy: energy
  change: energy_change
  deepest: penetration
''')
        for value, wanted in zip(found['position'], (6, 0, 100 - 0.5 * 9.81 * 4)):
            self.assertAlmostEqual(value, wanted, 9)
        for value, wanted in zip(found['pose'], (*found['position'], 0, 0, math.sin(1), math.cos(1))):
            self.assertAlmostEqual(value, wanted, 9)
        for value, wanted in zip(found['velocity'], (3, 0, -9.81 * 2, 0, 0, 1)):
            self.assertAlmostEqual(value, wanted, 9)
        inertia = 0.4 * 0.25 ** 2
        self.assertAlmostEqual(float(found['energy']), 0.5 * 9 + 0.5 * inertia + 9.81 * 100, 8)
        self.assertAlmostEqual(float(found['change']), 0, 8)
        self.assertEqual(float(found['deepest']), 0)

    def test_states_every_so_many_steps(self):
        states = self.values(FALL + 'steps: 10\nmeasure: {s: {states: {every: 4, bodies: [ball]}}}\n')['s']
        self.assertEqual(states.shape, (3, 1, 13))
        for k, row in enumerate(states[:, 0]):
            self.assertAlmostEqual(row[0], 3 * 4 * k / 60, 12)
            self.assertAlmostEqual(row[9], -9.81 * 4 * k / 60, 12)
        whole = self.values(FALL + 'steps: 3\nmeasure: {s: states}\n')['s']
        self.assertEqual(whole.shape, (4, 1, 13))

    def test_a_box_comes_to_rest(self):
        found = self.values(SLIDE + '''duration: 2
measure: {rest: {time_to_rest: {speed: 0.02, bodies: box}}, p: {final_position: box}, d: penetration}
''')
        self.assertAlmostEqual(float(found['rest']), (2 - 0.02) / (0.5 * 9.81), delta=1 / 60)
        self.assertAlmostEqual(found['p'][0], 4 / (2 * 0.5 * 9.81), delta=1e-3)
        self.assertLess(float(found['d']), 1e-6)
        moving = self.values(SLIDE + 'duration: 0.3\nmeasure: {rest: time_to_rest}\n')
        self.assertTrue(math.isnan(moving['rest']))
        thrown = FALL.replace('[3, 0, 0]', '[0, 0, 10]')  # slower than 5 m/s from 0.51 s to 1.53 s alone
        for seconds, wanted in ((1, 5 / 9.81), (3, math.nan)):
            found = float(self.values(thrown + f'duration: {seconds}\nmeasure: {{rest: {{time_to_rest: 5}}}}\n')['rest'])
            if math.isnan(wanted):
                self.assertTrue(math.isnan(found))
            else:
                self.assertAlmostEqual(found, wanted, delta=1 / 60)

    def test_a_run_stops_at_rest(self):
        record = self.record(SLIDE + 'duration: 9\nstop: {at_rest: 0.02}\nmeasure: {p: {final_position: box}}\n')
        self.assertEqual((record['status'], record['stopped']), ('ok', 'at_rest'))
        self.assertAlmostEqual(record['time'], (2 - 0.02) / (0.5 * 9.81) + 0.5, delta=2 / 60)

    def test_what_stands_and_what_falls(self):
        found = self.values(TIPPING + '''duration: 3
measure: {stands: {stood: stands}, tips: {stood: tips}, all: stood, low: {stood: {bodies: tips, tilt: 180, drop: 2}},
          tilted: {stood: {bodies: tips, drop: 2}}}
''')
        self.assertEqual([float(found[name]) for name in ('stands', 'tips', 'all', 'low', 'tilted')],
                         [1, 0, 0, 1, 0])
        record = self.record(TIPPING + 'duration: 3\nstop: {fell: tips}\n')
        self.assertEqual(record['stopped'], 'fell')
        self.assertLess(record['time'], 2)

    def test_distance_to_a_reference(self):
        text = SLIDE.replace('accurate', 'interactive') + '''duration: 0.2
vary: {fidelity: [preview, reference]}
measure: {error: {distance_to_reference: {fidelity: reference}}}
'''
        far, near = float(self.values(text, 0)['error']), float(self.values(text, 1)['error'])
        self.assertEqual(near, 0.0)
        self.assertTrue(1e-9 < far < 0.1, far)
        scene = self.plan(text).task(0).scene
        worlds = [World(Scene.parse(json.dumps({**scene, 'fidelity': level}))) for level in ('preview', 'reference')]
        for world in worlds:
            world.step(12)
        self.assertAlmostEqual(far, math.dist(worlds[0].positions[1], worlds[1].positions[1]), 12)
        odd = self.record(SLIDE + 'steps: 1\nmeasure: {e: {distance_to_reference: {step: 0.01}}}\n')
        self.assertEqual(odd['status'], 'failed')
        self.assertIn('steps of 0.01 s of the reference never end at', odd['detail'])

    def test_what_is_measured_of_a_saved_state_begins_with_it(self):
        world = World(Scene.parse(json.dumps(self.plan(SLIDE + 'steps: 1\n').tree['scene'])))
        world.step(7)
        self.write(world.capture().to_yaml(), 'later.yml')
        found = self.values('''scene: later.yml
duration: 1
measure:
  error: {distance_to_reference: {fidelity: accurate}}
  finer: {distance_to_reference: {fidelity: reference, step: 0.008333333333333333}}
  states: {states: {every: 30, bodies: box}}
  rest: {time_to_rest: 0.02}
''')
        self.assertEqual(float(found['error']), 0.0)
        self.assertLess(float(found['finer']), 1e-3)
        self.assertEqual(found['states'].shape, (3, 1, 13))
        self.assertEqual(found['states'][0, 0].tolist(), world.states[1].tolist())
        self.assertAlmostEqual(float(found['rest']), (2 - 0.02) / (0.5 * 9.81) - 7 / 60, delta=1 / 60)

    def test_a_reference_that_diverges_measures_nothing(self):
        record = self.record(FALL + 'duration: 2\nmeasure: {e: {distance_to_reference: {"bodies[ball].position": [999999999, 0, 0]}}}\n')
        self.assertEqual((record['status'], record['values']), ('failed', {}))
        self.assertIn('measure.e: ValueError: the reference diverges: ', record['detail'])

    def test_the_end_of_several_bodies_is_a_table(self):
        found = self.values(TIPPING + '''steps: 5
measure: {all: {final_position: all}, two: {final_velocity: [tips, floor]}, one: {final_pose: tips}, list: {final_pose: [tips]}}
''')
        self.assertEqual([found[name].shape for name in ('all', 'two', 'one', 'list')], [(3, 3), (2, 6), (7,), (1, 7)])
        self.assertEqual(found['all'][2].tolist(), found['one'][:3].tolist())
        self.assertEqual(found['list'][0].tolist(), found['one'].tolist())

    def test_functions_of_the_user(self):
        self.write('def both(world, parameters):\n    return [world.time, parameters["step"]]\n'
                   'def late(world, parameters):\n    return world.time > 0.5\n', 'f.py')
        record = self.record(FALL + 'duration: 2\nvary: {step: [0.125]}\nstop: {python: f.py:late}\n'
                             'measure: {b: {python: f.py:both}}\n')
        self.assertEqual((record['stopped'], record['values']['b'].tolist()), ('python', [0.625, 0.125]))
        self.write('def f(world, parameters):\n    raise KeyError(3)\n', 'f.py')
        record = self.record(FALL + 'duration: 2\nmeasure: {a: {python: f.py:f}, e: energy}\n')
        self.assertEqual((record['status'], record['detail']), ('failed', 'measure.a: KeyError: 3 (f.py, line 2)'))
        self.assertIn('e', record['values'])
        record = self.record(FALL + 'duration: 2\nstop: {python: f.py:f}\n')
        self.assertEqual((record['status'], record['detail']), ('failed', 'stop.python: KeyError: 3 (f.py, line 2)'))

    def test_no_function_changes_another_run(self):
        self.write('count = 0\n'
                   'def f(world, parameters):\n'
                   '    global count\n'
                   '    count += 1\n'
                   '    parameters["gravity"][2] += 1\n'
                   '    parameters.pop("step")\n'
                   '    world.step(9)\n'
                   '    return [count, parameters["gravity"][2]]\n'
                   'def shared(world, parameters):\n'
                   '    return [count, parameters["gravity"][2], parameters["step"], world.steps]\n', 'f.py')
        plan = self.plan(FALL + 'steps: 3\nrepeats: 3\nvary: {step: [0.125], gravity: [[0, 0, -1]]}\n'
                         'measure: {a: {python: f.py:f}, b: {python: f.py:shared}}\n')
        records = run_chunk(plan.text(), [0, 1, 2])
        self.assertEqual([record['status'] for record in records], ['ok'] * 3)
        self.assertEqual([record['values']['a'].tolist() for record in records], [[1, 0]] * 3)
        self.assertEqual([record['values']['b'].tolist() for record in records], [[1, -1, 0.125, 3]] * 3)
        self.assertEqual(len({record['hash'] for record in records}), 1)

    def test_what_a_function_gives_is_a_number_or_none_at_all(self):
        for text, said in (('return None', 'TypeError: None is neither a number nor an array of numbers'),
                           ('return "3.0"', "TypeError: '3.0' is neither"), ('return [1, None]', 'TypeError: [1, None] is neither'),
                           ('return 2j', 'TypeError: 2j is neither'), ('return {}', 'TypeError: {} is neither'),
                           ('import sys; sys.exit(3)', 'RuntimeError: it raised SystemExit: 3 (f.py, line 2)'),
                           ('raise GeneratorExit', 'RuntimeError: it raised GeneratorExit:  (f.py, line 2)'),
                           ('raise ValueError("a\\0b\\ud800")', 'ValueError: a\ufffdb? (f.py, line 2)')):
            self.write(f'def f(world, parameters):\n    {text}\n', 'f.py')
            for use in ('measure: {a: {python: f.py:f}}', 'stop: {python: f.py:f}'):
                if 'return' in text and 'stop' in use:
                    continue
                record = self.record(FALL + f'steps: 2\n{use}\n')
                self.assertEqual((record['status'], record['values']), ('failed', {}), use)
                self.assertIn(('measure.a: ' if 'measure' in use else 'stop.python: ') + said, record['detail'])
        for text, wanted in (('return 10 ** 20', 1e20), ('return [1, 2 ** 70]', [1, 2.0 ** 70]), ('return True', 1), ('import numpy; return numpy.uint8(3)', 3), ('return []', [])):
            self.write(f'def f(world, parameters):\n    {text}\n', 'f.py')
            self.assertEqual(self.values(FALL + 'steps: 2\nmeasure: {a: {python: f.py:f}}\n')['a'].tolist(), wanted)

    def test_ctrl_c_is_no_fault_of_a_function(self):
        self.write('def f(world, parameters):\n    raise KeyboardInterrupt\n', 'f.py')
        text = FALL + 'steps: 2\nmeasure: {a: {python: f.py:f}}\n'
        with self.assertRaises(KeyboardInterrupt):
            self.record(text)
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as a worker has it
        self.addCleanup(signal.signal, signal.SIGINT, before)
        self.assertEqual(self.record(text)['detail'], 'measure.a: RuntimeError: it raised KeyboardInterrupt:  (f.py, line 2)')

    def test_a_function_that_catches_all_exceeds_its_time_all_the_same(self):
        self.write('import time\ndef f(world, parameters):\n    try:\n        for _ in range(400):\n            time.sleep(0.01)\n'
                   '    except BaseException:\n        return -1\n    return 1\n', 'f.py')
        plan = self.plan(FALL + 'steps: 1\nrepeats: 2\nmax_seconds: 0.2\nmeasure: {a: {python: f.py:f}}\n')
        self.assertEqual([record['status'] for record in run_chunk(plan.text(), [0, 1])], ['overtime', 'overtime'])

    def test_a_stop_that_steps_the_world_has_failed(self):
        self.write('def f(world, parameters):\n    world.step()\n', 'f.py')
        record = self.record(FALL + 'steps: 3\nstop: {python: f.py:f}\n')
        self.assertEqual((record['status'], record['detail']),
                         ('failed', 'stop.python: RuntimeError: it has stepped the world'))

    def test_a_file_of_functions_may_have_dataclasses(self):
        self.write('from __future__ import annotations\nimport dataclasses\n@dataclasses.dataclass\nclass A:\n    x: float = 2.0\n'
                   'def f(world, parameters):\n    return A().x\n', 'f.py')
        self.assertEqual(float(self.values(FALL + 'steps: 1\nmeasure: {a: {python: f.py:f}}\n')['a']), 2.0)

    def test_a_run_that_diverges_says_so(self):
        record = self.record(FALL + 'duration: 2\nvary: {"bodies[ball].position": [[999999999, 0, 0]]}\nmeasure: {e: energy}\n')
        self.assertEqual(record['status'], 'diverged', record)
        self.assertIn('ball', record['detail'])
        self.assertEqual(record['values'], {})
        self.assertGreater(record['steps'], 0)

    def test_a_combination_that_is_no_scene_says_so(self):
        text = FALL + 'duration: 1\nrepeats: 30\nvary: {"bodies[ball].friction": {normal: [0, 1]}}\n'
        plan = self.plan(text)
        record = run_task(plan, next(k for k in range(30) if plan.parameters(k)[1]['bodies[ball].friction'] < 0))
        self.assertEqual(record['status'], 'refused')
        self.assertIn('friction', record['detail'])


class ProgramTest(SweepCase):
    def plan(self, text):
        return Reader(str(self.write(text)), None).read()

    def refused(self, text, *said, arguments=()):
        file, errors = self.write(text), io.StringIO()
        with contextlib.redirect_stderr(errors):
            self.assertEqual(command.main(str(PROGRAM), [str(file), *arguments]), 2)
        for part in said:
            self.assertIn(part, errors.getvalue())
        self.assertFalse((self.folder / 's.sweep').exists())

    def test_bad_files_are_refused_before_the_start(self):
        ball = 'scene: ball_hits_wall\nduration: 1\n'
        self.refused(ball + 'vary: {"bodies[bal].mass": [1]}', "no entry is named 'bal' (there are: floor, wall, ball)")
        self.refused(ball + 'vary: {"bodies[ball].mas": [1]}',
                     'vary.bodies[ball].mas = 1: bodies[2].mas; unknown key; ', "did you mean 'mass'")
        self.refused(ball + 'vary: {"bodies[ball].friction": [0.5, -1]}',
                     'vary.bodies[ball].friction = -1', 'friction: -1 (allowed: 0 to')
        self.refused(ball + 'vary: {"bodies[ball].friction": []}', 's.yaml:3: vary.bodies[ball].friction: an empty list')
        self.refused(ball + 'vary: {step: {range: [0.01, 0.02], count: 1000000}, seed: {range: [1, 2], count: 1000000}}',
                     '1,000,000,000,000 runs (allowed: 10,000,000)')
        self.refused(ball + 'measure: {e: {final_position: boll}}', "no body is named 'boll' (there are: floor, wall, ball)")
        self.refused('scene: bal\nduration: 1\n', "no scene 'bal' in the catalogue (there are: ball_hits_wall")
        self.refused('scene: ./none.yaml\nduration: 1\n', 'none.yaml cannot be read: No such file')
        self.refused('scene: {bodies: [{mas: 3}]}\nduration: 1\n', "did you mean 'mass'")
        self.refused('a: [', 's.yaml:2')
        self.refused('', 'no mapping')
        self.refused(ball, 'there are runs 0 to 0', arguments=('--only', '1'))
        self.refused(ball, 'holds no sweep to go on with', arguments=('--resume',))
        self.refused(ball, 'there are no results', arguments=('--chart', 'e', 'step'))
        self.assertEqual(self.sweep('--workers', '0').returncode, 2)
        self.assertEqual(self.sweep('--workers', '1', '--dask', 'x').returncode, 2)

    def test_numbers_out_of_all_range_are_refused(self):
        ball, many = 'scene: ball_hits_wall\nduration: 1\n', '9' * 400
        self.refused(ball + 'vary: {step: {range: [1, %s], count: 3}}' % many, 'vary.step.range', '(allowed: [number, number])')
        self.refused(ball + 'max_seconds:', 's.yaml:3: max_seconds: None (allowed: a number above 0, in s)')
        self.refused(ball + 'measure: {"a\\0b": energy}', 'it is no name')
        self.refused(ball + f'max_seconds: {many}', '(allowed: a number above 0, in s)')
        self.refused(ball + 'seed: ' + '1' * 5000, 'seed: ')
        self.refused(ball + f'vary: {{step: [{many}]}}', 'vary.step = 9')
        self.refused(ball + 'vary: {step: {range: [-1e308, 1e308], count: 3}}', 'is more than a number holds')
        self.refused(ball + 'vary: {step: {log_range: [1e-200, 1e200], count: 3}}', 'is more than a number holds')
        self.refused(ball + 'vary: {step: {uniform: [-1e308, 1e308]}}', 'vary.step.uniform')
        self.refused(ball + 'vary: {step: {log_uniform: [1e-200, 1e200]}}', 'vary.step.log_uniform')

    def test_scenes_that_are_none_are_refused(self):
        (self.folder / 'b.yml').write_bytes(b'name: \xff\n')
        self.refused('scene: b.yml\nduration: 1\n', 'b.yml cannot be read: ')
        self.refused('scene: "b\\0.yml"\nduration: 1\n', 'cannot be read: ')
        for bodies in ('5', '{a: 1}', '[5]', '"x"'):
            self.refused(f'scene: {{bodies: {bodies}}}\nduration: 1\n', 'scene: bodies')
        self.refused('scene: {bodies: [{shape: sphere}]}\nduration: 1\nmeasure: {e: {distance_to_reference: {stp: 1}}}\n',
                     "measure.e: the reference: stp; unknown key")

    def test_a_place_that_is_set_twice_is_refused(self):
        ball = 'scene: ball_hits_wall\nduration: 1\n'
        self.refused(ball + 'vary: {"bodies[ball].mass": [1], "bodies[2].mass": [2]}',
                     "vary.bodies[2].mass: it replaces what 'bodies[ball].mass' has set")
        self.refused('scene: {bodies: [{name: old, shape: sphere}]}\nduration: 1\nvary: {bodies: [[{name: a, shape: sphere}]], '
                     '"bodies[a].velocity": [[1, 0, 0]], "bodies[0].velocity": [[2, 0, 0]]}',
                     "vary.bodies[0].velocity: it replaces what 'bodies[a].velocity' has set")
        self.refused(ball + 'vary: {"bodies[-9].mass": [1]}', 'bodies[-9].mass: [-9] of a list of 3')
        self.refused(ball + 'vary: {fidelity.divisions: [2], fidelity: [{preset: accurate}]}',
                     "vary.fidelity: it replaces what 'fidelity.divisions' has set")
        self.write(ball + 'vary: {fidelity: [{preset: accurate}], fidelity.divisions: [2], "bodies[ball].velocity[0]": [1], '
                   '"bodies[ball].velocity[1]": [1]}')
        self.sound('--only', '0')

    def test_a_draw_that_is_no_scene_is_the_result_of_its_run(self):
        draws = 'scene: ball_hits_wall\nsteps: 1\nrepeats: 30\nvary:\n  bodies[ball].mass: {normal: [0, 1]}\n'
        self.refused(draws + '  bodies[ball].friction: [0.1, -1]', 'vary.bodies[ball].friction = -1')
        self.refused(draws.replace('mass', 'mas'), 'vary.bodies[ball].mas = ', 'unknown key')
        self.refused(draws.replace('[0, 1]', '[-9, 1]'), 'vary.bodies[ball].mass = -')
        self.refused(draws.replace('ball].mass', 'boll].mass'), "no entry is named 'boll'")
        self.write('scene: ball_hits_wall\nsteps: 1\nrepeats: 30\nvary:\n  bodies[ball].mass: {normal: [0, 1]}\n'
                   '  bodies[ball].friction: [0.1, 0.2]\nmeasure: {e: energy}\n')
        self.sound('--workers', '1')
        status = self.results()['status'].tolist()
        self.assertEqual(set(status), {'ok', 'refused'})
        self.assertGreater(status.count('ok'), 15)

    def test_what_is_hardly_meant_is_told(self):
        ball = 'scene: ball_hits_wall\nmeasure: {e: energy}\n'
        for text, said in (('duration: 0.1\nrepeats: 3\n', 'nothing is drawn: all repeats are the same run'),
                           ('duration: 1\nvary: {step: [0.1, 0.3]}\n',
                            'duration 1 s is no whole number of steps of 0.3 s: such runs end at 0.9 s'),
                           ('duration: 1\n', None), ('steps: 3\nrepeats: 2\nvary: {seed: run_seed}\n', None)):
            self.write(ball + text)
            done = self.sweep('--dry-run')
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(said or '', done.stderr)
            self.assertEqual(done.stderr == '', said is None, done.stderr)

    def test_one_run_is_no_quicker_on_two_workers(self):
        self.write('scene: ball_hits_wall\nsteps: 2000\n')
        said = self.sound('--dry-run', '--workers', '8')
        alone, together = (line.rsplit(': ', 1)[1] for line in said.splitlines()[1:3])
        self.assertEqual(alone, together + ' of one core')

    def test_long_rows_of_numbers_are_left_out_of_the_table_of_words(self):
        self.write('import numpy\n\n\ndef long(world, parameters):\n    return numpy.arange(600000.0)\n', 'f.py')
        self.write('scene: ball_hits_wall\nsteps: 1\nrepeats: 2\nvary: {seed: run_seed}\n'
                   'measure: {long: {python: "f.py:long"}, p: {final_position: ball}}\n')
        self.sound('--workers', '1')
        with open(self.folder / 's.sweep/results.csv', encoding='utf-8') as file:
            header = file.readline().strip().split(',')
        self.assertIn('p_2', header)
        self.assertNotIn('long_0', header)
        self.assertEqual(self.results()['metrics/long'].shape, (2, 600000))

    def test_no_long_axis_keeps_the_others_from_being_tried(self):
        self.refused('scene: ball_hits_wall\nduration: 1\nvary:\n  bodies[ball].friction: [0.5, -1]\n'
                     '  bodies[ball].mass: {range: [1, 2], count: 2000}\n', 'vary.bodies[ball].friction = -1')

    def test_metrics_of_unlike_shapes_are_all_kept(self):
        self.write('def f(world, parameters):\n    n = parameters["gravity"][0]\n'
                   '    return [5, [[1, 2, 3]], [7, 8], []][n]\n', 'f.py')
        self.write('scene: {bodies: [{shape: sphere}]}\nsteps: 1\nvary: {gravity: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]}\n'
                   'measure: {f: {python: f.py:f}}\n')
        self.sound('--workers', '1')
        none = math.nan
        numpy.testing.assert_equal(self.results()['metrics/f'], [[[5, none, none]], [[1, 2, 3]], [[7, 8, none]], [[none] * 3]])

    def test_no_column_hides_another(self):
        big = 2 ** 63 + 3
        self.write('scene: {bodies: [{name: b, shape: sphere}]}\nsteps: 1\nseed: 3\n'
                   f'vary: {{seed: [{big}, 7], step: [0.5, 1], name: ["a\\0b", c$]}}\n'
                   'measure: {status: energy, p: {final_position: b}, p_0: energy}\n')
        self.sound('--workers', '1')
        with open(self.folder / 's.sweep/results.csv', encoding='utf-8', newline='') as file:
            rows = list(csv.reader(file))
        self.assertEqual(len(set(rows[0])), len(rows[0]))
        self.assertEqual(rows[0][:10], ['number', 'seed', 'vary.seed', 'step', 'name', 'measure.status', 'p_0', 'p_1', 'p_2',
                                        'measure.p_0'])
        self.assertEqual([row[2] for row in rows[1:]], [str(big)] * 4 + ['7'] * 4)
        table = self.results()
        self.assertEqual(table['parameters/seed'].tolist(), [big] * 4 + [7] * 4)
        self.assertEqual(table['parameters/step'].tolist(), [0.5, 0.5, 1, 1] * 2)
        self.assertEqual(table['parameters/name'].tolist(), ['"a\\u0000b"', 'c$'] * 4)
        self.assertTrue(self.sound('--chart', 'status', 'name', 'seed').strip().endswith('.png'))

    def test_meshes_of_the_file_stand_beside_it_and_belong_to_the_sweep(self):
        corners = [f'v {x} {y} {z}\n' for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        mesh = self.write(''.join(corners), 'm.obj')
        self.write(''.join(corners + ['v 2 0.5 0.5\n']), 'n.obj')
        self.write('scene: {bodies: [{name: b, shape: hull, mesh: m.obj}]}\nsteps: 1\nvary: {"bodies[b].mesh": [m.obj, n.obj]}\n'
                   'measure: {e: energy}\n')
        self.sound('--workers', '1', cwd='/')
        self.sound('--resume', '--workers', '1', cwd='/')
        mesh.write_text(''.join(corners + ['v 3 0.5 0.5\n']), encoding='utf-8')
        done = self.sweep('--resume')
        self.assertEqual((done.returncode, 'holds a sweep of another file or scene' in done.stderr), (2, True), done.stderr)
        for vary in ('vary: {"bodies[b]mesh": [m.obj]}', 'measure: {e: {distance_to_reference: {"bodies[b].mesh": m.obj}}}'):
            plan = self.plan(f'scene: {{bodies: [{{name: b, shape: hull, mesh: n.obj}}]}}\nsteps: 1\n{vary}\n')
            self.assertEqual(set(plan.tree['meshes']), {str(self.folder / 'm.obj'), str(self.folder / 'n.obj')})

    def test_runs_of_two_builds_are_not_mixed(self):
        self.write(FALL + 'steps: 1\nrepeats: 4\nmeasure: {e: energy}\n')
        self.sound('--workers', '1')
        store = Store(self.folder / 's.sweep')
        for part in self.parts():
            part.unlink()
        plan = self.plan(FALL + 'steps: 1\nrepeats: 4\nmeasure: {e: energy}\n')
        store.keep([record_of(1, 'overtime'), {**run_task(plan, 0), 'build': 'another'}])
        done = self.sweep('--resume')
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn('holds runs of another build of the physics (another; this is ', done.stderr)
        class Engine:
            slots = 1

            def submit(self, text, numbers):
                self.numbers = numbers

            def wait(self):
                yield self.numbers, [{**run_task(plan, number), 'build': 'another'} for number in self.numbers], ''

        before = self.parts()
        with self.assertRaisesRegex(Refused, 'a worker has another build of the physics'):
            carry.carry_live(plan, [2, 3], Engine(), store, carry.Progress(2))
        self.assertEqual(self.parts(), before)

    def test_a_plan_without_runs_and_one_that_is_damaged(self):
        self.write(FALL + 'steps: 1\nrepeats: 4\nvary: {seed: run_seed}\nmeasure: {e: energy}\n')
        self.sound('--workers', '1')
        whole = self.hashes()
        shutil.rmtree(self.folder / 's.sweep/parts')
        self.sound('--resume', '--workers', '1')
        self.assertEqual(self.hashes(), whole)
        for text in ('', '[', '{}', '5', '{"axes": 3}'):
            self.write(text, 's.sweep/plan.json')
            done = self.sweep('--resume')
            self.assertEqual((done.returncode, done.stderr.count('\n')), (2, 1), done.stderr)
            self.assertIn('plan.json is damaged', done.stderr)

    def test_times_of_any_length(self):
        for seconds in ('2.3e6', '1e12', '1e300'):
            self.write(FALL + f'steps: 1\nmax_seconds: {seconds}\n')
            self.assertIn('\nok\n', self.sound('--only', '0'))
            self.write(f'program: ["true"]\nmax_seconds: {seconds}\n')
            self.assertIn('\nok\n', self.sound('--only', '0'))

    def test_words_that_say_nothing_are_refused(self):
        self.write(FALL + 'steps: 1\n')
        for words in (('--slurm', ''), ('--dask', ''), ('--hosts', ''), ('--dask', 'x'), ('--dask', 'no://x:1'), ('--dask', 'a:b'),
                      ('--dask', 'localhost:99999')):
            done = self.sweep(*words)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertNotIn('Traceback', done.stderr)
        done = subprocess.run(['/usr/bin/python3', str(PROGRAM), '--chart', 'e', 'step', 's.yaml'], capture_output=True, text=True,
                              check=False)
        self.assertIn('It comes before --chart', done.stderr)

    def test_a_failed_run_is_made_again_by_the_command_that_is_printed(self):
        folder = self.folder / "it's here"
        folder.mkdir()
        self.folder = folder
        self.write('def f(world, parameters):\n    raise ValueError(7)\n', 'f.py')
        self.write(FALL + 'steps: 1\nmeasure: {e: {python: f.py:f}}\n')
        said = self.sweep('--workers', '1').stdout
        words = shlex.split(re.search(r'again: rosrun rigid_body_sim sweep (.*)', said).group(1))
        self.assertEqual(words, [str(folder / 's.yaml'), '--only', '0'])

    def test_dry_run_and_only(self):
        self.write('scene: ball_hits_wall\nduration: 1\nrepeats: 1000\nvary: {"bodies[ball].restitution": [0, 1], seed: run_seed}\n'
                   'measure: {p: {final_position: ball}}\n')
        said = self.sound('--dry-run')
        self.assertIn('2,000 runs: 2 of bodies[ball].restitution x 1,000 repeats; drawn for each: seed', said)
        for part in ('a run takes', 'of one core', 'of this machine', 'MB'):
            self.assertIn(part, said)
        self.assertFalse((self.folder / 's.sweep').exists())
        said = self.sound('--only', '1500')
        self.assertIn('run 1500 of 2,000, seed ', said)
        self.assertIn('bodies[ball].restitution = 1\n', said)
        self.assertIn('\nok\n', said)

    def test_only_gives_what_the_sweep_gave(self):
        self.write('scene: bouncing_49\nduration: 0.5\nrepeats: 4\nvary: {seed: run_seed}\nmeasure: {e: energy}\n')
        self.sound('--workers', '2')
        self.assertIn('hash %016x' % self.hashes()[3], self.sound('--only', '3'))
        self.assertEqual(len(set(self.hashes().values())), 4)

    def test_results_hold_all_that_makes_a_run(self):
        self.write('scene: ball_hits_wall\nduration: 0.5\nrepeats: 2\nseed: 5\n'
                   'vary: {fidelity: [preview, {preset: accurate, divisions: 2}], "bodies[ball].friction": {uniform: [0, 1]}}\n'
                   'measure: {p: {final_position: ball}, e: energy, s: {states: {every: 10}}}\n')
        self.sound('--workers', '1')
        table = self.results()
        self.assertEqual(table['parameters/fidelity'].tolist(), ['preview'] * 2 + ['{"preset": "accurate", "divisions": 2}'] * 2)
        self.assertEqual(table['metrics/p'].shape, (4, 3))
        self.assertEqual(table['metrics/s'].shape, (4, 4, 3, 13))
        self.assertEqual(table['steps'].tolist(), [30] * 4)
        self.assertTrue((table['seconds'] > 0).all() and (table['cpu_seconds'] > 0).all())
        with h5py.File(self.folder / 's.sweep/results.h5', 'r') as file:
            self.assertTrue(file.attrs['complete'])
            self.assertEqual((file.attrs['runs'], file.attrs['planned']), (4, 4))
            self.assertRegex(json.loads(file.attrs['versions'])['rigid_body_sim'], r'^\d+\.\d+\.\d+$')
            build = json.loads(file.attrs['versions'])['build']
        # Of the extension and of the core, which is another file: either may be built anew without the other.
        extension = pathlib.Path(sys.modules[World.__module__].__file__)
        files = [extension, (extension.parent / '../../../librigid_body_sim_core.so').resolve()]
        self.assertEqual(build, hashlib.sha256(b''.join(file.read_bytes() for file in files)).hexdigest()[:16])
        with open(self.folder / 's.sweep/results.csv', encoding='utf-8', newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([int(row['hash'], 16) for row in rows], table['hash'].tolist())
        self.assertEqual([float(row['p_0']) for row in rows], table['metrics/p'][:, 0].tolist())
        self.assertEqual([float(row['bodies[ball].friction']) for row in rows], table['parameters/bodies[ball].friction'].tolist())
        self.assertNotIn('s_0', rows[0])

    def test_charts(self):
        self.write('scene: ball_hits_wall\nduration: 0.5\nrepeats: 20\n'
                   'vary: {fidelity: [preview, accurate], "bodies[ball].velocity[0]": {uniform: [3, 5]}}\n'
                   'measure: {p: {final_position: ball}, e: energy, none: {time_to_rest: 1.0e-9}, s: states}\n')
        self.sound('--workers', '1')
        for arguments in (('e', 'fidelity'), ('cpu_seconds', 'fidelity'), ('p_0', 'bodies[ball].velocity[0]', 'fidelity')):
            path = self.sound('--chart', *arguments).strip()
            with open(path, 'rb') as file:
                self.assertEqual(file.read(8), b'\x89PNG\r\n\x1a\n')
        for arguments, said in ((('q', 'fidelity'), "no metric 'q' (there are: e, none, p_0 to p_2, time, steps, seconds, cpu_seconds)"),
                                (('e', 'mass'), "no parameter 'mass' (there are: bodies[ball].velocity[0], fidelity)"),
                                (('none', 'fidelity', 'fidelity'), "no run has a value of 'none'"),
                                (('p', 'fidelity'), "no metric 'p'"), (('s', 'fidelity'), "metric 's' is a table of each run"), (('p_3', 'fidelity'), "no metric 'p_3'")):
            done = self.sweep('--chart', *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(said, done.stderr)


class BandTest(unittest.TestCase):
    def test_points_of_students_distribution(self):
        for freedom, wanted in ((1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (5, 2.571), (10, 2.228),
                                (30, 2.042), (1000, 1.962)):
            self.assertAlmostEqual(charts.student(freedom), wanted, delta=3e-3)

    def test_means_with_their_bands(self):
        mean, half = charts.mean_and_band([1.0, 2.0, 3.0, 4.0, 5.0])
        self.assertEqual(mean, 3.0)
        self.assertAlmostEqual(half, 2.776 * math.sqrt(2.5 / 5), delta=5e-3)
        self.assertTrue(math.isnan(charts.mean_and_band([1.0])[1]))


if __name__ == '__main__':
    unittest.main()
