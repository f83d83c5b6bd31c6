#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Two simulators in one graph: each with its own bodies and frames, side by side."""
import os
import sys
import unittest

import rosgraph
import rospy
import rostest
from rigid_body_sim import srv
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import Listener, wait  # noqa: E402


def ask(side, service, kind, **request):
    rospy.wait_for_service('/%s/sim/%s' % (side, service), 60)
    answer = rospy.ServiceProxy('/%s/sim/%s' % (side, service), kind)(**request)
    assert answer.success, answer.message
    return answer


class TwoTest(unittest.TestCase):
    def test_a_body_of_one_is_none_of_the_other(self):
        ask('left', 'spawn_body', srv.SpawnBody, name='only_left')
        self.assertIn('only_left', ask('left', 'list_bodies', srv.ListBodies).names)
        self.assertNotIn('only_left', ask('right', 'list_bodies', srv.ListBodies).names)

    def test_their_worlds_are_side_by_side(self):
        listener = Listener('/tf', TFMessage)
        frames = {}

        def known():
            for message in listener.all():
                frames.update({t.child_frame_id: (t.header.frame_id, t.transform.translation.y) for t in message.transforms})
            return {'left/world', 'right/world', 'left/ball', 'right/ball'} <= set(frames)

        wait(known, 'all frames are there')
        self.assertEqual((frames['left/world'], frames['right/world']), (('world', -3.0), ('world', 3.0)))
        self.assertEqual((frames['left/ball'][0], frames['right/ball'][0]), ('left/world', 'right/world'))

    def test_what_is_drawn_lies_in_the_world_of_its_simulator(self):
        for side in ('left', 'right'):
            listener = Listener('/%s/sim/visualization_marker_array' % side, MarkerArray)
            message = listener.next('the markers come', lambda m: m.markers)
            self.assertTrue(all(marker.header.frame_id.startswith(side + '/') for marker in message.markers), side)

    def test_neither_publishes_a_clock_nor_changes_that_of_the_others(self):
        self.assertIs(rospy.get_param('/use_sim_time'), True)
        published = [topic for topic, _ in rosgraph.Master('/two_test').getPublishedTopics('')]
        self.assertNotIn('/clock', published)


if __name__ == '__main__':
    rospy.init_node('two_test')
    rostest.rosrun('rigid_body_sim', 'two', TwoTest)
