#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A recorded session, replayed in place of the simulator: sought in, stepped, and refused where it is no recording."""
import bisect
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from xmlrpc.client import ServerProxy

import roslib.packages
import rosbag
import rospy
import rosservice
import rostest
from geometry_msgs.msg import Point, Pose
from rigid_body_sim.msg import BodyDescriptions, BodyNames, BodyStates, Contacts, Event, Status, Wind
from rigid_body_sim.srv import Seek
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from visualization_msgs.msg import InteractiveMarkerFeedback, Marker, MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from simulator import PATIENCE, TYPES, Listener, StatusListener, ask, call, wait  # noqa: E402

MARKERS = '/sim/visualization_marker_array'
KINDS = {'body_states': BodyStates, 'body_descriptions': BodyDescriptions, 'contacts': Contacts, 'wind': Wind,
         'status': Status}
HEARD = {'/sim/' + topic for topic in KINDS} | {MARKERS, '/tf', '/sim/events'}
FIELDS = {'body_states': ('ids', 'poses', 'twists', 'version'), 'body_descriptions': ('version', 'bodies'),
          'contacts': ('contacts', ), 'wind': ('mean', 'enabled'), 'status': ('time', 'scene', 'hash')}


def program(package, name):
    return roslib.packages.find_node(package, name)[0]


def limit_memory():
    """A length that is wrong asks for as much as there is. So does the address sanitizer, from the start."""
    if 'ASAN_OPTIONS' in os.environ:
        return
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))


def stamp_of(message):
    return message.header.stamp.to_nsec()


def content(*fields):
    """To compare by: the messages of a bag have classes of their own, which equal no others."""
    return [str(field) for field in fields]


def standing(messages):
    """The markers of the bodies after these messages, by id."""
    shown = {}
    for marker in (marker for message in messages for marker in message.markers):
        if marker.action == Marker.DELETEALL:
            shown.clear()
        elif marker.action == Marker.DELETE:
            shown.pop(marker.id, None)
        elif marker.ns == '/sim/bodies':
            shown[marker.id] = marker.pose.position, marker.scale, marker.frame_locked
    return shown


def seek(time):
    rospy.wait_for_service('/sim/seek', PATIENCE)
    return rospy.ServiceProxy('/sim/seek', Seek)(time)


class Process:
    def __init__(self, *command, **options):
        self.process = subprocess.Popen(command, **options)

    def end(self, how=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(how)
        return self.process.wait(60)


def steps_to(time):
    """Lets the simulation run until its physics time is later than this."""
    statuses = StatusListener()
    wait(lambda: any(status.time > time for status in statuses.all()[-1:]), 'the simulation is at %g s' % time)
    statuses.subscriber.unregister()


def act_out_a_session():
    """Loads, spawns, deletes, edits while paused, and resets."""
    events = Listener('/sim/events', Event)

    def wait_for_event(kind):
        wait(lambda: any(event.kind == kind for event in events.all()), 'the simulator has ' + kind)
        events.clear()
    steps_to(0.5)
    call('load_scene', name='dominoes')
    steps_to(0.3)
    call('spawn_body', name='late', shape='sphere')
    call('enable_wind', data=True)
    steps_to(0.6)
    call('pause')
    wait_for_event('paused')
    call('move_body', name='late', pose=Pose(position=Point(1, 2, 3)))
    call('delete_body', name='late')
    call('resume')
    wait_for_event('resumed')
    events.subscriber.unregister()
    steps_to(0.9)
    call('reset')
    steps_to(3.0)  # several chunks of the bag: a cut may cost the last one


class Recorded:
    """What the bag holds, read by rosbag itself."""

    def __init__(self, path):
        self.messages = {}
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                self.messages.setdefault(topic, []).append(message)
        self.states = self.messages['/sim/body_states']
        last = [self.messages['/sim/' + topic][-1] for topic in ('body_states', 'status', 'contacts', 'wind', 'events')]
        last.append(self.messages['/tf'][-1].transforms[0])
        self.end = max(map(stamp_of, last))
        self.starts_at(stamp_of(self.states[0]))

    def starts_at(self, stamp):
        self.begin = stamp
        self.length = (self.end - self.begin) * 1e-9

    def last(self, topic, time):
        """The last message of a topic that is stamped until a time of the recording, s; the first where there is none."""
        messages = self.messages['/sim/' + topic]
        stamps = [stamp_of(message) - self.begin for message in messages]
        return messages[max(0, bisect.bisect_right(stamps, round(time * 1e9)) - 1)]


class ReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.bag = os.path.join(cls.folder, 'session.bag')
        simulator = Process(program('rigid_body_sim', 'simulator_node'), '__name:=sim')
        recorder = None
        try:
            rospy.wait_for_service('/sim/pause', PATIENCE)
            call('pause')
            cls.services = cls.names_of_services()
            recorder = Process(program('rigid_body_sim', 'record'), '--file', cls.bag)
            wait(lambda: os.path.exists(cls.bag + '.active'), 'it is recorded')
            wait(lambda: HEARD <= cls.topics_sent(), 'the simulator sends to the recorder what it sends from the start')
            call('resume')
            act_out_a_session()
            call('pause')
        finally:
            cls.code = recorder and recorder.end()
            simulator.end()
        cls.recorded = Recorded(cls.bag)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @staticmethod
    def names_of_services():
        return {name for name in rosservice.get_service_list(namespace='/sim')
                if not name.endswith(('logger_level', 'get_loggers'))}

    @staticmethod
    def topics_sent():
        """The topics of the simulator that have a connection; a subscription that the master knows may have none yet."""
        simulator = ServerProxy(rospy.get_master().lookupNode('/sim')[2])
        _, _, connections = simulator.getBusInfo(rospy.get_name())
        return {topic for _, _, direction, _, topic, connected, *_ in connections if direction == 'o' and connected}

    def replay(self, *parameters):
        """A replay that is heard."""
        player = Process(program('rigid_body_sim', 'replay_node'), '__name:=player', '_bag:=' + self.bag, *parameters)
        self.addCleanup(player.end)
        statuses = StatusListener()
        self.addCleanup(statuses.subscriber.unregister)
        length = wait(statuses.all, 'the replay publishes its status')[0].recording[1]
        self.recorded.starts_at(self.recorded.end - round(length * 1e9))
        return player, statuses

    def listen(self, topic, kind):
        listener = Listener(topic, kind)
        self.addCleanup(listener.subscriber.unregister)
        return listener

    def test_a_recording_that_is_interrupted_is_whole(self):
        self.assertEqual(self.code, 0)
        self.assertFalse(os.path.exists(self.bag + '.active'))
        kinds = {event.kind for event in self.recorded.messages['/sim/events']}
        self.assertLessEqual({'loaded', 'spawned', 'deleted', 'reset', 'paused', 'resumed'}, kinds)

    def test_a_replay_starts_with_a_state_for_which_all_is_known(self):
        self.replay('_paused:=true')
        start = self.recorded.begin - stamp_of(self.recorded.states[0])
        self.assertGreaterEqual(start, 0)
        self.assertLessEqual(start, 500000000)
        self.assertIn(self.recorded.begin, map(stamp_of, self.recorded.states))
        markers = self.listen(MARKERS, MarkerArray)
        bodies = self.recorded.last('body_descriptions', 0.0).bodies
        wait(lambda: set(standing(markers.all())) == {body.id for body in bodies}, 'there are markers of all bodies')

    def test_a_replay_plays_every_state_in_order_and_stops_at_the_end(self):
        states, clocks = self.listen('/sim/body_states', BodyStates), self.listen('/clock', Clock)
        _, statuses = self.replay('_paused:=true', '_speed:=0.25')  # so slow that a busy computer leaves none out
        wait(states.all, 'the first state is shown')
        states.clear()
        call('resume')
        wait(lambda: statuses.fresh().paused, 'the replay has come to its end')
        played = states.all()
        recorded = self.recorded.states[-len(played):]
        self.assertEqual([content(state.ids, state.poses) for state in played],
                         [content(state.ids, state.poses) for state in recorded])
        self.assertGreaterEqual(len(played), sum(stamp_of(state) > self.recorded.begin for state in self.recorded.states))
        stamps = [stamp_of(state) for state in played]
        self.assertEqual(stamps, sorted(stamps))
        steps = [b - a for a, b in zip(stamps, stamps[1:])]
        recorded = [stamp_of(state) for state in recorded]
        self.assertEqual(steps, [b - a for a, b in zip(recorded, recorded[1:])])
        ticks = [clock.clock.to_nsec() for clock in clocks.all()]
        self.assertEqual(ticks, sorted(ticks))
        end = statuses.fresh()
        self.assertEqual(end.recording[0], end.recording[1])
        self.assertAlmostEqual(end.recording[1], self.recorded.length, 6)
        call('resume')  # from the start again
        self.assertLess(wait(lambda: not statuses.fresh().paused and statuses.fresh(), 'it plays again').recording[0], 2.0)

    def test_a_seek_shows_what_was_recorded_then(self):
        heard = {topic: self.listen('/sim/' + topic, kind) for topic, kind in KINDS.items()}
        clocks = self.listen('/clock', Clock)
        self.replay('_paused:=true')
        self.assertTrue(seek(0.2).success)
        for topic, listener in heard.items():
            wait(listener.all, 'messages of ' + topic)
        before = 0
        for time in random.Random(1).choices(range(150, int(1000 * self.recorded.length) + 1), k=50):
            time *= 1e-3
            for listener in heard.values():
                listener.clear()
            self.assertTrue(seek(time).success)
            for topic, fields in FIELDS.items():
                wanted = content(*(getattr(self.recorded.last(topic, time), field) for field in fields))
                # What came before the seek may still be on its way, and is followed by what was recorded then.
                wait(lambda: [message for message in heard[topic].all()[-1:]
                              if content(*(getattr(message, field) for field in fields)) == wanted],
                     '%s are those of %g s: %.200s' % (topic, time, wanted))
            self.assertAlmostEqual(heard['status'].all()[-1].recording[0], time, 8)
            state, descriptions = (heard[topic].all()[-1] for topic in ('body_states', 'body_descriptions'))
            self.assertEqual([body.id for body in descriptions.bodies], list(state.ids))
            self.assertGreater(stamp_of(state), before)
            before = stamp_of(state)
        ticks = [clock.clock.to_nsec() for clock in clocks.all()]
        self.assertEqual(ticks, sorted(ticks))

    def test_a_seek_shows_the_markers_of_that_time_and_no_others(self):
        self.replay('_paused:=true')
        markers = self.listen(MARKERS, MarkerArray)
        late = next(event for event in self.recorded.messages['/sim/events'] if event.body == 'late')
        gone = next(event for event in self.recorded.messages['/sim/events'] if event.kind == 'deleted')
        spawned = (stamp_of(late) - self.recorded.begin) * 1e-9
        deleted = (stamp_of(gone) - self.recorded.begin) * 1e-9
        for time in (deleted - 0.1, spawned - 0.1, deleted + 0.2, deleted - 0.1, 0.0, self.recorded.length):
            markers.clear()
            self.assertTrue(seek(time).success)
            bodies = self.recorded.last('body_descriptions', time).bodies
            self.assertEqual(any(body.name == 'late' for body in bodies), spawned <= time < deleted)
            try:
                wait(lambda: set(standing(markers.all())) == {body.id for body in bodies},
                     'there are markers of %d bodies at %g s' % (len(bodies), time))
            except AssertionError as error:
                raise AssertionError('%s, but of %s' % (error, sorted(standing(markers.all())))) from error

    def test_a_step_goes_to_the_next_state_also_within_a_pause(self):
        _, statuses = self.replay('_paused:=true')
        states = self.listen('/sim/body_states', BodyStates)
        wait(states.all, 'the first state is shown')
        gone = next(event for event in self.recorded.messages['/sim/events'] if event.kind == 'deleted')
        time = (stamp_of(gone) - self.recorded.begin) * 1e-9
        self.assertTrue(seek(time - 0.1).success)
        first = self.recorded.states.index(self.recorded.last('body_states', time - 0.1))
        for k in range(1, 11):
            self.assertEqual(call('step').taken, 1)
            wanted = content(self.recorded.states[first + k].poses)
            wait(lambda: states.all() and content(states.all()[-1].poses) == wanted, 'state %d is shown' % k)
        self.assertTrue(seek(self.recorded.length + 1e-10).success, 'the end, but for rounding')
        answer = ask('step', n=3)
        self.assertFalse(answer.success)
        self.assertEqual(answer.taken, 0)
        self.assertIn('the recording ends here', answer.message)
        call('resume')
        self.assertIn('must be paused', ask('step').message)
        call('pause')
        call('reset')
        wait(lambda: statuses.fresh().recording[0] == 0.0, 'the start is shown')

    def test_a_seek_out_of_the_recording_names_its_range_and_changes_nothing(self):
        _, statuses = self.replay('_paused:=true')
        self.assertTrue(seek(0.25).success)
        for time in (-0.001, self.recorded.length + 0.001, float('nan'), float('inf')):
            answer = seek(time)
            self.assertFalse(answer.success)
            self.assertIn('0 to %.6g s' % self.recorded.length, answer.message)
        self.assertEqual(statuses.fresh().recording[0], 0.25)

    def test_the_pace_is_that_of_the_replay(self):
        _, statuses = self.replay('_paused:=true')
        call('set_speed', factor=0.25)
        call('resume')
        status = wait(lambda: not statuses.fresh().paused and statuses.fresh(), 'it plays')
        self.assertEqual((status.requested_speed, status.achieved_speed), (0.25, 0.25))
        self.assertFalse(ask('set_speed', factor=-1).success)
        call('set_speed', factor=0)
        wait(lambda: statuses.fresh().paused, 'it has come to its end')

    def test_what_is_shown_is_sent_again_on_request(self):
        _, statuses = self.replay('_paused:=true')
        statuses.fresh()
        states = self.listen('/sim/body_states', BodyStates)
        wait(lambda: states.messages, 'the states come to who begins to listen')
        count = len(states.messages)
        call('republish')
        wait(lambda: len(states.messages) > count, 'the states come again')
        self.assertEqual(content(states.messages[-1].poses), content(states.messages[0].poses))

    def test_every_other_service_refuses_and_says_why(self):
        self.replay('_paused:=true')
        call('pause')  # the first answer comes once every service is offered
        self.assertEqual(self.names_of_services(), self.services | {'/sim/seek'})
        steers = {'pause', 'resume', 'toggle_pause', 'set_speed', 'step', 'reset', 'republish'}
        for service in set(TYPES) - steers:
            answer = ask(service)
            self.assertFalse(answer.success, service)
            self.assertIn('replay of a recording', answer.message)

    def test_the_viewer_selects_and_gets_the_answer_that_nothing_moves(self):
        self.replay('_paused:=true')
        selected = self.listen('/sim/selected_bodies', BodyNames)
        answers = self.listen('/sim/interactive_bodies/answer', String)
        select = rospy.Publisher('/sim/select_bodies', BodyNames, queue_size=1, latch=True)
        self.addCleanup(select.unregister)
        select.publish(BodyNames(['a', 'b']))
        wait(lambda: selected.all() and selected.all()[-1].names == ['a', 'b'], 'the selection is published')
        # Another process, since those of this one share a connection.
        heard = subprocess.run(['timeout', '5', 'rostopic', 'echo', '/sim/selected_bodies/names'], check=False,
                               stdout=subprocess.PIPE, text=True).stdout
        self.assertEqual(heard.split('---\n')[:-1], ['\n- a\n- b\n'])
        selected.clear()
        self.assertTrue(seek(0.3).success)
        self.assertEqual(selected.all(), [])
        mouse = rospy.Publisher('/sim/interactive_bodies/mouse', InteractiveMarkerFeedback, queue_size=1, latch=True)
        self.addCleanup(mouse.unregister)
        mouse.publish(InteractiveMarkerFeedback(marker_name='a', event_type=InteractiveMarkerFeedback.POSE_UPDATE))
        self.assertIn('nothing can be moved', wait(answers.all, 'the viewer gets an answer')[0].data)

    def refusal(self, path, *parameters):
        """What the node says of a bag that it cannot replay."""
        done = subprocess.run([program('rigid_body_sim', 'replay_node'), '__name:=refused', '_bag:=' + path, *parameters],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(path, done.stdout)
        return done.stdout

    def test_what_is_no_recording_is_refused(self):
        with open(self.bag, 'rb') as file:
            whole = file.read()
        path = os.path.join(self.folder, 'bad.bag')
        for share in (0.02, 0.5, 0.9, 0.999):
            with open(path, 'wb') as file:
                file.write(whole[:int(share * len(whole))])
            self.assertRegex(self.refusal(path), "was cut off.*rosbag reindex|is damaged.*rosbag reindex", share)
        for text in (b'', b'no bag at all\n' * 100):
            with open(path, 'wb') as file:
                file.write(text)
            self.assertIn('is no bag of ROS', self.refusal(path))
        with rosbag.Bag(path, 'w') as bag:
            bag.write('/chatter', String('hello'), rospy.Time(1))
        self.assertIn('no recording of a simulator', self.refusal(path))
        with rosbag.Bag(path, 'w') as bag:
            for name in ('/left', '/right'):
                bag.write(name + '/body_states', self.recorded.states[0], rospy.Time(1))
        self.assertIn('/left, /right', self.refusal(path))
        self.assertIn("no simulator '/middle'", self.refusal(path, '_simulator:=/middle'))
        os.remove(path)
        self.assertIn('cannot be read: No such file', self.refusal(path))
        self.assertIn('cannot be read', self.refusal(self.folder))

    def test_bytes_that_are_wrong_end_no_replay_in_a_crash(self):
        path, chance = os.path.join(self.folder, 'flipped.bag'), random.Random(2)
        for _ in range(10):
            with rosbag.Bag(self.bag) as whole, rosbag.Bag(path, 'w') as bag:
                for topic, (kind, data, *others), time in whole.read_messages(raw=True):
                    data = bytearray(data)
                    if chance.random() < 0.05:
                        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
                    bag.write(topic, (kind, bytes(data), *others), time, raw=True)
            player = subprocess.Popen([program('rigid_body_sim', 'replay_node'), '__name:=flipped', '_bag:=' + path,
                                       '_speed:=0', '_publish_clock:=false'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=limit_memory)
            try:  # to play it to its end
                code = player.wait(2)
            except subprocess.TimeoutExpired:
                player.send_signal(signal.SIGINT)
                code = player.wait(60)
            self.assertIn(code, (0, 1))

    def test_a_bag_that_was_cut_off_is_replayed_after_a_reindex(self):
        path = os.path.join(self.folder, 'cut.bag')
        with open(self.bag, 'rb') as file, open(path, 'wb') as cut:
            whole = file.read()
            cut.write(whole[:int(0.8 * len(whole))])
        subprocess.check_call(['rosbag', 'reindex', path], stdout=subprocess.DEVNULL)
        player = Process(program('rigid_body_sim', 'replay_node'), '__name:=player', '_bag:=' + path, '_paused:=true')
        self.addCleanup(player.end)
        statuses = StatusListener()
        self.addCleanup(statuses.subscriber.unregister)
        length = wait(statuses.all, 'it is replayed')[0].recording[1]
        self.assertLess(length, self.recorded.length)
        self.assertGreater(length, 0.2 * self.recorded.length)

    def test_a_second_simulator_of_the_name_is_not_disturbed(self):
        self.replay('_paused:=true')
        self.assertIn('end it first', subprocess.run(
            [program('rigid_body_sim', 'replay_node'), '__name:=second', '_bag:=' + self.bag], stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, timeout=60, check=False).stdout)

    def test_the_recorder_refuses_what_it_cannot_write(self):
        for file, says in ((self.bag, 'exists already'), ('/nowhere/x.bag', 'there is no folder /nowhere'),
                           (self.folder + '/x.txt', 'does not end in .bag')):
            done = subprocess.run([program('rigid_body_sim', 'record'), '--file', file], stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn(says, done.stdout)


if __name__ == '__main__':
    rospy.init_node('replay_test')
    rostest.rosrun('rigid_body_sim', 'replay', ReplayTest)
