#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""RViz with the saved layout, while one scene after another is opened: its memory must not go on to grow."""
import os
import statistics
import sys
import time
import unittest

import rospy
import rostest
from rigid_body_sim.msg import BodyStates
from rigid_body_sim.srv import ListScenes, LoadScene

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from gui_test import LAYOUT, Simulator, call  # noqa: E402
import rviz_driver  # noqa: E402

SECONDS = 0.5  # that a scene is open
WARM_UP = 2  # rounds, in which caches fill
MOST_GROWTH = 4.0  # MB, of the median of the next rounds over the least before: 0.05 MB a scene
TRIALS = 3  # a buffer that has been enlarged (20 MB are seen) fails one; a leak fails each


def memory_of(process):
    with open('/proc/%d/status' % process.pid) as status:
        fields = dict(line.split(':', 1) for line in status)
    return int(fields['VmRSS'].split()[0]) / 1024.0


@unittest.skipIf('RBS_RVIZ_PRELOAD' in os.environ, 'a sanitizer keeps the memory that RViz gives back')
class GrowthTest(unittest.TestCase):
    def test_opening_scenes_does_not_make_rviz_grow(self):
        simulator = Simulator()
        simulator.start()
        self.addCleanup(simulator.kill)
        scenes = call('list_scenes', ListScenes).names
        with rviz_driver.Screen() as screen, rviz_driver.Rviz(screen, LAYOUT) as rviz:
            sizes = []

            def open_all(rounds):
                for _ in range(rounds):
                    for scene in scenes:
                        call('load_scene', LoadScene, scene)
                        rospy.wait_for_message('/sim/body_states', BodyStates, rviz_driver.PATIENCE)
                        time.sleep(SECONDS)
                    sizes.append(memory_of(rviz.process))
                    print('RViz after %d scenes: %.0f MB' % (len(sizes) * len(scenes), sizes[-1]), flush=True)
                return sizes[-rounds:]

            before = open_all(WARM_UP)
            for _ in range(TRIALS):
                after = open_all(rospy.get_param('~rounds'))
                growth = statistics.median(after) - min(before)
                if growth < MOST_GROWTH:
                    break
                before = after
        self.assertGreater(len(scenes), 10)
        self.assertLess(growth, MOST_GROWTH, sizes)


if __name__ == '__main__':
    rospy.init_node('growth_test')
    rostest.rosrun('rigid_body_sim', 'growth_test', GrowthTest, sys.argv)
