# SPDX-License-Identifier: BSD-3-Clause
"""Engines that take one chunk after the other and hand back its records: processes of this machine, or Dask. None is ours.

`slots` is the number of chunks that run at once, `submit` gives one more, `wait` yields those that have ended as (numbers,
records, why): without records the chunk is lost, by a fault of its own where `why` says something.
"""
import collections
import concurrent.futures
import concurrent.futures.process
import ctypes
import multiprocessing
import os
import queue
import resource
import signal
import time

from .run import run_chunk
from .tree import Refused

PATIENCE_SECONDS = 120.0  # that a scheduler may be away; what is done stays
POLL_SECONDS = 0.5
PR_SET_PDEATHSIG = 1  # of prctl(2)
BROKEN = concurrent.futures.process.BrokenProcessPool


def begin_worker():
    """Ctrl-C reaches all processes of the terminal: the one that has started this alone decides. When that is killed, this ends
    with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # blocked until here
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class Processes:
    """Processes of this machine beside this one, so that what ends one does not end the sweep. Each is a pool of its own: what
    ends one ends no other. A chunk waits here until a process has nothing to do."""

    def __init__(self, workers):
        self.slots, self.pools = workers, [None] * workers
        self.waiting, self.running = collections.deque(), {}  # chunks; the process and the chunk, by its future
        _, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))  # a pool has eight

    def submit(self, plan_text, numbers):
        self.waiting.append((plan_text, numbers))
        self.fill()

    def fill(self):
        busy = {slot for slot, _ in self.running.values()}
        for slot in range(self.slots):
            if self.waiting and slot not in busy:
                plan_text, numbers = self.waiting.popleft()
                self.running[self.begun(slot, plan_text, numbers)] = slot, numbers

    def begun(self, slot, plan_text, numbers):
        """The future of a chunk. A process that has ended while it had nothing to do is replaced."""
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # until begin_worker() has run in a new process
        try:
            if self.pools[slot]:
                try:
                    return self.pools[slot].submit(run_chunk, plan_text, numbers)
                except BROKEN:
                    pass
            context = multiprocessing.get_context('spawn')
            self.pools[slot] = concurrent.futures.ProcessPoolExecutor(1, context, initializer=begin_worker)
            return self.pools[slot].submit(run_chunk, plan_text, numbers)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def wait(self):
        """At least one chunk, unless none ends within half a second."""
        done, _ = concurrent.futures.wait(self.running, POLL_SECONDS, concurrent.futures.FIRST_COMPLETED)
        ended = [(self.running.pop(future)[1], future) for future in list(self.running) if future in done]
        self.fill()
        for numbers, future in ended:
            try:
                yield numbers, future.result(), ''
            except BROKEN:
                yield numbers, None, 'its process ended'

    def close(self):
        for pool in filter(None, self.pools):
            processes = list((pool._processes or {}).values())
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.kill()


def distributed_module():
    try:
        import dask
        import distributed
    except ImportError:
        raise Refused('there is no Dask (Debian: python3-distributed)')
    dask.config.set({'distributed.comm.retry.count': 0, 'distributed.scheduler.allowed-failures': 0})
    return distributed


class DaskEngine:
    """The workers of the Dask scheduler at an address."""

    def __init__(self, address):
        self.distributed, self.address = distributed_module(), address
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
