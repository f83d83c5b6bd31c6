#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The package as its packagers and licence scanners read it."""
import math
import os
import pathlib
import re
import subprocess
import unittest

import yaml
from catkin_pkg.changelog import get_changelog_from_path
from catkin_pkg.package import parse_package
from catkin_pkg.package_version import get_forthcoming_label

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ['RBS_BUILD'])
GENERATED = ('.git', 'build', 'devel', 'install')
LICENCE = 'SPDX-License-Identifier: BSD-3-Clause'


def sources():
    """All files that are written by people or scripts and kept."""
    for folder, folders, files in os.walk(ROOT):
        top = pathlib.Path(folder) == ROOT
        folders[:] = [name for name in folders if name != '__pycache__' and not (top and name.startswith(GENERATED))
                      and not os.path.exists(os.path.join(folder, name, 'CMakeCache.txt'))]
        for name in files:
            if not name.endswith('.pyc') and not (top and name.startswith(GENERATED)):
                yield pathlib.Path(folder, name)


def run(*command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)


class PackageTest(unittest.TestCase):
    def test_scripts_that_are_asked_for_help_do_nothing_else(self):
        kept = BUILD / 'accuracy' / 'kept.txt'  # a run begins by emptying this folder
        kept.parent.mkdir(exist_ok=True)
        kept.touch()
        for name in ('accuracy_report', 'collision_figures', 'demo', 'effects_report', 'format', 'fuzz', 'hunt', 'mutate',
                     'performance_report', 'soak', 'stability', 'test'):
            done = run(str(ROOT / 'scripts' / name), '--help', timeout=20)
            self.assertEqual(0, done.returncode, name + done.stdout)
            self.assertRegex(done.stdout, f'(?i)usage: (scripts/)?{name}', name)
        self.assertTrue(kept.exists())
        kept.unlink()

    def test_catkin_lint_has_nothing_to_say(self):
        # The folder of a checkout is named by whoever made it.
        done = run('catkin_lint', '--strict', '-W2', '--ignore', 'package_path_name', str(ROOT))
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_the_changelog_is_parsed(self):
        changelog = get_changelog_from_path(str(ROOT))
        self.assertIn('\nChangelog for package rigid_body_sim\n', changelog.rst)
        headings = re.findall(r'^(\S.*)\n-+$', changelog.rst, re.MULTILINE)
        if get_forthcoming_label(changelog.rst):
            self.assertEqual(headings.pop(0), 'Forthcoming')
        parsed = ['%s (%s)' % (version, date.date()) for version, date, _ in changelog.foreach_version()]
        self.assertEqual(parsed, headings)
        self.assertEqual(parsed[0].split()[0], parse_package(str(ROOT)).version)

    def test_the_package_says_where_it_comes_from(self):
        package = parse_package(str(ROOT))
        package.validate()
        self.assertEqual(package.licenses, ['BSD-3-Clause'])
        self.assertTrue(package.urls)

    def test_every_file_names_its_licence(self):
        def head(file):
            return b'\n'.join(file.read_bytes().split(b'\n')[:30 if file.suffix == '.svg' else 5]).decode(errors='replace')

        # The licence itself, and what has no lines of its own: pictures, and inputs that a fuzzer made.
        named = [file for file in sources() if file.name != 'LICENSE' and file.suffix != '.png'
                 and ROOT / 'test/fuzz/corpus' not in file.parents]
        self.assertGreater(len(named), 300)
        self.assertEqual([str(file.relative_to(ROOT)) for file in named if LICENCE not in head(file)], [])

    def test_the_workflow_calls_what_people_call(self):
        jobs = yaml.safe_load((ROOT / '.github/workflows/ci.yml').read_text())['jobs'].values()
        programs = {step['run'].split()[0] for job in jobs for step in job['steps'] if 'run' in step}
        self.assertIn('./scripts/test', programs)
        for program in programs - {'catkin_lint'}:
            self.assertTrue(os.access(ROOT / program, os.X_OK), program)

    def test_the_api_is_documented_without_warnings(self):
        done = run('doxygen', '-', cwd=ROOT, input=(ROOT / 'Doxyfile').read_text() + 'OUTPUT_DIRECTORY = %s/doc\n' % BUILD)
        self.assertEqual((done.returncode, done.stdout), (0, ''))
        self.assertTrue((BUILD / 'doc/html/classrbs_1_1World.html').is_file())

    def test_rviz_begins_with_the_view_of_the_first_scene(self):
        layout = yaml.safe_load((ROOT / 'rviz/sim.rviz').read_text())['Visualization Manager']['Views']['Current']
        view = yaml.safe_load((ROOT / 'scenes/playground.yaml').read_text())['view']
        x, y, z = (eye - target for eye, target in zip(view['eye'], view['target']))
        self.assertEqual([layout['Focal Point'][axis] for axis in 'XYZ'], view['target'])
        self.assertAlmostEqual(layout['Distance'], math.hypot(x, y, z), delta=0.01)
        self.assertAlmostEqual(layout['Pitch'], math.atan2(z, math.hypot(x, y)), delta=0.002)
        self.assertAlmostEqual(layout['Yaw'], math.atan2(y, x) % (2.0 * math.pi), delta=0.002)

    def test_every_target_that_is_compiled_carries_our_name(self):
        folders = [pathlib.Path(line) for line in (BUILD / 'CMakeFiles/TargetDirectories.txt').read_text().split()]
        ours = [folder.stem for folder in folders
                if folder.parents[1] in (BUILD, BUILD / 'test') and (folder / 'flags.make').is_file()]
        self.assertGreater(len(ours), 10)
        self.assertEqual([name for name in ours if not name.startswith('rigid_body_sim')], [])


class UntilClosedTest(unittest.TestCase):
    """The launch-prefix that opens a window again when its program crashes."""

    def opened(self, crashes):
        """How often a program is opened that crashes so many times before a person closes it, and what is said."""
        count = BUILD / 'opened'
        count.write_text('')
        done = run(ROOT / 'launch/until_closed', '/bin/bash', '-c',
                   'echo >>%s; [ $(wc -l <%s) -gt %d ] || kill -SEGV $$' % (count, count, crashes), timeout=60)
        return len(count.read_text()), done.returncode, done.stdout

    def test_a_window_that_is_closed_stays_closed(self):
        self.assertEqual(self.opened(0), (1, 0, ''))

    def test_a_program_that_crashes_is_opened_again(self):
        opened, code, said = self.opened(2)
        self.assertEqual((opened, code), (3, 0))
        self.assertIn('bash ended with 139 and is opened again', said)

    def test_one_that_always_crashes_is_left_closed_and_the_launch_goes_on(self):
        program = subprocess.Popen([ROOT / 'launch/until_closed', '/bin/false'], stderr=subprocess.PIPE, text=True)
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.wait)
        self.addCleanup(program.terminate)
        said = [program.stderr.readline() for _ in range(3)]
        self.assertIn('ended with 1 three times and is left closed', said[2])
        self.assertIsNone(program.poll())


if __name__ == '__main__':
    unittest.main()
