# SPDX-License-Identifier: BSD-3-Clause
"""The running simulator as the tests of this folder see it."""
import threading
import time

import roslib.packages
import rospy
from rigid_body_sim import srv
from rigid_body_sim.msg import Status
from std_srvs.srv import SetBool, Trigger

PATIENCE = 30.0  # s of wall time before a wait counts as failed
SMALL = roslib.packages.get_pkg_dir('rigid_body_sim') + '/test/node/small.yaml'

TYPES = {
    'spawn_body': srv.SpawnBody, 'spawn_bodies': srv.SpawnBodies, 'delete_body': srv.NamedBody,
    'delete_bodies': srv.NamedBodies, 'duplicate_bodies': srv.DuplicateBodies, 'edit_bodies': srv.EditBodies,
    'clear': Trigger,
    'resize_body': srv.ResizeBody, 'move_body': srv.MoveBody, 'set_body': srv.SetBody,
    'apply_impulse': srv.ApplyImpulse, 'apply_wrench': srv.ApplyWrench, 'get_body': srv.GetBody,
    'list_bodies': srv.ListBodies, 'cast_ray': srv.CastRay,
    'closest_points': srv.ClosestPoints, 'overlaps': srv.Overlaps, 'list_scenes': srv.ListScenes, 'enable_wind': SetBool, 'set_wind': srv.SetWind,
    'set_gravity': srv.SetGravity, 'set_effects': srv.SetEffects, 'set_fidelity': srv.SetFidelity,
    'tune_fidelity': srv.TuneFidelity, 'seek_accuracy': srv.AccuracyGoal, 'apply_accuracy': srv.AccuracyGoal,
    'measure_accuracy': srv.MeasureAccuracy, 'stop_accuracy': Trigger, 'estimate_error': SetBool, 'show_ghost': SetBool,
    'pause': Trigger, 'resume': Trigger, 'toggle_pause': Trigger, 'republish': Trigger, 'step': srv.Step,
    'reset': Trigger, 'undo': Trigger, 'redo': Trigger, 'set_speed': srv.SetSpeed, 'load_scene': srv.LoadScene, 'load_scene_with_seed': srv.LoadSceneWithSeed, 'save_scene': srv.File,
    'save_state': srv.File, 'load_state': srv.File,
}


def ask(service, **request):
    """The answer of a service, whatever it says."""
    rospy.wait_for_service('/sim/' + service, PATIENCE)
    return rospy.ServiceProxy('/sim/' + service, TYPES[service])(**request)


def call(service, **request):
    """The answer of a service that must succeed."""
    answer = ask(service, **request)
    assert answer.success, '%s: %s' % (service, answer.message)
    return answer


def body(name):
    return call('get_body', name=name).body


def wait(condition, what):
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError('waited in vain until ' + what)


class Listener:
    """The messages of a topic since it was made or cleared."""

    def __init__(self, topic, kind):
        self.lock = threading.Lock()
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, kind, self.keep, queue_size=1000)

    def keep(self, message):
        with self.lock:
            self.messages.append(message)

    def all(self):
        with self.lock:
            return list(self.messages)

    def clear(self):
        with self.lock:
            self.messages = []

    def next(self, what='a message comes', condition=lambda message: True):
        """The first message from now on that fulfils the condition."""
        self.clear()
        return wait(lambda: next((m for m in self.all() if condition(m)), None), what)


class StatusListener(Listener):
    def __init__(self):
        super().__init__('/sim/status', Status)

    def fresh(self):
        """A status that was made after this call: the second from now on."""
        self.clear()
        return wait(lambda: self.all()[1:2], 'the simulator says how it is')[0]
