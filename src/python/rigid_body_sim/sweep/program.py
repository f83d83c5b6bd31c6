# SPDX-License-Identifier: BSD-3-Clause
"""A run of a program: its command, its end, and what it leaves: exit status, standard output, the end of standard error.

No shell has a part in it: a word of the file is an argument, whatever it holds. The program leads a process group of its
own, of which nothing is left when the run is over.
"""
import json
import os
import re
import selectors
import shutil
import signal
import subprocess
import time

from . import keeper, outputs
from .tree import Refused

PLACEHOLDER = re.compile(r'\{([A-Za-z_]\w*)\}')
GIVEN = ('seed', 'number')  # placeholders that every run has a value for
NOT_STARTED = 127  # exit status, as a shell has it
READ_BYTES = 1 << 16
LONGEST_WAIT = 3600.0  # s: epoll takes no wait of any length
MOST_READ = 1 << 26  # bytes of standard output
MOST_KEPT = 1_000_000  # characters of it that are stored
ERROR_BYTES, ERROR_LINES = 4000, 10  # of the end of standard error


def package_programs():
    """The folder with the programs of this package, in the devel space as installed."""
    return os.path.normpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), '../../../../rigid_body_sim'))


def found(name, folder):
    """The path of a program: one with a '/' begins at the folder; else it is of this package or on the PATH."""
    if '/' in name:
        path = os.path.normpath(os.path.join(folder, name))
    else:
        path = os.path.join(package_programs(), name)
        path = path if os.path.exists(path) else shutil.which(name) or path
    if not os.path.isfile(path):
        raise Refused(f'there is no program {path}' + ('' if '/' in name else ', and none of this name on the PATH'))
    if not os.access(path, os.X_OK):
        raise Refused(f'{path} is not executable')
    return path


def argument_of(value):
    """A value as an argument: text as it is, all else as JSON has it."""
    return value if isinstance(value, str) else json.dumps(value)


def filled(word, values):
    """The arguments that a word makes: one; for a list that is all of the word, one for each entry."""
    whole = PLACEHOLDER.fullmatch(word)
    if whole and isinstance(values[whole.group(1)], list):
        return [argument_of(entry) for entry in values[whole.group(1)]]
    return [PLACEHOLDER.sub(lambda match: argument_of(values[match.group(1)]), word)]


def command_of(plan, number):
    """The program of a run and its arguments."""
    seed, parameters = plan.parameters(number)
    values = {**parameters, 'seed': seed, 'number': number}
    path, *words = plan.program['words']
    return [path, *(text for word in words for text in filled(word, values))]


class Pipe:
    """What a program has written, as far as it is kept."""

    def __init__(self, file, most):
        self.file, self.most, self.data, self.count = file, most, bytearray(), 0
        os.set_blocking(file.fileno(), False)

    def read(self):
        """Takes what is there. False where there is nothing now, or nothing any more."""
        data = self.file.read(READ_BYTES)
        self.count += len(data or b'')
        self.data += data or b''
        del self.data[:-self.most]
        return bool(data)

    def text(self):
        """HDF5 has no texts with NUL in them."""
        return self.data.decode(errors='replace').replace('\0', '\ufffd')


class Process:
    """A program that runs."""

    def __init__(self, command, folder):
        self.kept = keeper.Kept()
        try:
            self.popen = subprocess.Popen(command, bufsize=0, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                          stderr=subprocess.PIPE, start_new_session=True, preexec_fn=self.kept.begin)
        except BaseException:
            self.kept.end()
            raise
        self.output, self.errors = Pipe(self.popen.stdout, MOST_READ), Pipe(self.popen.stderr, ERROR_BYTES)
        self.cut, self.cpu_seconds = '', 0.0

    def run(self, seconds):
        """To its end, or until it has run for so long or printed too much: `cut` says which."""
        end, deadline = os.pidfd_open(self.popen.pid), time.monotonic() + seconds
        try:
            with selectors.DefaultSelector() as selector:
                selector.register(end, selectors.EVENT_READ)
                for pipe in (self.output, self.errors):
                    selector.register(pipe.file, selectors.EVENT_READ, pipe)
                self.cut = self.follow(selector, deadline)
        finally:
            os.close(end)
            self.close()

    def follow(self, selector, deadline):
        while True:
            ready = [key for key, _ in selector.select(min(max(0.0, deadline - time.monotonic()), LONGEST_WAIT))]
            for key in ready:
                if key.data and not key.data.read():
                    selector.unregister(key.fileobj)
            if any(key.data is None for key in ready):
                return ''
            if self.output.count > MOST_READ:
                return 'output'
            if time.monotonic() >= deadline:
                return 'time'

    def close(self):
        """Ends what is left of its group, and takes what was written last. The group cannot be another's before wait4."""
        os.killpg(self.popen.pid, signal.SIGKILL)
        self.kept.end()
        _, status, usage = os.wait4(self.popen.pid, 0)
        self.popen.returncode, self.cpu_seconds = os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime
        for pipe in (self.output, self.errors):
            while pipe.count <= MOST_READ and pipe.read():
                pass
            pipe.file.close()

    def verdict(self, seconds):
        """Status and detail of the run, without its metrics."""
        said = '\n'.join(self.errors.text().rstrip().splitlines()[-ERROR_LINES:])
        if self.cut == 'time':
            status, detail = 'overtime', f'it had not ended after {seconds:g} s'
        elif self.cut == 'output':
            status, detail = 'failed', f'it printed more than {MOST_READ >> 20} MiB'
        elif self.popen.returncode < 0:
            status, detail = 'failed', f'it was ended by signal {-self.popen.returncode}'
        elif self.popen.returncode > 0:
            status, detail = 'failed', f'exit status {self.popen.returncode}'
        else:
            return 'ok', ''
        return status, detail + (f': {said}' if said else '')


def run_task(plan, number):
    """Runs the program of a task. Returns its status, the detail, and what else its record holds."""
    begin = time.perf_counter()
    try:
        process = Process(command_of(plan, number), plan.program['folder'])
    except (OSError, ValueError) as error:  # such as an argument that is too long, or that has a NUL in it
        return 'refused', f'it does not start: {error}', {'exit_status': NOT_STARTED}
    process.run(plan.max_seconds)
    status, detail = process.verdict(plan.max_seconds)
    output = process.output.text()
    values, faults = outputs.measured(plan, output, plan.parameters(number)[1])
    if status == 'ok' and faults:  # one that failed need not say what it was asked for
        status, detail = 'failed', '; '.join(faults)
    return status, detail, {'exit_status': process.popen.returncode, 'output': output[:MOST_KEPT], 'values': values,
                            'seconds': time.perf_counter() - begin, 'cpu_seconds': process.cpu_seconds}
