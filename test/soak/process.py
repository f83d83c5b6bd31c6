# SPDX-License-Identifier: BSD-3-Clause
"""What the kernel says of a process."""
import collections
import os
import pathlib

Sample = collections.namedtuple('Sample', 'megabytes threads descriptors children zombies')
NOTHING = Sample(float('nan'), 0, 0, 0, 0)


def _status(pid):
    """The fields of /proc/PID/status, or {} when the process is gone."""
    try:
        lines = pathlib.Path('/proc/%d/status' % pid).read_text().splitlines()
    except OSError:
        return {}
    return dict(line.split(':\t', 1) for line in lines if ':\t' in line)


def children(pid):
    """The process ids of its children, zombies among them."""
    found = set()
    for task in pathlib.Path('/proc/%d/task' % pid).glob('*/children'):
        try:
            found.update(int(child) for child in task.read_text().split())
        except OSError:
            pass
    return found


def is_zombie(pid):
    return _status(pid).get('State', '').startswith('Z')


def is_alive(pid):
    return bool(_status(pid)) and not is_zombie(pid)


def sample(pid):
    """Resident memory in MB and counts; NOTHING when the process is gone."""
    status = _status(pid)
    if 'VmRSS' not in status:
        return NOTHING
    try:
        descriptors = len(os.listdir('/proc/%d/fd' % pid))
    except OSError:
        return NOTHING
    family = children(pid)
    return Sample(int(status['VmRSS'].split()[0]) / 1024, int(status['Threads']), descriptors, len(family),
                  sum(is_zombie(child) for child in family))
