#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Includes between the rooms of the core only go down, and between its files they do not go round: a header with its source
file is one node. The core knows nothing of ROS."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORE = ROOT / 'src/core'
# From the lowest room up; docs/architecture.md says what each holds.
ROOMS = ['base', 'dynamics', 'shapes', 'narrowphase', 'coulomb', 'state', 'broadphase', 'effects', 'solver', 'step', 'scene', 'world',
         'accuracy', 'simulator']


def node(name):
    return name.rsplit('.', 1)[0]


def arrows():
    """The files that each file of the core includes."""
    paths = sorted(path for path in CORE.rglob('*') if path.suffix in ('.h', '.cpp'))
    names = {str(path.relative_to(CORE)) for path in paths}
    found = {}
    for path in paths:
        name = str(path.relative_to(CORE))
        included = re.findall(r'#include "([^"]+)"', path.read_text())
        found.setdefault(node(name), set()).update(node(other) for other in included if other in names and node(other) != node(name))
    return found


def round_trip(graph):
    """The files of one circle of includes; empty when there is none."""
    done, trail = set(), []

    def visit(name):
        if name in trail:
            return trail[trail.index(name):] + [name]
        if name in done:
            return []
        trail.append(name)
        for other in sorted(graph[name]):
            circle = visit(other)
            if circle:
                return circle
        trail.pop()
        done.add(name)
        return []

    for name in sorted(graph):
        circle = visit(name)
        if circle:
            return circle
    return []


def upward(graph):
    """The includes of a room above, as (file, included file)."""
    def height(name):
        return ROOMS.index(name.split('/')[0])
    return [(name, other) for name in sorted(graph) for other in sorted(graph[name]) if height(other) > height(name)]


class IncludesTest(unittest.TestCase):

    def test_an_upward_include_is_found(self):
        self.assertEqual(upward({'state/a': {'step/b', 'base/c'}, 'step/b': {'state/a'}, 'base/c': set()}), [('state/a', 'step/b')])

    def test_includes_between_rooms_go_down(self):
        self.assertEqual(sorted(path.name for path in CORE.iterdir() if path.is_dir()), sorted(ROOMS))
        self.assertEqual(upward(arrows()), [])

    def test_every_private_header_is_named_by_its_room(self):
        for path in CORE.rglob('*'):
            if path.suffix in ('.h', '.cpp'):
                for other in re.findall(r'#include "([^"]+)"', path.read_text()):
                    if not other.startswith('rigid_body_sim/') and other != 'effects_built.h':
                        self.assertTrue((CORE / other).exists(), '%s includes %s' % (path.relative_to(ROOT), other))

    def test_a_circle_is_found(self):
        self.assertEqual(round_trip({'a': {'b'}, 'b': {'c'}, 'c': {'b'}}), ['b', 'c', 'b'])
        self.assertEqual(round_trip({'a': {'b', 'c'}, 'b': {'c'}, 'c': set()}), [])

    def test_no_includes_go_round(self):
        graph = arrows()
        self.assertGreater(len(graph), 100)
        self.assertEqual(round_trip(graph), [])

    def test_the_core_knows_nothing_of_ros(self):
        for path in CORE.rglob('*'):
            if path.suffix in ('.h', '.cpp'):
                for other in re.findall(r'#include [<"](ros|tf2\w*|rviz|\w+_msgs|interactive_markers)/', path.read_text()):
                    self.fail('%s includes %s' % (path.relative_to(ROOT), other))


if __name__ == '__main__':
    unittest.main()
