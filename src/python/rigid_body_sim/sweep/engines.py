# SPDX-License-Identifier: BSD-3-Clause
"""Engines that take one chunk after the other and hand back its records: processes of this machine, or Dask.

`slots` is the number of chunks that run at once, `submit` gives one more, `wait` yields those that have ended as (numbers,
records, why): without records the chunk is lost, by a fault of its own where `why` says something.
"""
import collections
import concurrent.futures
import ctypes
import multiprocessing.connection
import multiprocessing.resource_tracker
import os
import queue
import resource
import signal
import time

from .run import ENDLESS, UNINTERRUPTED, run_chunk
from .tree import Refused

PATIENCE_SECONDS = 120.0  # that a scheduler may be away; what is done stays
POLL_SECONDS = 0.5
PR_SET_PDEATHSIG = 1  # of prctl(2)


def end_with_parent(how):
    """Lets this process get a signal when the one that has started it ends."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, how)


def serve(pipe):
    """What a process does: it hands back the records of each chunk that comes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all processes of the terminal: the one that has started this decides
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # blocked until here
    end_with_parent(signal.SIGKILL)  # killed, that one leaves nothing behind
    while True:
        try:
            chunk = pipe.recv()
        except EOFError:
            return
        pipe.send(run_chunk(*chunk))


class Worker:
    """A process beside this one. It alone holds the other end of its pipe, so that the pipe ends with it, even amid a record:
    of a queue the reader holds that end too, and would wait for the rest."""

    def __init__(self):
        context = multiprocessing.get_context('spawn')
        self.pipe, its_end = context.Pipe()
        self.process = context.Process(target=serve, args=[its_end])
        multiprocessing.resource_tracker.ensure_running()  # which start() would do, and unblock SIGINT then
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # the process begins with it
        try:
            self.process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        its_end.close()

    def begin(self, *chunk):
        try:
            self.pipe.send(chunk)
        except OSError:
            pass  # the process has ended: it has no records

    def why(self):
        """Why it has ended."""
        self.process.join(5.0)
        return ENDLESS if self.process.exitcode == UNINTERRUPTED else 'its process ended'

    def records(self):
        """Those of its chunk; None if the process has ended before it could hand them back."""
        try:
            return self.pipe.recv() if self.pipe.poll() else None
        except (EOFError, OSError):
            return None


class Processes:
    """Processes of this machine: what ends one ends neither another nor the sweep. A chunk waits here until a process has
    nothing to do."""

    def __init__(self, workers):
        _, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))  # a process takes two
        self.slots, self.idle = workers, []
        self.waiting, self.running = collections.deque(), {}  # chunks; the numbers that a worker runs
        try:
            while len(self.idle) < workers:
                self.idle.append(Worker())
        except BaseException:  # Ctrl-C, or no more processes
            self.close()
            raise

    def submit(self, plan_text, numbers):
        self.waiting.append((plan_text, numbers))
        self.fill()

    def fill(self):
        """One that has ended while it had nothing to do is replaced: the chunk is not to blame."""
        while self.waiting and self.idle:
            worker = self.idle.pop()
            worker = worker if worker.process.is_alive() else Worker()
            plan_text, numbers = self.waiting.popleft()
            worker.begin(plan_text, numbers)
            self.running[worker] = numbers

    def wait(self):
        """At least one chunk, unless none ends within half a second."""
        ready = multiprocessing.connection.wait([worker.pipe for worker in self.running], POLL_SECONDS)
        ended = []
        for worker in [worker for worker in self.running if worker.pipe in ready or not worker.process.is_alive()]:
            records = worker.records()
            ended.append((self.running.pop(worker), records, worker.why() if records is None else ''))
            self.idle.append(Worker() if records is None else worker)
        self.fill()
        yield from ended

    def close(self):
        for worker in [*self.idle, *self.running]:
            worker.process.kill()


def distributed_module():
    try:
        import dask
        import distributed
    except ImportError:
        raise Refused('there is no Dask (Debian: python3-distributed)')
    dask.config.set({'distributed.comm.retry.count': 0, 'distributed.scheduler.allowed-failures': 0})
    return distributed


def check_address(address):
    """A client of Dask that does not find its words leaves threads behind."""
    from distributed.comm import addressing, registry
    try:
        scheme, place = addressing.parse_address(address)
        registry.get_backend(scheme)
        _, port = addressing.parse_host_port(place)
    except ValueError as error:
        raise Refused(f'{address!r} is no address of a scheduler, such as tcp://10.0.0.1:8786: {error}')
    if not 0 < port < 65536:
        raise Refused(f'{address!r} is no address of a scheduler: port {port} (allowed: 1 to 65535)')


class DaskEngine:
    """The workers of the Dask scheduler at an address."""

    def __init__(self, address):
        self.distributed, self.address = distributed_module(), address
        check_address(address)
        self.pending, self.ended = {}, queue.SimpleQueue()
        self.client = self.connected()
        threads = self.client.nthreads()
        if not threads:
            self.close()
            raise Refused(f'the scheduler at {address} has no workers')
        self.slots = sum(threads.values())

    def connected(self):
        try:
            return self.distributed.Client(self.address, timeout=10, set_as_default=False)
        except (OSError, ValueError) as error:
            raise Refused(f'no Dask scheduler answers at {self.address}: {error}')

    def submit(self, plan_text, numbers):
        if self.client.status == 'closed':  # the scheduler has gone: wait() reconnects
            self.pending[object()] = numbers
            return
        future = self.client.submit(run_chunk, plan_text, numbers, pure=False)
        self.pending[future] = numbers
        future.add_done_callback(self.ended.put)

    def wait(self):
        try:
            future = self.ended.get(timeout=POLL_SECONDS)
        except queue.Empty:
            if self.client.status == 'closed':
                yield from self.reconnect()
            return
        numbers = self.pending.pop(future, None)
        if numbers is None:
            return
        yield numbers, *self.outcome(future)
        future.release()

    def outcome(self, future):
        """The records, or why there are none. Records on a worker or a scheduler that has ended since are lost."""
        try:
            if future.status == 'error':
                return None, self.blame(future.exception())
            return future.result(), ''
        except (self.distributed.KilledWorker, concurrent.futures.CancelledError, OSError):
            return None, ''

    def blame(self, error):
        if isinstance(error, self.distributed.KilledWorker):
            return 'its worker ended'
        raise Refused(f'the workers of Dask cannot run a chunk: {type(error).__name__}: {error}')

    def reconnect(self):
        """Waits for the scheduler to come back. All that it had is lost."""
        deadline = time.monotonic() + PATIENCE_SECONDS
        while True:
            try:
                self.client = self.connected()
                if self.client.nthreads():
                    break
                self.client.close()
            except (Refused, OSError):
                pass
            if time.monotonic() > deadline:
                raise Refused(f'the scheduler at {self.address} has been away for {PATIENCE_SECONDS:g} s')
            time.sleep(POLL_SECONDS)
        lost, self.pending = list(self.pending.values()), {}
        for numbers in lost:
            yield numbers, None, ''

    def close(self):
        self.client.close(timeout=5)


def cores():
    return len(os.sched_getaffinity(0))
