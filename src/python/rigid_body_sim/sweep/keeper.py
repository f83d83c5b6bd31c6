# SPDX-License-Identifier: BSD-3-Clause
"""A process beside each worker that ends the worker's programs, with their children, once the worker is gone: killed too, it
leaves nothing behind. It reads which process groups begin (+) and end (-), by keys, until no worker's end of the pipe is open.
A program announces its group itself, before it executes: were it for the worker to do, one killed in between would leave it.
"""
import functools
import itertools
import os
import subprocess
import sys

KEEPER = '''
import os, sys
groups = {}
for line in sys.stdin:
    key, *group = line[1:].split()
    if group:
        groups[key] = int(group[0])
    else:
        groups.pop(key, None)
for group in groups.values():
    try:
        os.killpg(group, 9)
    except OSError:
        pass
'''
KEYS = itertools.count()


@functools.lru_cache(maxsize=None)
def keeper():
    """Of this process. It is started at the first program."""
    return subprocess.Popen([sys.executable, '-ISc', KEEPER], stdin=subprocess.PIPE, bufsize=0, start_new_session=True)


class Kept:
    """A program that is to be kept: `begin` is called in its process, which leads a group, and `end` in the worker."""

    def __init__(self):
        self.key, self.pipe = next(KEYS), keeper().stdin.fileno()

    def begin(self):
        os.write(self.pipe, b'+%d %d\n' % (self.key, os.getpid()))

    def end(self):
        os.write(self.pipe, b'-%d\n' % self.key)
