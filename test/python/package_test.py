#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The package as people import it: messages without the physics, physics without ROS, stubs that are true, docstrings."""
import dataclasses
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import rigid_body_sim as rbs
from rigid_body_sim import _types

HERE = pathlib.Path(__file__).resolve().parent
PACKAGES = str(pathlib.Path(rbs.__file__).parents[1])
CLASSES = (rbs.Body, rbs.ConvexHull, rbs.Scene, rbs.Snapshot, rbs.StepReport, rbs.World)
FUNCTIONS = (rbs.catalogue, rbs.hull_of_mesh, rbs.make_hull, rbs.rollout)
# What mypy.stubtest finds and is as it should be: the metaclass of pybind11's classes, and those that only the extension makes.
EXPECTED = r'''
rigid_body_sim\._core\.(Body|ConvexHull|Scene|Snapshot|StepReport|World)
rigid_body_sim\._core\.(ConvexHull|Snapshot|StepReport)\.__init__
'''


def python(code, folder=PACKAGES):
    """What a new Python prints that finds the package in this folder and knows of no ROS workspace."""
    environment = {'PATH': '/usr/bin:/bin', 'PYTHONPATH': folder, 'PYTHONDONTWRITEBYTECODE': '1'}
    return subprocess.run(['/usr/bin/python3', '-c', code], env=environment, capture_output=True, text=True, check=False)


def public(owner):
    return sorted(name for name in vars(owner) if not name.startswith('_'))


class ImportTest(unittest.TestCase):
    def test_the_physics_needs_a_path_and_no_ros(self):
        done = python('import sys, rigid_body_sim as rbs\n'
                      'world = rbs.World(rbs.Scene.load("ball_hits_wall"))\nworld.step(9)\n'
                      'print(world.steps, [name for name in ("rospy", "genpy") if name in sys.modules])')
        self.assertEqual((done.stdout, done.stderr), ('9 []\n', ''))

    def test_messages_are_imported_without_the_physics(self):
        """genpy itself imports NumPy, where there is one."""
        done = python('import sys, rigid_body_sim\nprint("numpy" in sys.modules)\n'
                      'from rigid_body_sim.msg import BodyState\nfrom rigid_body_sim.srv import Step\n'
                      'print([name for name in sys.modules if name in ("rigid_body_sim._core", "rigid_body_sim._types")])\n'
                      'print("World" in dir(rigid_body_sim), hasattr(rigid_body_sim, "nothing"))')
        self.assertEqual((done.stdout, done.stderr), ('False\n[]\nTrue False\n', ''))

    def test_messages_are_imported_where_the_physics_was_not_built(self):
        with tempfile.TemporaryDirectory() as folder:
            package = pathlib.Path(folder, 'rigid_body_sim')
            package.mkdir()
            for file in pathlib.Path(rbs.__file__).parent.iterdir():
                if not file.name.startswith('_core') and file.name != '__pycache__':
                    (package / file.name).symlink_to(file)
            done = python('import rigid_body_sim.msg as msg, rigid_body_sim as rbs\n'
                          'print(msg.Status.__name__, rbs.InvalidInput.__name__)\n'
                          'try:\n  from rigid_body_sim import World\nexcept ImportError as error:\n  print(error)\n', folder)
        self.assertEqual(done.stderr, '')
        self.assertRegex(done.stdout, r'^Status InvalidInput\nthe physics of rigid_body_sim .*pybind11-dev.*python3-numpy\n')

    def test_a_missing_numpy_is_told_with_its_package(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, 'numpy.py').write_text('raise ImportError("no NumPy here")\n')
            done = python('import rigid_body_sim as rbs\nrbs.World\n', folder + ':' + PACKAGES)
        self.assertRegex(done.stderr, 'ImportError: the physics of .*no NumPy here.*python3-numpy')

    def test_the_version_is_that_of_the_package(self):
        written = re.search('<version>(.*)</version>', (HERE.parents[1] / 'package.xml').read_text(encoding='utf-8')).group(1)
        self.assertEqual(rbs.__version__, written)
        done = python('import sys, rigid_body_sim as rbs\nprint(rbs.__version__, "numpy" in sys.modules)')
        self.assertEqual(done.stdout, written + ' False\n')
        self.assertIn('`__version__`', rbs.__doc__)

    def test_every_name_is_there(self):
        for name in rbs.__all__:
            self.assertIsNotNone(getattr(rbs, name))
        core = sys.modules['rigid_body_sim._core']
        self.assertEqual([name for name in public(core) if name not in rbs.__all__], [])


class StubsTest(unittest.TestCase):
    def mypy(self, module, *arguments):
        environment = dict(os.environ, PYTHONPATH=PACKAGES)
        with tempfile.TemporaryDirectory() as folder:
            return subprocess.run(['/usr/bin/python3', '-m', module, *arguments], cwd=folder, env=environment, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, check=False)

    def test_stubs_say_what_is_there(self):
        with tempfile.NamedTemporaryFile('w', suffix='.txt') as expected:
            expected.write(EXPECTED)
            expected.flush()
            done = self.mypy('mypy.stubtest', 'rigid_body_sim._core', '--concise', '--ignore-unused-allowlist',
                             '--allowlist', expected.name)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_the_stub_of_the_package_has_its_names(self):
        stub = (pathlib.Path(rbs.__file__).parent / '__init__.pyi').read_text()
        self.assertEqual(sorted(re.findall(r'(\w+) as \1', stub)), sorted(rbs.__all__))
        self.assertEqual(sorted(re.findall(r"'(\w+)'", stub)), sorted(rbs.__all__))
        self.assertIn('\n__version__: str\n', stub)

    def test_fields_of_bodies_and_scenes_are_the_arguments_that_make_them(self):
        """What stubtest cannot see, since these take any keyword."""
        stubs = (pathlib.Path(rbs.__file__).parent / '_core.pyi').read_text()
        settable = {owner: {name for name in public(owner) if getattr(getattr(owner, name), 'fset', None)} for owner in CLASSES}
        cases = ((rbs.Body, '__init__', set()), (rbs.Scene, '__init__', {'bodies'}), (rbs.World, 'edit_body', set()))
        for owner, function, others in cases:
            text = stubs[stubs.index('class %s:' % owner.__name__):]
            arguments = re.search(r'def %s\((.*?)\) -> ' % function, text, re.DOTALL).group(1).split('*,')[1]
            names = set(re.findall(r'(\w+): ', arguments)) | others
            self.assertEqual(names - {'shape'}, settable[rbs.Body if owner is rbs.World else owner] - {'shape'})

    def test_a_program_of_a_user_is_checked(self):
        with tempfile.NamedTemporaryFile('w', suffix='.py') as program:
            program.write('import rigid_body_sim as rbs\nworld = rbs.World(rbs.Scene([rbs.Body(rbs.Sphere(), mass=2)]))\n'
                          'x: float = world.step(3).seconds\nworld.step("x")\nworld.jump()\n')
            program.flush()
            said = self.mypy('mypy', '--strict', program.name).stdout
        self.assertEqual(re.findall(r'\.py:(\d+): error', said), ['4', '5'], said)


class DocsTest(unittest.TestCase):
    def test_everything_is_documented(self):
        for owner in CLASSES:
            self.assertGreater(len(owner.__doc__), 40, owner)
            for name in public(owner):
                self.assertTrue(getattr(owner, name).__doc__, '%s.%s' % (owner.__name__, name))
        for function in FUNCTIONS:
            self.assertGreater(len(function.__doc__), 40, function)

    def test_fields_are_documented_with_their_units(self):
        types = [value for value in vars(_types).values()
                 if isinstance(value, type) and (hasattr(value, '_fields') or dataclasses.is_dataclass(value))]
        self.assertGreater(len(types), 20)
        for owner in types:
            for field in getattr(owner, '_fields', None) or [f.name for f in dataclasses.fields(owner)]:
                self.assertRegex(owner.__doc__, r'(?m)^ *%s: \S' % field, owner)
            for field in getattr(owner, '_fields', ()):
                self.assertNotIn('Alias for', getattr(owner, field).__doc__)
        self.assertIn('kg m²/s', rbs.Totals.angular_momentum.__doc__)

    def test_signatures_can_be_read(self):
        self.assertEqual(str(inspect.signature(rbs.World.step)), '(self, n=1)')
        self.assertEqual(str(inspect.signature(rbs.rollout)), '(scenes, steps, every=1, threads=1)')
        for owner in CLASSES:
            for name in public(owner):
                if callable(getattr(owner, name)):
                    inspect.signature(getattr(owner, name))

    def test_every_verb_is_called_by_a_test(self):
        text = '\n'.join(file.read_text() for file in HERE.glob('*_test.py'))
        missing = [name for owner in CLASSES for name in public(owner) if not re.search(r"[.']%s\b" % name, text)]
        self.assertEqual(missing, [])
        self.assertEqual([f.__name__ for f in FUNCTIONS if 'rbs.%s(' % f.__name__ not in text], [])


if __name__ == '__main__':
    unittest.main()
