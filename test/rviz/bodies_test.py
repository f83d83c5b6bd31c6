#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The Bodies display in a real RViz: what it draws, what a mouse takes, and messages that cannot be drawn.

Nothing here is timed: every check waits, for up to a minute, until what it expects is so.
"""
import math
import os
import random
import re
import sys
import tempfile
import threading
import unittest

import rospy
import rosservice
import rostest
import yaml
from geometry_msgs.msg import Point, Pose, TransformStamped, Twist
from rigid_body_sim.msg import BodyDescription, BodyDescriptions, BodyDetails, BodyStates
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger, TriggerResponse
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import InteractiveMarkerFeedback

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')
sys.path.insert(0, os.path.join(ROOT, 'scripts'))
import rviz_driver  # noqa: E402
from rviz_driver import wait_until  # noqa: E402

LAYOUT = os.path.join(ROOT, 'rviz', 'sim.rviz')
CLICKS = 200
VIEW = rviz_driver.View(eye=[6.0, -6.0, 5.0], target=[0.0, 0.0, 0.5])
RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
COLUMNS, ROWS, SIZE = 40, 25, 0.7  # of the field of 1,000 boxes that the mouse picks from


class SendFilePath:
    """A service of RViz, for which Debian has no Python: its messages look the same as these on the wire."""

    _type, _md5sum = 'rviz/SendFilePath', '*'
    _request_class, _response_class = String, Bool


class Fake:
    """Publishes descriptions and states as a simulator would."""

    def __init__(self, name, latch=True):
        self.name = name
        self.descriptions = rospy.Publisher(name + '/body_descriptions', BodyDescriptions, queue_size=10, latch=True)
        self.states = rospy.Publisher(name + '/body_states', BodyStates, queue_size=10, latch=latch)
        self.details = rospy.Publisher(name + '/body_details', BodyDetails, queue_size=10, latch=True)
        self.stamp = 1.0

    def describe(self, version, bodies):
        message = BodyDescriptions(version=version, bodies=bodies)
        message.header.frame_id = 'world'
        self.descriptions.publish(message)

    def move(self, version, places, ids=None):
        self.stamp += 0.01
        message = BodyStates(version=version, ids=ids or range(1, len(places) + 1))
        message.header.frame_id = 'world'
        message.header.stamp = rospy.Time.from_sec(self.stamp)
        for place in places:
            pose = Pose()
            pose.position.x, pose.position.y, pose.position.z = place
            pose.orientation.w = 1.0
            message.poses.append(pose)
            message.twists.append(Twist())
        self.states.publish(message)


def body(id, shape, color, size=(1.0, 1.0, 1.0), kind='dynamic', alpha=1.0):
    description = BodyDescription(id=id, name='body_%d' % id, shape=shape, kind=kind)
    description.size.x, description.size.y, description.size.z = size
    description.color.r, description.color.g, description.color.b = color
    description.color.a = alpha
    return description


def hue(pixel):
    """The index of the strongest part of a colour where it stands out, else None."""
    strongest = max(range(3), key=lambda k: pixel[k])
    return strongest if pixel[strongest] > 1.6 * sorted(pixel)[1] else None


class BodiesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fake = Fake('/sim')
        cls.mouse, cls.dragged, cls.lock = [], [], threading.Lock()
        rospy.Subscriber('/sim/interactive_bodies/mouse', InteractiveMarkerFeedback, cls.hear, queue_size=1000)
        cls.screen = rviz_driver.Screen().__enter__()
        cls.addClassCleanup(cls.screen.__exit__)

    @classmethod
    def hear(cls, feedback):
        with cls.lock:
            if feedback.event_type == InteractiveMarkerFeedback.MOUSE_DOWN:
                cls.mouse.append(feedback.marker_name)
            if feedback.event_type == InteractiveMarkerFeedback.POSE_UPDATE:
                cls.dragged.append(feedback.pose.position)

    def clicked(self):
        with self.lock:
            return list(self.mouse)

    def open(self, view=VIEW, fixed_frame='world', **properties):
        def change(layout):
            rviz_driver.look_from(layout, view)
            layout['Visualization Manager']['Global Options']['Fixed Frame'] = fixed_frame
            displays = layout['Visualization Manager']['Displays']
            # The panel goes where nothing answers it: a fake has no services.
            for display in displays:
                if display['Class'] == 'rigid_body_sim/Bodies':
                    display.update(properties)
            layout['Visualization Manager']['Displays'] = [
                display for display in displays if 'rigid_body_sim/' in display['Class']]

        return rviz_driver.Rviz(self.screen, LAYOUT, change)

    def pixel(self, rviz, point):
        """The colour at a point of the world that is in sight."""
        x, y = rviz.pixel_of(point)
        picture = self.screen.picture()
        at = 3 * (y * picture.width + x)
        return tuple(picture.rgb[at:at + 3])

    def wait_for_hues(self, rviz, wanted, what):
        """Waits until every point of `wanted` is drawn in the part of the colour that stands beside it."""
        wait_until(lambda: all(hue(self.pixel(rviz, point)) == part for point, part in wanted), what)

    def test_every_shape_is_drawn_in_its_colour(self):
        shapes = ['box', 'sphere', 'capsule', 'cylinder', 'cone', 'hull']
        bodies = [body(k + 1, shape, BLUE, (1.0, 1.0, 1.6)) for k, shape in enumerate(shapes)]
        bodies[1].size.z = 1.0
        bodies[5].size.z = 1.0
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                for z in (-0.5, 0.5):
                    bodies[5].vertices.append(Point(x, y, z))
        bodies.append(body(7, 'plane', RED, (0.0, 0.0, 0.0), 'static'))
        places = [(1.6 * k - 4.0, 0.0, 1.0) for k in range(6)] + [(0.0, 0.0, 0.0)]
        self.fake.describe(1, bodies)
        self.fake.move(1, places)
        with self.open(rviz_driver.View(eye=[0.0, -14.0, 6.0], target=[0.0, 0.0, 0.5]), Shadows=False) as rviz:
            self.wait_for_hues(rviz, [(place, 2) for place in places[:6]] + [((0.0, -3.0, 0.0), 0)],
                               'all shapes stand on a red floor in blue')

    def test_light_and_shadows_stay_with_the_world(self):
        self.fake.describe(90, [body(1, 'plane', (0.6, 0.6, 0.6), kind='static'), body(2, 'box', RED)])
        self.fake.move(90, [(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)])
        overhead = TransformStamped(child_frame_id='overhead')  # upside down, as a body may lie
        overhead.header.frame_id = 'world'
        overhead.transform.translation.z = 3.0
        overhead.transform.rotation.x = 1.0
        static = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        self.addCleanup(static.unregister)
        static.publish([overhead])
        seen = []
        for frame, place in (('world', lambda x, y, z: (x, y, z)), ('overhead', lambda x, y, z: (x, -y, 3.0 - z))):
            view = rviz_driver.View(eye=place(6.0, -6.0, 5.0), target=place(0.0, 0.0, 0.0))
            with self.open(view, frame) as rviz:
                self.wait_for_hues(rviz, [(place(1.0, 1.0, 1.0), 0)], 'the box is drawn')
                rviz.wait_for_rest()
                seen.append([self.pixel(rviz, place(*point)) for point in ((1.0, 1.0, 0.0), (-1.0, -1.0, 0.0))])
        shadow, floor = seen[0]
        self.assertLess(sum(shadow), 0.9 * sum(floor))
        for here, there in zip(*seen):
            self.assertLess(max(abs(a - b) for a, b in zip(here, there)), 8, 'seen in two frames: %s' % (seen,))

    def test_panels_that_are_added_stay_on_the_screen(self):
        def without_saved_docks(layout):
            layout['Window Geometry'] = {'Width': 1280, 'Height': 800, 'X': 0, 'Y': 0}
            layout['Panels'] = [{'Class': 'rviz/Displays', 'Name': 'Displays'}] + [
                {'Class': 'rigid_body_sim/' + name, 'Name': name} for name in ('SimulationPanel', 'BodiesPanel', 'Plots', 'Plots')]

        with rviz_driver.Rviz(self.screen, LAYOUT, without_saved_docks) as rviz:
            window = self.screen.run('xwininfo', '-id', str(rviz.window)).decode()
            self.assertLessEqual(int(re.search(r'Height: (\d+)', window)[1]), 800, window)

    def test_colours_follow_the_speed(self):
        self.fake.describe(2, [body(1, 'sphere', RED), body(2, 'sphere', RED)])
        self.fake.move(2, [(-1.0, -1.0, 0.5), (1.0, 1.0, 0.5)])
        with self.open(**{'Color By': 'Speed'}) as rviz:
            self.wait_for_hues(rviz, [((-1.0, -1.0, 0.5), 2), ((1.0, 1.0, 0.5), 2)], 'what is at rest is blue')

    def test_states_wait_for_their_descriptions(self):
        here, there = (0.0, 0.0, 0.5), (2.0, -1.0, 0.5)
        self.fake.describe(3, [body(1, 'sphere', RED)])
        self.fake.move(3, [here])
        with self.open() as rviz:
            self.wait_for_hues(rviz, [(here, 0)], 'the ball is red')
            self.fake.move(4, [there])
            rviz.wait_for_rest()
            self.assertEqual(hue(self.pixel(rviz, here)), 0)
            self.fake.describe(4, [body(1, 'sphere', GREEN)])
            self.wait_for_hues(rviz, [(there, 1)], 'the ball is green in its new place')

    def test_what_cannot_be_drawn_is_refused(self):
        here = (0.0, 0.0, 0.5)
        self.fake.describe(5, [body(1, 'sphere', RED)])
        self.fake.move(5, [here])
        with self.open() as rviz:
            self.wait_for_hues(rviz, [(here, 0)], 'the ball is red')
            for bad in (math.nan, math.inf, 1e300):
                self.fake.move(5, [(bad, 0.0, 0.0)])
                self.fake.describe(5, [body(1, 'sphere', RED, (bad, 1.0, 1.0))])
            self.fake.describe(5, [body(1, 'pear', RED)])
            self.fake.describe(5, [body(1, 'hull', RED)])
            self.fake.move(5, [here, here], ids=[1])
            self.fake.describe(6, [body(1, 'sphere', GREEN)])
            self.fake.move(6, [here])
            self.wait_for_hues(rviz, [(here, 1)], 'RViz goes on with what can be drawn')

    def test_details_colour_the_bodies_and_are_received_only_for_that(self):
        places = [(-1.0, 0.0, 0.5), (1.0, 0.0, 0.5)]
        self.fake.describe(10, [body(1, 'sphere', BLUE), body(2, 'sphere', BLUE)])
        self.fake.move(10, places)
        newton = BodyDetails(ids=[2, 1], islands=[2, 1])  # in another order than the descriptions
        newton.methods = bytes([BodyDetails.NEWTON, BodyDetails.NONE])
        self.fake.details.publish(newton)
        with self.open() as rviz:
            self.wait_for_hues(rviz, [(place, 2) for place in places], 'the balls have their own colours')
            self.assertEqual(self.fake.details.get_num_connections(), 0)
        with self.open(**{'Color By': 'Solver'}) as rviz:
            self.wait_for_hues(rviz, [(places[0], None), (places[1], 0)], 'one ball has the colour of its method')
            newton.methods = bytes([BodyDetails.NEWTON])  # too few
            self.fake.details.publish(newton)
            newton.methods, newton.islands = bytes([BodyDetails.NEWTON] * 2), [1, 1]
            self.fake.details.publish(newton)
            self.wait_for_hues(rviz, [(place, 0) for place in places], 'what makes no sense is left out')

    def test_a_display_asks_for_states_that_were_sent_before(self):
        here = (0.0, 0.0, 0.5)
        silent = Fake('/silent', latch=False)
        silent.describe(1, [body(1, 'sphere', GREEN)])

        def send(_request):
            wait_until(silent.states.get_num_connections, 'RViz listens to the states')
            silent.move(1, [here])
            return TriggerResponse(success=True)

        service = rospy.Service('/silent/republish', Trigger, send)
        self.addCleanup(service.shutdown)
        with self.open(Topic='/silent/body_states') as rviz:
            self.wait_for_hues(rviz, [(here, 1)], 'the ball is drawn')

    def test_a_simulator_that_starts_again_is_drawn(self):
        here, there = (0.0, 0.0, 0.5), (2.0, -1.0, 0.5)
        self.fake.describe(7, [body(1, 'sphere', RED)])
        self.fake.move(7, [here])
        with self.open() as rviz:
            self.wait_for_hues(rviz, [(here, 0)], 'the ball is red')
            self.fake.stamp = 0.5
            self.fake.describe(1, [body(1, 'sphere', GREEN)])
            self.fake.move(1, [there])
            self.wait_for_hues(rviz, [(there, 1)], 'the new ball is where it says')

    def test_a_topic_that_ros_does_not_take_is_no_crash(self):
        for topic in ('/no topic/../%', '~body_states'):
            with self.open(Topic=topic) as rviz:
                rviz.wait_for_rest()
                rviz.key('s')  # the tool Select asks every display for its node
                scene = rviz.scene
                rviz.sweep((scene.x + 100, scene.y + 100), (scene.x + 200, scene.y + 200))
                rviz.wait_for_rest()
                self.assertIsNone(rviz.process.poll(), topic)

    def test_a_click_takes_the_right_one_of_1000_bodies(self):
        places = [(x - 0.5 * (COLUMNS - 1), y - 0.5 * (ROWS - 1), 0.5 * SIZE) for x in range(COLUMNS) for y in range(ROWS)]
        self.fake.describe(8, [body(k + 1, 'box', GREEN, (SIZE, SIZE, SIZE)) for k in range(len(places))])
        self.fake.move(8, places)
        chosen = random.Random(1)
        for _ in range(4):
            yaw, pitch, distance = chosen.uniform(0, 2 * math.pi), chosen.uniform(0.7, 1.3), chosen.uniform(26.0, 34.0)
            eye = [distance * math.cos(pitch) * math.cos(yaw), distance * math.cos(pitch) * math.sin(yaw),
                   distance * math.sin(pitch)]
            with self.open(rviz_driver.View(eye=eye, target=[0.0, 0.0, 0.0])) as rviz:
                self.wait_for_hues(rviz, [(place[:2] + (SIZE, ), 1) for place in places[500:503]], 'the field is drawn')
                scene, taken = rviz.scene, 0
                while taken < CLICKS // 4:
                    k = chosen.randrange(len(places))
                    pixel = rviz.pixel_of((places[k][0], places[k][1], SIZE))  # its top is never hidden
                    if not rviz_driver.contains(scene, *pixel):
                        continue
                    before = len(self.clicked())
                    rviz.click(pixel)
                    wait_until(lambda: len(self.clicked()) > before, 'a body takes the click')
                    self.assertEqual(self.clicked()[-1], 'body_%d' % (k + 1))
                    taken += 1

    def test_the_body_under_the_mouse_is_brighter_and_shift_drags_it_away(self):
        here = (0.0, 0.0, 0.5)
        self.fake.describe(11, [body(1, 'sphere', RED)])
        self.fake.move(11, [here])
        with self.open() as rviz:
            self.wait_for_hues(rviz, [(here, 0)], 'the ball is red')
            rviz.wait_for_rest()
            plain, (x, y) = self.pixel(rviz, here), rviz.pixel_of(here)
            self.screen.xdotool('mousemove', x - 6, y, 'sleep', 0.3, 'mousemove', x - 5, y)
            wait_until(lambda: sum(self.pixel(rviz, here)) > sum(plain) + 20, 'the ball under the mouse is brighter')
            before = len(self.clicked())
            self.screen.xdotool('mousedown', 1)
            wait_until(lambda: len(self.clicked()) > before, 'the ball takes the mouse')
            self.assertEqual(self.farthest(), None)
            self.screen.xdotool('keydown', 'shift')
            for k in range(1, 9):
                self.screen.xdotool('mousemove', x - 5, y - 8 * k, 'sleep', 0.05)
            wait_until(lambda: self.farthest() and self.farthest() > math.dist(VIEW.eye, here) + 1.0, 'it is dragged away')
            self.screen.xdotool('mouseup', 1, 'keyup', 'shift', 'mousemove', 1, 1)
            self.screen.xdotool('mousemove', rviz.scene.x + 5, rviz.scene.y + 5, 'sleep', 0.3, 'mousemove',
                                rviz.scene.x + 6, rviz.scene.y + 6)
            wait_until(lambda: self.pixel(rviz, here) == plain, 'the mouse is at nothing')

    def farthest(self):
        """How far from the eye a body has been dragged, m."""
        with self.lock:
            return max((math.dist(VIEW.eye, (p.x, p.y, p.z)) for p in self.dragged), default=None)

    def test_the_display_can_be_taken_away_and_added_again(self):
        here = (0.0, 0.0, 0.5)
        self.fake.describe(9, [body(1, 'sphere', RED)])
        self.fake.move(9, [here])
        with self.open() as rviz:
            self.wait_for_hues(rviz, [(here, 0)], 'the ball is red')
            with open(rviz.file) as file:
                layout = yaml.safe_load(file)
            displays = layout['Visualization Manager']['Displays']
            layout['Visualization Manager']['Displays'] = [d for d in displays if d['Class'] != 'rigid_body_sim/Bodies']
            self.load(layout)
            wait_until(lambda: hue(self.pixel(rviz, here)) is None, 'the ball is gone')
            layout['Visualization Manager']['Displays'] = displays
            self.load(layout)
            self.wait_for_hues(rviz, [(here, 0)], 'the ball is red again')

    def load(self, layout):
        """Has RViz load another layout."""
        with tempfile.NamedTemporaryFile('w', suffix='.rviz') as file:
            yaml.safe_dump(layout, file)
            file.flush()
            service = wait_until(self.loader, 'RViz loads layouts')
            rospy.ServiceProxy(service, SendFilePath)(String(file.name))

    @staticmethod
    def loader():
        """The newest service that loads a layout: RViz has another name each time."""
        for service in rosservice.get_service_list():
            if service.endswith('/load_config') and rosservice.get_service_node(service):
                try:
                    rospy.wait_for_service(service, 1.0)
                    return service
                except rospy.ROSException:
                    pass
        return None


if __name__ == '__main__':
    rospy.init_node('bodies_test')
    rostest.rosrun('rigid_body_sim', 'bodies', BodiesTest)
