#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The saved layout in a real RViz, steered with a real mouse and keyboard.

Nothing here is timed: every check waits, for up to a minute, until what it expects is so.
"""
import math
import os
import subprocess
import sys
import threading
import unittest

import rosgraph
import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import Point, Quaternion, Vector3
from rigid_body_sim.msg import BodyNames, Status
from rigid_body_sim.srv import ClosestPoints, GetBody, ListBodies, LoadScene, SpawnBody, SpawnBodyRequest
from std_msgs.msg import ColorRGBA, String
from std_srvs.srv import SetBool, Trigger

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')
sys.path.insert(0, os.path.join(ROOT, 'scripts'))
import rviz_driver  # noqa: E402
from rviz_driver import wait_until  # noqa: E402

LAYOUT = os.path.join(ROOT, 'rviz', 'sim.rviz')
VIEW = rviz_driver.View(eye=[6.0, -6.0, 5.0], target=[0.0, 0.0, 0.5])  # of three_boxes.yaml
MANY = os.path.join(ROOT, 'test', 'rviz', 'many_boxes.yaml')
MANY_VIEW = rviz_driver.View(eye=[0.0, -70.0, 95.0], target=[0.0, 0.0, 0.0])  # of many_boxes.yaml
# Of the icons of the panel.
PLAY_GREEN = (0x2e, 0x9e, 0x4f)
PAUSE_AMBER = (0xd9, 0x8a, 0x00)
STEP_BLUE = (0x2f, 0x6f, 0xbf)
RESET_RED = (0xb8, 0x43, 0x3a)


def call(service, kind, *arguments, node='/sim'):
    rospy.wait_for_service('%s/%s' % (node, service), rviz_driver.PATIENCE)
    answer = rospy.ServiceProxy('%s/%s' % (node, service), kind)(*arguments)
    if not answer.success:
        raise AssertionError('%s: %s' % (service, answer.message))
    return answer


def position(body):
    place = call('get_body', GetBody, body).body.pose.position
    return (place.x, place.y, place.z)


class Simulator:
    """The node, as a process that can be killed and started again."""

    process = None

    def __init__(self, *arguments):
        self.arguments = arguments

    def start(self):
        """Does nothing when it runs already."""
        if self.process is None or self.process.poll() is not None:
            program = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]
            self.process = subprocess.Popen([program, '__name:=sim', *self.arguments])

    def kill(self):
        self.process.kill()
        self.process.wait()


class Last:
    """The newest message of a topic, as a function."""

    def __init__(self, topic, kind):
        self.lock = threading.Lock()
        self.message = None
        rospy.Subscriber(topic, kind, self.keep, queue_size=1)

    def keep(self, message):
        with self.lock:
            self.message = message

    def forget(self):
        self.keep(None)

    def __call__(self):
        with self.lock:
            return self.message


def prepare(layout):
    """Looks at the boxes, with the page of the panel open that measures accuracy; adds dodecahedra as meshes."""
    rviz_driver.look_from(layout, VIEW)
    panel = next(panel for panel in layout['Panels'] if panel['Class'] == 'rigid_body_sim/SimulationPanel')
    panel['Page'] = 1
    tool = next(tool for tool in layout['Visualization Manager']['Tools'] if tool['Class'] == 'rigid_body_sim/Spawn')
    tool['Size'] = 0.505  # is read before the tool has been used
    tool['Mesh'] = 'package://rigid_body_sim/scenes/meshes/dodecahedron.obj'


class GuiTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = Simulator()
        cls.simulator.start()
        cls.addClassCleanup(cls.simulator.kill)
        cls.status = Last('/sim/status', Status)
        cls.selection = Last('/sim/selection', String)
        cls.select = rospy.Publisher('/sim/select', String, queue_size=1)
        wait_until(cls.status, 'the simulator says how it is')
        cls.screen = rviz_driver.Screen().__enter__()
        cls.addClassCleanup(cls.screen.__exit__)
        cls.rviz = rviz_driver.Rviz(cls.screen, LAYOUT, prepare)
        cls.rviz.__enter__()
        cls.addClassCleanup(cls.rviz.__exit__)

    def setUp(self):
        """A paused world as it was loaded, without a selection, in a picture at rest."""
        self.simulator.start()
        wait_until(lambda: self.select.get_num_connections() > 0, 'the simulator can be told to select')
        self.select.publish('')
        self.wait_for_selection('')
        call('pause', Trigger)
        call('reset', Trigger)
        self.wait_for_status(lambda s: s.paused and s.time == 0.0, 'paused and reset')
        self.rviz.wait_for_rest()

    def wait_for_status(self, condition, what):
        return wait_until(lambda: self.status() and condition(self.status()), what)

    def wait_for_selection(self, name):
        wait_until(lambda: self.selection() and self.selection().data == name, "'%s' is selected" % name)

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

        wanted = {'/sim/body_descriptions', '/sim/body_states', '/sim/gizmo/update', '/sim/status'}
        wait_until(lambda: wanted <= heard_by_rviz(), 'RViz listens to %s' % wanted)
        # RViz draws a target that is dragged as a white solid, and its own tool reaches the bodies without.
        self.assertNotIn('/sim/interactive_bodies/update', heard_by_rviz())

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

    def test_what_stands_behind_glass_is_taken_through_it(self):
        self.addCleanup(call, 'reset', Trigger)
        pane = SpawnBodyRequest(name='pane', is_static=True, size=Vector3(1.2, 1.2, 1.2), color=ColorRGBA(0.3, 0.6, 0.9, 0.3))
        pane.pose.position = Point(2.0, -2.0, 1.9)  # between the eye and the middle box
        call('spawn_body', SpawnBody, pane)
        self.rviz.wait_for_rest()
        start = position('middle')
        at_middle = self.rviz.pixel_of(start)
        self.rviz.click(at_middle)
        self.wait_for_selection('middle')
        self.rviz.drag(at_middle, self.rviz.pixel_of((0.7, 0.7, start[2])))
        wait_until(lambda: position('middle')[0] > 0.3, 'the box behind the pane follows the mouse')
        # Gestures that are over before the simulator has said what is there.
        self.select.publish('')
        self.wait_for_selection('')
        self.screen.xdotool('mousemove', *self.rviz.pixel_of(position('middle')), 'sleep', 0.3, 'mousedown', 1, 'mouseup', 1)
        self.wait_for_selection('middle')
        start, at_middle = position('middle'), self.rviz.pixel_of(position('middle'))
        self.screen.xdotool('mousemove', *at_middle, 'sleep', 0.3, 'mousedown', 1, 'mousemove', at_middle[0] - 60, at_middle[1], 'mouseup', 1)
        wait_until(lambda: math.dist(position('middle'), start) > 0.1, 'it follows a mouse that was faster than the answer')
        start, at_middle = position('middle'), self.rviz.pixel_of(position('middle'))
        self.screen.xdotool('mousemove', *at_middle, 'sleep', 0.3, 'mousedown', 1, 'mouseup', 1, 'mousemove', at_middle[0] - 60, at_middle[1],
                            'sleep', 1.0)
        self.assertEqual(position('middle'), start, 'a mouse that moves on after a click drags nothing')
        self.assertEqual(position('pane'), (2.0, -2.0, 1.9))

    def is_drawn_near(self, name, pixel):
        return all(abs(a - b) <= 8 for a, b in zip(self.rviz.pixel_of(position(name)), pixel))

    def test_any_of_5000_bodies_is_dragged_in_one_gesture(self):
        def show(scene, view):
            call('load_scene', LoadScene, scene)
            rviz_driver.look_from(self.rviz.layout, view)

        self.addCleanup(show, os.path.join(ROOT, 'test', 'rviz', 'three_boxes.yaml'), VIEW)
        show(MANY, MANY_VIEW)
        self.wait_for_status(lambda s: s.bodies == 5001, 'there are 5,000 boxes')
        for name in ('box_1', 'box_2550', 'box_5000'):
            start = position(name)
            target = self.rviz.pixel_of((0.9 * start[0], 0.8 * start[1], start[2] + 2.0))
            self.rviz.drag(self.rviz.pixel_of(start), target)
            self.wait_for_selection(name)
            wait_until(lambda: self.is_drawn_near(name, target), '%s is where the mouse let it go' % name)

    def test_bodies_are_taken_through_those_of_the_reference_run(self):
        self.addCleanup(call, 'show_ghost', SetBool, False)
        call('show_ghost', SetBool, True)
        self.wait_for_status(lambda s: s.ghost_lag, 'there is a reference run')
        self.rviz.wait_for_rest()
        for name in ('left', 'middle', 'right'):
            self.rviz.click(self.rviz.pixel_of(position(name)))
            self.wait_for_selection(name)
        start = position('middle')
        target = self.rviz.pixel_of((start[0] + 0.7, start[1] + 0.7, start[2]))
        self.rviz.drag(self.rviz.pixel_of(start), target)
        wait_until(lambda: self.is_drawn_near('middle', target), 'the body is where the mouse let it go')

    def test_a_click_on_nothing_and_escape_drop_the_selection(self):
        scene = self.rviz.scene
        sky = (scene.x + 30, scene.y + 30)
        for drop in (lambda: self.rviz.click(sky), lambda: self.rviz.click(self.rviz.pixel_of((1.5, -1.5, 0.0))),
                     lambda: self.rviz.key('Escape')):
            self.rviz.click(self.rviz.pixel_of(position('middle')))
            self.wait_for_selection('middle')
            drop()
            self.wait_for_selection('')
        self.assertEqual(tuple(position('middle')), (0.0, 0.0, 0.4))

    def test_bodies_are_selected_by_a_rectangle_and_one_by_one(self):
        self.addCleanup(self.rviz.key, 'i')
        selected = Last('/sim/selected_bodies', BodyNames)

        def wait_for(*names):
            wait_until(lambda: selected() and sorted(selected().names) == sorted(names), '%s are selected' % (names, ))

        left, middle, right = (self.rviz.pixel_of(position(name)) for name in ('left', 'middle', 'right'))
        self.rviz.key('s')
        corner = (min(left[0], middle[0]) - 40, min(left[1], middle[1]) - 40)
        other = (max(left[0], middle[0]) + 40, max(left[1], middle[1]) + 40)
        self.rviz.sweep(corner, other)
        wait_for('left', 'middle')
        self.rviz.click(right)
        wait_for('right')
        self.rviz.click(left, 'shift')
        wait_for('left', 'right')
        self.rviz.click(right, 'ctrl')
        wait_for('left')
        self.rviz.key('Delete')
        wait_until(lambda: 'left' not in call('list_bodies', ListBodies).names, 'the left box is deleted')
        call('undo', Trigger)
        self.rviz.wait_for_rest()
        self.rviz.click(left)
        wait_for('left')
        self.rviz.key('i')
        self.rviz.click(middle, 'ctrl')
        wait_for('left', 'middle')
        self.rviz.click(left, 'ctrl')
        wait_for('middle')
        self.rviz.key('Delete')
        wait_until(lambda: 'middle' not in call('list_bodies', ListBodies).names, 'the middle box is deleted')
        self.assertIn('left', call('list_bodies', ListBodies).names)

    def test_the_menu_of_a_selected_body_is_for_all_that_are_selected(self):
        self.addCleanup(call, 'reset', Trigger)
        left, middle = (self.rviz.pixel_of(position(name)) for name in ('left', 'middle'))
        self.rviz.click(left)
        self.wait_for_selection('left')
        self.rviz.click(middle, 'ctrl')
        self.wait_for_selection('middle')
        self.screen.xdotool('mousemove', *left, 'sleep', 0.5, 'click', 3, 'sleep', 0.5, 'key', 'Down', 'key', 'Return')
        wait_until(lambda: call('list_bodies', ListBodies).names == ['floor', 'right'], 'both are deleted')

    def test_the_menu_is_for_those_that_were_selected_when_it_opened(self):
        self.addCleanup(call, 'reset', Trigger)
        select = rospy.Publisher('/sim/select_bodies', BodyNames, queue_size=1, latch=True)
        self.addCleanup(select.unregister)
        select.publish(names=['middle', 'left'])
        self.wait_for_selection('left')
        self.screen.xdotool('mousemove', *self.rviz.pixel_of(position('left')), 'sleep', 0.5, 'click', 3, 'sleep', 0.5)
        select.publish(names=['left', 'right'])
        self.wait_for_selection('right')
        said = Last('/sim/interactive_bodies/answer', String)
        self.screen.xdotool('sleep', 0.5, 'key', 'Down', 'key', 'Return')
        wait_until(lambda: said() and 'selection has changed' in said().data, 'the entry is refused')
        self.assertEqual(call('list_bodies', ListBodies).names, ['floor', 'left', 'middle', 'right'])

    def test_bodies_are_added_and_thrown_by_the_mouse(self):
        self.addCleanup(self.rviz.key, 'i')
        before = set(call('list_bodies', ListBodies).names)

        def added():
            return sorted(set(call('list_bodies', ListBodies).names) - before)

        spot = self.rviz.pixel_of((1.5, -1.5, 0.0))
        self.rviz.key('b')
        self.screen.xdotool('mousemove', spot[0] - 9, spot[1], 'sleep', 0.3)
        self.rviz.click(spot)
        wait_until(lambda: len(added()) == 1, 'a body is added')
        x, y, z = position(added()[0])
        self.assertLess(math.hypot(x - 1.5, y + 1.5), 0.1)
        self.assertAlmostEqual(z, 0.505 * 0.5, delta=0.02)
        self.rviz.sweep(self.rviz.pixel_of((1.5, 1.5, 0.0)), self.rviz.pixel_of((1.5, 1.5, 1.0)))
        wait_until(lambda: len(added()) == 2, 'a body is thrown')
        thrown = call('get_body', GetBody, added()[1]).body.twist.linear
        self.assertGreater(thrown.z, 1.0)
        call('undo', Trigger)
        call('undo', Trigger)
        self.assertEqual(added(), [])

    def test_a_body_of_any_shape_is_added_so_that_it_touches_the_slope_under_the_mouse(self):
        self.addCleanup(call, 'reset', Trigger)
        self.addCleanup(self.rviz.key, 'i')
        tilt = math.radians(30.0)
        ramp = SpawnBodyRequest(name='ramp', is_static=True, size=Vector3(2.0, 2.0, 0.2))
        ramp.pose.position = Point(1.5, -1.5, 1.0)
        ramp.pose.orientation = Quaternion(0.0, math.sin(0.5 * tilt), 0.0, math.cos(0.5 * tilt))
        call('spawn_body', SpawnBody, ramp)
        self.rviz.wait_for_rest()
        spot = self.rviz.pixel_of((1.5, -1.5, 1.0 + 0.1 / math.cos(tilt)))
        self.rviz.key('b')
        for row, shape in enumerate(['box', 'sphere', 'capsule', 'cylinder', 'cone', 'hull']):
            self.screen.xdotool('mousemove', spot[0] - 9, spot[1], 'sleep', 0.3, 'click', 3, 'sleep', 0.3)
            self.screen.xdotool(*['key', 'Down'] * (row + 1), 'key', 'Return', 'sleep', 0.3)
            self.screen.xdotool('mousemove', spot[0] - 9, spot[1] - 9, 'sleep', 0.3)
            before = set(call('list_bodies', ListBodies).names)
            self.rviz.click(spot)
            added = wait_until(lambda seen=before: set(call('list_bodies', ListBodies).names) - seen, 'a ' + shape).pop()
            body = call('get_body', GetBody, added).body.description
            self.assertEqual(body.shape, shape)
            self.assertAlmostEqual(max(body.size.x, body.size.y, body.size.z), 0.5, delta=0.01)
            distance = call('closest_points', ClosestPoints, added, 'ramp').distance
            self.assertGreater(distance, 0.0, shape)
            self.assertLess(distance, 0.03, shape)
            call('undo', Trigger)

    def test_delete_deletes_what_is_selected_but_no_body_from_a_text_field(self):
        self.addCleanup(call, 'reset', Trigger)
        self.rviz.click(self.rviz.pixel_of(position('left')))
        self.wait_for_selection('left')
        step = wait_until(lambda: self.rviz.find_color(STEP_BLUE), 'the step button')
        self.rviz.click((step[0] + 40, step[1]))  # the number of steps
        self.rviz.key('Delete')
        self.press(STEP_BLUE)
        self.wait_for_status(lambda s: s.steps == 1, 'a step after the key in the text field')
        self.assertIn('left', call('list_bodies', ListBodies).names)
        self.rviz.click(self.rviz.pixel_of(position('right')))
        self.wait_for_selection('right')
        self.rviz.key('Delete')
        wait_until(lambda: 'right' not in call('list_bodies', ListBodies).names, 'the selected body is deleted')
        self.assertIn('left', call('list_bodies', ListBodies).names)
        self.wait_for_selection('')

    def test_keys_in_an_open_list_are_meant_for_the_list(self):
        self.addCleanup(call, 'reset', Trigger)
        step = wait_until(lambda: self.rviz.find_color(STEP_BLUE), 'the step button')
        self.rviz.click((step[0], step[1] + 60))  # the list of scenes
        self.screen.xdotool('sleep', 0.5, 'key', '1', 'sleep', 0.5, 'key', 'Escape', 'sleep', 0.5)
        self.rviz.key('1')
        self.wait_for_status(lambda s: s.wind, 'the wind is on')
        call('undo', Trigger)
        self.wait_for_status(lambda s: 'wind' not in s.undo and not s.wind, 'it was switched once')

    def delete_right(self):
        self.rviz.click(self.rviz.pixel_of(position('right')))
        self.wait_for_selection('right')
        self.rviz.key('Delete')
        self.wait_for_status(lambda s: 'right' in s.undo and s.unsaved, 'the deletion can be undone')
        self.assertNotIn('right', call('list_bodies', ListBodies).names)

    def test_edits_are_undone_by_key_and_by_button(self):
        self.addCleanup(call, 'reset', Trigger)
        before = self.status().hash
        self.delete_right()
        self.rviz.key('ctrl+z')
        self.wait_for_status(lambda s: s.hash == before, 'the deletion is undone')
        self.rviz.key('ctrl+shift+z')
        self.wait_for_status(lambda s: 'right' in s.undo, 'the deletion is made again')
        self.assertNotIn('right', call('list_bodies', ListBodies).names)
        step = wait_until(lambda: self.rviz.find_color(STEP_BLUE), 'the step button')
        self.rviz.click((step[0] + 96, step[1]))  # its arrow has the colour of texts
        self.wait_for_status(lambda s: s.hash == before, 'the deletion is undone')

    def answer_question(self, *keys):
        """Presses keys in the dialogue that asks. A window takes none before it can be seen."""
        command = ['xdotool', 'search', '--onlyvisible', '--name', '^Reset$', 'windowfocus']
        wait_until(lambda: subprocess.run(command, env=self.screen.env, check=False, stdout=subprocess.DEVNULL,
                                          stderr=subprocess.DEVNULL).returncode == 0, 'the dialogue takes the keys')
        self.screen.xdotool('sleep', 0.3, *(word for key in keys for word in ('key', key, 'sleep', 0.2)))

    def test_reset_asks_before_it_drops_edits(self):
        self.addCleanup(call, 'reset', Trigger)
        self.delete_right()
        self.press(RESET_RED)
        self.answer_question('Return')  # the default is to cancel
        self.press(STEP_BLUE)
        self.wait_for_status(lambda s: s.steps == 1, 'a step after the question')
        self.assertNotIn('right', call('list_bodies', ListBodies).names)
        self.press(RESET_RED)
        self.answer_question('Tab', 'space')
        self.wait_for_status(lambda s: not s.unsaved and s.steps == 0, 'reset')
        self.assertIn('right', call('list_bodies', ListBodies).names)
        call('undo', Trigger)
        self.wait_for_status(lambda s: s.unsaved, 'the reset is undone')
        self.assertNotIn('right', call('list_bodies', ListBodies).names)

    def test_no_text_changes_the_window(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'the panel hears the simulator')
        scene = self.rviz.scene
        said = rospy.Publisher('/sim/interactive_bodies/answer', String, queue_size=1, latch=True)
        for text in ('word ' * 1000, 'x' * 5000):
            before = self.panel()
            said.publish(text)
            wait_until(lambda: self.panel() != before, 'the panel says it')
            self.assertEqual(self.rviz.scene, scene)
        said.unregister()

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

    def test_the_gizmo_goes_when_a_replay_takes_the_place_of_the_simulator(self):
        def gizmo():
            """Number of pixels in the blue of its arrows and rings, which nothing else has."""
            rgb = self.screen.picture(self.rviz.scene).rgb
            return sum(blue > 150 and red < 90 and green < 90 for red, green, blue in zip(rgb[::3], rgb[1::3], rgb[2::3]))

        self.rviz.click(self.rviz.pixel_of(position('middle')))
        wait_until(lambda: gizmo() > 500, 'the gizmo is drawn')
        replay = rospy.Publisher('/sim/status', Status, queue_size=1)
        self.addCleanup(replay.unregister)
        self.simulator.kill()
        self.addCleanup(self.status.forget)

        def is_gone():
            replay.publish(recording=[0.0, 10.0])
            return gizmo() == 0

        wait_until(is_gone, 'the gizmo is gone', period=0.2)
        self.simulator.start()

        def is_back():
            self.select.publish('middle')
            return gizmo() > 500

        wait_until(is_back, 'the next simulator has its gizmo drawn', period=0.2)

    def test_the_panel_survives_the_death_of_the_simulator(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'the panel hears the simulator')
        self.simulator.kill()
        wait_until(lambda: not self.rviz.find_color(PLAY_GREEN), 'the panel is grey without a simulator')
        self.status.forget()
        self.simulator.start()
        wait_until(self.status, 'the simulator is back')
        self.press(STEP_BLUE)
        self.wait_for_status(lambda s: s.steps == 1, 'a step of the new simulator after a press on step')


class TwoPanelsTest(unittest.TestCase):
    """Two simulators, each with a panel of its own in one RViz."""

    @classmethod
    def setUpClass(cls):
        cls.simulators = {'/sim': Simulator(), '/left/sim': Simulator('__ns:=/left', '_publish_clock:=false',
                                                                      '_paused:=true')}
        cls.status = {node: Last(node + '/status', Status) for node in cls.simulators}
        for node, simulator in cls.simulators.items():
            simulator.start()
            cls.addClassCleanup(simulator.kill)
            wait_until(cls.status[node], '%s says how it is' % node)
        cls.screen = rviz_driver.Screen().__enter__()
        cls.addClassCleanup(cls.screen.__exit__)

        def with_two_panels(layout):
            rviz_driver.look_from(layout, VIEW)
            layout['Panels'] = [{'Class': 'rigid_body_sim/SimulationPanel', 'Name': name, 'Node': node}
                                for name, node in (('Simulation', 'sim'), ('Left', '/left/sim'))]

        cls.rviz = rviz_driver.Rviz(cls.screen, LAYOUT, with_two_panels)
        cls.rviz.__enter__()
        cls.addClassCleanup(cls.rviz.__exit__)

    def winds(self):
        return {node: status().wind for node, status in self.status.items()}

    def test_key_1_goes_to_one_of_two_panels(self):
        wait_until(lambda: self.rviz.find_color(PLAY_GREEN), 'a panel hears its simulator')
        before = self.winds()
        self.rviz.key('1')
        wait_until(lambda: self.winds() != before, 'a simulator has switched its wind')
        self.assertEqual(sorted(self.winds().values()), [False, True])
        self.rviz.key('1')
        wait_until(lambda: self.winds() == before, 'it has switched it back')


if __name__ == '__main__':
    rospy.init_node('gui_test')
    rostest.rosrun('rigid_body_sim', 'gui', 'gui_test')
