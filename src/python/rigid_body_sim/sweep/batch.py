# SPDX-License-Identifier: BSD-3-Clause
"""Engines that take all chunks at once: a Slurm job array, or GNU parallel over ssh. Their workers see the folder of the
sweep, run `sweep --work FOLDER ROUND CHUNK` and store what they have done in it.
"""
import functools
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

from .carry import Progress, carry_live
from .engines import Processes, end_with_parent
from .plan import Plan
from .program import package_programs
from .run import build_of_physics, check_builds
from .store import AGAIN, Store, write_whole
from .tree import Refused

LEAST_POLL_SECONDS, MOST_POLL_SECONDS = 1.0, 30.0
PATIENCE_SECONDS = 600.0  # that a scheduler may be away
USUAL_ELEMENTS = 1001  # where Slurm does not say how many an array may have
TIME_MARGIN = 3.0  # over the measured time of the runs, for slower machines
LEAST_MINUTES = 10


def needed(program, package):
    if not shutil.which(program):
        raise Refused(f'there is no {program} (Debian: {package})')


def spans(numbers):
    """Numbers in their order as [first, count] of those that follow each other."""
    found = []
    for number in numbers:
        if found and number == sum(found[-1]):
            found[-1][1] += 1
        else:
            found.append([number, 1])
    return found


def write_round(store, name, chunks):
    os.makedirs(store.path('rounds'), exist_ok=True)
    os.makedirs(store.path('logs'), exist_ok=True)
    text = json.dumps({'build': build_of_physics(), 'chunks': [spans(numbers) for numbers in chunks]})
    write_whole(store.path('rounds', name + '.json'), lambda file: file.write(text.encode()))


def work(folder, name, which):
    """What a worker does: the runs of a chunk. It stores them as it goes, survives a run that ends its process, and goes on
    where it was when it is started again."""
    store = Store(folder)
    with open(store.path('rounds', name + '.json'), encoding='utf-8') as file:
        described = json.load(file)
    check_builds([described['build']], f'round {name} was written by')
    numbers = [first + k for first, count in described['chunks'][which] for k in range(count)]
    known = store.status(store.parts_beginning_in(set(numbers)))
    numbers = [number for number in numbers if known.get(number, AGAIN[0]) in AGAIN]
    engine = Processes(1)
    try:
        carry_live(Plan.from_text(store.plan_text()), numbers, engine, store, Progress(len(numbers)))
    finally:
        engine.close()


def pause(begin):
    """Between two looks at a scheduler and at the folder: rarer, the longer the work takes."""
    time.sleep(min(MOST_POLL_SECONDS, max(LEAST_POLL_SECONDS, (time.monotonic() - begin) / 50)))


def worker_command():
    """How a worker is started on any machine that sees the same files."""
    package = os.path.dirname(os.path.dirname(os.path.abspath(sys.modules['rigid_body_sim'].__file__)))
    paths = ':'.join(dict.fromkeys([package, *filter(None, os.environ.get('PYTHONPATH', '').split(':'))]))
    program = os.path.join(package_programs(), 'sweep')
    return f'env PYTHONPATH={shlex.quote(paths)} {shlex.quote(sys.executable)} {shlex.quote(program)} --work'


def check_hosts(file):
    """Without a host GNU parallel would make all runs on this machine; one of no jobs makes none."""
    with open(file, encoding='utf-8', errors='replace') as text:
        lines = ['' if line.lstrip().startswith('#') else line.strip() for line in text]
    if not any(lines):
        raise Refused(f"{file} names no host (allowed: one a line; ':' is this machine)")
    for number, line in enumerate(lines, 1):
        if any(re.match(r'(@[^/]*/)?0+/', host.strip()) for host in line.split(',')):
            raise Refused(f'{file}:{number}: {line} (allowed: 1 job or more on a host)')


class Parallel:
    """GNU parallel: the hosts of a file, one a line, as its --sshloginfile takes them; ':' is this machine."""

    name = 'GNU parallel'

    def __init__(self, hosts):
        needed('parallel', 'parallel')
        if not os.path.isfile(hosts):
            raise Refused(f'there is no file {hosts} of hosts')
        check_hosts(hosts)
        self.hosts, self.process = os.path.abspath(hosts), None

    @staticmethod
    def pieces(seconds):
        """Jobs of 5 s where there are few, so that all hosts have one; of a minute where there are many."""
        return max(1, round(seconds / 60), min(200, round(seconds / 5)))

    def command(self, *options):
        return ['parallel', '--will-cite', '--plain', '--sshloginfile', self.hosts, *options]

    def begin(self, store):
        """Every host must see the folder."""
        plan = shlex.quote(store.path('plan.json'))
        done = subprocess.run(self.command('--nonall', '--tag', f'test -r {plan} || echo does not see {plan}'), text=True,
                              capture_output=True, check=False, stdin=subprocess.DEVNULL)
        said = (done.stdout + done.stderr).strip()
        if done.returncode or said:
            raise Refused(f'a host of {self.hosts} cannot work: {said or done.returncode}')

    def run(self, store, name, chunks, seconds, report):
        write_round(store, name, chunks)
        template = f'{worker_command()} {shlex.quote(store.folder)} {name} {{}}'
        with open(store.path('logs', name + '.log'), 'ab') as log:
            self.process = subprocess.Popen(
                self.command('--joblog', store.path('logs', name + '.jobs'), '--retries', '2', template), stdin=subprocess.PIPE,
                stdout=log, stderr=log, start_new_session=True, preexec_fn=functools.partial(end_with_parent, signal.SIGTERM))
            begin = time.monotonic()
            try:
                self.process.stdin.write('\n'.join(map(str, range(len(chunks)))).encode())
                self.process.stdin.close()
                while self.process.poll() is None:
                    report()
                    pause(begin)
            finally:
                self.stop()

    def stop(self):
        """GNU parallel waits for its jobs at the first signal and ends them at the second."""
        for _ in range(2):
            if self.process.poll() is None:
                self.process.send_signal(signal.SIGTERM)
                time.sleep(0.2)
        self.process.wait()

    def farewell(self):
        return ''


class Slurm:
    """A job array of a partition. What sbatch needs besides comes with its variables, such as SBATCH_ACCOUNT."""

    name = 'Slurm'

    def __init__(self, partition):
        for program in ('sbatch', 'squeue', 'scontrol'):
            needed(program, 'slurm-client')
        if not re.fullmatch(r'[\w.,-]+', partition):
            raise Refused(f'{partition!r} is no name of a partition')
        self.partition, self.jobs = partition, []
        shown = self.ask('scontrol', 'show', 'partition', *([partition] if ',' not in partition else []))
        if shown.returncode:
            raise Refused(f'Slurm: {(shown.stdout + shown.stderr).strip()}')
        most = re.search(r'MaxArraySize\s*=\s*(\d+)', self.ask('scontrol', 'show', 'config').stdout)
        self.most = int(most.group(1)) if most else USUAL_ELEMENTS

    def pieces(self, seconds):
        """Elements of the array: of 20 s at least, and as many as Slurm takes at most."""
        return max(1, min(self.most, round(seconds / 20)))

    @staticmethod
    def ask(*command, **options):
        return subprocess.run(command, text=True, capture_output=True, check=False, stdin=subprocess.DEVNULL, **options)

    def begin(self, store):
        """Jobs of a sweep that was left are waited for: they go on storing runs."""
        if set('"\\\n') & set(store.folder):
            raise Refused(f'Slurm takes no folder with ", \\ or a line break in its name: {store.folder!r}')
        try:
            with open(store.path('jobs.json'), encoding='utf-8') as file:
                self.jobs = json.load(file)
        except OSError:
            self.jobs = []
        if self.jobs:
            print(f'waiting for job {", ".join(self.jobs)}, which was submitted before')
            self.wait(lambda: None)

    def run(self, store, name, chunks, seconds, report):
        write_round(store, name, chunks)
        minutes = round(max(LEAST_MINUTES, TIME_MARGIN * seconds / 60) + Plan.from_text(store.plan_text()).max_seconds / 60)
        script = store.path('rounds', name + '.sbatch')
        log = store.path('logs', name).replace('%', '%%') + '-%a.log'  # a pattern, in which % begins a field
        text = '\n'.join((
            '#!/bin/bash', f'#SBATCH --partition={self.partition}', f'#SBATCH --array=0-{len(chunks) - 1}',
            '#SBATCH --job-name=sweep', '#SBATCH --ntasks=1', '#SBATCH --cpus-per-task=1', '#SBATCH --requeue',
            '#SBATCH --open-mode=append', f'#SBATCH --time={minutes}', f'#SBATCH --output="{log}"',
            f'exec {worker_command()} {shlex.quote(store.folder)} {name} $SLURM_ARRAY_TASK_ID', ''))
        write_whole(script, lambda file: file.write(text.encode()))
        done = self.ask('sbatch', '--parsable', script)
        if done.returncode:
            raise Refused(f'sbatch refuses {script}: {done.stderr.strip()}')
        self.jobs = [done.stdout.strip().split(';')[0]]
        write_whole(store.path('jobs.json'), lambda file: file.write(json.dumps(self.jobs).encode()))
        self.wait(report)
        os.unlink(store.path('jobs.json'))

    def wait(self, report):
        """Until the queue holds none of the jobs. A controller that does not answer is waited for."""
        begin = answered = time.monotonic()
        while True:
            report()
            done = self.ask('squeue', '--noheader', '--format=%i', '--jobs=' + ','.join(self.jobs))
            gone = done.returncode and 'Invalid job id' in done.stderr
            if gone or (done.returncode == 0 and not done.stdout.strip()):
                self.jobs = []
                return
            if done.returncode == 0:
                answered = time.monotonic()
            elif time.monotonic() - answered > PATIENCE_SECONDS:
                raise Refused(f'Slurm has not answered for {PATIENCE_SECONDS:g} s: {done.stderr.strip()}')
            pause(begin)

    def farewell(self):
        """What somebody who leaves should know."""
        if not self.jobs:
            return ''
        return f'Job {self.jobs[0]} goes on: --resume collects it, `scancel {self.jobs[0]}` ends it.'
