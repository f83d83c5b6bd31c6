# SPDX-License-Identifier: BSD-3-Clause
"""A shell as a person has it, and a display for its windows."""
import os
import queue
import signal
import subprocess
import threading
import time


class Terminal:
    """Takes lines as they are typed. Environment and folder go on from line to line."""

    END = 'end of the answer to line'

    def __init__(self, environment, folder):
        self.shell = subprocess.Popen(['/bin/bash', '--noprofile', '--norc', '-O', 'expand_aliases'], cwd=folder,
                                      env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True, errors='replace', start_new_session=True)
        self.lines, self.seen = queue.Queue(), []
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.shell.stdout:
            self.lines.put(line)
        self.lines.put(None)

    def type(self, line):
        self.shell.stdin.write(line + '\n')
        self.shell.stdin.flush()

    def run(self, line, patience):
        """Exit status and what was printed; None for the status where it took longer than `patience` s."""
        self.type(line)
        self.type("printf '\\n%%s %%d\\n' '%s' $?" % self.END)
        printed, deadline = '', time.monotonic() + patience
        while True:
            try:
                text = self.lines.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                return None, printed
            if text is None:
                return None, printed
            if text.startswith(self.END):
                return int(text.split()[-1]), printed
            printed += text

    def output(self):
        """What a line that goes on running has printed so far."""
        while not self.lines.empty():
            self.seen.append(self.lines.get() or '')
        return ''.join(self.seen)

    def ends(self):
        return self.shell.poll() is not None

    def close(self, patience=60.0):
        """Ctrl-C; then harder."""
        for ending in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            self.signal_all(ending)
            try:
                self.shell.stdin.close()
            except OSError:
                pass
            try:
                self.shell.wait(patience)
                break
            except subprocess.TimeoutExpired:
                patience = 5.0
        self.shell.stdout.close()

    def signal_all(self, ending):
        try:
            os.killpg(self.shell.pid, ending)
        except ProcessLookupError:
            pass


class Display:
    """An X server of its own, on a free number."""

    def __init__(self):
        reading, writing = os.pipe()
        self.server = subprocess.Popen(['Xvfb', '-displayfd', str(writing), '-screen', '0', '1280x900x24', '-nolisten', 'tcp'],
                                       pass_fds=[writing], stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as pipe:
            self.name = ':' + pipe.readline().strip()

    def close(self):
        self.server.terminate()
        self.server.wait()
