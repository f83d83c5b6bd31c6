#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A bag that is played from the middle shows the whole scene."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import rosbag
import rospy
import rostest
from rigid_body_sim.msg import BodyDescriptions, BodyStates
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import Listener, wait  # noqa: E402

TOPICS = {'/sim/body_descriptions': BodyDescriptions, '/sim/body_states': BodyStates, '/tf': TFMessage,
          '/sim/visualization_marker_array': MarkerArray}
PERIOD = 1.0  # s after which all is sent again, as the launch file says


def markers_of(messages):
    return {(marker.ns, marker.id) for message in messages for marker in message.markers if marker.action == Marker.ADD}


class BagTest(unittest.TestCase):
    def record(self, path):
        """Records until the middle of the bag is followed by several periods."""
        recorder = subprocess.Popen(['rosbag', 'record', '--output-name', path] + list(TOPICS))
        self.addCleanup(recorder.kill)
        states = Listener('/sim/body_states', BodyStates)
        begin = states.next('the states come').header.stamp
        wait(lambda: (states.all()[-1].header.stamp - begin).to_sec() > 10 * PERIOD, 'enough is recorded')
        recorder.send_signal(signal.SIGINT)
        recorder.wait()
        wait(lambda: os.path.exists(path), 'the recorder has closed its bag')

    def test_a_bag_played_from_the_middle_shows_all(self):
        all_markers = Listener('/sim/visualization_marker_array', MarkerArray)
        wait(all_markers.all, 'the markers come')
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'scene.bag')
            self.record(path)
            with rosbag.Bag(path) as bag:
                half = (bag.get_end_time() - bag.get_start_time()) / 2
            played = {topic: Listener('/played' + topic, kind) for topic, kind in TOPICS.items()}
            remaps = ['%s:=/played%s' % (topic, topic) for topic in TOPICS]
            subprocess.check_call(['rosbag', 'play', '--quiet', '--rate', '4', '--delay', '1', '--start', str(half),
                                   path] + remaps)
            messages = {topic: heard.all() for topic, heard in played.items()}
        descriptions = messages['/sim/body_descriptions']
        self.assertGreater(len(descriptions), 0)
        bodies = {body.id: body for body in descriptions[0].bodies}
        for states in messages['/sim/body_states']:
            self.assertEqual(states.version, descriptions[0].version)
            self.assertEqual(set(states.ids), set(bodies))
        # The water, too, which never moves.
        self.assertEqual(markers_of(messages['/sim/visualization_marker_array']), markers_of(all_markers.all()))
        self.assertIn('/sim/fluid', {name for name, _ in markers_of(all_markers.all())})
        frames = {t.child_frame_id for message in messages['/tf'] for t in message.transforms}
        self.assertEqual(frames, {body.name for body in bodies.values() if body.kind != 'static'})


if __name__ == '__main__':
    rospy.init_node('bag_test')
    rostest.rosrun('rigid_body_sim', 'bag', BagTest)
