# SPDX-License-Identifier: BSD-3-Clause
"""One run, and a chunk of runs. Whatever happens in a run is its result: nothing is raised for it."""
import ctypes
import functools
import hashlib
import json
import os
import re
import socket
import sys
import threading
import time

from rigid_body_sim import InvalidInput, Scene, World

from . import metrics, program, stops, users_code
from .plan import Plan
from .tree import Refused

DIVERGED = 'non_finite'  # the kind of warning of a body that was frozen
GRACE_SECONDS = 5.0  # after its time, until the process of a run that cannot be interrupted ends
UNINTERRUPTED = 70  # exit status of that process
ENDLESS = 'it had not ended after its time and could not be interrupted'  # why its records are missing
LONGEST_WAIT = 3600.0  # s: the clocks of the system take no wait of any length
MOST_SAID = 10_000  # characters of a detail that are kept


class StopFailed(Exception):
    """A user's function that ends runs has failed."""


def scene_of(tree):
    """The scene of a tree. Its faults name places in the scene; there are no lines."""
    try:
        return Scene.parse(json.dumps(tree))
    except InvalidInput as error:
        raise Refused(*(re.sub(r'^text:\d+: ', '', line) for line in str(error).splitlines()))


class Run:
    """A world and what is measured in it."""

    def __init__(self, plan, task):
        self.plan, self.task, self.files = plan, task, users_code.Files()
        scene = scene_of(task.scene)
        self.world, self.steps = World(scene), plan.steps(scene.step)
        self.metrics = {entry['name']: metrics.made_for(self, entry) for entry in plan.tree['measure']}
        self.stops = {entry['name']: stops.made_for(self, entry) for entry in plan.tree['stop']}
        self.flags, self.stopped, self.diverged = set(), '', ''

    @staticmethod
    def step_of(scene):
        """Length of a step of another scene, s."""
        return scene_of(scene).step

    @staticmethod
    def positions_of(scene, steps):
        """Those of the bodies of another scene after so many steps. Raises ValueError where it diverges."""
        world = World(scene_of(scene))
        for _ in range(steps):
            for warning in world.step().warnings:
                if warning.kind == DIVERGED:
                    raise ValueError(f'the reference diverges: {warning.text}')
        return world.positions

    def advance(self):
        """Steps to the end, or until something stops it."""
        world = self.world
        observers = [metric.observe for metric in self.metrics.values() if hasattr(metric, 'observe')]
        for observe in observers:
            observe(world, None)
        for _ in range(self.steps):
            report = world.step()
            if report.warnings:
                self.note(report.warnings)
                if self.diverged:
                    return
            for observe in observers:
                observe(world, report)
            self.stopped = self.reason_to_stop()
            if self.stopped:
                return

    def reason_to_stop(self):
        """The first stop that holds; empty where none does."""
        for entry in self.plan.tree['stop']:
            steps = self.world.steps
            try:
                holds = self.stops[entry['name']].holds(self.world)
                if self.world.steps != steps:
                    raise RuntimeError('it has stepped the world')
                if holds:
                    return entry['name']
            except Exception as error:  # of a user's function
                raise StopFailed(f'stop.{entry["name"]}: {users_code.said(error, entry["argument"])}')
        return ''

    def note(self, warnings):
        self.flags.update(warning.kind for warning in warnings)
        self.diverged = next((warning.text for warning in warnings if warning.kind == DIVERGED), '')

    def measure(self):
        """The value of each metric, and what went wrong."""
        values, faults = {}, []
        for entry in self.plan.tree['measure']:
            try:
                values[entry['name']] = users_code.numbers(self.metrics[entry['name']].value(self.world))
            except Exception as error:  # whatever a user's function raises
                faults.append(f'measure.{entry["name"]}: {users_code.said(error, entry["argument"])}')
        return values, '; '.join(faults)


@functools.lru_cache(maxsize=None)
def build_of_physics():
    """A digest of the code of the physics: of the extension, and of the library of the core that it has loaded."""
    extension = sys.modules[World.__module__].__file__
    with open('/proc/self/maps', encoding='utf-8') as maps:
        core = {line.split(maxsplit=5)[5].strip().removesuffix(' (deleted)') for line in maps if 'librigid_body_sim_core' in line}
    digest = hashlib.sha256()
    for path in (extension, *sorted(core)):
        with open(path, 'rb') as file:
            digest.update(file.read())
    return digest.hexdigest()[:16]


def check_builds(builds, where):
    """Equal runs have equal results by one build of the physics alone."""
    foreign = sorted(set(builds) - {build_of_physics()})
    if foreign:
        raise Refused(f'{where} another build of the physics ({", ".join(foreign)}; this is {build_of_physics()})')


def storable(text):
    """A text as HDF5 takes it: without NUL, and without what is no character."""
    return text[:MOST_SAID].replace('\0', '\ufffd').encode(errors='replace').decode()


def record_of(number, status='ok', detail='', **known):
    """The result of a run as it is stored."""
    return {'number': number, 'status': status, 'detail': storable(detail), 'seconds': 0.0, 'cpu_seconds': 0.0,
            'host': socket.gethostname(), 'values': {}, **known}


def run_scene(plan, number):
    """Runs the scene of a task to its record. `seconds` is the wall time of all of it; `cpu_seconds` is without the metrics at its end,
    which may be reference runs."""
    begin, cpu_begin, cpu, run, values = time.perf_counter(), time.thread_time(), 0.0, None, {}
    try:
        run = Run(plan, plan.task(number))
        run.advance()
        cpu = time.thread_time() - cpu_begin
        if run.diverged:
            status, detail = 'diverged', run.diverged
        else:
            values, detail = run.measure()
            status = 'failed' if detail else 'ok'
    except (Refused, InvalidInput) as error:
        status, detail = 'refused', str(error)
    except StopFailed as error:
        status, detail = 'failed', str(error)
    except Exception as error:  # of a user's file, or want of memory
        status, detail = 'failed', users_code.said(error)
    known = {}
    if run:
        known = {'stopped': run.stopped, 'flags': ' '.join(sorted(run.flags)), 'hash': run.world.state_hash(),
                 'steps': run.world.steps, 'time': run.world.time, 'values': values}
    return record_of(number, status, detail, seconds=time.perf_counter() - begin, cpu_seconds=cpu, build=build_of_physics(), **known)


def run_task(plan, number):
    """The record of a task."""
    if not plan.program:
        return run_scene(plan, number)
    status, detail, known = program.run_task(plan, number)
    return record_of(number, status, detail, **known)


class Watchdog:
    """Raises Overtime in the thread that made it where a run takes longer than it may, and ends the process where that
    does not help. Whoever has started the process notices."""

    def __init__(self):
        self.seconds, self.thread = 0.0, threading.get_ident()
        self.deadline, self.raised, self.change = None, False, threading.Condition()
        threading.Thread(target=self.watch, daemon=True).start()

    def watch(self):
        with self.change:
            while True:
                left = None if self.deadline is None else self.deadline - time.monotonic()
                if left is None or left > 0:
                    self.change.wait(None if left is None else min(left, LONGEST_WAIT))
                elif self.raised:
                    print(f'a run cannot be interrupted after {self.seconds:g} s: its process ends', file=sys.stderr, flush=True)
                    os._exit(UNINTERRUPTED)
                else:
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.thread), ctypes.py_object(users_code.Overtime))
                    self.deadline, self.raised = time.monotonic() + GRACE_SECONDS, True

    def begin(self, seconds):
        with self.change:
            self.seconds, self.deadline, self.raised = seconds, time.monotonic() + seconds, False
            self.change.notify()

    def end(self):
        with self.change:
            self.deadline = None


OF_THREAD = threading.local()


def watchdog_of_thread():
    """One for each thread that runs chunks."""
    if not hasattr(OF_THREAD, 'watchdog'):
        OF_THREAD.watchdog = Watchdog()
    return OF_THREAD.watchdog


@functools.lru_cache(maxsize=4)
def plan_of(text):
    return Plan.from_text(text)


def run_chunk(plan_text, numbers):
    """The records of some tasks, in their order."""
    plan = plan_of(plan_text)
    seconds = plan.max_seconds + (GRACE_SECONDS if plan.program else 0.0)  # a program is ended by its run; its metrics are not
    watchdog, records = watchdog_of_thread(), []
    for number in numbers:
        record = None
        try:
            watchdog.begin(seconds)
            record = run_task(plan, number)
            watchdog.end()  # within the try: Overtime may come until then
        except users_code.Overtime:
            pass
        finally:
            watchdog.end()
        if watchdog.raised:  # whatever a user's `except:` has made of it
            record = record_of(number, 'overtime', f'it had not ended after {plan.max_seconds:g} s', seconds=plan.max_seconds)
        records.append(record)
    return records
