#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What RViz looks like with the saved layout, compared with pictures that somebody has looked at.

The pictures are reduced by eight, to 160 x 100: a panel, a button or a body that is missing, moved or of another colour is
seen, and a digit of a time that differs from run to run is not.

    rostest rigid_body_sim looks.test write:=FOLDER      writes the pictures of now into a folder
"""
import os
import sys
import tempfile
import time
import unittest

import rospy
import rostest
from rigid_body_sim.msg import BodyNames, Status

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from gui_test import LAYOUT, VIEW, Last, Simulator  # noqa: E402
import rviz_driver  # noqa: E402
from rviz_driver import wait_until  # noqa: E402

FOLDER = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'looks')
REDUCED = '160x100!'
MOST_OFF = 25  # of 255, in any channel of a reduced pixel: what is beyond has changed
CLOCK = 16  # percent of the height, at the bottom, in which RViz shows the time of day
MOST_CHANGED = 40  # reduced pixels; two runs differ by none
PAGES = ('stages', 'accuracy', 'effects', 'wind', 'warnings')


class LooksTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = Simulator()
        cls.simulator.start()
        cls.addClassCleanup(cls.simulator.kill)
        status = Last('/sim/status', Status)
        wait_until(status, 'the simulator says how it is')
        cls.select = rospy.Publisher('/sim/select_bodies', BodyNames, queue_size=1, latch=True)
        cls.screen = rviz_driver.Screen().__enter__()
        cls.addClassCleanup(cls.screen.__exit__)

    def look(self, name, page=0, bodies=(), **options):
        def change(layout):
            rviz_driver.look_from(layout, VIEW)
            panel = next(p for p in layout['Panels'] if p['Class'] == 'rigid_body_sim/SimulationPanel')
            panel['Page'] = page
            display = next(d for d in layout['Visualization Manager']['Displays'] if d['Class'] == 'rigid_body_sim/Bodies')
            display.update(options)
        self.select.publish(BodyNames(names=list(bodies)))
        with rviz_driver.Rviz(self.screen, LAYOUT, change) as rviz:
            rviz.wait_for_rest()
            time.sleep(1.0)  # the panels show what they have heard meanwhile
            self.compare(name)

    def reduced(self, picture):
        ppm = self.screen.run('convert', picture, '-scale', REDUCED, '-depth', '8', 'ppm:-')
        return ppm.split(b'\n255\n', 1)[1]

    def compare(self, name):
        with tempfile.TemporaryDirectory() as folder:
            whole = os.path.join(rospy.get_param('~write', '') or folder, name + '_whole.png')
            self.screen.save(whole)
            if rospy.get_param('~write', ''):
                return self.screen.run('convert', whole, '-scale', REDUCED, whole.replace('_whole', ''))
            now, wanted = self.reduced(whole), self.reduced(os.path.join(FOLDER, name + '.png'))
        self.assertEqual(len(now), len(wanted))
        now = now[:len(now) * (100 - CLOCK) // 100]
        changed = sum(any(abs(now[at + c] - wanted[at + c]) > MOST_OFF for c in range(3)) for at in range(0, len(now), 3))
        self.assertLessEqual(changed, MOST_CHANGED, '%s: so many of %d pixels have changed' % (name, len(now) // 3))

    def test_bodies_that_are_selected(self):
        self.look('selected', bodies=('middle',))

    def test_options_of_the_display(self):
        self.look('options', **{'Color By': 'Island', 'Names': True, 'Axes': True, 'Bounding Boxes': True, 'Centres of Mass': True})


def add_page(number, name):
    setattr(LooksTest, 'test_page_of_' + name, lambda self: self.look('page_of_' + name, page=number))


for number, name in enumerate(PAGES):
    add_page(number, name)


if __name__ == '__main__':
    rospy.init_node('looks_test')
    rostest.rosrun('rigid_body_sim', 'looks_test', LooksTest, sys.argv)
