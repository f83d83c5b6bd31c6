#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Random calls of every service of a simulator, many of them hostile.

The node must answer each call, leave its state as it is, hash for hash, with each refusal, say nothing that is not
finite, and end in good order. What it did is recorded, and must run again to the same hashes. The same count and seed give
the same calls.
"""
import argparse
import collections
import math
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
from xmlrpc.client import ServerProxy

import rosgraph
import roslib.packages
import rosnode
import rospy

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[depth]) for depth in (0, 1)]
from hostile_requests import Requests  # noqa: E402
from master import Master  # noqa: E402
from service_link import Died, Hung, ServiceLink, zeros  # noqa: E402

# How often a service is called, where that is not 1: those that start another program or read large files.
SHARES = {'measure_accuracy': 0.02, 'seek_accuracy': 0.05, 'apply_accuracy': 0.05, 'show_ghost': 0.05, 'load_scene': 0.2,
          'load_state': 0.3, 'save_scene': 0.3, 'save_state': 0.3, 'list_scenes': 0.1, 'clear': 0.2}
MOST_BODIES = 30
LONGEST_MESSAGE = 20000  # letters
LARGEST_LOG = 20000000   # bytes
REPLACEMENT = '\ufffd'    # of bytes that are no UTF-8
PROGRESS_PERIOD = 10.0   # s
CLOSING = 30.0           # s that the recorder may take to close its bag, of which its command does not wait for the end


class Failure(Exception):
    pass


class Node:
    """simulator_node, paused, with all its files in `folder`, as a context manager."""

    def __init__(self, folder):
        self.log = os.path.join(folder, 'node.log')
        program = roslib.packages.find_node('rigid_body_sim', 'simulator_node')[0]
        with open(self.log, 'a') as log:
            self.process = subprocess.Popen(
                [program, '__name:=sim', '_paused:=true', '_scene:=shapes', '_state_file:=%s/kept.yaml' % folder],
                stdout=log, stderr=subprocess.STDOUT)

    def __enter__(self):
        rospy.wait_for_service('/sim/list_bodies', 120)
        return self

    def __exit__(self, *error):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()

    def end(self):
        """Its exit status after SIGINT: that of a sanitizer where it has found something."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(120)

    def forget_log(self):
        """The node tells every edit: gigabytes in a million."""
        if os.path.getsize(self.log) > LARGEST_LOG:
            os.truncate(self.log, 0)

    def said(self):
        with open(self.log, errors='replace') as log:
            return log.read()[-LONGEST_MESSAGE:]


class Recording:
    """A bag of what changes the simulator, as a context manager."""
    TOPICS = {'/sim/commands', '/sim/status'}

    def __init__(self, folder):
        self.bag = os.path.join(folder, 'calls.bag')

    def __enter__(self):
        self.recorder = subprocess.Popen(['rosbag', 'record', '--quiet', '--output-name', self.bag, *self.TOPICS],
                                         stdout=subprocess.DEVNULL)
        simulator = ServerProxy(rosnode.get_api_uri(rosgraph.Master('/service_fuzz'), '/sim'))
        while {connection[4] for connection in simulator.getBusInfo('/service_fuzz')[2]} < self.TOPICS:
            time.sleep(0.1)
        return self

    def __exit__(self, *error):
        self.recorder.send_signal(signal.SIGINT)
        self.recorder.wait()
        end = time.monotonic() + CLOSING
        while not os.path.exists(self.bag) and time.monotonic() < end:
            time.sleep(0.1)

    def check(self):
        """Raises Failure unless it runs again to the same hashes."""
        program = roslib.packages.find_node('rigid_body_sim', 'resimulate')[0]
        done = subprocess.run([program, self.bag], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode != 0:
            raise Failure('the recording does not run again: ' + done.stdout)


def make_hostile_files(folder):
    """What the requests find: links, a folder with the name of a file, broken meshes and scenes."""
    os.makedirs(os.path.join(folder, 'dir.yaml'))
    os.symlink('link.yaml', os.path.join(folder, 'link.yaml'))
    contents = {
        'c.stl': b'solid x\nfacet normal nan nan nan\nouter loop\nvertex 1e999 0 0\n',
        'b.yaml': b'bodies: [' * 2000,
        'g.obj': b'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 999999999\n',
        'a': bytes(range(256))
    }
    for name, content in contents.items():
        with open(os.path.join(folder, name), 'wb') as file:
            file.write(content)


def not_finite(value, slot='answer'):
    """The name of a number in an answer that is not finite; None where all are."""
    if isinstance(value, float):
        return None if math.isfinite(value) else slot
    if isinstance(value, (list, tuple)):
        return next(filter(None, (not_finite(element, slot) for element in value)), None)
    names = getattr(value, '__slots__', [])
    return next(filter(None, (not_finite(getattr(value, name), name) for name in names)), None)


class ServiceFuzz:
    def __init__(self, seed, folder):
        self.random = random.Random(seed)
        make_hostile_files(folder)
        self.requests = Requests(self.random, folder)
        services = [name for name, nodes in rospy.get_master().getSystemState()[2][2] if '/sim' in nodes]
        links = [ServiceLink(name) for name in sorted(services)]
        self.links = {link.name.split('/')[-1]: link for link in links if not link.type._type.startswith('roscpp/')}
        self.shares = [SHARES.get(name, 1.0) for name in self.links]
        self.called, self.outcomes = collections.Counter(), collections.Counter()
        self.read_state()

    def plain(self, service):
        """The answer to a request with all fields zero."""
        link = self.links[service]
        return link.call(zeros(link.type._request_class))[1]

    def read_state(self):
        answer = self.plain('list_bodies')
        self.state = answer.hash
        self.requests.names = [name.encode() for name in answer.names]

    def call(self):
        """One random call, of each service at first. Raises Failure where the node does not do as it must."""
        untried = [name for name in self.links if not self.called[name]]
        name = untried[0] if untried else self.random.choices(list(self.links), self.shares)[0]
        link = self.links[name]
        request = self.requests.request(link.type._request_class)
        self.called[name] += 1
        try:
            self.judge(*link.call(request))
        except (Failure, Died, Hung) as error:
            raise Failure('call %d, %s: %s; request %s' % (
                sum(self.called.values()), name, error, request.hex()[:2000]))

    def judge(self, read, answer):
        if read and answer.success:
            self.outcomes['done'] += 1
            return self.judge_done(answer)
        self.outcomes['refused' if read else 'unreadable'] += 1
        if read and not 0 < len(answer.message) < LONGEST_MESSAGE:
            raise Failure('refused with %d letters' % len(answer.message))
        if read and REPLACEMENT in answer.message:
            raise Failure('the message is not UTF-8: ' + answer.message)
        before = self.state
        self.read_state()
        if self.state != before:
            raise Failure('the state has changed with the refusal "%s"' % (answer.message if read else ''))

    def judge_done(self, answer):
        if not_finite(answer):
            raise Failure('%s is not finite' % not_finite(answer))
        self.plain('pause')
        self.read_state()
        if len(self.requests.names) > MOST_BODIES:
            self.plain('clear')
            self.read_state()


def run(count, seed, folder, progress=lambda fuzz: None):
    """Starts a node and calls it `count` times; returns the ServiceFuzz. Raises Failure with what the node has said."""
    with Node(folder) as node:
        try:
            with Recording(folder) as recording:
                fuzz = ServiceFuzz(seed, folder)
                for _ in range(count):
                    fuzz.call()
                    node.forget_log()
                    progress(fuzz)
            recording.check()
            status = node.end()
            if status != 0:
                raise Failure('the node ended with %d' % status)
        except Failure as error:
            raise Failure('seed %d, %s\nthe node:\n%s' % (seed, error, node.said()))
    return fuzz


def summary(fuzz, seconds):
    return '%d calls of %d services in %.0f s: %s' % (
        sum(fuzz.called.values()), len(fuzz.links), seconds,
        ', '.join('%d %s' % (fuzz.outcomes[what], what) for what in ('done', 'refused', 'unreadable')))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('count', type=int, help='of calls')
    parser.add_argument('--seed', type=int, default=1)
    arguments = parser.parse_args()
    began = told = time.monotonic()

    def progress(fuzz):
        nonlocal told
        if time.monotonic() - told > PROGRESS_PERIOD:
            told = time.monotonic()
            print(summary(fuzz, told - began), flush=True)

    with tempfile.TemporaryDirectory(prefix='rigid_body_sim_fuzz_') as folder:
        os.environ['ROS_HOME'] = folder
        try:
            with Master():
                fuzz = run(arguments.count, arguments.seed, folder, progress)
        except Failure as failure:
            print(failure)
            return 1
    print(summary(fuzz, time.monotonic() - began))
    return 0


if __name__ == '__main__':
    sys.exit(main())
