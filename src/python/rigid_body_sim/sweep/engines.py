# SPDX-License-Identifier: BSD-3-Clause
"""Engines that take one chunk after the other and hand back its records: one process, or Dask. None of them is ours.

`slots` is the number of chunks that run at once, `submit` gives one more, `wait` yields those that have ended as (numbers,
records, why): without records the chunk is lost, by a fault of its own where `why` says something.
"""
import concurrent.futures
import concurrent.futures.process
import ctypes
import multiprocessing
import os
import queue
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
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class SerialEngine:
    """One process beside this one, so that what ends it does not end the sweep."""

    slots = 1

    def __init__(self):
        self.pool, self.pending = None, {}

    def start(self):
        context = multiprocessing.get_context('spawn')
        self.pool = concurrent.futures.ProcessPoolExecutor(1, context, initializer=begin_worker)

    def submit(self, plan_text, numbers):
        if self.pool is None:
            self.start()
        try:
            future = self.pool.submit(run_chunk, plan_text, numbers)
        except BROKEN:
            self.start()
            future = self.pool.submit(run_chunk, plan_text, numbers)
        self.pending[future] = numbers

    def wait(self):
        """At least one chunk, unless none ends within half a second. The first of those that a process has taken with it is
        to blame; the others had not begun."""
        done, _ = concurrent.futures.wait(self.pending, POLL_SECONDS, concurrent.futures.FIRST_COMPLETED)
        blamed = False
        for future in [future for future in self.pending if future in done]:
            numbers = self.pending.pop(future)
            try:
                yield numbers, future.result(), ''
            except BROKEN:
                yield numbers, None, '' if blamed else 'its process ended'
                blamed = True

    def close(self):
        if self.pool:
            processes = list((self.pool._processes or {}).values())
            self.pool.shutdown(wait=False, cancel_futures=True)
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
    """The workers of a Dask scheduler: of that at an address, or of one of our own with so many processes."""

    def __init__(self, address=None, workers=None):
        self.distributed, self.address, self.cluster, self.client = distributed_module(), address, None, None
        self.pending, self.ended = {}, queue.SimpleQueue()
        if address is None:
            self.cluster = self.local_cluster(workers)
        self.client = self.connected()
        threads = self.client.nthreads()
        if not threads:
            self.close()
            raise Refused(f'the scheduler at {address} has no workers')
        self.slots = sum(threads.values())

    def local_cluster(self, workers):
        # Workers never see Ctrl-C: this process alone decides, as soon as they are there.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return self.distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None,
                                                 silence_logs='CRITICAL')
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def connected(self):
        try:
            return self.distributed.Client(self.cluster or self.address, timeout=10, set_as_default=False)
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
        for part in (self.client, self.cluster):
            if part:
                part.close(timeout=5)


def local_engine(workers):
    """The processes of this machine; one process where that is all that is asked for or there is no Dask."""
    if workers == 1:
        return SerialEngine(), ''
    try:
        return DaskEngine(workers=workers), ''
    except Refused as error:
        return SerialEngine(), f'{error}; one process runs all'


def cores():
    return len(os.sched_getaffinity(0))
