#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Uses the simulator for hours as people do, and kills its parts; watches it, and prints a table.

Every minute comes a quiet point: the same small scene, nothing beside it. Memory, threads and descriptors are compared
between quiet points. The node lives through the first half of the time; in the second half it is ended and killed.
"""
import argparse
import contextlib
import os
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[0]), str(HERE.parents[1] / 'scripts')]

import rospy  # noqa: E402
import rviz_driver  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

import process  # noqa: E402
from actions import Actions  # noqa: E402
from master import Master  # noqa: E402
from report import Report  # noqa: E402
from simulator import Node, Rviz  # noqa: E402
from stream import CLOCK, TF, Stream  # noqa: E402

QUIET_PERIOD = 60.0     # s
KILL_PERIOD = 150.0     # s, of the node, in the second half
RVIZ_PERIOD = 240.0     # s
HELPER_PERIOD = 90.0    # s
LONGEST_SILENCE = 10.0  # s, of /clock, before it counts as stalled
LONGEST_END = 15.0      # s that roslaunch waits after SIGINT


class Soak:
    def __init__(self, arguments, folder, screen, stack):
        """Starts the node and, where there is a screen, RViz; `stack` ends them."""
        self.random = random.Random(arguments.seed)
        self.end = time.monotonic() + 3600 * arguments.hours
        self.report = Report()
        self.clock, self.tf = Stream('/clock', CLOCK), Stream('/tf', TF)
        self.node = Node(folder)
        self.rviz = screen and Rviz(screen, str(HERE.parents[1] / 'rviz' / 'sim.rviz'))
        stack.callback(self.kill)
        self.node.start(False)
        if self.rviz:
            self.rviz.start()
        self.actions = Actions(self.random, folder)
        self.due = {}
        half = 1800 * arguments.hours
        for what, seconds in ((self.be_quiet, 0.0), (self.kill_rviz, RVIZ_PERIOD), (self.kill_helper, HELPER_PERIOD),
                              (self.end_node, half), (self.kill_node, half + KILL_PERIOD / 2)):
            self.again(what, seconds)

    def run(self):
        while time.monotonic() < self.end:
            what = next((what for what, due in self.due.items() if time.monotonic() >= due), self.act)
            try:
                what()
            except Exception as error:  # whatever went wrong is told, and the soak goes on
                self.report.problem('%s: %r' % (what.__name__, error))
            if self.node.process.poll() is not None:
                self.report.problem('the node ended by itself with %s: %s' % (
                    self.node.process.returncode, self.node.said()[-2000:]))
                self.start_node(True)
            self.report.note(self.node.process.pid, self.rviz and self.rviz.process.pid)
            # tf is silent where no body can move.
            if self.clock.silent_for() > LONGEST_SILENCE:
                self.report.problem('/clock stalled for %.0f s after %s' % (self.clock.silent_for(), what.__name__))
                self.clock.pause()
        self.be_quiet()
        self.stop()

    def act(self):
        self.actions.any()
        time.sleep(self.random.uniform(0.0, 0.5))

    def again(self, what, seconds):
        self.due[what] = time.monotonic() + seconds

    def be_quiet(self):
        self.again(self.be_quiet, QUIET_PERIOD)
        self.actions.quiet()
        time.sleep(3.0)
        self.report.quiet_point(self.node.lives, self.node.process.pid)

    def kill_rviz(self):
        self.again(self.kill_rviz, RVIZ_PERIOD)
        if self.rviz:
            self.report.count('RViz killed')
            self.rviz.kill()
            self.rviz.start()

    def kill_helper(self):
        self.again(self.kill_helper, HELPER_PERIOD)
        self.actions.measure()
        for child in process.children(self.node.process.pid):
            self.report.count('accuracy helper killed')
            os.kill(child, signal.SIGKILL)

    def end_node(self):
        """SIGTERM while it measures; the next one must go on from the same state."""
        self.again(self.end_node, KILL_PERIOD)
        self.actions.measure()
        self.actions.call('pause', Trigger)
        before = self.node.fresh_status().hash
        status, seconds, orphans = self.node.signal(signal.SIGTERM)
        self.report.count('node ended by SIGTERM')
        self.report.largest('longest end after SIGTERM, s', seconds)
        if status != 0 or seconds > LONGEST_END:
            self.report.problem('SIGTERM: exit status %s after %.1f s: %s' % (status, seconds, self.node.said()[-500:]))
        self.report.orphans(orphans)
        self.start_node(True, paused=True)
        if self.node.fresh_status().hash == before:
            self.report.count('state resumed bit for bit')
        else:
            self.report.problem('the state after SIGTERM and resume is another: ' + self.node.said()[-500:])
        self.actions.call('resume', Trigger)

    def kill_node(self):
        """SIGKILL while it measures; the next one must find a whole state, or none."""
        self.again(self.kill_node, KILL_PERIOD)
        self.actions.measure()
        _, _, orphans = self.node.signal(signal.SIGKILL)
        self.report.count('node killed by SIGKILL')
        self.report.orphans(orphans)
        had_state = os.path.exists(self.node.state_file)
        self.start_node(True)
        if had_state != ('resumed ' in self.node.said()):
            self.report.problem('resumed wrongly after SIGKILL: ' + self.node.said()[-500:])

    def start_node(self, resume, paused=False):
        self.clock.pause()
        self.tf.pause()
        self.node.start(resume, paused)

    def kill(self):
        """Leaves nothing behind, whatever has happened."""
        for part in self.node, self.rviz:
            if part and part.process:
                part.process.kill()

    def stop(self):
        status, seconds, orphans = self.node.signal(signal.SIGINT)
        self.report.orphans(orphans)
        if status != 0:
            self.report.problem('SIGINT: exit status %s after %.1f s' % (status, seconds))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('hours', type=float, help='above 0; 0.1 is enough for a look')
    parser.add_argument('--seed', type=int, default=1, help='of what is done')
    parser.add_argument('--picture', metavar='FILE', help='draw memory over time: .svg or .png')
    parser.add_argument('--no-rviz', action='store_true', help='without RViz, which takes most of the time of a processor')
    arguments = parser.parse_args()
    if not 0.0 < arguments.hours < 10000.0:
        parser.error('HOURS: above 0, below 10000')

    for number in signal.SIGINT, signal.SIGTERM:  # also where a shell has started it in the background
        signal.signal(number, signal.default_int_handler)
    folder = tempfile.mkdtemp(prefix='rigid_body_sim_soak_')
    os.environ['ROS_HOME'] = folder
    with Master(), contextlib.ExitStack() as stack:
        rospy.init_node('soak', disable_signals=True)
        screen = None if arguments.no_rviz else stack.enter_context(rviz_driver.Screen())
        soak = Soak(arguments, folder, screen, stack)
        try:
            soak.run()
        except KeyboardInterrupt:
            soak.report.problem('interrupted')
    report = soak.report
    print(report.table(soak.actions.counts, soak.clock, soak.tf))
    if arguments.picture:
        report.draw(arguments.picture)
    if report.problems:
        print('logs: ' + folder)
        return 1
    shutil.rmtree(folder)
    return 0


if __name__ == '__main__':
    sys.exit(main())
