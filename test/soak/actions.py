# SPDX-License-Identifier: BSD-3-Clause
"""What people do with a simulator, at random: each is a few calls that must all succeed."""
import math
import time

import rospy
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from rigid_body_sim import srv
from rigid_body_sim.msg import BodySpec
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import InteractiveMarkerFeedback as Feedback

SCENES = ['playground', 'boxes_on_slope', 'dominoes', 'newtons_cradle', 'shapes', 'harbour', 'windy_day', 'pyramid',
          'card_house', 'marbles', 'spinning_box', 'bouncing_49', 'tower']
SHAPES = ['box', 'sphere', 'capsule', 'cylinder', 'cone', 'hull']
MOST_BODIES = 150
PATIENCE = 60.0  # s


class Refused(Exception):
    pass


class Actions:
    def __init__(self, random, folder):
        self.random, self.folder = random, folder
        self.feedback = rospy.Publisher('/sim/interactive_bodies/feedback', Feedback, queue_size=100)
        self.counts = {}
        self.saved = False
        self.weights = {
            self.spawn: 10, self.delete: 5, self.move: 6, self.resize: 6, self.change: 6, self.push: 8,
            self.surroundings: 4, self.dial: 3, self.effects: 2, self.pace: 4, self.step: 3, self.load: 3,
            self.reset: 2, self.undo: 5, self.save_and_load: 2, self.query: 8, self.drag: 10, self.measure: 1, self.overlays: 2,
        }

    def any(self):
        """Does one of them; returns its name."""
        act = self.random.choices(list(self.weights), list(self.weights.values()))[0]
        self.counts[act.__name__] = self.counts.get(act.__name__, 0) + 1
        act()
        return act.__name__

    def call(self, service, kind, /, **request):
        rospy.wait_for_service('/sim/' + service, PATIENCE)  # of a node that has just started
        answer = rospy.ServiceProxy('/sim/' + service, kind)(**request)
        if not answer.success:
            raise Refused('%s: %s' % (service, answer.message))
        return answer

    def quiet(self):
        """Back to where every quiet point is measured: a small scene, nothing beside it."""
        for service in 'show_ghost', 'estimate_error':
            self.call(service, SetBool, data=False)
        rospy.ServiceProxy('/sim/stop_accuracy', Trigger)()
        self.call('load_scene', srv.LoadScene, name='boxes_on_slope')
        self.call('set_speed', srv.SetSpeed, factor=1.0)
        self.call('resume', Trigger)

    # --- bodies

    def place(self):
        half_turn = self.random.uniform(0, math.pi / 2)
        return Pose(Point(self.random.uniform(-3, 3), self.random.uniform(-3, 3), self.random.uniform(1, 6)),
                    Quaternion(0, 0, math.sin(half_turn), math.cos(half_turn)))

    def vector(self, most):
        return Vector3(*(self.random.uniform(-most, most) for _ in range(3)))

    def body(self):
        """The name of one that moves; one is made where there is none."""
        names = self.call('list_bodies', srv.ListBodies).names
        for name in self.random.sample(list(names), min(len(names), 20)):
            if self.call('get_body', srv.GetBody, name=name).body.description.kind == 'dynamic':
                return name
        return self.call('spawn_body', srv.SpawnBody).name

    def spawn(self):
        if len(self.call('list_bodies', srv.ListBodies).names) > MOST_BODIES:
            self.call('clear', Trigger)
        bodies = []
        for _ in range(self.random.choice([1, 1, 1, 5, 20])):
            shape = self.random.choice(SHAPES)
            body = BodySpec(shape=shape, pose=self.place(), twist=Twist(self.vector(3), self.vector(3)))
            if shape == 'hull':
                body.points = [Point(*(self.random.uniform(-0.3, 0.3) for _ in range(3))) for _ in range(12)]
            bodies.append(body)
        self.call('spawn_bodies', srv.SpawnBodies, bodies=bodies)

    def delete(self):
        self.call('delete_body', srv.NamedBody, name=self.body())

    def move(self):
        self.call('move_body', srv.MoveBody, name=self.body(), pose=self.place(), keep_velocity=self.random.random() < 0.5)

    def resize(self):
        self.call('resize_body', srv.ResizeBody, name=self.body(), factor=self.random.uniform(0.7, 1.3))

    def change(self):
        self.call('set_body', srv.SetBody, name=self.body(), density=self.random.uniform(100, 3000),
                  twist=[Twist(self.vector(3), self.vector(3))])

    def push(self):
        name = self.body()
        self.call('apply_impulse', srv.ApplyImpulse, name=name, impulse=self.vector(20))
        self.call('apply_wrench', srv.ApplyWrench, name=name, force=self.vector(50), torque=self.vector(5), seconds=0.5)

    # --- the rest of the world

    def surroundings(self):
        self.call('set_gravity', srv.SetGravity, gravity=Vector3(0, 0, self.random.choice([-9.81, -1.6, -3.7])))
        self.call('set_wind', srv.SetWind, velocity=self.vector(5), gust=self.random.uniform(0, 2))
        self.call('enable_wind', SetBool, data=self.random.random() < 0.5)

    def dial(self):
        fidelity = self.random.choice(['preview', 'interactive', 'interactive', 'accurate'])
        self.call('set_fidelity', srv.SetFidelity, fidelity=fidelity)

    def effects(self):
        effect = self.random.choice(['drag', 'friction', 'impacts', 'gyroscopic', 'restitution'])
        self.call('set_effects', srv.SetEffects, **{self.random.choice(['force_on', 'force_off']): [effect]})
        self.call('set_effects', srv.SetEffects, detect=[effect])

    def pace(self):
        self.call('set_speed', srv.SetSpeed, factor=self.random.choice([0.2, 1.0, 1.0, 2.0]))
        self.call('toggle_pause', Trigger)
        time.sleep(0.2)
        self.call('resume', Trigger)

    def step(self):
        self.call('pause', Trigger)
        self.call('step', srv.Step, n=self.random.randint(1, 60))
        self.call('resume', Trigger)

    def load(self):
        self.call('load_scene', srv.LoadScene, name=self.random.choice(SCENES))

    def reset(self):
        self.call('reset', Trigger)

    def undo(self):
        self.spawn()
        self.call('undo', Trigger)
        self.call('redo', Trigger)

    def save_and_load(self):
        """A new file each time, so that none is in the way."""
        self.counts['files'] = self.counts.get('files', 0) + 1
        file = '%s/saved_%d.yaml' % (self.folder, self.counts['files'])
        self.call('save_state', srv.File, file=file)
        self.load()
        self.call('load_state', srv.File, file=file)

    def query(self):
        self.call('cast_ray', srv.CastRay, origin=Point(0, 0, 20), direction=Vector3(0, 0, -1), all=True)
        self.call('overlaps', srv.Overlaps, size=Vector3(1, 1, 1), pose=self.place(), margin=0.5)
        self.call('list_scenes', srv.ListScenes)

    # --- the mouse

    def drag(self):
        """One in ten times the mouse never comes up: its RViz has died."""
        name = self.body()
        pose = self.call('get_body', srv.GetBody, name=name).body.pose
        event = Feedback(marker_name=name, client_id='soak_%d' % self.random.randint(0, 3), mouse_point_valid=True,
                         mouse_point=pose.position, pose=pose)
        event.header.frame_id = 'world'
        event.event_type = Feedback.MOUSE_DOWN
        self.feedback.publish(event)
        event.event_type = Feedback.POSE_UPDATE
        for _ in range(self.random.randint(5, 40)):
            event.pose.position.x += self.random.uniform(-0.1, 0.12)
            event.pose.position.z += self.random.uniform(-0.05, 0.1)
            self.feedback.publish(event)
            time.sleep(1 / 30)
        if self.random.random() < 0.9:
            event.event_type = Feedback.MOUSE_UP
            self.feedback.publish(event)

    # --- accuracy

    def measure(self):
        self.call('measure_accuracy', srv.MeasureAccuracy, seconds=0.5, windows=2, max_cpu_seconds=5.0)
        time.sleep(self.random.uniform(0, 5))

    def overlays(self):
        self.call('estimate_error', SetBool, data=self.random.random() < 0.5)
        self.call('show_ghost', SetBool, data=self.random.random() < 0.5)
