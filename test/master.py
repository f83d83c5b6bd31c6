# SPDX-License-Identifier: BSD-3-Clause
"""A ROS master for a program that runs by hand what a rostest would run with one of its own."""
import os
import socket
import subprocess
import time

import rospy


class Master:
    """On a free port, as a context manager; this process and its children use it."""

    def __enter__(self):
        with socket.socket() as free:
            free.bind(('localhost', 0))
            port = free.getsockname()[1]
        os.environ['ROS_MASTER_URI'] = 'http://localhost:%d' % port
        self.process = subprocess.Popen(['roscore', '-p', str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not self.answers():
            if self.process.poll() is not None:
                raise RuntimeError('roscore ended with %d' % self.process.returncode)
            time.sleep(0.1)

    @staticmethod
    def answers():
        try:
            return rospy.get_master().getPid()
        except OSError:
            return None

    def __exit__(self, *error):
        self.process.terminate()
        self.process.wait()
