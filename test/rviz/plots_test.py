#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The Plots panel in a real RViz with a real simulator, steered with a real mouse and keyboard.

Nothing here is timed: every check waits, for up to a minute, until what it expects is so.
"""
import csv
import os
import sys
import tempfile
import unittest

import rosgraph
import rospy
import rostest
from rigid_body_sim.msg import Status
from rigid_body_sim.srv import SetFidelity, SetSpeed
from std_srvs.srv import Trigger

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from gui_test import LAYOUT, Last, Simulator, call  # noqa: E402
import rviz_driver  # noqa: E402
from rviz_driver import wait_for_alike, wait_until  # noqa: E402

HEIGHT, GRAVITY = 1000.0, 9.81  # of free_fall.yaml
# The recorded times are stamps: whole nanoseconds, at up to 100 m/s.
TOLERANCE = 1e-6  # m
# Of the first two curves of a plot, on a light background.
FIRST_CURVE, SECOND_CURVE = (0x00, 0x72, 0xb2), (0xd5, 0x5e, 0x00)


def only_plots(layout):
    layout['Panels'] = [{'Class': 'rigid_body_sim/Plots', 'Name': 'Plots', 'Node': 'sim',
                         'Plots': [{'Quantity': 'height', 'Bodies': ['ball']}]}]


class PlotsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = Simulator()
        cls.simulator.start()
        cls.addClassCleanup(cls.simulator.kill)
        cls.status = Last('/sim/status', Status)
        wait_until(cls.status, 'the simulator says how it is')
        cls.screen = rviz_driver.Screen().__enter__()
        cls.addClassCleanup(cls.screen.__exit__)
        cls.rviz = rviz_driver.Rviz(cls.screen, LAYOUT, only_plots)
        cls.rviz.__enter__()
        cls.addClassCleanup(cls.rviz.__exit__)
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def setUp(self):
        self.simulator.start()
        call('pause', Trigger)
        call('set_speed', SetSpeed, 1.0)
        call('reset', Trigger)
        self.wait_for_status(lambda s: s.paused and s.time == 0.0, 'paused and reset')
        wait_until(lambda: self.rviz.find_color(FIRST_CURVE), 'the panel names its curve')

    def wait_for_status(self, condition, what):
        return wait_until(lambda: self.status() and condition(self.status()), what)

    def key(self, *names):
        self.rviz.key(names[0])
        for name in names[1:]:
            self.screen.xdotool('sleep', 0.3, 'key', name)

    def type(self, text):
        self.screen.xdotool('sleep', 0.3, 'type', '--delay', 30, text)

    def canvas(self):
        """A pixel in the middle of the only plot."""
        scene = self.rviz.scene
        return (scene.x // 2, scene.y + scene.height // 2)

    def plot(self):
        """What is drawn beside the scene, at half of its height."""
        scene = self.rviz.scene
        return self.screen.picture(rviz_driver.Window(None, 0, scene.y + scene.height // 4, scene.x, scene.height // 2))

    def window_named(self, name):
        return self.screen.run('sh', '-c', 'xdotool search --onlyvisible --name "^%s$" || true' % name).decode().split()

    def export(self, path):
        """Asks for a file by the button and the dialogue."""
        self.key('alt+x')
        dialogue = wait_until(lambda: self.window_named('Export plots'), 'the dialogue is open')[0]
        self.screen.xdotool('windowfocus', dialogue, 'sleep', 0.5)
        self.type(path)
        self.screen.xdotool('sleep', 0.3, 'key', 'Return')
        wait_until(lambda: not self.window_named('Export plots'), 'the dialogue is closed')

    def table(self):
        """The exported table: its heading, and its rows of numbers, None for an empty cell."""
        path = os.path.join(self.folder.name, self.id() + str(len(os.listdir(self.folder.name))) + '.csv')
        self.export(path)
        wait_until(lambda: os.path.exists(path), 'the table is written')
        with open(path, newline='') as file:
            heading, *rows = csv.reader(file, strict=True)
        return heading, [[float(cell) if cell else None for cell in row] for row in rows]

    def assert_free_fall_until(self, until):
        self.assert_free_fall(self.table()[1], until)

    def assert_free_fall(self, rows, until):
        self.assertGreater(len(rows), 10)
        self.assertEqual([row[0] for row in rows], sorted(row[0] for row in rows))
        self.assertAlmostEqual(rows[-1][0], until, places=6)
        for time, height, *_ in rows:
            self.assertAlmostEqual(height, HEIGHT - GRAVITY * time * time / 2, delta=TOLERANCE)

    def fall(self, duration):
        """Falls from the start for as long, s, or a little longer. Returns when it was stopped, s of physics time."""
        call('resume', Trigger)
        self.wait_for_status(lambda s: s.time >= duration, '%g s have passed' % duration)
        call('pause', Trigger)
        self.wait_for_status(lambda s: s.paused, 'paused')
        self.draw_anew()
        return self.status().time

    def draw_anew(self):
        wait_for_alike(self.plot, 4, 'the plot is drawn')

    def test_the_height_of_a_falling_body_is_exported_as_it_was(self):
        until = self.fall(2.0)
        heading, rows = self.table()
        self.assertEqual(heading[:2], ['time (s)', 'height of ball (m)'])
        self.assertAlmostEqual(rows[0][0], 0.0, places=6)
        self.assert_free_fall(rows, until)

    def test_a_reset_begins_a_run(self):
        self.fall(2.0)
        call('reset', Trigger)
        self.wait_for_status(lambda s: s.time == 0.0, 'reset')
        self.assert_free_fall_until(self.fall(1.0))

    def test_another_start_of_the_simulator_begins_a_run(self):
        self.fall(2.0)
        picture = self.plot()
        self.simulator.kill()
        self.status.forget()
        self.simulator.start()
        self.wait_for_status(lambda s: s.time == 0.0, 'the simulator is back')
        wait_until(lambda: self.plot() != picture, 'the panel hears the simulator')
        self.assert_free_fall_until(self.fall(1.5))

    def test_pictures_are_written(self):
        self.fall(0.5)
        for kind, beginning in (('png', b'\x89PNG'), ('svg', b'<?xml')):
            path = os.path.join(self.folder.name, 'plots.' + kind)
            self.export(path)
            wait_until(lambda: os.path.exists(path), 'the %s is written' % kind)
            with open(path, 'rb') as file:
                content = file.read()
            self.assertEqual(content[:len(beginning)], beginning)
            self.assertGreater(len(content), 2000)

    def test_a_file_that_cannot_be_written_is_told_and_leaves_nothing(self):
        until = self.fall(0.5)
        before = os.listdir('/proc/self')
        scene = self.rviz.scene
        below = rviz_driver.Window(None, 0, scene.y + scene.height - 90, scene.x, 90)  # the message above the node
        for path in ('/proc/self/plots.csv', os.path.join(self.folder.name, 'plots.pdf')):
            silent = self.screen.picture(below)
            self.export(path)
            wait_until(lambda: self.screen.picture(below) != silent, 'the panel says that it is not written')
            self.assertFalse(os.path.exists(path))
        self.assertEqual(os.listdir('/proc/self'), before)
        self.assert_free_fall_until(until)

    def choose(self, body, quantity):
        """Names a body in the list of quantities, and takes the quantity."""
        self.key('alt+a')
        self.screen.xdotool('sleep', 0.5, 'key', 'Tab', 'key', 'Tab', 'key', 'ctrl+a')
        self.type(body)
        self.screen.xdotool('sleep', 0.3, 'key', 'shift+Tab', 'key', 'shift+Tab')
        self.type(quantity)
        self.screen.xdotool('sleep', 0.3, 'key', 'Return', 'sleep', 0.5, 'key', 'Escape')

    def test_only_bodies_that_are_there_are_added(self):
        self.choose('bal', 'height')
        self.choose('', 'height')
        self.assertEqual(self.table()[0], ['time (s)', 'height of ball (m)'])
        self.assertIsNone(self.rviz.find_color(SECOND_CURVE))
        self.choose('box', 'height')
        wait_until(lambda: self.rviz.find_color(SECOND_CURVE), 'a second curve is named')
        self.assertEqual(self.table()[0], ['time (s)', 'height of ball (m)', 'height of box (m)'])

    def test_it_listens_only_to_what_it_shows(self):
        def heard():
            _, subscribed, _ = rosgraph.Master('/plots_test').getSystemState()
            return {topic for topic, nodes in subscribed if any('rviz' in node for node in nodes)}

        wait_until(lambda: '/sim/body_states' in heard(), 'it listens to the states of bodies')
        self.assertNotIn('/sim/contacts', heard())

    def run_slowly(self):
        call('set_speed', SetSpeed, 0.2)
        call('resume', Trigger)
        self.wait_for_status(lambda s: s.time > 0.5, 'running')

    def assert_still_while_time_goes_on(self):
        wait_for_alike(self.plot, 4, 'the plot stands still')
        picture, time = self.plot(), self.status().time
        self.wait_for_status(lambda s: s.time > time + 0.3, 'time goes on')
        self.assertEqual(self.plot(), picture)

    def assert_moves(self):
        picture = self.plot()
        wait_until(lambda: self.plot() != picture, 'the plot goes on')

    def test_what_is_held_stands_still_and_is_recorded(self):
        self.run_slowly()
        self.assert_moves()
        self.key('alt+l')
        self.assert_still_while_time_goes_on()
        held_until = self.status().time
        self.key('alt+l')
        self.assert_moves()
        call('pause', Trigger)
        self.wait_for_status(lambda s: s.paused, 'paused')
        self.draw_anew()
        times = [row[0] for row in self.table()[1]]
        self.assertTrue(any(held_until - 0.3 < time < held_until for time in times))

    def test_the_mouse_zooms_moves_and_goes_back(self):
        x, y = self.canvas()
        mouse = self.screen.xdotool
        actions = {
            'wheel': ('click', 4),
            'rectangle': ('mousedown', 1, 'sleep', 0.2, 'mousemove', x + 40, y + 60, 'sleep', 0.2, 'mouseup', 1),
            'pan': ('mousedown', 2, 'sleep', 0.2, 'mousemove', x + 40, y, 'sleep', 0.2, 'mouseup', 2),
        }
        self.fall(2.0)
        mouse('mousemove', 1, 1)
        self.draw_anew()
        followed = self.plot()
        for name, action in actions.items():
            with self.subTest(name):
                mouse('mousemove', x, y, 'sleep', 0.3, *action, 'sleep', 0.3, 'mousemove', 1, 1)
                self.draw_anew()
                self.assertNotEqual(self.plot(), followed)
                mouse('mousemove', x, y, 'sleep', 0.2, 'click', '--repeat', 2, '--delay', 50, 1, 'mousemove', 1, 1)
                wait_until(lambda: self.plot() == followed, 'it is back')

    def test_a_change_of_the_settings_and_a_baseline_are_seen(self):
        self.fall(1.0)
        picture = self.plot()
        call('set_fidelity', SetFidelity, 'accurate')
        wait_until(lambda: self.plot() != picture, 'a mark is seen')
        self.addCleanup(call, 'set_fidelity', SetFidelity, 'interactive')
        self.draw_anew()
        picture = self.plot()
        self.key('alt+b')
        wait_until(lambda: self.plot() != picture, 'the change since the baseline is seen')
        self.key('alt+b')
        wait_until(lambda: self.plot() == picture, 'the values are seen again')


if __name__ == '__main__':
    rospy.init_node('plots_test')
    rostest.rosrun('rigid_body_sim', 'plots', 'plots_test')
