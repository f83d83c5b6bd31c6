#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Interactive bodies, driven by the messages that RViz sends for a mouse."""
import math
import time
import unittest

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from rigid_body_sim.msg import BodyChange, BodyNames, BodySpec, Status
from rigid_body_sim.srv import EditBodies, GetBody, ListBodies, LoadScene, NamedBody, ResizeBody, SetBody, SetGravity, SpawnBodies
from std_msgs.msg import String
from std_srvs.srv import Trigger
from visualization_msgs.msg import InteractiveMarkerFeedback as Feedback
from visualization_msgs.msg import Marker, InteractiveMarkerInit, InteractiveMarkerUpdate

GIZMO = "selection.gizmo"
FACES = ["selection." + face for face in ("+x", "-x", "+y", "-y", "+z", "-z")]
SMALL = roslib.packages.get_pkg_dir("rigid_body_sim") + "/test/node/small.yaml"
PATIENCE = 20.0  # s of wall time before a wait counts as failed


def call(service, service_type, /, **request):
    rospy.wait_for_service("/sim/" + service, PATIENCE)
    answer = rospy.ServiceProxy("/sim/" + service, service_type)(**request)
    assert answer.success, "%s: %s" % (service, answer.message)
    return answer


def body(name):
    return call("get_body", GetBody, name=name).body


def position(name):
    p = body(name).pose.position
    return [p.x, p.y, p.z]


def turned_by(angle):
    """The place of the crate, turned about z."""
    return Pose(Point(0, 0, 5), Quaternion(0, 0, math.sin(angle / 2), math.cos(angle / 2)))


def pose_at(x, y, z):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))


def dot(a, b):
    return sum(u * v for u, v in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def distance(a, b):
    return sum((u - v) ** 2 for u, v in zip(a, b)) ** 0.5


def wait(condition, what):
    deadline = time.time() + PATIENCE
    while time.time() < deadline:
        if condition():
            return
        time.sleep(0.02)
    raise AssertionError("waited in vain until " + what)


class Client:
    """What an RViz knows of the server, and its mouse."""

    def __init__(self, name, server="/sim/interactive_bodies"):
        self.name = name
        self.markers = {}
        self.subscriber = rospy.Subscriber(server + "/update_full", InteractiveMarkerInit, self.receive)
        self.publisher = rospy.Publisher(server + "/feedback", Feedback, queue_size=100)
        wait(lambda: self.publisher.get_num_connections() > 0, "the server listens")

    def receive(self, message):
        self.markers = {marker.name: marker for marker in message.markers}

    def close(self):
        self.subscriber.unregister()

    def wait_for(self, *names):
        wait(lambda: all(name in self.markers for name in names), "%s are shown" % (names,))

    def wait_without(self, *names):
        wait(lambda: not any(name in self.markers for name in names), "%s are gone" % (names,))

    def titles(self, name):
        return {entry.title: entry.id for entry in self.markers[name].menu_entries}

    def send(self, event, marker, pose, hit=None, entry=0):
        feedback = Feedback(client_id=self.name, marker_name=marker, event_type=event, pose=pose,
                            menu_entry_id=entry)
        feedback.header.frame_id = "world"
        if hit is not None:
            feedback.mouse_point_valid = True
            feedback.mouse_point = Point(*hit)
        self.publisher.publish(feedback)

    def press(self, marker, pose=None, hit=None):
        self.send(Feedback.MOUSE_DOWN, marker, pose or self.markers[marker].pose, hit)

    def move(self, marker, pose):
        self.send(Feedback.POSE_UPDATE, marker, pose)

    def hold_still(self, marker, pose):
        self.send(Feedback.KEEP_ALIVE, marker, pose)

    def release(self, marker, pose):
        # RViz sends what is left of the motion after the button is up.
        self.send(Feedback.MOUSE_UP, marker, pose)
        self.send(Feedback.POSE_UPDATE, marker, pose)

    def click(self, name):
        pose = body(name).pose
        self.press(name, pose, [pose.position.x, pose.position.y, pose.position.z])
        self.release(name, pose)
        self.wait_for(GIZMO)

    def choose(self, name, title, hit=None):
        pose = body(name).pose
        self.send(Feedback.MENU_SELECT, name, pose, hit, self.titles(name)[title])


class Mouse(Client):
    """What the Interact tool of this package sends: of bodies by name, with no need for a marker."""

    def __init__(self, name):
        self.name = name
        self.markers = {}
        self.answers = []
        self.subscriber = rospy.Subscriber("/sim/interactive_bodies/answer", String,
                                           lambda answer: self.answers.append(answer.data))
        self.publisher = rospy.Publisher("/sim/interactive_bodies/mouse", Feedback, queue_size=100)
        wait(lambda: self.publisher.get_num_connections() > 0 and self.subscriber.get_num_connections() > 0,
             "the simulator listens")

    def close(self):
        self.subscriber.unregister()
        self.publisher.unregister()

    def wait_for_answer(self, *words):
        wait(lambda: any(all(word in answer for word in words) for answer in list(self.answers)),
             "an answer with %s" % (words,))


class Selection:
    """The name that ~selection told last."""

    def __init__(self):
        self.name = None
        self.subscriber = rospy.Subscriber("/sim/selection", String, self.keep)

    def keep(self, name):
        self.name = name.data

    def wait_for(self, name):
        wait(lambda: self.name == name, "'%s' is selected" % name)


class SelectedBodies:
    """The names that ~selected_bodies told last."""

    def __init__(self):
        self.names = None
        self.subscriber = rospy.Subscriber("/sim/selected_bodies", BodyNames, self.keep)

    def keep(self, message):
        self.names = message.names

    def wait_for(self, *names):
        wait(lambda: self.names == list(names), "these are selected: %s" % list(names))


class InteractiveBodiesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.select = rospy.Publisher("/sim/select", String, queue_size=1)
        wait(lambda: cls.select.get_num_connections() > 0, "the node can be told to select")

    def setUp(self):
        """A box of 1 m and a ball of 1 m that float at rest, 4 m apart; paused."""
        call("pause", Trigger)
        call("clear", Trigger)
        call("set_gravity", SetGravity, gravity=Vector3(0, 0, 0))
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="crate", shape="box", size=Vector3(1, 1, 1), pose=pose_at(0, 0, 5)),
            BodySpec(name="ball", shape="sphere", size=Vector3(1, 1, 1), pose=pose_at(4, 0, 5))])
        self.client = Client("rviz")
        self.client.wait_for("crate", "ball")
        self.client.wait_without(GIZMO, *FACES)  # of the test before

    def drop_selection(self):
        """For tests that replace the world: a selection goes on by its name, to the bodies of the next test."""
        self.select.publish("")
        self.client.wait_without(GIZMO)

    def tearDown(self):
        self.client.close()

    # --- picking

    def test_0_the_first_undo_of_a_node_keeps_the_selection(self):
        """By its name it comes before the other tests: their undos are not the first one."""
        selected = SelectedBodies()
        self.select.publish("crate")
        selected.wait_for("crate")
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="other", shape="box", size=Vector3(1, 1, 1), pose=pose_at(8, 0, 5))])
        call("undo", Trigger)
        self.client.wait_for(GIZMO)
        time.sleep(0.5)
        selected.wait_for("crate")

    def test_every_body_is_a_light_target_of_its_size(self):
        self.assertEqual(set(self.client.markers), {"crate", "ball"})
        for name in ("crate", "ball"):
            marker = self.client.markers[name]
            self.assertEqual(marker.header.frame_id, "world")
            self.assertTrue(marker.header.stamp.is_zero(), "stamped markers need tf and answer in any frame")
            [control] = marker.controls
            [shape] = control.markers
            self.assertLessEqual(len(shape.points), 60, "each target is sent many times")
            self.assertGreater(shape.color.a, 0.0, "RViz logs a complaint for each invisible marker")
            self.assertLess(shape.color.a, 0.05)
        # Every face is outside the drawn body, or the mouse would meet that first.
        [[cube]] = [control.markers for control in self.client.markers["crate"].controls]
        for extent in (cube.scale.x, cube.scale.y, cube.scale.z):
            self.assertGreater(extent, 1.0)
            self.assertLess(extent, 1.1)
        [[ball]] = [control.markers for control in self.client.markers["ball"].controls]
        self.assertEqual(len(ball.points), 60)
        for a, b, c in zip(*[iter(ball.points)] * 3):
            middle = [(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3]
            self.assertAlmostEqual(distance(middle, [0, 0, 0]), 1.02 * 0.5)

    def test_other_shapes_have_light_targets_around_them(self):
        corner = [Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(0, 0, 1)]
        many = [Point(x, y, z) for x in range(-3, 4) for y in range(-3, 4) for z in range(-3, 4)
                if 2 <= x * x + y * y + z * z <= 14]
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="capsule", shape="capsule", size=Vector3(1, 1, 3), pose=pose_at(0, 4, 5)),
            BodySpec(name="can", shape="cylinder", size=Vector3(1, 1, 3), pose=pose_at(4, 4, 5)),
            BodySpec(name="cone", shape="cone", size=Vector3(1, 1, 3), pose=pose_at(8, 4, 5)),
            BodySpec(name="hull", shape="hull", points=corner, pose=pose_at(12, 4, 5)),
            BodySpec(name="ball_of_points", shape="hull", points=many, pose=pose_at(16, 4, 5))])
        names = ["capsule", "can", "cone", "hull", "ball_of_points"]
        self.client.wait_for(*names)
        for name in names:
            [[target]] = [control.markers for control in self.client.markers[name].controls]
            self.assertLessEqual(len(target.points), 3 * 64, name)
            triangles = [[(p.x, p.y, p.z) for p in corners] for corners in zip(*[iter(target.points)] * 3)]
            volume = sum(dot(a, cross(b, c)) for a, b, c in triangles) / 6 * target.scale.x ** 3
            description = body(name).description
            self.assertGreater(volume, description.mass / 1000, name)
            self.assertLess(volume, (2.5 if name == "ball_of_points" else 1.4) * description.mass / 1000, name)
            # What is deepest inside of the body is behind all faces: they look outward.
            for a, b, c in triangles:
                self.assertGreater(dot(a, cross(b, c)), 0.0, name)

    def test_a_click_selects_and_changes_nothing(self):
        before = body("crate")
        self.client.click("crate")
        self.assertEqual(body("crate").pose, before.pose)
        gizmo = self.client.markers[GIZMO]
        self.assertEqual(sorted(control.name for control in gizmo.controls),
                         ["move_x", "move_y", "move_z", "turn_x", "turn_y", "turn_z"])
        self.assertAlmostEqual(gizmo.pose.position.x, 0.0)
        self.client.click("ball")
        wait(lambda: abs(self.client.markers[GIZMO].pose.position.x - 4.0) < 1e-6, "the gizmo is at the ball")

    def test_a_click_that_rounds_the_pose_moves_nothing_and_a_small_drag_does(self):
        for offset in (1e-7, 4e-4, 2e-3):
            pose = pose_at(offset, 0, 5 - offset)
            self.client.press("crate", pose_at(0, 0, 5), (0, 0, 5))
            self.client.move("crate", pose)
            self.client.release("crate", pose)
        self.client.wait_for(GIZMO)
        self.assertEqual(position("crate"), [0, 0, 5])
        self.client.press("crate", pose_at(0, 0, 5), (0, 0, 5))
        self.client.move("crate", pose_at(0.02, 0, 5))
        wait(lambda: distance(position("crate"), [0.02, 0, 5]) < 1e-9, "the crate is where the drag is")
        self.client.move("crate", pose_at(0.001, 0, 5))
        wait(lambda: distance(position("crate"), [0.001, 0, 5]) < 1e-9, "a drag may come back to where it began")
        self.client.release("crate", pose_at(0.001, 0, 5))

    def test_a_name_selects(self):
        publisher = rospy.Publisher("/sim/select", String, queue_size=1, latch=True)
        publisher.publish("ball")
        self.client.wait_for(GIZMO)
        self.assertAlmostEqual(self.client.markers[GIZMO].pose.position.x, 4.0)
        publisher.publish("")
        self.client.wait_without(GIZMO)
        publisher.unregister()

    def test_a_client_opened_while_paused_sees_and_drags(self):
        self.client.close()
        self.client = Client("late_rviz")
        self.client.wait_for("crate", "ball")
        time.sleep(1.1)  # for so long the server keeps a marker for the client that used it last
        self.client.press("crate", hit=[0, 0, 5])
        self.client.move("crate", pose_at(0, 1, 5))
        wait(lambda: distance(position("crate"), [0, 1, 5]) < 1e-9, "the late client has moved the crate")
        self.client.release("crate", pose_at(0, 1, 5))
        time.sleep(1.1)

    def test_of_many_bodies_the_nearest_to_the_click_are_targets(self):
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="n%d" % i, shape="sphere", size=Vector3(0.1, 0.1, 0.1), pose=pose_at(i, 9, 5))
            for i in range(400)])
        wait(lambda: len(self.client.markers) == 300, "300 targets are left")
        publisher = rospy.Publisher("/sim/select", String, queue_size=1, latch=True)
        publisher.publish("n399")
        self.client.wait_for("n399", "n398", GIZMO)
        self.client.wait_without("crate")
        self.assertEqual(len(self.client.markers), 301)
        publisher.unregister()

    # --- the mouse of our own tool, which needs no markers

    def test_the_mouse_takes_a_body_without_a_marker(self):
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="n%d" % i, shape="sphere", size=Vector3(0.1, 0.1, 0.1), pose=pose_at(i, 9, 5))
            for i in range(400)])
        wait(lambda: len(self.client.markers) == 300, "300 targets are left")
        self.assertNotIn("n399", self.client.markers)
        mouse, selection = Mouse("mouse"), Selection()
        self.addCleanup(mouse.close)
        mouse.press("n399", pose_at(399, 9, 5), hit=[399, 9, 5.05])
        selection.wait_for("n399")
        mouse.wait_for_answer("n399", "sphere", "kg")
        mouse.move("n399", pose_at(399, 9, 6))
        wait(lambda: distance(position("n399"), [399, 9, 6]) < 1e-9, "the body is where the mouse is")
        mouse.release("n399", pose_at(399, 9, 7))
        wait(lambda: distance(position("n399"), [399, 9, 7]) < 1e-9, "the last move counts")
        self.client.wait_for("n399", GIZMO)
        wait(lambda: abs(self.client.markers["n399"].pose.position.z - 7) < 1e-6, "its target has followed")

    def mouse_that_pulls_the_crate(self):
        mouse = Mouse("mouse")
        self.addCleanup(mouse.close)
        call("resume", Trigger)
        mouse.press("crate", pose_at(0, 0, 5), hit=[0.0, -0.5, 5])
        mouse.move("crate", pose_at(3, 0, 5))
        wait(lambda: body("crate").twist.linear.x > 1.0, "the crate follows")
        return mouse

    def test_the_mouse_throws_a_body_of_a_running_world(self):
        mouse = self.mouse_that_pulls_the_crate()
        mouse.release("crate", pose_at(3, 0, 5))
        call("pause", Trigger)
        self.assertGreater(body("crate").twist.linear.x, 0.5)

    def test_a_drag_goes_on_when_somebody_renames_the_body(self):
        mouse = self.mouse_that_pulls_the_crate()
        call("edit_bodies", EditBodies, changes=[BodyChange(name="crate", new_name="chest")])
        mouse.move("crate", pose_at(3, 0, 9))
        wait(lambda: position("chest")[2] > 7.0, "it follows still")
        mouse.release("crate", pose_at(3, 0, 9))
        call("pause", Trigger)

    def test_the_mouse_opens_the_menu_of_a_body_without_a_marker(self):
        mouse, selection = Mouse("mouse"), Selection()
        self.addCleanup(mouse.close)
        mouse.send(Feedback.MENU_SELECT, "ball", pose_at(4, 0, 5), entry=self.client.titles("ball")["Delete"])
        mouse.wait_for_answer("ball", "deleted")
        self.assertNotIn("ball", call("list_bodies", ListBodies).names)
        selection.wait_for("")

    def test_the_menu_is_for_all_selected_bodies_where_its_own_is_one_of_them(self):
        publisher, selected = rospy.Publisher("/sim/select_bodies", BodyNames, queue_size=1, latch=True), SelectedBodies()
        self.addCleanup(publisher.unregister)
        publisher.publish(names=["crate", "ball"])
        wait(lambda: "Make 2 bodies static" in self.client.titles("crate"), "the menu says how many")
        self.assertIn("Push this body", self.client.titles("ball"))
        self.client.choose("crate", "Make 2 bodies static")
        wait(lambda: body("ball").description.kind == body("crate").description.kind == "static", "both are static")
        call("undo", Trigger)  # of both
        self.assertEqual([body("ball").description.kind, body("crate").description.kind], ["dynamic", "dynamic"])
        wait(lambda: "Push this body" in self.client.titles("crate"), "it can be pushed again")
        self.client.choose("crate", "Push this body", position("crate"))
        wait(lambda: body("crate").twist.linear.z > 0.0, "it is pushed")
        self.assertEqual(body("ball").twist.linear.z, 0.0)
        before = set(call("list_bodies", ListBodies).names)
        self.client.choose("crate", "Duplicate 2 bodies")
        wait(lambda: len(call("list_bodies", ListBodies).names) == len(before) + 2, "there is a copy of each")
        publisher.publish(names=["ball"])
        selected.wait_for("ball")
        wait(lambda: "Delete" in self.client.titles("crate"), "it is for one again")
        self.client.choose("crate", "Delete")
        self.client.wait_without("crate")
        self.assertIn("ball", call("list_bodies", ListBodies).names)

    def test_an_entry_of_the_menu_is_for_the_bodies_that_its_title_meant(self):
        publisher, selected, mouse = rospy.Publisher("/sim/select_bodies", BodyNames, queue_size=1, latch=True), SelectedBodies(), Mouse("mouse")
        self.addCleanup(publisher.unregister)
        self.addCleanup(mouse.close)
        call("spawn_bodies", SpawnBodies, bodies=[BodySpec(name="third", shape="sphere", size=Vector3(1, 1, 1), pose=pose_at(8, 0, 5))])
        alone = self.client.titles("crate")["Delete"]
        publisher.publish(names=["crate", "ball"])
        wait(lambda: "Delete 2 bodies" in self.client.titles("crate"), "the menu says how many")
        both = self.client.titles("crate")["Delete 2 bodies"]
        publisher.publish(names=["crate", "third"])
        selected.wait_for("crate", "third")
        mouse.send(Feedback.MENU_SELECT, "crate", pose_at(0, 0, 5), entry=both)
        mouse.wait_for_answer("selection has changed", "nothing is done")
        self.assertEqual(call("list_bodies", ListBodies).names, ["crate", "ball", "third"])
        selected.wait_for("crate", "third")
        publisher.publish(names=["ball", "crate"])  # the same two
        selected.wait_for("ball", "crate")
        mouse.send(Feedback.MENU_SELECT, "crate", pose_at(0, 0, 5), entry=both)
        wait(lambda: call("list_bodies", ListBodies).names == ["third"], "both are deleted")
        call("undo", Trigger)
        publisher.publish(names=["crate", "ball", "third"])
        selected.wait_for("crate", "ball", "third")
        mouse.send(Feedback.MENU_SELECT, "crate", pose_at(0, 0, 5), entry=alone)
        wait(lambda: call("list_bodies", ListBodies).names == ["ball", "third"], "the title was of the crate alone")
        mouse.send(Feedback.MENU_SELECT, "crate", pose_at(0, 0, 5), entry=alone)
        mouse.wait_for_answer("crate", "gone")
        self.drop_selection()

    def test_a_mouse_at_a_body_that_is_gone_is_told(self):
        mouse = Mouse("mouse")
        self.addCleanup(mouse.close)
        mouse.press("nobody", pose_at(0, 0, 5))
        mouse.wait_for_answer("nobody", "gone")

    def test_the_selection_is_told(self):
        selection = Selection()
        selection.wait_for("")
        self.client.click("crate")
        selection.wait_for("crate")
        late = Selection()
        late.wait_for("crate")
        call("delete_body", NamedBody, name="crate")
        selection.wait_for("")

    def test_a_pulled_body_has_a_visible_spring(self):
        springs = []
        subscriber = rospy.Subscriber("/sim/interactive_bodies/springs", Marker, springs.append)
        self.addCleanup(subscriber.unregister)
        call("resume", Trigger)
        self.client.press("crate", hit=[0, 0, 5.5])
        self.client.move("crate", pose_at(0, 2, 5))
        wait(lambda: springs and springs[-1].action == Marker.ADD, "the spring is shown")
        end = springs[-1].points[1]
        self.assertLess(distance([end.x, end.y, end.z], [0, 2, 5.5]), 1e-9)
        self.client.release("crate", pose_at(0, 2, 5))
        wait(lambda: springs[-1].action == Marker.DELETE, "the spring is gone")
        call("pause", Trigger)

    def test_many_bodies_are_selected_and_the_last_one_has_the_gizmo(self):
        last, selected = Selection(), SelectedBodies()
        publisher = rospy.Publisher("/sim/select_bodies", BodyNames, queue_size=1, latch=True)
        self.addCleanup(publisher.unregister)
        publisher.publish(names=["crate", "nobody", "ball", "crate"])
        selected.wait_for("crate", "ball")
        last.wait_for("ball")
        self.client.wait_for(GIZMO)
        self.assertAlmostEqual(self.client.markers[GIZMO].pose.position.x, 4.0)
        self.client.click("crate")  # one of those that are selected comes last
        selected.wait_for("ball", "crate")
        last.wait_for("crate")
        call("edit_bodies", EditBodies, changes=[BodyChange(name="ball", new_name="globe")])
        selected.wait_for("globe", "crate")
        call("undo", Trigger)
        selected.wait_for("ball", "crate")
        call("redo", Trigger)
        selected.wait_for("globe", "crate")
        call("delete_body", NamedBody, name="crate")
        selected.wait_for("globe")
        last.wait_for("globe")
        self.client.wait_without("crate")
        call("undo", Trigger)
        self.client.wait_for("crate")
        selected.wait_for("globe")
        self.client.click("crate")  # any other body is selected alone
        selected.wait_for("crate")
        publisher.publish(names=[])
        selected.wait_for()
        last.wait_for("")
        self.client.wait_without(GIZMO)

    def test_a_body_that_two_drag_goes_on_with_the_one_who_still_holds_it(self):
        mouse = Mouse("mouse")
        self.addCleanup(mouse.close)
        call("set_gravity", SetGravity, gravity=Vector3(0, 0, -9.81))
        self.client.press("crate", hit=[0, 0, 5.5])
        mouse.press("crate", pose_at(0, 0, 5), hit=[0, 0, 5.5])
        call("resume", Trigger)
        for _ in range(5):
            self.client.hold_still("crate", pose_at(0, 0, 5))
            mouse.hold_still("crate", pose_at(0, 0, 5))
            time.sleep(0.1)
        self.client.release("crate", pose_at(0, 0, 5))
        before = rospy.wait_for_message("/sim/status", Status).time

        def is_later():
            mouse.hold_still("crate", pose_at(0, 0, 5))
            return rospy.wait_for_message("/sim/status", Status).time > before + 1.0
        wait(is_later, "a second has passed")
        self.assertGreater(position("crate")[2], 4.5)
        mouse.release("crate", pose_at(0, 0, 5))

    # Every scene numbers its bodies from 1 on, so the next one has bodies with the ids of these.

    def wait_for_small(self):
        wait(lambda: abs(self.client.markers["ball"].pose.position.x - 2.0) < 1e-6, "the small scene is shown")

    def test_a_plane_has_no_marker(self):
        call("load_scene", LoadScene, name=SMALL)
        self.wait_for_small()
        self.assertNotIn("floor", self.client.markers)
        call("clear", Trigger)  # the next test has bodies of the same names elsewhere
        self.client.wait_without("crate", "ball")

    def test_the_next_scene_has_nothing_selected(self):
        call("load_scene", LoadScene, name=SMALL)
        self.wait_for_small()
        self.client.choose("crate", "Resize")
        self.client.wait_for(*FACES)
        call("load_scene", LoadScene, name="playground")
        self.client.wait_for("kerb_east")
        self.client.wait_without(GIZMO, *FACES)

    def test_a_drag_ends_with_its_scene(self):
        call("load_scene", LoadScene, name=SMALL)
        self.wait_for_small()
        self.client.click("crate")
        self.client.press(GIZMO)
        self.client.move(GIZMO, pose_at(0, 0, 5))
        wait(lambda: distance(position("crate"), [0, 0, 5]) < 1e-9, "the drag is on")
        same_id = body("crate").description.id
        call("load_scene", LoadScene, name="playground")
        self.client.move(GIZMO, pose_at(0, 0, 9))
        self.client.release(GIZMO, pose_at(0, 0, 9))
        self.client.wait_for("kerb_west")
        self.client.click("kerb_west")  # done after all of that
        self.assertEqual(body("kerb_east").description.id, same_id)
        self.assertEqual(position("kerb_east"), [6.1, 0.0, 0.15])

    def test_a_drag_ends_with_its_world_though_the_next_has_its_name(self):
        for again, request in (("load_scene", {"name": SMALL}), ("reset", {})):
            call("load_scene", LoadScene, name=SMALL)
            self.wait_for_small()
            self.client.click("crate")
            self.client.press("crate", hit=[0, 0, 0.5])
            self.client.move("crate", pose_at(0, 0, 5))
            wait(lambda: distance(position("crate"), [0, 0, 5]) < 1e-9, "the drag is on")
            call(again, LoadScene if request else Trigger, **request)
            wait(lambda: abs(self.client.markers[GIZMO].pose.position.z - 0.25) < 1e-6, "the body is still selected")
            self.client.move("crate", pose_at(0, 0, 9))
            self.client.release("crate", pose_at(0, 0, 9))
            self.client.click("ball")  # done after all of that
            x = body("ball").pose.position.x
            wait(lambda: abs(self.client.markers[GIZMO].pose.position.x - x) < 1e-6, "the ball is selected")
            self.assertLess(distance(position("crate"), [0, 0, 0.25]), 1e-9, again)
        self.drop_selection()

    def test_a_drag_is_one_edit(self):
        self.client.press("crate", hit=[0, 0, 0.5])
        for height in range(6, 9):
            self.client.move("crate", pose_at(0, 0, height))
            wait(lambda: distance(position("crate"), [0, 0, height]) < 1e-9, "the crate follows")
        self.client.release("crate", pose_at(0, 0, 9))
        wait(lambda: distance(position("crate"), [0, 0, 9]) < 1e-9, "the last motion counts")
        self.assertEqual(call("undo", Trigger).message, "undone: dragged 'crate'")
        self.assertLess(distance(position("crate"), [0, 0, 5]), 1e-9)
        call("redo", Trigger)
        self.assertLess(distance(position("crate"), [0, 0, 9]), 1e-9)
        self.drop_selection()

    # --- dragging the body

    def test_paused_drag_puts_the_body_there(self):
        self.client.press("crate", hit=[0.5, 0.2, 5.1])
        self.client.move("crate", pose_at(0, 2, 6))
        wait(lambda: distance(position("crate"), [0, 2, 6]) < 1e-9, "the crate has moved at once")
        self.client.release("crate", pose_at(0, 3, 7))
        wait(lambda: distance(position("crate"), [0, 3, 7]) < 1e-9, "the last motion counts")
        wait(lambda: abs(self.client.markers["crate"].pose.position.y - 3) < 1e-6, "the target is there too")

    def test_paused_drag_stays_outside_of_the_floor_and_of_walls(self):
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="floor", shape="plane", kind="static"),
            BodySpec(name="wall", shape="box", kind="static", size=Vector3(1, 20, 10), pose=pose_at(-5, 0, 5))])
        self.client.wait_for("wall")
        self.client.press("crate", hit=[0.5, 0.2, 5.1])
        self.client.move("crate", pose_at(0, 2, -3))
        wait(lambda: distance(position("crate"), [0, 2, 0.5]) < 1e-6, "the crate lies on the floor")
        self.client.move("crate", pose_at(-4.2, 2, -3))
        wait(lambda: distance(position("crate"), [-4, 2, 0.5]) < 1e-6, "it stands in the corner")
        self.client.move("crate", pose_at(4.2, 0, 5))
        wait(lambda: distance(position("crate"), [4.2, 0, 5]) < 1e-6, "what can be pushed is no obstacle")
        self.client.release("crate", pose_at(0, 3, 7))
        wait(lambda: distance(position("crate"), [0, 3, 7]) < 1e-9, "the last motion counts")

    def test_running_drag_pulls_and_lets_go_with_its_velocity(self):
        call("resume", Trigger)
        self.client.press("crate", hit=[0, 0, 5])
        y = 0.0
        while y < 3.0:  # 3 m at about 2 m/s
            y += 0.04
            self.client.move("crate", pose_at(0, y, 5))
            time.sleep(0.02)
        self.client.release("crate", pose_at(0, y, 5))
        readings = [body("crate")]

        def flies_freely():  # without a force its velocity stays
            time.sleep(0.1)
            readings.append(body("crate"))
            return readings[-1].twist == readings[-2].twist
        wait(flies_freely, "the hand has let go")
        thrown = readings[-1]
        self.assertGreater(thrown.twist.linear.y, 0.5)
        wait(lambda: body("crate").pose.position.y > thrown.pose.position.y + 2.0, "the crate flies on")
        self.assertAlmostEqual(body("crate").twist.linear.y, thrown.twist.linear.y, places=6)

    def test_a_pull_at_a_corner_turns_the_body(self):
        call("resume", Trigger)
        self.client.press("crate", hit=[0.5, 0.5, 5])
        for _ in range(100):
            self.client.move("crate", pose_at(0, 1, 5))
            time.sleep(0.02)
            if abs(body("crate").pose.orientation.z) > 0.05:
                break
        self.assertGreater(body("crate").pose.orientation.z, 0.05)
        self.client.release("crate", pose_at(0, 1, 5))

    def test_a_dragged_marker_is_replaced_only_after_the_drag(self):
        replaced = []

        def note(update):
            replaced.extend(marker.name for marker in update.markers)
        subscriber = rospy.Subscriber("/sim/interactive_bodies/update", InteractiveMarkerUpdate, note)
        wait(lambda: subscriber.get_num_connections() > 0, "updates come in")
        self.client.press("crate", hit=[0, 0, 5])
        self.client.move("crate", pose_at(0, 1, 5))
        wait(lambda: distance(position("crate"), [0, 1, 5]) < 1e-9, "the drag is on")
        del replaced[:]
        for name in ("ball", "crate"):
            call("resize_body", ResizeBody, name=name, factor=2.0)
        wait(lambda: "ball" in replaced, "the target of the ball has grown")
        self.client.hold_still("crate", pose_at(0, 1, 5))
        self.assertNotIn("crate", replaced)
        self.client.release("crate", pose_at(0, 1, 5))
        wait(lambda: "crate" in replaced, "the target of the crate has grown")
        subscriber.unregister()

    def test_a_static_body_is_put_even_while_running(self):
        call("set_body", SetBody, name="crate", is_static=[True])
        call("resume", Trigger)
        self.client.press("crate", hit=[0, 0, 5])
        self.client.move("crate", pose_at(0, 2, 5))
        wait(lambda: distance(position("crate"), [0, 2, 5]) < 1e-9, "the static crate has moved")
        self.client.release("crate", pose_at(0, 2, 5))

    # --- dragging the gizmo

    def test_paused_gizmo_puts_the_body_there(self):
        self.client.click("crate")
        self.client.press(GIZMO)
        target = Pose(Point(1, 2, 6), Quaternion(0, 0, 0.6, 0.8))
        self.client.move(GIZMO, target)
        wait(lambda: distance(position("crate"), [1, 2, 6]) < 1e-9, "the crate has moved at once")
        self.assertAlmostEqual(body("crate").pose.orientation.z, 0.6)
        self.client.release(GIZMO, target)

    def test_the_gizmo_has_a_server_of_its_own_without_click_targets(self):
        other = Client("viewer", "/sim/gizmo")
        self.addCleanup(other.close)
        self.client.click("crate")
        other.wait_for(GIZMO)
        self.assertEqual(set(other.markers), {GIZMO})
        other.press(GIZMO)
        moved = Pose(Point(1, 2, 3), Quaternion(0, 0, 0, 1))
        other.move(GIZMO, moved)
        other.release(GIZMO, moved)
        wait(lambda: abs(body("crate").pose.position.z - 3.0) < 1e-6, "the crate is where the gizmo was put")
        self.client.choose("crate", "Resize")
        other.wait_for(*FACES)
        other.wait_without(GIZMO)
        self.assertEqual(set(other.markers), set(FACES))

    def test_a_click_on_the_gizmo_moves_nothing_and_a_small_turn_does(self):
        self.client.click("crate")
        before = body("crate").pose
        # In single precision; by what RViz makes of the pixel of a click on a ring, and on an arrow.
        turned = turned_by(1e-3)
        for rounded in (pose_at(0, 0, 5 + 4e-7), turned, pose_at(0, 0.015, 5)):
            self.client.press(GIZMO)
            for _ in range(3):
                self.client.move(GIZMO, rounded)
            self.client.release(GIZMO, rounded)
        self.client.click("ball")  # done after all of that
        self.assertEqual(body("crate").pose, before)
        self.client.click("crate")
        self.client.press(GIZMO)
        self.client.move(GIZMO, turned)
        further = turned_by(2e-3)
        self.client.move(GIZMO, further)
        wait(lambda: abs(body("crate").pose.orientation.z - math.sin(1e-3 / 2)) < 1e-9, "the crate has turned by 1 mrad, as the mouse has")
        self.client.release(GIZMO, further)

    def test_running_gizmo_carries_against_gravity_and_leaves_at_rest(self):
        self.client.click("crate")
        call("set_gravity", SetGravity, gravity=Vector3(0, 0, -9.81))
        call("resume", Trigger)
        self.client.press(GIZMO)
        target = pose_at(0, 2, 6)

        def arrives():
            self.client.move(GIZMO, target)
            return distance(position("crate"), [0, 2, 6]) < 1e-6
        wait(arrives, "the crate is carried there")
        for _ in range(10):
            self.client.hold_still(GIZMO, target)
            time.sleep(0.1)
            self.assertLess(distance(position("crate"), [0, 2, 6]), 1e-6)
        self.client.release(GIZMO, target)
        wait(lambda: position("crate")[2] < 5.5, "the crate falls")
        fallen, v = position("crate"), body("crate").twist.linear
        self.assertAlmostEqual(fallen[0], 0.0, places=6)
        self.assertAlmostEqual(fallen[1], 2.0, places=6)
        self.assertAlmostEqual(v.y, 0.0, places=6)

    def test_silence_lets_go(self):
        self.client.click("crate")
        self.client.press(GIZMO)
        call("resume", Trigger)
        call("set_gravity", SetGravity, gravity=Vector3(0, 0, -9.81))
        for _ in range(15):
            self.client.hold_still(GIZMO, pose_at(0, 0, 5))
            time.sleep(0.1)
        self.assertLess(distance(position("crate"), [0, 0, 5]), 1e-6)
        wait(lambda: position("crate")[2] < 4.5, "the crate falls, since the client is silent")

    def test_deleting_in_mid_drag_is_safe(self):
        for pause_or_resume in ("pause", "resume"):
            call(pause_or_resume, Trigger)
            name = "doomed_" + pause_or_resume
            call("spawn_bodies", SpawnBodies, bodies=[BodySpec(name=name, pose=pose_at(0, 5, 5))])
            self.client.wait_for(name)
            self.client.press(name, hit=[0, 5, 5])
            self.client.move(name, pose_at(0, 6, 5))
            call("delete_body", NamedBody, name=name)
            self.client.move(name, pose_at(0, 7, 5))
            self.client.release(name, pose_at(0, 7, 5))
            self.client.wait_without(name, GIZMO)
            self.assertNotIn(name, call("list_bodies", ListBodies).names)

    def test_nonsense_is_ignored(self):
        nan = float("nan")
        self.client.press("crate", hit=[nan, nan, nan])
        self.client.move("crate", pose_at(nan, 0, 5))
        self.client.move("crate", pose_at(1e30, 0, 5))
        self.client.release("crate", pose_at(float("inf"), 0, 5))
        self.client.send(Feedback.MENU_SELECT, "crate", pose_at(0, 0, 5), entry=99)
        self.client.send(77, "crate", pose_at(0, 0, 5))
        self.client.press("nobody", pose_at(0, 0, 5))
        self.client.click("ball")  # done after all of that
        self.assertLess(distance(position("crate"), [0, 0, 5]), 1e-9)
        wait(lambda: self.client.markers["crate"].pose == pose_at(0, 0, 5), "the target is back at the crate")

    # --- resizing

    def drag_handle(self, face, dx, dy, dz):
        handle = self.client.markers[face].pose
        self.client.press(face)
        p = handle.position
        moved = Pose(Point(p.x + dx, p.y + dy, p.z + dz), handle.orientation)
        self.client.move(face, moved)
        self.client.release(face, moved)

    def test_a_handle_moves_its_face_and_the_opposite_one_stays(self):
        self.client.choose("crate", "Resize")
        self.client.wait_for(*FACES)
        self.assertNotIn(GIZMO, self.client.markers)
        self.drag_handle("selection.+x", 0.5, 0, 0)
        wait(lambda: abs(body("crate").description.size.x - 1.5) < 1e-6, "the crate is longer")
        self.assertAlmostEqual(position("crate")[0], 0.25)
        self.drag_handle("selection.-z", 0, 0, -1.0)
        wait(lambda: abs(body("crate").description.size.z - 2.0) < 1e-6, "the crate is deeper")
        self.assertAlmostEqual(position("crate")[2], 4.5)
        self.assertAlmostEqual(body("crate").description.size.y, 1.0)
        self.assertAlmostEqual(body("crate").description.mass, 1000 * 1.5 * 2.0)
        self.client.choose("crate", "Resize")
        self.client.wait_without(*FACES)
        self.client.wait_for(GIZMO)

    def test_a_face_cannot_pass_the_opposite_one(self):
        self.client.choose("crate", "Resize")
        self.client.wait_for(*FACES)
        self.drag_handle("selection.+y", 0, -5.0, 0)
        wait(lambda: body("crate").description.size.y < 0.5, "the crate is flat")
        self.assertGreater(body("crate").description.size.y, 0.0)
        self.assertAlmostEqual(position("crate")[1] - 0.5 * body("crate").description.size.y, -0.5)

    def test_a_handle_of_a_sphere_changes_its_diameter(self):
        self.client.choose("ball", "Resize")
        self.client.wait_for(*FACES)
        self.drag_handle("selection.+z", 0, 0, 1.0)
        wait(lambda: abs(body("ball").description.size.x - 2.0) < 1e-6, "the ball is larger")
        self.assertAlmostEqual(position("ball")[2], 5.5)  # its lowest point stays

    def test_a_handle_of_a_cone_widens_it_or_lifts_its_apex(self):
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="cone", shape="cone", size=Vector3(1, 1, 2), pose=pose_at(0, 4, 5))])
        self.client.wait_for("cone")
        self.client.choose("cone", "Resize")
        self.client.wait_for(*FACES)
        self.assertGreater(self.client.markers["selection.+z"].pose.position.z, 6.5)  # beyond the apex
        self.assertGreater(self.client.markers["selection.-z"].pose.position.z, 4.0)  # near the base
        self.drag_handle("selection.+z", 0, 0, 2.0)
        wait(lambda: abs(body("cone").description.size.z - 4.0) < 1e-6, "the cone is higher")
        self.assertAlmostEqual(position("cone")[2], 4.5 + 1.0)  # its base stays
        self.drag_handle("selection.+x", 1.0, 0, 0)
        wait(lambda: abs(body("cone").description.size.x - 2.0) < 1e-6, "the cone is wider")
        self.assertAlmostEqual(body("cone").description.size.y, 2.0)
        self.assertAlmostEqual(position("cone")[0], 0.5)

    def test_a_handle_of_a_hull_stretches_it(self):
        corner = [Point(0, 0, 0), Point(3, 0, 0), Point(0, 2, 0), Point(0, 0, 1)]
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="hull", shape="hull", points=corner, pose=pose_at(0, 6, 5))])
        self.client.wait_for("hull")
        before = body("hull")
        q = before.pose.orientation
        x_axis = (1 - 2 * (q.y ** 2 + q.z ** 2), 2 * (q.x * q.y + q.z * q.w), 2 * (q.x * q.z - q.y * q.w))
        least = min(v.x for v in before.description.vertices)
        side = dot(x_axis, position("hull")) + least
        self.client.choose("hull", "Resize")
        self.client.wait_for(*FACES)
        self.drag_handle("selection.+x", *[0.5 * c for c in x_axis])
        wait(lambda: abs(body("hull").description.size.x - before.description.size.x - 0.5) < 1e-6, "it is longer")
        after = body("hull")
        self.assertAlmostEqual(dot(x_axis, position("hull")) + min(v.x for v in after.description.vertices), side)
        self.assertAlmostEqual(after.description.size.y, before.description.size.y)
        self.assertAlmostEqual(after.description.mass / before.description.mass,
                               after.description.size.x / before.description.size.x)

    def test_a_capsule_stays_as_long_as_it_is_wide(self):
        call("spawn_bodies", SpawnBodies, bodies=[
            BodySpec(name="capsule", shape="capsule", size=Vector3(1, 1, 2), pose=pose_at(0, 4, 5))])
        self.client.wait_for("capsule")
        self.client.choose("capsule", "Resize")
        self.client.wait_for(*FACES)
        self.drag_handle("selection.+y", 0, 2.0, 0)
        wait(lambda: abs(body("capsule").description.size.y - 3.0) < 1e-6, "the capsule is wider")
        self.assertAlmostEqual(body("capsule").description.size.z, 3.0)
        self.drag_handle("selection.+z", 0, 0, 1.0)
        wait(lambda: abs(body("capsule").description.size.z - 4.0) < 1e-6, "the capsule is longer")
        self.drag_handle("selection.+z", 0, 0, -3.0)
        wait(lambda: abs(body("capsule").description.size.z - 3.0) < 1e-6, "the capsule is as long as wide")

    # --- the menu

    def test_menu_delete(self):
        self.client.choose("crate", "Delete")
        self.client.wait_without("crate", GIZMO)
        self.assertNotIn("crate", call("list_bodies", ListBodies).names)

    def test_menu_duplicate(self):
        call("set_body", SetBody, name="crate", density=250.0)
        self.client.choose("crate", "Duplicate")
        wait(lambda: len(call("list_bodies", ListBodies).names) == 3, "there is a third body")
        copy = body(call("list_bodies", ListBodies).names[2])
        self.assertAlmostEqual(copy.description.mass, 250.0)
        self.assertAlmostEqual(copy.description.size.x, 1.0)
        self.assertGreater(copy.pose.position.z, 6.0)
        self.client.wait_for(copy.description.name)

    def test_menu_duplicates_all_but_planes(self):
        publisher, mouse = rospy.Publisher("/sim/select_bodies", BodyNames, queue_size=1, latch=True), Mouse("mouse")
        self.addCleanup(publisher.unregister)
        self.addCleanup(mouse.close)
        call("spawn_bodies", SpawnBodies, bodies=[BodySpec(name="floor", shape="plane", is_static=True, pose=pose_at(0, 0, 0))])
        publisher.publish(names=["floor", "crate", "ball"])
        wait(lambda: "Duplicate 3 bodies" in self.client.titles("crate"), "the menu says how many")
        self.client.choose("crate", "Duplicate 3 bodies")
        mouse.wait_for_answer("2 bodies: duplicated, but not 'floor'", "a plane needs an offset")
        self.assertEqual(len(call("list_bodies", ListBodies).names), 5)

    def test_menu_static_and_dynamic(self):
        self.assertNotIn("Make dynamic", self.client.titles("crate"))
        self.client.choose("crate", "Make static")
        wait(lambda: body("crate").description.kind == "static", "the crate is static")
        wait(lambda: "Make dynamic" in self.client.titles("crate"), "the menu offers the way back")
        self.assertNotIn("Push", self.client.titles("crate"))
        self.client.choose("crate", "Make dynamic")
        wait(lambda: body("crate").description.kind == "dynamic", "the crate is dynamic")

    def test_menu_push_goes_away_from_the_viewer(self):
        self.client.choose("crate", "Push", hit=[0, -0.5, 5])
        wait(lambda: body("crate").twist.linear.y > 0.5, "the crate is pushed away")
        twist = body("crate").twist
        self.assertGreater(twist.linear.z, 0.1)
        self.assertAlmostEqual(twist.linear.x, 0.0)
        self.assertAlmostEqual(twist.angular.x, 0.0)


if __name__ == "__main__":
    rospy.init_node("interactive_bodies_test")
    rostest.rosrun("rigid_body_sim", "interactive_bodies", InteractiveBodiesTest)
