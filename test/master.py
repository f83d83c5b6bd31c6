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
        for _ in range(3):  # somebody else may take the port in between
            with socket.socket() as free:
                free.bind(('localhost', 0))
                port = free.getsockname()[1]
            os.environ['ROS_MASTER_URI'] = 'http://localhost:%d' % port
            self.process = subprocess.Popen(['rosmaster', '--core', '-p', str(port)], stdout=subprocess.DEVNULL,
                                            stderr=subprocess.DEVNULL)
            while self.process.poll() is None:
                if self.answers():
                    return
                time.sleep(0.1)
        raise RuntimeError('rosmaster ended with %d' % self.process.returncode)

    @staticmethod
    def answers():
        try:
            return rospy.get_master().getPid()
        except OSError:
            return None

    def __exit__(self, *error):
        self.process.terminate()
        self.process.wait()
