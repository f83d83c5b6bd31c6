#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A simulator whose world is the frame "map", with a prefix for its bodies' frames and a root folder for its files."""
import math
import os
import sys
import tempfile
import unittest

import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Point, Pose, Quaternion, TransformStamped, TwistStamped, Vector3
from rigid_body_sim.msg import BodyStates
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, Listener, ask, body, call, wait  # noqa: E402

HALF = math.sqrt(0.5)


def frame(parent, child, x, y, z):
    """A frame turned by a quarter about z."""
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = parent
    transform.transform.translation = Vector3(x, y, z)
    transform.transform.rotation = Quaternion(0, 0, HALF, HALF)
    return transform


class FramesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.broadcaster = tf2_ros.StaticTransformBroadcaster()
        cls.broadcaster.sendTransform([frame('map', 'robot', 1, 2, 3), frame('robot', 'camera', 0, 0, 1),
                                       frame('lost', 'elsewhere', 0, 0, 0)])
        wait(lambda: ask('cast_ray', direction=Vector3(0, 0, 1), frame_id='camera').success, 'the simulator knows the frame')

    def setUp(self):
        call('pause')
        call('load_scene', name=SMALL)

    def refusal(self, service, **request):
        answer = ask(service, **request)
        self.assertFalse(answer.success, '%s %s' % (service, request))
        return answer.message

    def place(self, name):
        p = body(name).pose.position
        return [p.x, p.y, p.z]

    def assert_near(self, found, expected):
        self.assertLess(math.dist(found, expected), 1e-9, found)

    def test_requests_can_be_made_in_frames_of_tf(self):
        call('spawn_body', name='seen', pose=Pose(Point(1, 0, 0), Quaternion(0, 0, 0, 1)), frame_id='camera')
        self.assert_near(self.place('seen'), [0, 2, 4])  # the camera looks along -x
        call('apply_impulse', name='seen', impulse=Vector3(body('seen').description.mass, 0, 0), frame_id='robot')
        self.assertAlmostEqual(body('seen').twist.linear.y, 1.0)
        hit = call('cast_ray', origin=Point(0, 0, 0), direction=Vector3(1, 0, 0), frame_id='camera').hits[0]
        self.assertEqual((hit.body, round(hit.position.x, 9)), ('seen', 0.25))

    def test_frames_of_bodies_have_their_name_with_or_without_the_prefix(self):
        call('move_body', name='crate', pose=Pose(Point(5, 0, 9), Quaternion(0, 0, 0, 1)))
        for number, name in enumerate(('crate', 'sim/crate')):
            call('spawn_body', name='beside_%d' % number, pose=Pose(Point(0, number + 1, 0), Quaternion()), frame_id=name)
            self.assert_near(self.place('beside_%d' % number), [5, number + 1, 9])

    def test_a_body_is_driven_by_the_frame_that_tf_knows(self):
        publisher = rospy.Publisher('/sim/cmd_twist', TwistStamped, queue_size=1)
        self.addCleanup(publisher.unregister)
        wait(lambda: publisher.get_num_connections() > 0, 'the simulator listens')
        for speed, frame_id in ((1.5, 'sim/crate'), (2.5, 'crate')):
            command = TwistStamped()
            command.header.frame_id = frame_id
            command.twist.linear.x = speed
            publisher.publish(command)
            wait(lambda wanted=speed: body('crate').twist.linear.x == wanted, 'the crate is driven by ' + frame_id)

    def test_unknown_frames_are_refused_with_what_tf_says(self):
        place = Pose(Point(1, 0, 0), Quaternion(0, 0, 0, 1))
        for unknown in ('nowhere', 'world', 'elsewhere', '/map', 'sim/nobody', 'x' * 100000, 'a\x01b'):
            message = self.refusal('spawn_body', pose=place, frame_id=unknown)
            self.assertIn("'map'", message)
            self.assertLess(len(message), 1000)
        self.assertIn('elsewhere', self.refusal('cast_ray', direction=Vector3(1, 0, 0), frame_id='elsewhere'))

    def test_everything_is_published_in_the_world_frame(self):
        states, tf = Listener('/sim/body_states', BodyStates), Listener('/tf', TFMessage)
        markers = Listener('/sim/visualization_marker_array', MarkerArray)
        call('move_body', name='ball', pose=Pose(Point(5, 0, 9), Quaternion(0, 0, 0, 1)))
        self.assertEqual(wait(states.all, 'states come')[0].header.frame_id, 'map')
        wait(lambda: [m for m in tf.all() if m.transforms], 'transforms come')
        for message in tf.all():
            for transform in message.transforms:
                self.assertEqual(transform.header.frame_id, 'map')
                self.assertTrue(transform.child_frame_id.startswith('sim/'))
        frames = {m.header.frame_id for a in wait(markers.all, 'markers come') for m in a.markers if m.action == m.ADD}
        self.assertTrue(frames and all(f == 'map' or f.startswith('sim/') for f in frames), frames)

    def test_no_body_is_named_like_the_world_frame(self):
        for name in ('map', 'world'):
            self.assertIn('name', self.refusal('spawn_body', name=name))

    def test_files_stay_in_their_root(self):
        call('load_scene', name='tower')  # of the catalogue
        call('load_scene', name=SMALL)
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, 'scene.yaml')
            with open(scene, 'w') as file:
                file.write('bodies: []\n')
            mesh = os.path.join(folder, 'corner.obj')
            with open(mesh, 'w') as file:
                file.write('v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n')
            around = os.path.join(os.path.dirname(SMALL), '..', '..', 'scenes', 'tower.yaml')
            for service, request in (('load_scene', dict(name=scene)), ('load_scene', dict(name=around)),
                                     ('load_state', dict(file=scene)), ('save_state', dict(file=folder + '/state')),
                                     ('save_scene', dict(file=scene, overwrite=True)),
                                     ('save_scene', dict(file='/proc/self/cwd/x')),
                                     ('spawn_body', dict(shape='hull', mesh=mesh))):
                self.assertIn('confined', self.refusal(service, **request))
            self.assertEqual(sorted(os.listdir(folder)), ['corner.obj', 'scene.yaml'])
        call('spawn_body', shape='hull', mesh='package://rigid_body_sim/scenes/meshes/dodecahedron.obj')


if __name__ == '__main__':
    rospy.init_node('frames_test')
    rostest.rosrun('rigid_body_sim', 'frames', FramesTest)
