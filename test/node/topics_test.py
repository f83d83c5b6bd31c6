#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every topic: what it says, and when."""
import os
import sys
import time
import unittest
from operator import attrgetter

import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, Pose, Quaternion, TwistStamped, Vector3, WrenchStamped
from rigid_body_sim.msg import BodyDescriptions, BodyDetails, BodyStates, Contacts, Event, Status, Wind
from rosgraph_msgs.msg import Clock, Log
from rigid_body_sim.srv import LoadScene, Step
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

    def listen(self, topic, kind):
        """A listener of this test alone: those of one process share a connection, and are newcomers but once."""
        heard = Listener(topic, kind)
        self.addCleanup(heard.subscriber.unregister)
        return heard

    def transforms(self, name):
        return [t for message in self.tf.all() for t in message.transforms if t.child_frame_id == name]

    def test_tf_has_the_moving_bodies_under_world(self):
        self.tf.clear()
        call('step', n=3)
        crate = wait(lambda: self.transforms('crate'), 'tf has the crate')[-1]
        self.assertEqual(crate.header.frame_id, 'world')
        self.assertAlmostEqual(crate.transform.translation.z, 0.25, delta=1e-3)
        self.assertEqual(self.transforms('floor'), [])

    def test_tf_knows_every_body_at_the_stamp_of_every_message(self):
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        self.addCleanup(listener.unregister)
        listeners = [self.listen('/sim/' + name, kind) for name, kind in
                     (('body_states', BodyStates), ('contacts', Contacts), ('status', Status))]
        wait(lambda: all(heard.subscriber.get_num_connections() for heard in listeners), 'all topics are heard')
        call('step', n=300)  # until they rest
        wait(lambda: buffer.can_transform('world', 'ball', rospy.Time()), 'tf has the ball')
        for heard in listeners:
            heard.clear()
        last = self.status.fresh().time
        call('resume')
        self.status.next('time goes on', lambda status: status.time > last + 2.0)
        call('pause')
        messages = [message for heard in listeners for message in heard.all()]
        self.assertGreater(len(messages), 20)
        newest = max(message.header.stamp for message in messages)
        for name in ('crate', 'ball'):
            wait(lambda: buffer.can_transform('world', name, newest), 'tf has caught up')
            for message in messages:
                buffer.lookup_transform('world', name, message.header.stamp)  # or it throws

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
        descriptions = self.listen('/sim/body_descriptions', BodyDescriptions)
        states = self.listen('/sim/body_states', BodyStates)
        wait(lambda: descriptions.all() and states.all(), 'a newcomer hears of the bodies')
        last = descriptions.all()[-1]
        self.assertEqual([b.name for b in last.bodies], ['floor', 'crate', 'ball'])
        self.assertEqual(states.all()[-1].version, last.version)
        self.assertEqual(list(states.all()[-1].ids), [b.id for b in last.bodies])
        call('spawn_body', name='late')
        changed = wait(lambda: [d for d in descriptions.all() if d.version > last.version], 'the change is told')[-1]
        self.assertEqual(changed.bodies[-1].name, 'late')

    def test_contacts_carry_the_weight(self):
        contacts = self.listen('/sim/contacts', Contacts)
        call('step', n=120)
        last = wait(lambda: [m for m in contacts.all() if m.contacts], 'there are contacts')[-1]
        under = [c for c in last.contacts if c.body_b == 'crate']
        self.assertEqual(len(under), 4)
        weight = body('crate').description.mass * 9.81 / 60.0
        self.assertAlmostEqual(sum(c.normal_impulse for c in under), weight, delta=1e-6 * weight)
        self.assertEqual({c.touching_steps for c in under}, {120})

    def test_details_name_the_method_and_the_island_of_each_body(self):
        details = self.listen('/sim/body_details', BodyDetails)
        first = wait(details.all, 'a newcomer hears the details, also while paused')[0]
        self.assertEqual(set(first.methods), {BodyDetails.NONE})
        call('spawn_body', name='top', size=Vector3(0.3, 0.3, 0.3), pose=at(0, 0, 0.65))
        call('spawn_body', name='high', shape='sphere', size=Vector3(0.3, 0.3, 0.3), pose=at(9, 0, 90))
        ids = {name: body(name).description.id for name in ('floor', 'crate', 'ball', 'top', 'high')}
        call('step', n=2)
        last = wait(lambda: [d for d in details.all() if len(d.ids) == 5 and BodyDetails.FLIGHT in d.methods], 'a step')[-1]
        method, island = dict(zip(last.ids, last.methods)), dict(zip(last.ids, last.islands))
        self.assertEqual((method[ids['floor']], island[ids['floor']]), (BodyDetails.NONE, 0))
        self.assertEqual(method[ids['high']], BodyDetails.FLIGHT)
        self.assertIn(method[ids['crate']], (BodyDetails.SOFT_STEP, BodyDetails.WARM_START, BodyDetails.GAUSS_SEIDEL,
                                             BodyDetails.NEWTON))
        self.assertEqual(island[ids['top']], ids['crate'])
        self.assertEqual(island[ids['crate']], ids['crate'])
        self.assertEqual(island[ids['ball']], ids['ball'])
        self.assertEqual(len(last.reference_distances), 0)

    def test_who_shares_a_connection_has_all_sent_again(self):
        first = self.listen('/sim/body_states', BodyStates)
        wait(first.all, 'a newcomer hears the states, also while paused')
        second = self.listen('/sim/body_states', BodyStates)  # of the same process: nobody new for the simulator
        stamp = first.all()[-1].header.stamp
        call('republish')
        again = wait(second.all, 'the states come again')[0]
        self.assertGreater(again.header.stamp, stamp)
        self.assertEqual(again.poses, first.all()[0].poses)

    def test_contacts_are_as_rare_as_they_are_asked_to_be_and_the_last_ones_always_come(self):
        every, rare = self.listen('/sim/contacts', Contacts), self.listen('/sim_rare/contacts', Contacts)
        for node, heard in (('/sim', every), ('/sim_rare', rare)):
            wait(lambda: heard.subscriber.get_num_connections() and heard.all(), 'a newcomer hears the contacts')
            rospy.ServiceProxy(node + '/load_scene', LoadScene)(name=SMALL)
            for _ in range(10):
                answer = rospy.ServiceProxy(node + '/step', Step)(n=30)
                self.assertTrue(answer.success, answer.message)
        # The ten stops are 5 s apart, and a message of /sim_rare would come an hour after the first.
        wait(lambda: every.all()[-1].header.stamp == self.status.all()[-1].header.stamp, 'the last contacts come')
        self.assertEqual(len(rare.all()), 1)

    def test_the_status_tells_the_truth_when_steps_cannot_keep_up(self):
        states = self.listen('/sim/body_states', BodyStates)
        self.assertEqual(self.status.fresh().bottleneck, '')
        call('set_speed', factor=1e6)
        call('resume')
        slow = self.status.next('it says that it is slow', lambda s: s.bottleneck and s.lost_time > 0.0)
        states.clear()
        wait(lambda: len({m.header.stamp.to_nsec() for m in states.all()}) > 10, 'the view moves')
        later = self.status.fresh()
        call('pause')
        call('set_speed', factor=1.0)
        self.assertEqual(slow.requested_speed, 1e6)
        self.assertLess(slow.achieved_speed, 0.9e6)
        self.assertRegex(slow.bottleneck, r'takes \d+ % of a step of .* ms')
        self.assertGreater(later.lost_time, slow.lost_time)
        # What it says of its speed is what its own time and that of the losses come to.
        self.assertGreater(later.time, slow.time)
        self.assertEqual(self.status.fresh().bottleneck, '')

    def test_the_status_says_what_runs_and_why(self):
        stages = {stage.name: stage for stage in self.status.fresh().pipeline}
        self.assertFalse(stages['forces.drag'].active)
        self.assertIn('air', stages['forces.drag'].reason)
        call('enable_wind', data=True)
        stages = {stage.name: stage for stage in self.status.fresh().pipeline}
        self.assertTrue(stages['forces.drag'].active)

    def test_the_wind_is_told_when_it_changes(self):
        wind = self.listen('/sim/wind', Wind)
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
        call('undo')
        told('undone', '')
        call('redo')
        told('redone', '')

    def test_the_status_tells_of_trouble_that_lasts_for_a_step(self):
        status = self.listen('/sim/status', Status)
        wait(status.all, 'statuses come')
        call('set_speed', factor=5.0)
        self.addCleanup(call, 'set_speed', factor=1.0)
        self.events.clear()
        for k in range(5):
            name = 'twin_%d' % k
            call('pause')
            call('spawn_body', name=name, pose=at(3 * k, 30, 2.5), size=Vector3(0.5, 0.5, 0.5))
            call('spawn_body', pose=at(3 * k, 30, 2.55), size=Vector3(0.5, 0.5, 0.5))
            call('resume')
            wait(lambda: [m for m in self.events.all() if m.kind == 'warning' and name in m.text], 'an event tells of ' + name)
            wait(lambda: [w for m in status.all() for w in m.warnings if w.startswith('overlap: ') and name in w],
                 'a status tells of ' + name)
        call('pause')

    def test_diagnostics_speak_of_the_simulation(self):
        diagnostics = self.listen('/diagnostics', DiagnosticArray)

        def of_sim():
            return [m for m in diagnostics.all() for s in m.status if s.name == 'sim: simulation']

        told = wait(of_sim, 'diagnostics come')
        # On the clock of all else that the node publishes, and not on the wall's.
        self.assertLessEqual(abs((told[-1].header.stamp - self.clock.all()[-1].clock).to_sec()), 60.0)
        # A period that was too long is shortened at once, and not when it is over.
        self.addCleanup(rospy.delete_param, '/sim/diagnostic_period')
        rospy.set_param('/sim/diagnostic_period', 1000.0)
        time.sleep(1.5)
        diagnostics.clear()
        time.sleep(1.5)
        self.assertEqual(of_sim(), [])
        rospy.set_param('/sim/diagnostic_period', 0.1)
        wait(of_sim, 'diagnostics come again')

    def test_a_commanded_twist_is_in_the_frame_of_the_body(self):
        publisher = rospy.Publisher('/sim/cmd_twist', TwistStamped, queue_size=1)
        wait(publisher.get_num_connections, 'the simulator listens')
        command = TwistStamped()
        command.header.frame_id = 'ball'
        command.twist.linear.x = 2.0
        publisher.publish(command)
        wait(lambda: body('ball').twist.linear.x == 2.0, 'the ball has its twist')

    def command_wrench(self, publisher, name, force):
        command = WrenchStamped()
        command.header.frame_id = name
        command.wrench.force.x = force
        publisher.publish(command)

    def pushers(self):
        call('set_gravity', gravity=Vector3())
        call('move_body', name='ball', pose=at(0, 0, 50))
        call('move_body', name='crate', pose=at(0, 90, 50))
        publisher = rospy.Publisher('/sim/cmd_wrench', WrenchStamped, queue_size=100)
        wait(publisher.get_num_connections, 'the simulator listens')
        return publisher

    def wrenches(self):
        return next(stage.items for stage in self.status.fresh().pipeline if stage.name == 'forces.wrench')

    def test_commanded_wrenches_do_not_pile_up_while_paused(self):
        publisher = self.pushers()
        for _ in range(50):
            self.command_wrench(publisher, 'ball', 1000.0)
        self.command_wrench(publisher, 'crate', 1.0)  # comes last
        wait(lambda: self.wrenches() > 1, 'all commands have come')
        self.assertEqual(self.wrenches(), 2)
        call('step', n=60)
        ball = body('ball')
        self.assertAlmostEqual(ball.description.mass * ball.twist.linear.x, 1000.0 * 0.2, delta=1e-6)

    def test_commanded_wrenches_push_with_their_force_at_any_rate(self):
        publisher = self.pushers()
        mass, force = body('ball').description.mass, 10.0
        states = self.listen('/sim/body_states', BodyStates)
        wait(states.all, 'states come')
        ball = list(states.all()[-1].ids).index(body('ball').description.id)
        for rate in (10, 50, 200):
            call('pause')
            call('move_body', name='ball', pose=at(0, 0, 50))
            states.clear()
            call('resume')
            for _ in range(rate):
                self.command_wrench(publisher, 'ball', force)
                time.sleep(1.0 / rate)
            call('pause')
            heard = [(m.header.stamp.to_sec(), mass * m.twists[ball].linear.x) for m in states.all()]
            pushes = [(p1 - p0) / (t1 - t0) for (t0, p0), (t1, p1) in zip(heard, heard[1:]) if t1 - t0 > 0.01]
            # Never more than the force, however often it is sent; and the force itself, wherever none was late.
            self.assertLessEqual(max(pushes), force * (1 + 1e-6), '%d Hz' % rate)
            self.assertGreater(sum(abs(push - force) < 1e-6 * force for push in pushes), len(pushes) // 3, '%d Hz' % rate)

    def test_a_command_without_a_body_is_told_with_the_field_that_names_it(self):
        log = self.listen('/rosout', Log)
        for topic, kind in (('cmd_twist', TwistStamped), ('cmd_wrench', WrenchStamped)):
            publisher = rospy.Publisher('/sim/' + topic, kind, queue_size=1)
            wait(publisher.get_num_connections, 'the simulator listens')
            told = '~%s: header.frame_id: empty (allowed: the name of a body; bodies: ' % topic

            def is_told():
                publisher.publish(kind())
                return any(m.msg.startswith(told) for m in log.all())

            wait(is_told, 'the empty field is named')

    def test_a_command_out_of_range_is_told_as_it_was_sent(self):
        call('move_body', name='ball', pose=Pose(Point(0, 0, 3), Quaternion(0, 0.6, 0, 0.8)))
        log = self.listen('/rosout', Log)
        for topic, kind, part, told in (
                ('cmd_twist', TwistStamped, 'twist.linear', "~cmd_twist: twist.linear for 'ball': [1e+09, 0, 0]"),
                ('cmd_twist', TwistStamped, 'twist.angular', "~cmd_twist: twist.angular for 'ball': [1e+09, 0, 0]"),
                ('cmd_wrench', WrenchStamped, 'wrench.force', "~cmd_wrench: wrench.force for 'ball': [1e+300, 0, 0]"),
                ('cmd_wrench', WrenchStamped, 'wrench.torque', "~cmd_wrench: wrench.torque for 'ball': [1e+300, 0, 0]"),
                ('cmd_wrench', WrenchStamped, 'wrench.force', "~cmd_wrench: wrench.force for 'ball': [nan, 0, 0]")):
            publisher = rospy.Publisher('/sim/' + topic, kind, queue_size=1)
            wait(publisher.get_num_connections, 'the simulator listens')
            command = kind()
            command.header.frame_id = 'ball'
            setattr(attrgetter(part)(command), 'x', float(told.split('[')[1].split(',')[0]))

            def is_told():
                publisher.publish(command)
                return any(m.msg.startswith(told) for m in log.all())

            wait(is_told, told)

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
