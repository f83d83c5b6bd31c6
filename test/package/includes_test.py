#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Arrows between the files of the core only go down: a header with its source file is one node, and no includes go round.
The core knows nothing of ROS."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CORE = ROOT / 'src/core'


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


class IncludesTest(unittest.TestCase):

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
