#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Scene and Body: read, built, written, copied, refused."""
import copy
import os
import pathlib
import pickle
import subprocess
import tempfile
import unittest

import numpy as np
import rigid_body_sim as rbs

BUILD = pathlib.Path(os.environ['RBS_BUILD'])
NAN = float('nan')


def full_scene():
    """With a value of its own in every field."""
    hull = rbs.make_hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    box = rbs.Body(
        rbs.Box([1, 2, 3]), name='box', kind='kinematic', position=[1, 2, 30], orientation=[0, 0, 0.6, 0.8], velocity=[1, 0, 0],
        spin=[0, 1, 0], density=500, friction=0.3, restitution=0.4, drag_coefficient=0.5, rolling_resistance=0.01,
        torsional_resistance=0.02, color=[0.25, 0.5, 0.75], group=2, mask=3)
    shapes = [rbs.Sphere(0.2), rbs.Capsule(0.1, 0.3), rbs.Cylinder(0.2, 0.4), rbs.Cone(0.3, 0.5), hull.hull]
    bodies = [rbs.Body(shape, position=[3 * k, 9, 5], mass=2) for k, shape in enumerate(shapes)]
    return rbs.Scene(
        [rbs.Body(rbs.Plane(), name='floor', kind='static'), box, *bodies], name='full', property='Nothing.', gravity=[0, 1, -9],
        step=0.01, fidelity=rbs.Setting('accurate', 2, 3, 1e-7, 5.0), goal=rbs.Goal(max_error=0.1), seed=2**64 - 1, air=rbs.Air(1.1),
        wind=rbs.Wind([1, 2, 3], 0.5), fluid=rbs.Fluid(900, -20), effects={'drag': True, 'friction': False},
        view=rbs.View([1, 2, 3], [4, 5, 6]))


class ReadTest(unittest.TestCase):
    def test_every_scene_of_the_catalogue_is_known_by_name_and_makes_a_world(self):
        scenes = rbs.catalogue()
        self.assertIn('ball_hits_wall', scenes)
        for name, shows in scenes.items():
            self.assertGreater(len(shows), 10)
            scene = rbs.Scene.load(name)
            self.assertEqual(scene.name, name)
            self.assertEqual(len(rbs.World(scene).names), len(scene.bodies))

    def test_an_unknown_name_lists_the_known_ones(self):
        with self.assertRaisesRegex(rbs.InvalidInput, 'nowhere.*ball_hits_wall'):
            rbs.Scene.load('nowhere')

    def test_faults_are_those_of_the_cpp_programs_with_the_same_places(self):
        faulty = 'gravity: [0, 0]\nbodies:\n  - {name: a, mas: 2}\n  - {shape: ball, friction: -1}\n'
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, 'faulty.yaml')
            file.write_text(faulty)
            program = BUILD / 'devel/lib/rigid_body_sim/explain'
            said = subprocess.run([program, file], capture_output=True, text=True, check=False).stderr
            with self.assertRaises(rbs.InvalidInput) as caught:
                rbs.Scene.load(file)
        self.assertEqual('explain: %s\n' % caught.exception, said)
        with self.assertRaises(ValueError) as caught:
            rbs.Scene.parse(faulty, 'here')
        places = [problem.path for problem in caught.exception.problems]
        self.assertEqual(places[0], 'here:1: gravity')
        self.assertIn('here:3: bodies[0].mas', places)
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(again), again.problems), (str(caught.exception), caught.exception.problems))

    def test_the_seed_of_a_text_can_be_replaced(self):
        text = 'seed: 3\nbodies: [{repeat: {count: [9, 1, 1], spacing: [1, 1, 1], jitter: 0.2}}]'
        places = [[body.position.tolist() for body in rbs.Scene.parse(text, seed=seed).bodies] for seed in (None, 3, 4)]
        self.assertEqual(places[0], places[1])
        self.assertNotEqual(places[0], places[2])
        for seed in (-1, 2**64, 'x', 1.5):
            with self.assertRaisesRegex(rbs.InvalidInput, '^seed: '):
                rbs.Scene.load('marbles', seed=seed)


class BuiltTest(unittest.TestCase):
    def test_what_is_built_is_written_and_read_back(self):
        scene = full_scene()
        self.assertEqual(scene.validate(), ())
        text = scene.to_yaml()
        again = rbs.Scene.parse(text)
        self.assertEqual(again.to_yaml(), text)
        for name in ('name', 'property', 'step', 'fidelity', 'goal', 'seed', 'air', 'fluid', 'effects', 'is_saved_state'):
            self.assertEqual(getattr(again, name), getattr(scene, name), name)
        self.assertEqual((again.wind, again.view), (rbs.Wind((1, 2, 3), 0.5), rbs.View((1, 2, 3), (4, 5, 6))))
        self.assertEqual(again.gravity.tolist(), [0, 1, -9])
        for mine, read in zip(scene.bodies[1:], again.bodies[1:]):
            self.assertEqual(mine.shape if mine.name != 'box' else rbs.Box((1, 2, 3)), read.shape)
            for name in ('kind', 'mass', 'friction', 'restitution', 'drag_coefficient', 'rolling_resistance',
                         'torsional_resistance', 'color', 'group', 'mask'):
                self.assertEqual(getattr(mine, name), getattr(read, name), name)
            for name in ('position', 'orientation', 'velocity', 'spin'):
                np.testing.assert_array_equal(getattr(mine, name), getattr(read, name))
        self.assertEqual(again.bodies[1].density, 500)

    def test_defaults_are_those_of_the_core(self):
        read = rbs.Scene.parse('air: {}\nwind: {velocity: [4, 0, 0]}\nfluid: {}\nbodies: [{}]')
        self.assertEqual((read.air, read.wind, read.fluid, read.view), (rbs.Air(), rbs.Wind(), rbs.Fluid(), rbs.View()))
        self.assertEqual((read.fidelity, read.goal, read.bodies[0].shape), (rbs.Setting(), None, rbs.Box()))
        new = rbs.Scene()
        self.assertEqual((new.step, new.gravity.tolist(), new.air, new.bodies), (1 / 60, [0, 0, -9.81], None, []))

    def test_bodies_change_in_place(self):
        scene = rbs.Scene([rbs.Body()])
        scene.bodies[0].position[2] = 4
        scene.bodies[0].mass = 7
        scene.bodies.append(rbs.Body(rbs.Sphere(), name='ball'))
        scene.gravity[2] = -1
        world = rbs.World(scene)
        self.assertEqual((world.names, world.positions[0, 2], world.bodies()[0].mass), (['box_1', 'ball'], 4.0, 7.0))
        self.assertEqual(world.scene.gravity.tolist(), [0, 0, -1])

    def test_bodies_may_come_from_a_generator(self):
        bodies = [rbs.Body(position=[3 * k, 0, 0]) for k in range(3)]
        for given in (bodies, tuple(bodies), iter(bodies), (body for body in bodies), map(rbs.Body.copy, bodies)):
            self.assertEqual(len(rbs.World(rbs.Scene(given)).names), 3)
        scene = rbs.Scene()
        scene.bodies = (body for body in bodies)
        self.assertEqual(len(scene.bodies), 3)

    def test_equal_shapes_are_equal_however_they_were_given(self):
        self.assertEqual(rbs.Box([1, 2, 3]), rbs.Box(np.array([1.0, 2.0, 3.0])))
        self.assertEqual(len({rbs.Box([1, 2, 3]), rbs.Box((1, 2, 3)), rbs.Box([1, 2, 4])}), 2)
        self.assertEqual(rbs.Wind(velocity=[1, 0, 0]), rbs.Wind(velocity=(1.0, 0, 0)))
        self.assertEqual(rbs.View(eye=[1, 0, 0]), rbs.View(eye=np.array([1, 0, 0])))

    def test_a_view_of_a_body_outlives_it(self):
        position = rbs.Body(position=[1, 2, 3]).position
        self.assertEqual(position.tolist(), [1, 2, 3])

    def test_copies_are_independent(self):
        scene = full_scene()
        for other in (scene.copy(), copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
            self.assertEqual(other.to_yaml(), scene.to_yaml())
            other.bodies[1].position[0] = 77
            other.bodies.pop()
            self.assertEqual((scene.bodies[1].position[0], len(scene.bodies)), (1.0, 7))
        body = scene.bodies[1]
        for other in (body.copy(), copy.copy(body), copy.deepcopy(body)):
            other.friction = 9
            self.assertEqual(body.friction, 0.3)
        unsound = rbs.Body(name='my ball', mass=-1, density=2, color=[1, 2, 3])
        twin = pickle.loads(pickle.dumps(unsound))
        self.assertEqual((twin.name, twin.mass, twin.density, twin.color), ('my ball', -1.0, 2.0, unsound.color))
        for body in scene.bodies:  # also without a name
            twin = pickle.loads(pickle.dumps(body))
            self.assertEqual((rbs.Scene([twin]).to_yaml(), twin.name), (rbs.Scene([body]).to_yaml(), body.name))

    def test_a_file_is_written_whole_and_not_over_another(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, 'scene.yaml')
            full_scene().save(file)
            self.assertEqual(rbs.Scene.load(file).to_yaml(), full_scene().to_yaml())
            with self.assertRaisesRegex(rbs.InvalidInput, 'overwrite'):
                rbs.Scene().save(file)
            self.assertEqual(file.read_text(), full_scene().to_yaml())
            rbs.Scene().save(str(file), overwrite=True)
            self.assertEqual(rbs.Scene.load(str(file)).bodies, [])
            with self.assertRaisesRegex(rbs.InvalidInput, 'No such file'):
                rbs.Scene().save(pathlib.Path(folder, 'none', 'scene.yaml'))
            self.assertEqual(os.listdir(folder), ['scene.yaml'])


class RefusedTest(unittest.TestCase):
    def refused(self, text, call):
        with self.assertRaisesRegex(rbs.InvalidInput, text):
            call()

    def test_what_a_field_does_not_take_is_refused_with_its_name(self):
        body, scene = rbs.Body(), rbs.Scene()
        for name, value in dict(
                name=3, kind='hovering', position=[1, 2], orientation=[0, 0, 1], velocity='fast', spin=None, shape='box', mass='x',
                density=[], friction=None, restitution='x', drag_coefficient='x', rolling_resistance='x', torsional_resistance='x',
                color=[1, 2], group=-1, mask=2**32).items():
            before = repr(getattr(body, name))
            self.refused('^%s: .*allowed: ' % name, lambda: setattr(body, name, value))
            self.refused('^%s: .*allowed: ' % name, lambda: rbs.Body(**{name: value}))
            self.assertEqual(repr(getattr(body, name)), before)
        for name, value in dict(
                name=3, property=3, gravity=[1], step='x', fidelity='best', goal=3, seed=-1, air=1.2, wind=[1, 0, 0], fluid=1, view=1,
                effects=['drag'], bodies=[3]).items():
            before = repr(getattr(scene, name))
            self.refused(r'^%s(\[0\])?: .*allowed: ' % name, lambda: setattr(scene, name, value))
            self.assertEqual(repr(getattr(scene, name)), before)
        self.refused('^effect: ', lambda: rbs.Scene(effects={'magic': True}))
        self.refused('^effects.drag: ', lambda: rbs.Scene(effects={'drag': 1}))
        self.refused('^fidelity.divisions: 0', lambda: rbs.Scene(fidelity=rbs.Setting(divisions=0)))
        self.refused('^masss: 2 .*a field of Body: color, density, .*, mass, .*, velocity', lambda: rbs.Body(masss=2))
        self.refused('^copy: 2 .*a field of Body', lambda: rbs.Body(copy=2))
        self.refused('^is_saved_state: True .*a field of Scene', lambda: rbs.Scene(is_saved_state=True))
        self.refused('^gravty: 2 .*a field of Scene: air, .*, gravity, ', lambda: rbs.Scene(gravty=2))

    def test_what_is_no_size_is_refused(self):
        for size in ('123', b'abc', {1, 2, 3}, [10**400, 1, 1], [1, 2, 'x'], [1, 2], 3):
            self.refused('size', lambda size=size: rbs.World(rbs.Scene([rbs.Body(rbs.Box(size))])))

    def test_what_is_no_text_is_refused_and_a_file_may_have_any_name(self):
        self.refused(r"^name: '\\udcff' .*a text of Unicode", lambda: rbs.Body(name='\udcff'))
        self.refused(r"^kind: '\\udcff' .*a text of Unicode", lambda: rbs.Body(kind='\udcff'))
        self.refused('^path: None ', lambda: rbs.Scene.load(None))
        self.refused("^path: '' ", lambda: rbs.Scene(name='x').save(''))
        self.refused('^text: 3 .*a text', lambda: rbs.Scene.parse(3))
        self.refused('^source: 3 .*a text', lambda: rbs.Scene.parse('', 3))
        world = rbs.World(rbs.Scene())
        self.refused('^name: 3 .*a text', lambda: world.find(3))
        self.refused('^command: None .*a text', lambda: world.execute(None))
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, 'a\udcff.yaml')  # the byte 0xff, which is no UTF-8
            rbs.Scene(name='x').save(file)
            self.assertEqual(os.listdir(os.fsencode(folder)), [b'a\xff.yaml'])
            self.assertEqual(rbs.Scene.load(file).name, 'x')

    def test_numbers_out_of_range_are_refused_where_they_are_used_all_at_once(self):
        bodies = [rbs.Body(friction=NAN), rbs.Body(position=[0, 0, NAN]), rbs.Body(rbs.Sphere(-1)), rbs.Body(mass=1, density=1)]
        scene = rbs.Scene(bodies, step=-1)
        places = ['step', 'bodies[0].material.friction', 'bodies[1].position', 'bodies[2].size', 'bodies[3].density']
        self.assertEqual([problem.path for problem in scene.validate()], places)
        for use in (rbs.World, rbs.Scene.to_yaml):
            with self.assertRaises(rbs.InvalidInput) as caught:
                use(scene)
            self.assertEqual([problem.path for problem in caught.exception.problems], places)
        scene.bodies.append('no body')
        self.refused(r"^bodies\[4\]: 'no body' .*a Body", lambda: rbs.World(scene))


class HullTest(unittest.TestCase):
    POINTS = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], dtype=float)

    def test_a_hull_is_placed_where_its_points_are(self):
        hull, position, orientation = rbs.make_hull(self.POINTS)
        np.testing.assert_allclose(position, [0.5, 1, 1.5], atol=1e-12)
        np.testing.assert_allclose(np.abs(orientation), [0, 0, 0, 1], atol=1e-12)
        self.assertEqual(hull.vertices.shape, (8, 3))
        self.assertAlmostEqual(hull.volume, 6.0)
        again = pickle.loads(pickle.dumps(hull))
        self.assertEqual((again, hash(again)), (hull, hash(hull)))
        self.assertNotEqual(hull, rbs.make_hull(2 * self.POINTS).hull)

    def test_a_mesh_is_read(self):
        mesh = str(pathlib.Path(__file__).parents[2] / 'scenes/meshes/dodecahedron.obj')
        small, large = rbs.hull_of_mesh(mesh), rbs.hull_of_mesh(mesh, scale=2)
        self.assertAlmostEqual(large.hull.volume / small.hull.volume, 8.0, places=6)
        for scale in (0, -1, NAN):
            with self.assertRaisesRegex(rbs.InvalidInput, '^scale: '):
                rbs.hull_of_mesh(mesh, scale)
        with self.assertRaisesRegex(rbs.InvalidInput, 'nowhere.obj'):
            rbs.hull_of_mesh('nowhere.obj')

    def test_points_that_make_no_hull_are_refused(self):
        for points in (self.POINTS[:3], self.POINTS * [1, 1, 0], self.POINTS[:, :2], 'x', [[NAN] * 3] * 4):
            with self.assertRaisesRegex(rbs.InvalidInput, '^points'):
                rbs.make_hull(points)


if __name__ == '__main__':
    unittest.main()
