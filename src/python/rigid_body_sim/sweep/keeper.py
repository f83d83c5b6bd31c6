# SPDX-License-Identifier: BSD-3-Clause
"""A process beside each worker that ends the worker's programs, with their children, once the worker is gone: killed too, it
leaves nothing behind. It reads the process groups that begin (+) and end (-) until the worker's end of the pipe closes."""
import functools
import subprocess
import sys

KEEPER = '''
import os, sys
groups = set()
for line in sys.stdin:
    (groups.add if line[0] == '+' else groups.discard)(int(line[1:]))
for group in groups:
    try:
        os.killpg(group, 9)
    except OSError:
        pass
'''


@functools.lru_cache(maxsize=None)
def keeper():
    """Of this process. It is started at the first program."""
    return subprocess.Popen([sys.executable, '-ISc', KEEPER], stdin=subprocess.PIPE, bufsize=0, start_new_session=True)


def keep(group):
    keeper().stdin.write(b'+%d\n' % group)


def release(group):
    keeper().stdin.write(b'-%d\n' % group)
