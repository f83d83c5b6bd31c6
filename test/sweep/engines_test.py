#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The same sweep by every engine, and what goes wrong on the way: equal results, nothing lost, nothing counted twice."""
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest
from unittest import mock

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import slurm_cluster  # noqa: E402
from rigid_body_sim.sweep import batch, carry, command, engines  # noqa: E402
from rigid_body_sim.sweep.run import record_of  # noqa: E402
from rigid_body_sim.sweep.store import Store  # noqa: E402
from rigid_body_sim.sweep.tree import Refused  # noqa: E402
from sweep_file import PATIENCE, PROGRAM, ROOT, SweepCase  # noqa: E402

BALLS = '''
scene: ball_hits_wall
duration: 1
repeats: 20
vary:
  bodies[ball].restitution: {range: [0, 1], count: 5}
  bodies[ball].velocity[0]: {normal: [4, 0.5]}
measure: {end: {final_position: ball}, deepest: penetration}
'''
# Something happens in some runs, known by their friction. `mark` is a file by which runs of several processes agree.
TRAPS = '''
import os, pathlib, sys, threading, time
HERE = pathlib.Path(__file__).parent

def once(name):
    try:
        (HERE / name).touch(exist_ok=False)
        return True
    except FileExistsError:
        return False

def value(world, parameters):
    k = round(parameters['bodies[ball].friction'])
    if k == 3:
        os.kill(os.getpid(), 9)
    if k == 5:
        while True:
            pass
    if k == 6:
        raise ArithmeticError('six')
    if k == 7:
        return 'seven'
    if k == 8 and once('killed'):
        os.kill(os.getpid(), 9)
    return k

def end_amid_sending(thread):
    while 'send' not in sys._current_frames()[thread].f_code.co_name:
        pass
    os.kill(os.getpid(), 9)

def amid(world, parameters):
    if round(parameters['bodies[ball].friction']) > 1:
        return [0.0]
    threading.Thread(target=end_amid_sending, args=[threading.get_ident()], daemon=True).start()
    return [0.0] * 4_000_000

def slowly(world, parameters):
    time.sleep(0.05)
    return 1
'''


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


class Scheduler:
    """A Dask scheduler and workers on loopback, as an administrator starts them."""

    def __init__(self, folder, environment=None):
        self.folder, self.port, self.environment = folder, free_port(), environment
        self.address = 'tcp://127.0.0.1:%d' % self.port
        self.processes = []

    def launch(self, *arguments):
        with open(self.folder / 'dask.log', 'ab') as log:
            process = subprocess.Popen(['/usr/bin/python3', '-m', 'distributed.cli.%s' % arguments[0], *arguments[1:]], stdout=log,
                                       env=self.environment, stderr=log, stdin=subprocess.DEVNULL, cwd=self.folder, start_new_session=True)
        self.processes.append(process)
        return process

    def start(self):
        self.scheduler = self.launch('dask_scheduler', '--host', '127.0.0.1', '--port', str(self.port), '--no-dashboard')
        self.workers()

    def workers(self):
        self.launch('dask_worker', self.address, '--host', '127.0.0.1', '--nworkers', '2', '--nthreads', '1', '--no-dashboard')

    def stop(self):
        for process in self.processes:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
        self.processes = []


class EnginesTest(SweepCase):
    def setUp(self):
        super().setUp()
        self.write(BALLS)

    def one_process(self):
        """The hashes that every engine has to give."""
        self.sound('--workers', '1', '--output', self.folder / 'one')
        return self.hashes('one')

    def test_two_processes_give_what_one_gives(self):
        one = self.one_process()
        self.assertEqual(len(one), 100)
        self.assertGreater(len(set(one.values())), 90)
        self.sound('--workers', '2')
        self.assertEqual(self.hashes(), one)
        for metric in ('end', 'deepest'):
            self.assertEqual(self.results()['metrics/' + metric].tolist(), self.results('one')['metrics/' + metric].tolist())

    def test_a_scheduler_of_dask_gives_what_one_process_gives(self):
        scheduler = Scheduler(self.folder)
        self.addCleanup(scheduler.stop)
        scheduler.start()
        done = self.when_there(scheduler)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.hashes(), self.one_process())

    def when_there(self, scheduler):
        """A sweep on a scheduler, as soon as that has workers."""
        for _ in range(120):
            done = self.sweep('--dask', scheduler.address)
            if 'has no workers' not in done.stderr and 'no Dask scheduler' not in done.stderr:
                break
            time.sleep(0.5)
        return done

    def test_workers_of_dask_without_our_module_are_told(self):
        environment = {name: value for name, value in os.environ.items() if name != 'PYTHONPATH'}
        scheduler = Scheduler(self.folder, environment)
        self.addCleanup(scheduler.stop)
        scheduler.start()
        done = self.when_there(scheduler)
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot run a chunk: ModuleNotFoundError: No module named 'rigid_body_sim'", done.stderr)

    def test_gnu_parallel_gives_what_one_process_gives(self):
        if not shutil.which('parallel'):
            self.skipTest('GNU parallel is not installed (Debian: parallel)')
        hosts = self.write('2/:\n', 'hosts')
        self.sound('--hosts', hosts)
        self.assertEqual(self.hashes(), self.one_process())

    @unittest.skipUnless(shutil.which('parallel'), 'there is no GNU parallel')
    def test_nothing_is_left_of_a_sweep_by_gnu_parallel_that_is_killed(self):
        self.write('import time\ndef f(world, parameters):\n    time.sleep(0.2)\n    return 1\n', 'f.py')
        self.write('scene: ball_hits_wall\nsteps: 1\nrepeats: 300\nmeasure: {f: {python: f.py:f}}\n')
        self.write(':\n', 'hosts')

        def left():
            return subprocess.run(['pgrep', '-f', '--', f'--work {self.folder}'], capture_output=True, text=True, check=False).stdout

        process = subprocess.Popen(self.command('--hosts', self.folder / 'hosts'), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not left() and process.poll() is None:
            time.sleep(0.01)
        self.assertTrue(left())
        process.kill()
        process.wait()
        deadline = time.monotonic() + 40
        while left() and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertEqual(left(), '')

    def test_a_host_that_does_not_answer_is_named_before(self):
        if not shutil.which('parallel'):
            self.skipTest('GNU parallel is not installed (Debian: parallel)')
        for text, said in (('', 'names no host'), ('# none\n\n', 'names no host'), (':\n0/:\n', 'hosts:2: 0/:')):
            done = self.sweep('--hosts', self.write(text, 'hosts'))
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(said, done.stderr)
            self.assertEqual(self.parts(), [])
        hosts = self.write('ssh -o BatchMode=yes -p 1 127.0.0.1\n', 'hosts')
        done = self.sweep('--hosts', hosts)
        self.assertEqual(done.returncode, 2)
        self.assertIn('cannot work', done.stderr)

    def test_without_an_engine_its_package_is_named(self):
        (self.folder / 'distributed.py').write_text('raise ImportError("none")\n')
        environment = dict(os.environ, PYTHONPATH='%s:%s' % (self.folder, os.environ.get('PYTHONPATH', '')))
        done = self.sweep('--dask', 'tcp://127.0.0.1:1', env=environment)
        self.assertEqual(done.returncode, 2)
        self.assertIn('there is no Dask (Debian: python3-distributed)', done.stderr)
        nothing = dict(os.environ, PATH='/nowhere')
        for option, package in ((('--slurm', 'test'), 'slurm-client'), (('--hosts', 'hosts'), 'parallel')):
            done = self.sweep(*option, '--output', self.folder / package, env=nothing)
            self.assertEqual(done.returncode, 2)
            self.assertIn('(Debian: %s)' % package, done.stderr)


    def test_a_scheduler_of_dask_that_is_restarted_loses_nothing(self):
        self.write(TRAPS, 'traps.py')
        self.write(BALLS.replace('measure: {', 'measure: {slow: {python: "traps.py:slowly"}, '))
        scheduler = Scheduler(self.folder)
        self.addCleanup(scheduler.stop)
        scheduler.start()
        process = None
        while process is None or (process.poll() is not None and process.returncode == 2):
            if process:
                process.communicate()
            shutil.rmtree(self.folder / 's.sweep', ignore_errors=True)
            process = subprocess.Popen(self.command('--dask', scheduler.address), text=True, stdout=subprocess.PIPE,
                                       stderr=subprocess.STDOUT)
            while not self.parts() and process.poll() is None:
                time.sleep(0.05)
        scheduler.stop()
        time.sleep(1)
        scheduler.start()
        said, _ = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(self.hashes(), self.one_process())


class SlurmTest(SweepCase):
    @classmethod
    def setUpClass(cls):
        if slurm_cluster.why_not():
            raise unittest.SkipTest(slurm_cluster.why_not())

    def setUp(self):
        super().setUp()
        self.write(BALLS)
        self.cluster = slurm_cluster.Cluster(self.folder / 'slurm')
        self.addCleanup(self.cluster.stop)
        self.cluster.start()

    def test_a_job_array_gives_what_one_process_gives(self):
        self.sound('--workers', '1', '--output', self.folder / 'one')
        self.sound('--slurm', 'test', env=self.cluster.environment)
        self.assertEqual(self.hashes(), self.hashes('one'))
        done = self.sweep('--slurm', 'nowhere', '--output', self.folder / 'two', env=self.cluster.environment)
        self.assertEqual(done.returncode, 2)
        self.assertIn('nowhere', done.stderr)

    def test_a_folder_may_have_any_name_that_slurm_takes(self):
        self.sound('--workers', '1', '--output', self.folder / 'one')
        self.sound('--slurm', 'test', '--output', self.folder / "50%A it's ö", env=self.cluster.environment)
        self.assertEqual(self.hashes("50%A it's ö"), self.hashes('one'))
        done = self.sweep('--slurm', 'test', '--output', self.folder / 'ba\\ck', env=self.cluster.environment)
        self.assertEqual(done.returncode, 2)
        self.assertIn('Slurm takes no folder', done.stderr)

    def test_a_restarted_controller_and_a_cancelled_job_lose_nothing(self):
        self.write(TRAPS, 'traps.py')
        self.write(BALLS.replace('measure: {', 'measure: {slow: {python: "traps.py:slowly"}, '))
        process = subprocess.Popen(self.command('--slurm', 'test'), text=True, env=self.cluster.environment, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT)
        while not self.cluster.ask('squeue', '--noheader', '--states=RUNNING').strip() and process.poll() is None:
            time.sleep(0.1)
        self.cluster.restart_controller()
        self.cluster.ask('scancel', '--user=root')
        said, _ = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, said)
        self.assertIn('go out again', said)
        self.assertEqual(len(self.hashes()), 100)

    def test_who_leaves_finds_the_job_again(self):
        self.write(TRAPS, 'traps.py')
        self.write(BALLS.replace('measure: {', 'measure: {slow: {python: "traps.py:slowly"}, '))
        code, said = self.interrupted(lambda: len(self.parts()) > 1, '--slurm', 'test', env=self.cluster.environment)
        self.assertEqual(code, 130, said)
        job = re.search(r'Job (\d+) goes on: --resume collects it, `scancel \1` ends it', said)
        self.assertTrue(job, said)
        said = self.sound('--resume', '--slurm', 'test', env=self.cluster.environment)
        self.assertIn('waiting for job %s, which was submitted before' % job.group(1), said)
        self.assertEqual(sum(int(part.name.split('-')[2]) for part in self.parts()), 100)  # none was made twice
        self.assertEqual(len(self.hashes()), 100)


class TroubleTest(SweepCase):
    """Runs that go wrong, and sweeps that are cut off."""

    def check_traps(self, *arguments):
        self.write(TRAPS, 'traps.py')
        self.write('''
scene: ball_hits_wall
steps: 10
max_seconds: 1
repeats: 4
vary: {"bodies[ball].friction": {range: [0, 9], count: 10}}
measure: {k: {python: "traps.py:value"}}
''')
        done = self.sweep(*arguments)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        table = self.results()
        wanted = {3: 'crashed', 5: 'overtime', 6: 'failed', 7: 'failed'}
        self.assertEqual(table['number'].tolist(), list(range(40)))
        self.assertEqual(table['status'].tolist(), [wanted.get(k, 'ok') for k in range(10) for _ in range(4)])
        sound = [k for k in range(40) if k // 4 not in wanted]
        self.assertEqual(table['metrics/k'][sound].tolist(), [k // 4 for k in sound])
        self.assertIn('measure.k: ArithmeticError: six (traps.py, line 20)', table['detail'][24])
        self.assertIn('again: rosrun rigid_body_sim sweep %s --only 12' % (self.folder / 's.yaml'), done.stdout)
        self.assertTrue((self.folder / 'killed').exists())

    def test_runs_that_end_their_worker_cost_no_other_by_one_process(self):
        self.check_traps('--workers', '1')

    def processes(self, metric, *chunks):
        """Two processes that have got these chunks of a plan of 40 runs, and what has ended of them by and by."""
        self.write(TRAPS, 'traps.py')
        file = self.write('''
scene: ball_hits_wall
steps: 10
repeats: 10
vary: {"bodies[ball].friction": {range: [1, 4], count: 4}}
measure: {k: {python: "traps.py:%s"}}
''' % metric)
        text = command.read_plan(str(file), ROOT).text()
        engine = engines.Processes(2)
        self.addCleanup(engine.close)
        for numbers in chunks:
            engine.submit(text, numbers)
        while engine.running:
            for numbers, records, why in engine.wait():
                yield numbers, records is not None, why

    def test_a_run_that_ends_its_process_is_to_blame_and_no_other(self):
        ended = {tuple(numbers): rest for numbers, *rest in self.processes('value', [20], [0], [10], [30])}
        self.assertEqual(ended, {(20, ): [False, 'its process ended'], (0, ): [True, ''], (10, ): [True, ''], (30, ): [True, '']})

    def test_a_process_may_end_while_it_hands_back_its_records(self):
        ended = {tuple(numbers): rest for numbers, *rest in self.processes('amid', [0], [10], [20])}
        self.assertEqual(ended, {(0, ): [False, 'its process ended'], (10, ): [True, ''], (20, ): [True, '']})

    def test_no_chunk_waits_for_a_long_one_while_a_process_has_nothing_to_do(self):
        long = list(range(40))  # of a twentieth of a second each
        ended = [numbers for numbers, *_ in self.processes('slowly', long, [0], [1], [2], [3])]
        self.assertEqual(ended, [[0], [1], [2], [3], long])

    def test_a_scheduler_of_dask_that_is_away_is_awaited(self):
        engine = object.__new__(engines.DaskEngine)
        engine.pending, client = {object(): [7]}, mock.Mock()
        away = [Refused('no Dask scheduler answers'), OSError('gone'), client]
        with mock.patch.object(engine, 'connected', side_effect=away), mock.patch.object(engines, 'POLL_SECONDS', 0.01):
            self.assertEqual(list(engine.reconnect()), [([7], None, '')])
        self.assertEqual((engine.client, engine.pending), (client, {}))

    def test_runs_that_end_their_worker_cost_no_other_by_two(self):
        self.check_traps('--workers', '2')

    def balls(self):
        """Runs that take a twentieth of a second."""
        self.write(TRAPS, 'traps.py')
        self.write(BALLS.replace('measure: {', 'measure: {slow: {python: "traps.py:slowly"}, '))

    def check_balls(self):
        """All runs are there once, as one sweep without trouble makes them."""
        hashes = self.hashes()
        self.assertEqual(sorted(hashes), list(range(100)))
        if not (self.folder / 'whole').exists():
            self.write(BALLS)
            self.sound('--workers', '1', '--output', self.folder / 'whole')
        self.assertEqual(hashes, self.hashes('whole'))

    def workers_of(self, parent):
        """Processes below one that run chunks."""
        found = []
        for path in pathlib.Path('/proc').glob('[0-9]*'):
            try:
                above = int((path / 'stat').read_text().rsplit(')', 1)[1].split()[1])
                command = (path / 'cmdline').read_bytes()
            except OSError:
                continue
            if above == parent and b'spawn_main' in command:
                found.append(int(path.name))
        return found

    def test_a_killed_worker_loses_nothing(self):
        for workers in ('1', '2'):
            with self.subTest(workers=workers):
                shutil.rmtree(self.folder / 's.sweep', ignore_errors=True)
                self.balls()
                process = subprocess.Popen(self.command('--workers', workers), text=True, stdout=subprocess.PIPE,
                                           stderr=subprocess.STDOUT)
                while not self.parts() and process.poll() is None:
                    time.sleep(0.01)
                victims = self.workers_of(process.pid)
                self.assertTrue(victims)
                os.kill(victims[0], signal.SIGKILL)
                said, _ = process.communicate(timeout=300)
                self.assertEqual(process.returncode, 0, said)
                self.check_balls()

    def test_ctrl_c_keeps_what_is_done_and_resume_goes_on(self):
        for workers in ('1', '2'):
            with self.subTest(workers=workers):
                shutil.rmtree(self.folder / 's.sweep', ignore_errors=True)
                self.balls()
                code, said = self.interrupted(lambda: len(self.parts()) >= 2, '--workers', workers)
                self.assertEqual(code, 130, said)
                self.assertIn('--resume goes on', said)
                self.assertNotIn('Traceback', said)
                begun = self.results()
                self.assertTrue(0 < len(begun['number']) < 100)
                refused = self.sweep('--workers', workers)
                self.assertEqual(refused.returncode, 2)
                self.assertIn('holds a sweep already: --resume goes on with it', refused.stderr)
                self.sound('--resume', '--workers', workers)
                again = self.results()
                for number, seconds in zip(begun['number'], begun['seconds']):  # these were not made again
                    self.assertEqual(again['seconds'][number], seconds)
                self.check_balls()

    def test_a_run_that_cannot_be_interrupted_exceeds_its_time(self):
        self.write('import ctypes\ndef f(world, parameters):\n    if world.step() and parameters["step"] == 0.5:\n'
                   '        ctypes.CDLL(None).sleep(99)\n    return 1\n', 'f.py')
        self.write('scene: {bodies: [{shape: sphere}]}\nsteps: 1\nmax_seconds: 0.5\nvary: {step: [0.25, 0.5, 1]}\n'
                   'measure: {f: {python: f.py:f}}\n')
        begin = time.monotonic()
        self.sound('--workers', '1')
        self.assertLess(time.monotonic() - begin, 25)  # two attempts of 5.5 s, not three more
        self.assertEqual(self.results()['status'].tolist(), ['ok', 'overtime', 'ok'])
        self.assertIn('could not be interrupted', self.results()['detail'][1])

    def test_a_signal_to_end_keeps_what_is_done(self):
        self.balls()
        process = subprocess.Popen(self.command('--workers', '1'), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        while not self.parts() and process.poll() is None:
            time.sleep(0.01)
        process.terminate()
        said, _ = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 130, said)
        self.assertIn('Interrupted. What is done is kept', said)
        self.assertTrue((self.folder / 's.sweep/results.h5').exists())

    def test_a_killed_program_loses_only_what_was_running(self):
        self.balls()
        process = subprocess.Popen(self.command('--workers', '1'), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while len(self.parts()) < 2 and process.poll() is None:
            time.sleep(0.01)
        process.kill()
        process.wait()
        (self.folder / 's.sweep/parts/part-000000050-3-0000.h5.99.tmp').write_bytes(b'half')
        self.sound('--resume', '--workers', '1')
        self.check_balls()

    def test_a_damaged_part_is_made_again(self):
        self.write(BALLS)
        self.sound('--workers', '1')
        whole = self.hashes()
        parts = self.parts()
        data = bytearray(parts[0].read_bytes())
        data[len(data) // 2] ^= 1
        parts[0].write_bytes(data)
        parts[1].write_bytes(parts[1].read_bytes()[:-7])
        said = self.sound('--resume', '--workers', '1')
        self.assertIn('2 damaged parts', said)
        self.assertEqual(self.hashes(), whole)

    def test_a_worker_that_is_started_again_goes_on_where_it_was(self):
        self.write(BALLS)
        self.sound('--workers', '1')
        whole = self.hashes()
        store = Store(self.folder / 's.sweep')
        batch.write_round(store, 'again', [list(range(30)), [*range(30, 60), *range(90, 100)]])
        self.assertEqual([batch.spans([3, 4, 5, 9]), batch.spans([])], [[[3, 3], [9, 1]], []])
        for part in self.parts():
            part.unlink()
        for _ in range(2):
            done = subprocess.run(['/usr/bin/python3', str(PROGRAM), '--work', store.folder, 'again', '1'], check=False)
            self.assertEqual(done.returncode, 0)
            self.assertEqual(sorted(store.status()), [*range(30, 60), *range(90, 100)])
            self.assertEqual(store.counts(), (40, 0))
        self.sound('--resume', '--workers', '1')
        self.assertEqual(self.hashes(), whole)

    def test_failed_runs_of_batch_workers_are_counted_as_they_come(self):
        store, shown = Store(self.folder / 's.sweep'), []

        class Workers:
            name = 'these workers'

            def pieces(self, _):
                return 4

            def run(self, _, __, chunks, ___, report):
                for numbers in chunks:
                    store.keep([record_of(number, 'failed' if number % 3 == 0 else 'ok') for number in numbers])
                    report()
                    shown.append((progress.done, progress.failed))

        os.makedirs(store.parts)
        store.keep([record_of(100, 'failed')])  # of an earlier round
        progress = carry.Progress(12)
        carry.carry_batch(list(range(12)), Workers(), store, progress, 1.0)
        self.assertEqual(shown, [(3, 1), (6, 2), (9, 3), (12, 4)])

    def test_what_killed_writers_have_left_goes(self):
        self.write(BALLS)
        self.sound('--workers', '1')
        part = f'part-000000000-1-0-{"0" * 16}.h5'
        old = [self.folder / 's.sweep' / name for name in (f'parts/{part}.17.tmp', 'plan.json.17.tmp', 'results.h5.17.tmp')]
        others = [self.folder / 's.sweep' / name for name in (f'parts/{part}.18.tmp', 'mine.tmp', 'results.h5.tmp', 'notes/plan.json.1.tmp')]
        others[-1].parent.mkdir()
        for path in (*old, *others):
            path.write_text('half')
        for path in (*old, *others[1:]):
            os.utime(path, (time.time() - 4000,) * 2)
        self.sound('--resume', '--workers', '1')
        self.assertEqual([path for path in old if path.exists()], [])
        self.assertEqual([path for path in others if not path.exists()], [])

    def test_runs_that_two_parts_hold_count_once(self):
        self.write(BALLS)
        self.sound('--workers', '1')
        whole = self.hashes()
        self.sound('--workers', '1', '--output', self.folder / 'two')
        for part in self.parts('two'):
            shutil.copy(part, self.folder / 's.sweep/parts')
        (self.folder / 's.sweep/results.h5').unlink()
        self.sound('--resume', '--workers', '1')
        self.assertEqual(self.hashes(), whole)

    def test_a_full_disk_keeps_what_was_stored(self):
        """The kernel refuses to make any file longer than 40 kB: parts fit at first, later ones do not."""
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))

        self.write(BALLS.replace('measure: {', 'measure: {all: states, '))
        done = self.sweep('--workers', '1', preexec_fn=limit)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn('--resume goes on', done.stderr)
        self.assertNotIn('Traceback', done.stderr)
        kept = len(self.parts())
        self.assertGreater(kept, 0)
        self.assertFalse(list(self.folder.glob('s.sweep/**/*.tmp')))
        self.sound('--resume', '--workers', '1')
        self.assertGreater(len(self.parts()), kept)
        self.check_balls()

    def test_a_disk_that_is_full_before_the_results_keeps_the_parts(self):
        """The parts fit, and any length of the results but the whole does not."""
        self.write(BALLS)
        self.sound('--workers', '1')
        whole, size = self.hashes(), (self.folder / 's.sweep/results.h5').stat().st_size
        for limit in (10, size // 3, 2 * size // 3, size - 100):
            done = self.sweep('--resume', preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertIn('--resume goes on', done.stderr)
            self.assertNotIn('Traceback', done.stderr)
            self.assertFalse(list(self.folder.glob('s.sweep/**/*.tmp')))
            self.assertEqual(self.hashes(), whole)  # those of before
        self.sound('--resume')
        self.assertEqual(self.hashes(), whole)

    def test_no_table_of_another_time_stands_beside_the_results(self):
        self.write('scene: ball_hits_wall\nsteps: 300\nrepeats: 400\nvary: {"bodies[ball].velocity[0]": {uniform: [2, 4]}}\n')
        code, said = self.interrupted(lambda: len(self.parts()) >= 1, '--workers', 1)
        self.assertEqual(code, 130, said)
        whole, partial = self.folder / 's.sweep/results.csv', self.folder / 's.sweep/results.partial.csv'
        self.assertTrue(partial.exists() and not whole.exists(), said)
        self.sound('--resume')
        self.assertTrue(whole.exists() and not partial.exists())
        self.assertEqual(len(whole.read_text(encoding='utf-8').splitlines()), 401)
        size = (self.folder / 's.sweep/results.h5').stat().st_size
        done = self.sweep('--resume', preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size // 2, size // 2)))
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn('results.h5: File too large', done.stderr)
        self.assertTrue(whole.exists())  # of the results that are still there

    def test_closed_streams_change_nothing(self):
        self.write('#!/bin/sh\necho "{\\"n\\": 3}"\necho told >&2\n', 'three').chmod(0o755)
        for text in ('scene: ball_hits_wall\nsteps: 3\nrepeats: 4\n',
                     'program: [./three]\nrepeats: 4\nmeasure: {n: {json: n}}\n'):
            self.write(text)
            self.check_closed_streams()

    def check_closed_streams(self):
        for closed in ('>&-', '2>&-', '<&- >&- 2>&-'):
            words = ' '.join(map(shlex.quote, self.command('--output', self.folder / 'out')))
            self.assertEqual(subprocess.run(f'{words} {closed}', shell=True, check=False, timeout=PATIENCE).returncode, 0, closed)
            self.assertEqual(self.results('out')['status'].tolist(), ['ok'] * 4)
            shutil.rmtree(self.folder / 'out')

    def test_a_full_file_system_keeps_what_was_stored(self):
        if os.geteuid() != 0:
            self.skipTest('a small file system needs root to mount')
        small = self.folder / 'small'
        small.mkdir()
        if subprocess.run(['mount', '-t', 'tmpfs', '-o', 'size=300k', 'none', str(small)], check=False).returncode:
            self.skipTest('no small file system can be mounted here')
        self.addCleanup(subprocess.run, ['umount', str(small)], check=True)
        self.write(BALLS.replace('measure: {', 'measure: {all: states, '))
        done = self.sweep('--workers', '2', '--output', small / 'out')
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn('No space left on device', done.stderr)
        self.assertNotIn('Traceback', done.stderr)
        self.assertGreater(len(self.parts('small/out')), 0)
        subprocess.run(['mount', '-o', 'remount,size=20m', str(small)], check=True)
        self.sound('--resume', '--workers', '2', '--output', small / 'out')
        self.write(BALLS)
        self.sound('--workers', '1')
        self.assertEqual(self.hashes('small/out'), self.hashes())

    def test_two_programs_do_not_write_into_one_folder(self):
        self.balls()
        process = subprocess.Popen(self.command('--workers', '1'), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        while not self.parts() and process.poll() is None:
            time.sleep(0.01)
        done = self.sweep('--resume', '--workers', '1')
        self.assertEqual((done.returncode, 'another sweep is writing into' in done.stderr), (2, True), done.stderr)

    def test_a_changed_file_is_not_mixed_with_its_old_results(self):
        self.write(BALLS)
        self.sound('--workers', '1')
        self.write(BALLS.replace('count: 5', 'count: 6'))
        done = self.sweep('--resume')
        self.assertEqual(done.returncode, 2)
        self.assertIn('holds a sweep of another file or scene', done.stderr)


if __name__ == '__main__':
    unittest.main()
