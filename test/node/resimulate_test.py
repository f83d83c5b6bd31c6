#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A session is recorded with rosbag, and run again by resimulate. It knows recordings that differ from those that cannot be
run."""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from xmlrpc.client import ServerProxy

import rosbag
import rosgraph
import roslib.packages
import rosnode
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, TwistStamped, Vector3, WrenchStamped
from rigid_body_sim.msg import BodyChange, BodySpec, Command
from visualization_msgs.msg import InteractiveMarkerFeedback as Feedback

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import SMALL, Listener, StatusListener, body, call, wait  # noqa: E402

COMMANDS, STATUS = '/sim/commands', '/sim/status'
TOPICS = [COMMANDS, STATUS]


def resimulate(bag, *options):
    """Its exit code and all that it prints."""
    program = roslib.packages.find_node('rigid_body_sim', 'resimulate')[0]
    done = subprocess.run([program, bag, *options], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def subscribers():
    """The topics of the recording that the simulator sends to somebody."""
    simulator = ServerProxy(rosnode.get_api_uri(rosgraph.Master('/resimulate_test'), '/sim'))
    return {connection[4] for connection in simulator.getBusInfo('/resimulate_test')[2]
            if connection[2] == 'o' and connection[4] in TOPICS}


def publisher(topic, kind):
    made = rospy.Publisher(topic, kind, queue_size=100)
    wait(lambda: made.get_num_connections() > 0, 'the simulator listens to ' + topic)
    return made


def drag(name, status):
    """Takes a body by the mouse, pulls it along for some time, and lets go."""
    mouse = publisher('/sim/interactive_bodies/mouse', Feedback)
    pose = body(name).pose

    def send(event):
        feedback = Feedback(client_id='test', marker_name=name, event_type=event, pose=pose, mouse_point_valid=True,
                            mouse_point=Point(pose.position.x, pose.position.y, pose.position.z))
        feedback.header.frame_id = 'world'
        mouse.publish(feedback)

    send(Feedback.MOUSE_DOWN)
    for _ in range(10):
        pose.position.z += 0.1
        send(Feedback.POSE_UPDATE)
        status.next()
    send(Feedback.MOUSE_UP)


def steer(name, status):
    """As a controller does."""
    twist, wrench = TwistStamped(), WrenchStamped()
    twist.header.frame_id = wrench.header.frame_id = name
    twist.twist.linear.x, wrench.wrench.force.z = 1.0, 20.0
    for topic, message in (('/sim/cmd_twist', twist), ('/sim/cmd_wrench', wrench)):
        publisher(topic, type(message)).publish(message)
        status.fresh()


def play():
    """What a person may do."""
    status = StatusListener()
    call('spawn_body', shape='sphere', name='thrown')
    call('apply_impulse', name='thrown', impulse=Vector3(20, 5, 30))
    call('spawn_body', shape='sphere', name='alone', pose=Pose(Point(30, 30, 2), Quaternion(0, 0, 0, 1)))
    call('apply_impulse', name='alone', impulse=Vector3(7, 0, 0))
    status.fresh()
    drag('thrown', status)
    steer('thrown', status)
    call('enable_wind', data=True)
    call('set_wind', velocity=Vector3(3, 1, 0), gust=1.0)
    status.fresh()
    commands = Listener(COMMANDS, Command)  # whoever comes gets a checkpoint, of after the first commands
    wait(lambda: any(entry.kind == 'checkpoint' for entry in commands.all()), 'a checkpoint comes')
    call('set_gravity', gravity=Vector3(0, 0, -3.7))
    call('set_effects', force_on=['sleeping'])
    call('tune_fidelity', preset='interactive', divisions=2)
    status.fresh()
    call('undo')
    call('undo')
    status.fresh()
    call('redo')
    call('load_scene', name=SMALL)
    status.fresh()
    call('seek_accuracy', max_error=1e-6)
    hull = [Point(0, 0, 0), Point(1, 0, 0.1), Point(0, 1, 0), Point(0.1, 0, 1), Point(0.3, 0.9, 0.7)]
    call('spawn_bodies', bodies=[BodySpec(shape='hull', points=hull)] + [BodySpec(shape='cone')] * 200)
    call('edit_bodies', changes=[BodyChange(name='cone_%d' % (k + 1), mass=1.0 + k) for k in range(200)])
    call('apply_wrench', name='crate', force=Vector3(30, 0, 40), seconds=0.3)
    status.fresh()
    call('resize_body', name='crate', factor=1.5)
    call('delete_body', name='ball')
    call('reset')
    status.fresh()
    call('clear')
    call('undo')
    call('apply_impulse', name='ball', impulse=Vector3(1, 2, 3))
    status.fresh()


class ResimulateTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.bag = os.path.join(cls.folder.name, 'session.bag')
        recorder = subprocess.Popen(['rosbag', 'record', '--output-name', cls.bag] + TOPICS)
        try:
            wait(lambda: subscribers() == set(TOPICS), 'the recorder is connected')
            play()
            StatusListener().fresh()
        finally:
            recorder.send_signal(signal.SIGINT)
            recorder.wait()
        wait(lambda: os.path.exists(cls.bag), 'the recorder has closed its bag')

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def changed(self, change):
        """The bag again, with what `change` makes of each (topic, message): another pair, or None."""
        path = os.path.join(self.folder.name, 'changed.bag')
        with rosbag.Bag(self.bag) as old, rosbag.Bag(path, 'w') as new:
            for topic, message, stamp in old:
                pair = change(topic, message)
                if pair:
                    new.write(pair[0], pair[1], stamp)
        return path

    def entries(self):
        with rosbag.Bag(self.bag) as bag:
            return [message for _, message, _ in bag.read_messages([COMMANDS])]

    def test_a_session_runs_again_to_the_same_hashes(self):
        code, said = resimulate(self.bag)
        self.assertEqual(code, 0, said)
        found = re.search(r're-simulated ([\d,]+) steps \(([\d.]+) s\) with ([\d,]+) commands: ([\d,]+) hashes equal$', said)
        self.assertTrue(found, said)
        steps, _, commands, hashes = (float(text.replace(',', '')) for text in found.groups())
        entries = self.entries()
        self.assertGreater(steps, 100)
        self.assertEqual(commands, sum(len(entry.commands) for entry in entries))
        self.assertGreater(hashes, len(entries))  # those of ~status, too
        kinds = {text.split(':')[0] for entry in entries for text in entry.commands}
        self.assertGreaterEqual(kinds, {
            'add_bodies', 'apply_impulse', 'apply_wrench', 'command_wrench', 'edit_body', 'grab', 'release', 'set_air',
            'set_wind', 'set_gravity', 'set_effects', 'set_fidelity', 'set_goal', 'remove_body', 'clear'})
        self.assertEqual({entry.world for entry in entries}, set(range(7)))  # 4 of undo and redo, a load and a reset

    def test_entries_are_numbered_and_begin_with_a_checkpoint(self):
        entries = self.entries()
        self.assertEqual([entry.sequence for entry in entries],
                         list(range(entries[0].sequence, entries[0].sequence + len(entries))))
        worlds = set()
        for entry in entries:
            self.assertIn(entry.kind, ('commands', 'checkpoint'))
            self.assertEqual(bool(entry.commands), entry.kind == 'commands')
            self.assertEqual(bool(entry.checkpoint), entry.kind == 'checkpoint')
            self.assertRegex(entry.hash, '^[0-9a-f]{16}$')
            if entry.world not in worlds:
                self.assertEqual(entry.kind, 'checkpoint')
            worlds.add(entry.world)

    def test_a_number_that_was_changed_is_found(self):
        def change(topic, message):
            if topic == COMMANDS:
                message.commands = [text.replace('impulse: [7, 0, 0]', 'impulse: [7.5, 0, 0]')
                                    for text in message.commands]
            return topic, message
        code, said = resimulate(self.changed(change))
        self.assertEqual(code, 1, said)
        self.assertRegex(said, r'step [\d,]+ of world \d+ \([\d.]+ s\), apply_impulse: hash [0-9a-f]{16} is recorded, ')
        self.assertRegex(said, r'then one differs')
        self.assertRegex(said, r'At the checkpoint of step [\d,]+, \d+ of \d+ bodies (is|are) elsewhere; the farthest:\n  alone +\S+ m')

    def test_a_status_that_was_changed_is_found(self):
        last = max(entry.step for entry in self.entries() if entry.world == 0)

        def change(topic, message):
            if topic == STATUS and message.world == 0 and message.steps == changed[0]:
                message.hash = '0123456789abcdef'
            return topic, message
        with rosbag.Bag(self.bag) as bag:
            changed = [message.steps for _, message, _ in bag.read_messages([STATUS])
                       if message.world == 0 and 0 < message.steps < last][5:6]
        code, said = resimulate(self.changed(change))
        self.assertEqual(code, 1, said)
        self.assertIn('status: hash 0123456789abcdef is recorded', said)

    def test_a_command_that_is_refused_is_a_difference(self):
        def change(topic, message):
            if topic == COMMANDS:
                message.commands = [text.replace('apply_impulse: {body: "thrown"', 'apply_impulse: {body: "gone"')
                                    for text in message.commands]
            return topic, message
        code, said = resimulate(self.changed(change))
        self.assertEqual(code, 1, said)
        self.assertIn("is refused now: body: 'gone'", said)

    def test_a_lost_entry_is_no_recording(self):
        lost = next(entry.sequence for entry in self.entries() if entry.commands)
        code, said = resimulate(self.changed(
            lambda topic, message: None if topic == COMMANDS and message.sequence == lost else (topic, message)))
        self.assertEqual(code, 2, said)
        self.assertIn('entry %d of the commands is followed by entry %d' % (lost - 1, lost + 1), said)

    def test_a_bag_that_was_cut_off_before_its_last_commands_is_sound(self):
        last = [entry.sequence for entry in self.entries() if entry.commands][-1]
        code, said = resimulate(self.changed(
            lambda topic, message: None if topic == COMMANDS and message.sequence >= last else (topic, message)))
        self.assertEqual(code, 0, said)
        self.assertIn('The bag was cut off: it lacks the last commands', said)

    def test_entries_before_the_first_checkpoint_are_passed_over(self):
        first = self.entries()[0]
        self.assertEqual(first.kind, 'checkpoint')
        code, said = resimulate(self.changed(
            lambda topic, message: None if topic == COMMANDS and message.sequence == first.sequence else (topic, message)))
        self.assertEqual(code, 0, said)

    def test_faulty_text_is_no_recording(self):
        def change(topic, message):
            if topic == COMMANDS:
                message.commands = [text.replace('apply_impulse', 'apply_impuls') for text in message.commands]
            return topic, message
        code, said = resimulate(self.changed(change))
        self.assertEqual(code, 2, said)
        self.assertRegex(said, r"entry \d+:1: apply_impuls; unknown key; did you mean 'apply_impulse'")

    def test_a_bag_without_status_has_the_hashes_of_its_entries(self):
        code, said = resimulate(self.changed(lambda topic, message: (topic, message) if topic == COMMANDS else None))
        self.assertEqual(code, 0, said)
        self.assertIn(' %d hashes equal' % len(self.entries()), said)

    def test_a_bag_without_commands_is_no_recording(self):
        code, said = resimulate(self.changed(lambda topic, message: (topic, message) if topic == STATUS else None))
        self.assertEqual(code, 2, said)
        self.assertIn('has no commands', said)

    def test_of_two_simulators_one_must_be_chosen(self):
        path = os.path.join(self.folder.name, 'two.bag')
        with rosbag.Bag(self.bag) as old, rosbag.Bag(path, 'w') as new:
            for topic, message, stamp in old:
                new.write(topic, message, stamp)
                new.write('/left' + topic, message, stamp)
        code, said = resimulate(path)
        self.assertEqual(code, 2, said)
        self.assertIn('choose one by --node: /left/sim, /sim', said)
        self.assertEqual(resimulate(path, '--node', '/left/sim')[0], 0)
        code, said = resimulate(path, '--node', '/right/sim')
        self.assertEqual(code, 2, said)
        self.assertIn('/left/sim, /sim', said)

    def test_a_file_that_is_cut_off_and_one_that_is_no_bag_are_refused(self):
        path = os.path.join(self.folder.name, 'cut.bag')
        with open(self.bag, 'rb') as whole, open(path, 'wb') as cut:
            cut.write(whole.read()[:os.path.getsize(self.bag) // 2])
        unclosed = os.path.join(self.folder.name, 'unclosed.bag')
        with rosbag.Bag(unclosed + '.active', 'w') as bag:
            bag.write(COMMANDS, self.entries()[0])
            bag.flush()
            shutil.copy(unclosed + '.active', unclosed)
        for file, words in ((path, 'rosbag reindex'), (unclosed, 'rosbag reindex'), (SMALL, 'no bag'),
                            (path + '.none', 'no bag')):
            code, said = resimulate(file)
            self.assertEqual(code, 2, said)
            self.assertIn(words, said)
        self.assertEqual(resimulate('--help')[0], 0)


if __name__ == '__main__':
    rospy.init_node('resimulate_test')
    rostest.rosrun('rigid_body_sim', 'resimulate', ResimulateTest)
