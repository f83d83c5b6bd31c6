# SPDX-License-Identifier: BSD-3-Clause
"""Watches the stamps of a topic: they must never go back, and messages must never stop for long."""
import struct
import threading
import time

import rospy

# Where the stamp of the first message begins, in bytes.
CLOCK = 0  # Clock: secs, nsecs
TF = 8     # TFMessage: count, then the header of the first transform: seq, secs, nsecs


class Stream:
    def __init__(self, topic, offset):
        self.topic, self.offset = topic, offset
        self.lock = threading.Lock()
        self.longest = 0.0  # s of wall time without a message
        self.backward = 0   # stamps older than the one before
        self.messages = 0
        self.pause()
        self.subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self.hear, queue_size=1000)

    def pause(self):
        """What comes next is of another node, or after a time in which nobody sent."""
        with self.lock:
            self.last = self.heard = None

    def hear(self, message):
        if len(message._buff) < self.offset + 8:
            return
        stamp = struct.unpack_from('<II', message._buff, self.offset)
        now = time.monotonic()
        with self.lock:
            self.messages += 1
            if self.last is not None:
                self.longest = max(self.longest, now - self.heard)
                self.backward += stamp < self.last
            self.last, self.heard = stamp, now

    def silent_for(self):
        """Since the last message, s; 0 before the first one."""
        with self.lock:
            return 0.0 if self.heard is None else time.monotonic() - self.heard
