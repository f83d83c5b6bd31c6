#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The marker array: who gets what, and when."""
import math
import subprocess
import sys
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from rigid_body_sim.msg import BodySpec
from rigid_body_sim.srv import MoveBody, NamedBody, ResizeBody, SetBody, SpawnBodies
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

SECOND_VIEWER = "--second-viewer"
PATIENCE = 20.0  # s of wall time before a wait counts as failed


def call(service, service_type, /, **request):
    rospy.wait_for_service(service, PATIENCE)
    answer = rospy.ServiceProxy(service, service_type)(**request)
    assert answer.success, "%s: %s" % (service, answer.message)
    return answer


def pose_at(x, y, z):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))


def wait(condition, what):
    deadline = time.time() + PATIENCE
    while time.time() < deadline:
        if condition():
            return
        time.sleep(0.02)
    raise AssertionError("waited in vain until " + what)


def wait_for_quiet(picture):
    """Until nothing has come for a while: longer than any period at which markers are sent."""
    seen = []

    def is_quiet():
        time.sleep(0.4)
        seen.append(len(picture.messages))
        return len(seen) > 1 and seen[-1] == seen[-2]
    wait(is_quiet, "no more markers come")


def key(marker):
    return marker.ns, marker.id


class Picture:
    """What an RViz that subscribes now has on its screen."""

    def __init__(self, node):
        self.messages = []
        self.shown = {}
        self.subscriber = rospy.Subscriber(node + "/visualization_marker_array", MarkerArray, self.receive)

    def receive(self, message):
        for marker in message.markers:
            if marker.action == Marker.ADD:
                self.shown[key(marker)] = marker
            else:
                self.shown.pop(key(marker), None)
        self.messages.append(message)

    def close(self):
        self.subscriber.unregister()

    def of_type(self, marker_type):
        return [marker for marker in self.shown.values() if marker.type == marker_type]

    def in_frame(self, frame):
        return [marker for marker in self.shown.values() if marker.header.frame_id == frame]

    def news_of(self, action):
        """What `action` changes: the markers of the messages that come after it."""
        wait_for_quiet(self)
        count = len(self.messages)
        action()
        wait(lambda: len(self.messages) > count, "there is news")
        wait_for_quiet(self)
        return [marker for message in self.messages[count:] for marker in message.markers]


class MarkersTest(unittest.TestCase):
    def setUp(self):
        self.pictures = []
        for node in ("/sim", "/sim_without_tf"):
            call(node + "/pause", Trigger)
            call(node + "/clear", Trigger)
            call(node + "/spawn_bodies", SpawnBodies, bodies=[
                BodySpec(name="floor", shape="plane", is_static=True),
                BodySpec(name="ledge", shape="box", size=Vector3(1, 2, 3), pose=pose_at(5, 0, 5), is_static=True),
                BodySpec(name="crate", shape="box", size=Vector3(2, 1, 1), pose=pose_at(0, 0, 5)),
                BodySpec(name="ball", shape="sphere", size=Vector3(1, 1, 1), pose=pose_at(3, 0, 5))])

    def tearDown(self):
        for picture in self.pictures:
            for message in picture.messages:
                self.check(message)
            picture.close()

    def check(self, message):
        """What holds for every message."""
        self.assertEqual(len({key(marker) for marker in message.markers}), len(message.markers))
        for marker in message.markers:
            self.assertIn(marker.action, (Marker.ADD, Marker.DELETE))
            self.assertTrue(marker.header.stamp.is_zero())
            self.assertEqual(len(marker.points) % 3, 0)
            numbers = [marker.pose.position.x, marker.pose.position.y, marker.pose.position.z,
                       marker.scale.x, marker.scale.y, marker.scale.z, marker.color.r, marker.color.a]
            for point in marker.points:
                numbers += [point.x, point.y, point.z]
            self.assertTrue(all(math.isfinite(number) for number in numbers))

    def open(self, node="/sim"):
        picture = Picture(node)
        self.pictures.append(picture)
        wait(lambda: picture.shown, "the picture has begun")
        wait_for_quiet(picture)
        return picture

    # --- shapes

    def test_spheres_are_sampled_on_their_radius(self):
        halves = self.open().in_frame("ball")
        self.assertEqual({marker.ns for marker in halves}, {"/sim/bodies", "/sim/bodies_dark"})
        self.assertNotEqual(halves[0].color, halves[1].color)
        points = [point for marker in halves for point in marker.points]
        # 10 rows of 20 quads, of which the two at the poles are triangles
        self.assertEqual(len(points), 3 * (2 * 20 * 10 - 2 * 20))
        for p in points:
            self.assertAlmostEqual(math.sqrt(p.x ** 2 + p.y ** 2 + p.z ** 2), 0.5)
        self.assertAlmostEqual(max(p.z for p in points), 0.5)
        self.assertAlmostEqual(min(p.x for p in points), -0.5)
        self.assertEqual(len({(round(p.x, 6), round(p.y, 6), round(p.z, 6)) for p in points}), 20 * 9 + 2)

    def test_boxes_are_twelve_triangles_that_face_outward(self):
        [crate] = self.open().in_frame("crate")
        self.assertEqual(len(crate.points), 36)
        for p in crate.points:
            self.assertAlmostEqual(abs(p.x), 1.0)
            self.assertAlmostEqual(abs(p.y), 0.5)
            self.assertAlmostEqual(abs(p.z), 0.5)
        self.assertEqual(len({(p.x, p.y, p.z) for p in crate.points}), 8)
        # The divergence theorem: a closed surface that faces outward holds V = sum of a . (b x c) / 6.
        self.assertAlmostEqual(self.enclosed([crate]), 2.0)

    def test_spheres_face_outward(self):
        ball = 4.0 / 3.0 * math.pi * 0.5 ** 3
        volume = self.enclosed(self.open().in_frame("ball"))
        self.assertLess(volume, ball)
        self.assertGreater(volume, 0.9 * ball)

    @staticmethod
    def enclosed(markers):
        total = 0.0
        for marker in markers:
            for a, b, c in zip(*[iter(marker.points)] * 3):
                total += (a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
                          a.z * (b.x * c.y - b.y * c.x)) / 6.0
        return total

    def test_other_shapes_hold_their_volume(self):
        corner = [Point(0, 0, 0), Point(3, 0, 0), Point(0, 2, 0), Point(0, 0, 1)]
        call("/sim/spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="capsule", shape="capsule", size=Vector3(1, 1, 3), pose=pose_at(0, 5, 5)),
            BodySpec(name="can", shape="cylinder", size=Vector3(1, 1, 3), pose=pose_at(3, 5, 5)),
            BodySpec(name="cone", shape="cone", size=Vector3(1, 1, 3), pose=pose_at(6, 5, 5)),
            BodySpec(name="hull", shape="hull", points=corner, pose=pose_at(9, 5, 5))])
        picture = self.open()
        for name, volume, least in (("capsule", math.pi * (0.5 + 1.0 / 6.0), 0.98), ("can", math.pi * 0.75, 0.99),
                                    ("cone", math.pi * 0.25, 0.99), ("hull", 1.0, 1.0 - 1e-12)):
            markers = picture.in_frame(name)
            self.assertEqual(len(markers), 1 if name == "hull" else 2, name)
            enclosed = self.enclosed(markers)
            self.assertGreater(enclosed, least * volume, name)
            self.assertLess(enclosed, (1.0 + 1e-12) * volume, name)
        call("/sim/resize_body", ResizeBody, name="hull", factor=2.0)
        wait(lambda: abs(self.enclosed(picture.in_frame("hull")) - 8.0) < 1e-9, "the hull has grown")

    def test_planes_are_flat_tiles_in_two_tones(self):
        picture = self.open()
        floor = [marker for marker in picture.in_frame("world") if len(marker.points) > 36]
        self.assertEqual(len(floor), 2)
        self.assertEqual(sum(len(marker.points) for marker in floor), 16 * 16 * 6)
        self.assertTrue(all(p.z == 0.0 for marker in floor for p in marker.points))

    # --- frames

    def test_what_tf_follows_is_locked_to_its_frame(self):
        picture = self.open()
        for name in ("crate", "ball"):
            for marker in picture.in_frame(name):
                self.assertTrue(marker.frame_locked)
                self.assertEqual(marker.pose, pose_at(0, 0, 0))
        for marker in picture.in_frame("world"):
            self.assertFalse(marker.frame_locked)

    def test_without_tf_primitives_stand_in_the_world(self):
        picture = self.open("/sim_without_tf")
        self.assertEqual(len(picture.in_frame("world")), len(picture.shown))
        [crate] = picture.of_type(Marker.CUBE)
        self.assertEqual((crate.scale.x, crate.scale.y, crate.scale.z), (2, 1, 1))
        [ball] = picture.of_type(Marker.SPHERE)
        self.assertEqual((ball.scale.x, ball.pose.position.x), (1, 3))

    # --- who gets what

    def test_every_new_subscriber_gets_all_once(self):
        first = self.open()
        self.assertEqual(len(first.shown), 2 + 1 + 1 + 2)
        heard = sum(len(message.markers) for message in first.messages)  # of the scene before this test, too
        count = subprocess.check_output([sys.executable, __file__, SECOND_VIEWER], text=True, timeout=60)
        self.assertEqual(int(count), 6)
        wait_for_quiet(first)
        self.assertEqual(sum(len(message.markers) for message in first.messages), heard)

    def test_the_first_subscriber_gets_all_and_nothing_empty(self):
        count = subprocess.check_output([sys.executable, __file__, SECOND_VIEWER], text=True, timeout=60)
        self.assertEqual(int(count), 6)
        first = self.open()
        self.assertEqual(len(first.messages[0].markers), 6)

    def test_only_what_moved_is_sent(self):
        picture = self.open("/sim_without_tf")
        [ball] = picture.of_type(Marker.SPHERE)
        news = picture.news_of(lambda: call("/sim_without_tf/move_body", MoveBody, name="ball",
                                            pose=pose_at(3, 1, 5)))
        self.assertEqual([key(marker) for marker in news], [key(ball)])
        self.assertEqual(news[0].pose.position.y, 1.0)

    def test_what_tf_moves_is_not_sent_again(self):
        picture = self.open()
        [crate] = picture.in_frame("crate")
        call("/sim/move_body", MoveBody, name="ball", pose=pose_at(3, 1, 5))
        news = picture.news_of(lambda: call("/sim/move_body", MoveBody, name="ledge", pose=pose_at(5, 1, 5)))
        self.assertEqual([marker.pose.position.y for marker in news], [1.0])
        self.assertEqual(picture.in_frame("crate"), [crate])

    def test_only_what_changed_its_look_is_sent(self):
        picture = self.open()
        [crate] = picture.in_frame("crate")
        news = picture.news_of(lambda: call("/sim/resize_body", ResizeBody, name="crate", factor=2.0))
        self.assertEqual([key(marker) for marker in news], [key(crate)])
        self.assertAlmostEqual(max(p.x for p in news[0].points), 2.0)

    def test_a_body_that_becomes_static_moves_to_the_world_frame(self):
        picture = self.open()
        [crate] = picture.in_frame("crate")
        news = picture.news_of(lambda: call("/sim/set_body", SetBody, name="crate", is_static=[True]))
        self.assertEqual([(key(marker), marker.action) for marker in news],
                         [(key(crate), Marker.DELETE), (key(crate), Marker.ADD)])
        self.assertEqual(news[1].header.frame_id, "world")
        self.assertEqual(news[1].pose.position.z, 5.0)

    def test_what_is_gone_is_deleted_and_nothing_else(self):
        picture = self.open()
        ball = {key(marker) for marker in picture.in_frame("ball")}
        news = picture.news_of(lambda: call("/sim/delete_body", NamedBody, name="ball"))
        self.assertEqual({key(marker) for marker in news}, ball)
        self.assertTrue(all(marker.action == Marker.DELETE for marker in news))
        picture.news_of(lambda: call("/sim/clear", Trigger))
        self.assertEqual(picture.shown, {})

    def test_of_many_moving_bodies_the_first_are_meshes(self):
        call("/sim/spawn_bodies", SpawnBodies, bodies=[
            BodySpec(shape="box", pose=pose_at(i, 9, 5)) for i in range(350)])
        picture = self.open()
        moving = [marker for marker in picture.shown.values() if marker.type != Marker.TRIANGLE_LIST]
        locked = [marker for marker in moving if marker.frame_locked]
        self.assertEqual(len(moving), 352 - 100)
        self.assertEqual(len(locked), 300 - 100)


def count_first_message():
    """A viewer of its own process: prints how many markers the first message has that it gets."""
    rospy.init_node("second_viewer", anonymous=True)
    message = rospy.wait_for_message("/sim/visualization_marker_array", MarkerArray, timeout=PATIENCE)
    print(len(message.markers))


if __name__ == "__main__":
    if SECOND_VIEWER in sys.argv:
        count_first_message()
        sys.exit()
    rospy.init_node("markers_test")
    rostest.rosrun("rigid_body_sim", "markers", MarkersTest)
