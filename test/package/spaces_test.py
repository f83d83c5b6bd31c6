#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What others build on: the devel space, the install space, and a build without RViz, pybind11 and other engines."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = pathlib.Path(os.environ['RBS_BUILD'])
CLEAN = {name: os.environ[name] for name in ('HOME', 'LANG', 'ROS_HOSTNAME') if name in os.environ}
CLEAN['PATH'] = '/usr/bin:/bin'


def cached(name):
    """A setting of the build that runs this test."""
    return re.search(r'^%s:\w+=(.*)$' % name, (BUILD / 'CMakeCache.txt').read_text(), re.MULTILINE).group(1)


class SpacesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def done(self, script, **environment):
        """What a shell of someone who has just logged in prints; every line of it must succeed."""
        result = subprocess.run(['/bin/bash', '-ec', script], cwd=self.folder, env=dict(CLEAN, **environment), text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        self.assertEqual(result.returncode, 0, result.stdout)
        return result.stdout

    def check_downstream(self, space):
        flags = cached('CMAKE_CXX_FLAGS')
        said = self.done('source %s/setup.bash; cmake -S %s/downstream -B build -DCMAKE_CXX_FLAGS="%s"; cmake --build build; '
                         'build/devel/lib/downstream/downstream_fall' % (space, HERE, flags))
        self.assertRegex(said.splitlines()[-1], r'^ball at z = 5\.[01]\d* m$')

    def test_a_package_downstream_builds_against_the_devel_space(self):
        self.check_downstream(BUILD / 'devel')

    def test_a_package_downstream_builds_against_the_install_space(self):
        space = pathlib.Path(cached('CMAKE_INSTALL_PREFIX'))
        if BUILD not in space.parents:
            self.skipTest('this build is to be installed outside of itself')
        shutil.rmtree(space, ignore_errors=True)
        self.done('cmake --install %s' % BUILD)
        self.check_downstream(space)
        self.assertIn('forces.gravity', self.done('source %s/setup.bash; rosrun rigid_body_sim explain harbour' % space))
        self.assertIn('10,000 runs: ', self.done('source %s/setup.bash; rosrun rigid_body_sim sweep %s/share/rigid_body_sim/sweeps/rebound.yaml '
                                                 '--dry-run' % (space, space)))
        for sourced in (space, BUILD / 'devel'):  # each finds its own launch file, and no other
            self.assertIn('/sim', self.done('source %s/setup.bash; roslaunch --nodes rigid_body_sim sim.launch' % sourced))
        programs = sorted(os.listdir(space / 'lib/rigid_body_sim'))
        self.assertEqual(programs, ['accuracy_probe', 'explain', 'rbs', 'record', 'replay_node', 'resimulate',
                                    'rigid_body_sim_accuracy', 'scene_accuracy', 'simulator_node', 'sweep'])
        python = '/usr/bin/python3 -c "import rigid_body_sim as rbs; print(rbs.World(rbs.Scene.load(\'tower\')).step(), rbs.__file__)"'
        self.assertIn(str(space), self.done(python, PYTHONPATH=str(space / 'lib/python3/dist-packages')))
        libraries = self.done('ldd %s/lib/rigid_body_sim/* %s/lib/*.so 2>&1 || true' % (space, space))
        for engine in ('Bullet', 'libode', 'libmujoco', 'libdart'):
            self.assertNotIn(engine, libraries)

    def test_core_and_node_are_built_without_rviz_python_and_other_engines(self):
        said = self.done('cmake -S %s -B build -DCMAKE_DISABLE_FIND_PACKAGE_rviz=TRUE -DRBS_PEER_ENGINES=OFF '
                         '-DCMAKE_DISABLE_FIND_PACKAGE_pybind11=TRUE; '
                         'cmake --build build --target help' % ROOT)
        targets = re.findall(r'^\.\.\. (\w+)', said, re.MULTILINE)
        self.assertIn('no plugin for RViz', said)
        self.assertIn('no physics for Python', said)
        for target in ('core', 'node', 'explain', 'accuracy_probe_with_peers'):
            self.assertIn('rigid_body_sim_' + target, targets)
        for target in ('rviz', 'python', 'peers', 'scene_benchmark', 'beside_fcl_benchmark'):
            self.assertNotIn('rigid_body_sim_' + target, targets)


if __name__ == '__main__':
    unittest.main()
