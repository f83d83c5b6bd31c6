# SPDX-License-Identifier: BSD-3-Clause
"""The simulator and RViz as processes that are killed and started again."""
import contextlib
import os
import subprocess
import time

import rospy
import roslib.packages
import rviz_driver
from rigid_body_sim.msg import Status

import process

PATIENCE = 60.0  # s, for a node to start


class Node:
    """simulator_node, with its state kept in `folder`."""

    def __init__(self, folder):
        self.folder = folder
        self.state_file = folder + '/state.yaml'
        self.program = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]
        self.status = None
        self.lives = 0
        self.process = None
        rospy.Subscriber('/sim/status', Status, self._hear)

    def _hear(self, status):
        self.status = status

    def start(self, resume, paused=False):
        self.lives += 1
        self.status = None
        self.log = '%s/node_%d.log' % (self.folder, self.lives)
        with open(self.log, 'w') as log:
            self.process = subprocess.Popen(
                [self.program, '__name:=sim', '_state_file:=' + self.state_file, '_resume:=%s' % resume,
                 '_paused:=%s' % paused],
                env=dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED='1'), stdout=log, stderr=subprocess.STDOUT)
        rviz_driver.wait_until(lambda: self.status or self.process.poll() is not None, 'the simulator is there', PATIENCE)

    def fresh_status(self):
        """One that was made after this call: the second from now on."""
        for _ in range(2):
            self.status = None
            rviz_driver.wait_until(lambda: self.status, 'the simulator says how it is', PATIENCE)
        return self.status

    def signal(self, number):
        """Sends a signal and waits for the end: exit status, seconds, and its children that outlived it."""
        children = process.children(self.process.pid)
        began = time.monotonic()
        self.process.send_signal(number)
        status = self.process.wait(120)
        seconds = time.monotonic() - began
        time.sleep(2.0)  # for the children to notice
        return status, seconds, [child for child in children if process.is_alive(child)]

    def said(self):
        with open(self.log, errors='replace') as log:
            return log.read()


class Rviz:
    """The RViz of the demo, on a screen of its own."""

    def __init__(self, screen, layout):
        self.screen, self.layout = screen, layout
        self.window = self.process = None

    def start(self):
        """In three attempts: on a busy machine a window may not be there yet where one looks for it."""
        for attempt in range(3):
            self.window = rviz_driver.Rviz(self.screen, self.layout)
            try:
                self.window.__enter__()
                self.process = self.window.process
                return
            except (subprocess.CalledProcessError, RuntimeError, TimeoutError):
                self.window.process.kill()
                if attempt == 2:
                    raise

    def kill(self):
        self.process.kill()
        with contextlib.suppress(FileNotFoundError):  # of its layout, where it has died before
            self.window.__exit__()
