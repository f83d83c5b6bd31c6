#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every topic: what it says, and when."""
import os
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, Pose, Quaternion, TwistStamped, Vector3, WrenchStamped
from rigid_body_sim.msg import BodyDescriptions, BodyStates, Contacts, Event, Wind
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, Listener, StatusListener, body, call, wait  # noqa: E402


def at(x, y, z):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))


class TopicsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.status = StatusListener()
        cls.clock = Listener('/clock', Clock)
        cls.tf = Listener('/tf', TFMessage)
        cls.events = Listener('/sim/events', Event)
        wait(cls.clock.all, 'the clock ticks')

    def setUp(self):
        call('pause')
        call('load_scene', name=SMALL)
        self.status.fresh()

    def transforms(self, name):
        return [t for message in self.tf.all() for t in message.transforms if t.child_frame_id == name]

    def test_tf_has_the_moving_bodies_under_world(self):
        self.tf.clear()
        call('step', n=3)
        crate = wait(lambda: self.transforms('crate'), 'tf has the crate')[-1]
        self.assertEqual(crate.header.frame_id, 'world')
        self.assertAlmostEqual(crate.transform.translation.z, 0.25, delta=1e-3)
        self.assertEqual(self.transforms('floor'), [])

    def test_an_edit_while_paused_has_a_later_stamp(self):
        call('step', n=1)
        before = wait(lambda: self.transforms('ball'), 'tf has the ball')[-1]
        for x in (4.0, 5.0):
            self.tf.clear()
            call('move_body', name='ball', pose=at(x, 0, 1))
            after = wait(lambda: [t for t in self.transforms('ball') if t.transform.translation.x == x],
                         'tf has the ball where it was put')[-1]
            self.assertGreater(after.header.stamp, before.header.stamp)
            before = after

    def test_a_reset_while_paused_is_seen_in_tf(self):
        call('load_scene', name='playground')
        for _ in range(2):
            self.tf.clear()
            call('step', n=30)
            wait(lambda: any(t.transform.translation.x > -0.5 for t in self.transforms('thrown_ball')),
                 'tf has the ball where it flew')
            self.tf.clear()
            call('reset')
            wait(lambda: any(t.transform.translation.x == -1.0 for t in self.transforms('thrown_ball')),
                 'tf has the ball back where it began')

    def test_the_clock_starts_at_one_and_only_goes_forward(self):
        start = self.clock.next().clock.to_sec()
        self.assertGreaterEqual(start, 1.0)
        call('step', n=30)
        call('reset')
        call('step', n=30)
        call('load_scene', name='tower')
        call('step', n=5)
        wait(lambda: self.clock.all()[-1].clock.to_sec() > start + 64.5 / 60.0, 'the clock has gone all 65 steps')
        ticks = [message.clock.to_sec() for message in self.clock.all()]
        self.assertEqual(ticks, sorted(ticks))
        # An edit while paused moves the clock by a nanosecond or two, so that tf takes the new poses.
        self.assertAlmostEqual(ticks[-1] - start, 65 / 60.0, delta=1e-6)

    def test_the_clock_is_sent_again_while_paused(self):
        self.clock.clear()
        wait(lambda: len(self.clock.all()) > 10, 'the clock is sent ten times')
        self.assertEqual(len({message.clock.to_nsec() for message in self.clock.all()[1:]}), 1)

    def test_descriptions_are_latched_and_name_the_version_of_the_states(self):
        descriptions = Listener('/sim/body_descriptions', BodyDescriptions)
        states = Listener('/sim/body_states', BodyStates)
        wait(lambda: descriptions.all() and states.all(), 'a newcomer hears of the bodies')
        last = descriptions.all()[-1]
        self.assertEqual([b.name for b in last.bodies], ['floor', 'crate', 'ball'])
        self.assertEqual(states.all()[-1].version, last.version)
        self.assertEqual(list(states.all()[-1].ids), [b.id for b in last.bodies])
        call('spawn_body', name='late')
        changed = wait(lambda: [d for d in descriptions.all() if d.version > last.version], 'the change is told')[-1]
        self.assertEqual(changed.bodies[-1].name, 'late')

    def test_contacts_carry_the_weight(self):
        contacts = Listener('/sim/contacts', Contacts)
        call('step', n=120)
        last = wait(lambda: [m for m in contacts.all() if m.contacts], 'there are contacts')[-1]
        under = [c for c in last.contacts if c.body_b == 'crate']
        self.assertEqual(len(under), 4)
        weight = body('crate').description.mass * 9.81 / 60.0
        self.assertAlmostEqual(sum(c.normal_impulse for c in under), weight, delta=1e-6 * weight)

    def test_the_status_says_what_runs_and_why(self):
        stages = {stage.name: stage for stage in self.status.fresh().pipeline}
        self.assertFalse(stages['forces.drag'].active)
        self.assertIn('air', stages['forces.drag'].reason)
        call('enable_wind', data=True)
        stages = {stage.name: stage for stage in self.status.fresh().pipeline}
        self.assertTrue(stages['forces.drag'].active)

    def test_the_wind_is_told_when_it_changes(self):
        wind = Listener('/sim/wind', Wind)
        call('set_wind', velocity=Vector3(3, 1, 0), gust=0.0)
        last = wait(lambda: [m for m in wind.all() if m.enabled], 'the wind is told')[-1]
        self.assertTrue(last.air)
        self.assertEqual((last.mean.x, last.mean.y), (3.0, 1.0))

    def test_events_tell_what_happened(self):
        def told(kind, body):
            wait(lambda: [m for m in self.events.all() if (m.kind, m.body) == (kind, body)], '%s is told' % kind)

        self.events.clear()
        call('spawn_body', name='new')
        told('spawned', 'new')
        call('delete_body', name='new')
        told('deleted', 'new')
        call('reset')
        told('reset', '')

    def test_diagnostics_speak_of_the_simulation(self):
        diagnostics = Listener('/diagnostics', DiagnosticArray)
        wait(lambda: [s for m in diagnostics.all() for s in m.status if 'sim' in s.name], 'diagnostics come')

    def test_a_commanded_twist_is_in_the_frame_of_the_body(self):
        publisher = rospy.Publisher('/sim/cmd_twist', TwistStamped, queue_size=1)
        wait(publisher.get_num_connections, 'the simulator listens')
        command = TwistStamped()
        command.header.frame_id = 'ball'
        command.twist.linear.x = 2.0
        publisher.publish(command)
        wait(lambda: body('ball').twist.linear.x == 2.0, 'the ball has its twist')

    def test_a_commanded_wrench_pushes_the_body(self):
        publisher = rospy.Publisher('/sim/cmd_wrench', WrenchStamped, queue_size=1)
        wait(publisher.get_num_connections, 'the simulator listens')
        command = WrenchStamped()
        command.header.frame_id = 'ball'
        command.wrench.force.x = 1000.0
        publisher.publish(command)
        wait(lambda: call('step', n=1) and body('ball').twist.linear.x > 0.1, 'the ball moves')

    def test_a_command_that_makes_no_sense_changes_nothing(self):
        before = self.status.fresh().hash
        publisher = rospy.Publisher('/sim/cmd_twist', TwistStamped, queue_size=10)
        wait(publisher.get_num_connections, 'the simulator listens')
        for name, speed in (('nobody', 1.0), ('ball', float('nan')), ('floor', 1.0), ('ball', 1e30)):
            command = TwistStamped()
            command.header.frame_id = name
            command.twist.linear.x = speed
            publisher.publish(command)
        self.status.fresh()
        self.assertEqual(self.status.fresh().hash, before)


if __name__ == '__main__':
    rospy.init_node('topics_test')
    rostest.rosrun('rigid_body_sim', 'topics', TopicsTest)
