#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The saved layout in a real RViz, steered with a real mouse and keyboard.

Nothing here is timed: every check waits, for up to a minute, until what it expects is so.
"""
import os
import subprocess
import sys
import threading
import unittest

import rosgraph
import roslib.packages
import rospy
import rostest
from rigid_body_sim.msg import Status
from rigid_body_sim.srv import GetBody
from std_srvs.srv import SetBool, Trigger

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')
sys.path.insert(0, os.path.join(ROOT, 'scripts'))
import rviz_driver  # noqa: E402
from rviz_driver import wait_until  # noqa: E402

LAYOUT = os.path.join(ROOT, 'rviz', 'sim.rviz')
VIEW = rviz_driver.View(eye=[6.0, -6.0, 5.0], target=[0.0, 0.0, 0.5])  # of three_boxes.yaml
# Of the icons of the panel.
PLAY_GREEN = (0x2e, 0x9e, 0x4f)
PAUSE_AMBER = (0xd9, 0x8a, 0x00)
STEP_BLUE = (0x2f, 0x6f, 0xbf)


def call(service, kind, *arguments):
    rospy.wait_for_service('/sim/' + service, rviz_driver.PATIENCE)
    answer = rospy.ServiceProxy('/sim/' + service, kind)(*arguments)
    if not answer.success:
        raise AssertionError('%s: %s' % (service, answer.message))
    return answer


def position(body):
    place = call('get_body', GetBody, body).body.pose.position
    return (place.x, place.y, place.z)


class Simulator:
    """The node, as a process that can be killed and started again."""

    process = None

    def start(self):
        """Does nothing when it runs already."""
        if self.process is None or self.process.poll() is not None:
            program = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]
            self.process = subprocess.Popen([program, '__name:=sim'])

    def kill(self):
        self.process.kill()
        self.process.wait()


class LastStatus:
    """The newest ~status, as a function."""

    def __init__(self):
        self.lock = threading.Lock()
        self.status = None
        rospy.Subscriber('/sim/status', Status, self.keep, queue_size=1)

    def keep(self, status):
        with self.lock:
            self.status = status

    def forget(self):
        self.keep(None)

    def __call__(self):
        with self.lock:
            return self.status


class GuiTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = Simulator()
        cls.simulator.start()
        cls.addClassCleanup(cls.simulator.kill)
        cls.status = LastStatus()
        wait_until(cls.status, 'the simulator says how it is')
        cls.screen = rviz_driver.Screen().__enter__()
        cls.addClassCleanup(cls.screen.__exit__)
        cls.rviz = rviz_driver.Rviz(cls.screen, LAYOUT, lambda layout: rviz_driver.look_from(layout, VIEW))
        cls.rviz.__enter__()
        cls.addClassCleanup(cls.rviz.__exit__)

    def setUp(self):
        """A paused world as it was loaded, in a picture at rest."""
        self.simulator.start()
        call('pause', Trigger)
        call('reset', Trigger)
        self.wait_for_status(lambda s: s.paused and s.time == 0.0, 'paused and reset')
        self.rviz.wait_for_rest()

    def wait_for_status(self, condition, what):
        return wait_until(lambda: self.status() and condition(self.status()), what)

    def press(self, color):
        """Clicks the button of the panel whose icon has this colour, once it is there."""
        self.rviz.click(wait_until(lambda: self.rviz.find_color(color), 'a button of colour %s' % (color, )))

    def test_the_panel_is_loaded_and_hears_the_simulator(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'the panel shows a button to run')
        self.assertNotIn('failed to load', self.rviz.output())

    def test_the_layout_subscribes_to_what_the_simulator_offers(self):
        def heard_by_rviz():
            published, subscribed, _ = rosgraph.Master('/gui_test').getSystemState()
            offered = {topic for topic, nodes in published if '/sim' in nodes}
            return {topic for topic, nodes in subscribed if any('rviz' in node for node in nodes)} & offered

        wanted = {'/sim/visualization_marker_array', '/sim/interactive_bodies/update', '/sim/status'}
        wait_until(lambda: wanted <= heard_by_rviz(), 'RViz listens to %s' % wanted)

    def test_dragging_a_body_moves_it_where_the_mouse_lets_go(self):
        start = position('middle')
        # The drag stays in the plane of the view, so this point is found again on the way back.
        target = (start[0] + 0.7, start[1] + 0.7, start[2])
        self.rviz.drag(self.rviz.pixel_of(start), self.rviz.pixel_of(target))

        def is_there():
            x, y = self.rviz.pixel_of(position('middle'))
            wanted_x, wanted_y = self.rviz.pixel_of(target)
            return abs(x - wanted_x) <= 8 and abs(y - wanted_y) <= 8

        wait_until(is_there, 'the body is where the mouse let it go')
        self.assertGreater(position('middle')[0], start[0] + 0.3)
        self.assertEqual(position('left'), (-1.5, -1.5, 0.4))

    def test_the_button_runs_and_pauses(self):
        self.press(PLAY_GREEN)
        self.wait_for_status(lambda s: not s.paused and s.time > 0.0, 'running after a press on play')
        self.press(PAUSE_AMBER)
        self.wait_for_status(lambda s: s.paused, 'paused after a press on pause')

    def test_the_step_button_takes_one_step(self):
        self.press(STEP_BLUE)
        self.wait_for_status(lambda s: s.steps == 1, 'one step after a press on step')

    def test_key_1_toggles_the_wind(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'the panel hears the simulator')
        self.rviz.key('1')
        self.wait_for_status(lambda s: s.wind, 'wind after key 1')
        self.rviz.key('1')
        self.wait_for_status(lambda s: not s.wind, 'no wind after key 1 again')

    def panel(self):
        """What is drawn beside the scene, the bytes of each row of pixels: not what is below it, which tells frames a second."""
        picture, scene = self.screen.picture(), self.rviz.scene

        def row(y):
            pixels = picture.rgb[3 * picture.width * y:3 * picture.width * (y + 1)]
            return pixels[:3 * scene.x] + pixels[3 * (scene.x + scene.width):]

        return [row(y) for y in range(scene.y, scene.y + scene.height)]

    def test_the_check_boxes_follow_what_others_switch(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'the panel hears the simulator')
        for service in ('estimate_error', 'show_ghost'):
            self.addCleanup(call, service, SetBool, False)
            before = self.panel()

            def changed():
                """Height of what is not as it was, pixels."""
                rows = [y for y, (a, b) in enumerate(zip(before, self.panel())) if a != b]
                return rows[-1] - rows[0] + 1 if rows else 0

            call(service, SetBool, True)
            # A check mark has appeared, and nothing as high as two rows of the panel has changed.
            wait_until(lambda: 0 < changed() < 40, '%s is seen in the panel' % service)
            call(service, SetBool, False)
            wait_until(lambda: changed() == 0, 'the panel is as it was before %s' % service)

    def test_the_panel_survives_the_death_of_the_simulator(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'the panel hears the simulator')
        self.simulator.kill()
        wait_until(lambda: not self.rviz.find_color(PLAY_GREEN), 'the panel is grey without a simulator')
        self.status.forget()
        self.simulator.start()
        wait_until(self.status, 'the simulator is back')
        self.press(STEP_BLUE)
        self.wait_for_status(lambda s: s.steps == 1, 'a step of the new simulator after a press on step')


if __name__ == '__main__':
    rospy.init_node('gui_test')
    rostest.rosrun('rigid_body_sim', 'gui', GuiTest)
