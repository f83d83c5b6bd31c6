# SPDX-License-Identifier: BSD-3-Clause
"""Runs a scene or a program many times: a file says what varies, how long a run is, and what is measured.

It writes into a folder (FILE without .yaml, with .sweep): results.h5, results.csv where that is small (results.partial.csv while
runs are missing), and parts of what is done. Exit codes: 0 every run has a result, which may be that it failed, 1 could not go on or some runs have none, 2 bad
arguments or a bad file, 130 interrupted by Ctrl-C or SIGTERM (what is done is kept: --resume).
"""
import argparse
import collections
import functools
import json
import os
import platform
import re
import shlex
import signal
import statistics
import sys
import time

import h5py
import numpy
from rigid_body_sim import InvalidInput, __version__

from . import batch, charts, engines
from .carry import Progress, carry_batch, carry_live, duration, pilot
from .plan import Task, checked_numbers
from .reader import Reader
from .run import Run, build_of_physics, check_builds, run_chunk, scene_of
from .store import AGAIN, CSV, MOST_CSV_RUNS, PARTIAL_CSV, Store, folder_of, in_csv
from .tree import Refused, replaced
from .users_code import said

CANNOT, BAD_FILE, INTERRUPTED = 1, 2, 130
SHOWN_FAILURES, SHOWN_FAULTS = 10, 20
SHOWN_STEPS = 3
FAILED_DRAWS = 20  # of one key, after which no sound one is expected
FOLDER_BYTES = 200_000
RUN_BYTES, CSV_BYTES = 240, 100  # of a run in a part and in results.h5, and in results.csv, without metrics and parameters
CLOCKED = re.compile(r'"max_solve_ms"')


def add_engine(parser):
    """The options that say who makes the runs."""
    engine = parser.add_mutually_exclusive_group()
    engine.add_argument('--workers', type=int, help='processes on this machine (one for each core)')
    engine.add_argument('--dask', metavar='ADDRESS', help='run on the workers of this Dask scheduler')
    engine.add_argument('--slurm', metavar='PARTITION', help='run as a job array of Slurm')
    engine.add_argument('--hosts', metavar='FILE', help='run by GNU parallel over ssh on the hosts of this file, one a line')


def engine_words(options):
    """Those of them that were given, for another command."""
    given = {name: getattr(options, name) for name in ('workers', 'dask', 'slurm', 'hosts')}
    return [word for name, value in given.items() if value is not None for word in ('--' + name, str(value))]


def arguments(words):
    parser = argparse.ArgumentParser(prog='sweep', description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('file', nargs='?', metavar='FILE', help='what to run (docs/batch.md)')
    parser.add_argument('--output', help='folder of the results (FILE without .yaml, with .sweep)')
    parser.add_argument('--resume', action='store_true', help='go on with what the folder holds; runs that crashed or exceeded '
                        'their time are run again')
    parser.add_argument('--dry-run', action='store_true', help='say how many runs, how long and how much disk; run three of them')
    parser.add_argument('--only', type=int, metavar='N', help='run this one alone, print what comes of it, and store nothing')
    parser.add_argument('--chart', nargs='+', metavar=('METRIC', 'PARAMETER'), help='draw a metric of the results over one or '
                        'two parameters, with bands of 95 %% confidence')
    add_engine(parser)
    parser.add_argument('--work', nargs=3, metavar=('FOLDER', 'ROUND', 'CHUNK'), help=argparse.SUPPRESS)  # what engines call
    options = parser.parse_args(words)
    if not options.file and not options.work:
        parser.error('which FILE?' + (' It comes before --chart.' if options.chart else ''))
    if options.workers is not None and not 1 <= options.workers <= 1024:
        parser.error('--workers must be 1 to 1024')
    if options.chart and len(options.chart) not in (2, 3):
        parser.error('--chart takes a metric and one or two parameters')
    return options


def package_folder(program):
    """Where the scenes and package.xml are: in the source, where the program is a file of it, or as installed."""
    here = os.path.dirname(os.path.realpath(program))
    source = os.path.normpath(os.path.join(here, '../..'))
    return source if os.path.isfile(os.path.join(source, 'package.xml')) else os.path.join(here, '../../share/rigid_body_sim')


def versions():
    """What the results were made with. Equal builds make equal hashes on the same kind of processor."""
    return {'rigid_body_sim': __version__, 'build': build_of_physics(), 'python': platform.python_version(), 'numpy': numpy.__version__,
            'h5py': h5py.__version__, 'system': platform.platform(), 'made': time.strftime('%Y-%m-%dT%H:%M:%S%z')}


def find_scene(folder, name):
    known = sorted(file[:-5] for file in os.listdir(os.path.join(folder, 'scenes')) if file.endswith('.yaml'))
    if name not in known:
        raise Refused(f"no scene '{name}' in the catalogue (there are: {', '.join(known)})")
    return os.path.join(folder, 'scenes', name + '.yaml')


def culprit(plan, parameters):
    """The first of the paths that vary at which the scene of a run goes wrong; None where it does before."""
    scene = plan.tree['scene']
    try:
        scene_of(scene)
    except Refused:
        return None
    for path, value in parameters.items():
        try:
            scene = replaced(scene, path, value)
            scene_of(scene)
        except Refused:
            return path
    return None


def fails_always(plan, parameters, path):
    """Whether no draw of the first runs makes a sound scene."""
    return all(culprit(plan, {**parameters, path: plan.parameters(number)[1][path]}) == path
               for number in range(min(FAILED_DRAWS, plan.count)))


def sound_task(plan, number, hopeful):
    """A task and its scene. A draw that makes no sound scene is left out where others do: a run that draws so has the status
    `refused`. Raises Refused with the value that brings the fault. `hopeful` collects the paths some of whose draws are sound."""
    drawn = {axis.path for axis in plan.axes if axis.draw}
    seed, parameters = plan.parameters(number)
    while True:
        try:
            tree = plan.tree['scene']
            for path, value in parameters.items():
                tree = replaced(tree, path, value)
            return Task(number, seed, parameters, tree), scene_of(tree)
        except Refused as error:
            path = culprit(plan, parameters)
            if path not in drawn or (path not in hopeful and fails_always(plan, parameters, path)):
                where = f'vary.{path} = {json.dumps(parameters[path])}' if path else 'scene'
                raise Refused(*(f'{where}: {fault}' for fault in error.faults)) from None
            hopeful.add(path)
            del parameters[path]


def check(plan, number, hopeful):
    """Faults of a task that are known before it runs, and its scene."""
    try:
        task, scene = sound_task(plan, number, hopeful)
    except Refused as error:
        return error.faults, None
    try:
        if number == 0:
            Run(plan, task)
    except (Refused, InvalidInput) as error:
        return str(error).splitlines(), scene
    except Exception as error:  # of a user's file
        return [said(error)], scene
    return [], scene


def warn(plan, steps):
    """Warns of plans that are valid but probably not intended. `steps`: how long the steps of scenes are, s."""
    is_clocked = CLOCKED.search(plan.text())
    if is_clocked:
        print('sweep: max_solve_ms cuts solves short by the clock: the results of this sweep do not repeat', file=sys.stderr)
    if plan.program:
        return
    if plan.tree['repeats'] > 1 and not any(axis.draw for axis in plan.axes) and not is_clocked:
        print('sweep: nothing is drawn: all repeats are the same run, but for its time', file=sys.stderr)
    duration_asked = plan.tree['duration']
    uneven = [step for step in steps if duration_asked
              and abs(plan.steps(step) * step - duration_asked) > 1e-5 * duration_asked]
    for step in uneven[:SHOWN_STEPS]:
        print(f'sweep: duration {duration_asked:g} s is no whole number of steps of {step:g} s: such runs end at '
              f'{plan.steps(step) * step:g} s', file=sys.stderr)
    if len(uneven) > SHOWN_STEPS:
        print(f'sweep: and so for {len(uneven) - SHOWN_STEPS:,} more lengths of the step', file=sys.stderr)


def read_plan(file, folder):
    """The plan of a file, whose runs can be made as far as that is known before."""
    plan, faults, steps = Reader(file, functools.partial(find_scene, folder)).read(), {}, {}
    hopeful = set()
    for number in () if plan.program else checked_numbers(plan):
        found, scene = check(plan, number, hopeful)
        faults.update(dict.fromkeys(found))
        if number == 0 and faults:
            break
        if scene is not None:
            steps[scene.step] = None
    if faults:
        raise Refused(*(f'{file}: {fault}' for fault in faults))
    warn(plan, steps)
    return plan


def describe(plan):
    factors = [f'{len(axis.values):,} of {axis.path}' for axis in plan.axes if axis.values is not None]
    factors += [f'{plan.tree["repeats"]:,} repeats'] if plan.tree['repeats'] > 1 else []
    drawn = [axis.path for axis in plan.axes if axis.draw]
    text = f'{plan.count:,} run' + ('s' if plan.count > 1 else '') + (': ' + ' x '.join(factors) if factors else '')
    return text + (f'; drawn for each: {", ".join(drawn)}' if drawn else '')


def median_seconds(records):
    """The time of a run: the first of a process takes longer than the others."""
    return statistics.median(record['seconds'] for record in records)


def dry_run(plan, options):
    print(describe(plan))
    engine = engines.Processes(1)
    try:
        records = pilot(plan, range(plan.count), engine)
    finally:
        engine.close()
    seconds = median_seconds(records)
    values = records[0]['values'].values()
    numbers = sum(value.size for value in values) + len(plan.axes)
    shown = sum(value.size for value in values if in_csv((plan.count, *value.shape))) + len(plan.axes)
    output = max(len(record.get('output', '').encode()) for record in records)
    csv_bytes = CSV_BYTES + 18 * shown if plan.count <= MOST_CSV_RUNS else 0
    size = FOLDER_BYTES + plan.count * (2 * (RUN_BYTES + 8 * numbers + output) + csv_bytes)
    workers = options.workers or engines.cores()
    print(f'a run takes {duration(seconds)} (median of {len(records)}): {duration(seconds * plan.count)} of one core')
    if (options.dask, options.slurm, options.hosts) == (None, None, None):
        together = seconds * max(1.0, plan.count / workers)
        print(f'on {workers} worker{"s" if workers > 1 else ""} of this machine: {duration(together)}')
    print(f'disk: about {size / 1e6:.3g} MB')
    for record in records:
        if record['status'] != 'ok':
            print(f'run {record["number"]:,} is {record["status"]}: {record["detail"]}')
    return 0


def run_only(plan, options):
    if not 0 <= options.only < plan.count:
        raise Refused(f'--only {options.only}: there are runs 0 to {plan.count - 1:,}')
    seed, parameters = plan.parameters(options.only)
    print(f'run {options.only} of {plan.count:,}, seed {seed}')
    for path, value in parameters.items():
        print(f'  {path} = {json.dumps(value)}')
    record = run_chunk(plan.text(), [options.only])[0]
    for name, value in record['values'].items():
        print(f'{name}: {numpy.array2string(value, threshold=50)}')
    if plan.program:
        print(record.get('output', '').rstrip())
        print(f'exit status {record.get("exit_status")}, in {duration(record["seconds"])}')
    elif 'hash' in record:
        print(f'hash {record["hash"]:016x} after {record["steps"]:,} steps ({record["time"]:g} s), in {duration(record["seconds"])}')
    print(record['status'] + (f', stopped: {record["stopped"]}' if record.get('stopped') else '')
          + (f' ({record["flags"]})' if record.get('flags') else '') + (f': {record["detail"]}' if record['detail'] else ''))
    return 0 if record['status'] == 'ok' else CANNOT


def carry(plan, numbers, store, options):
    """Runs what is missing."""
    progress = Progress(len(numbers))
    if options.slurm is not None or options.hosts is not None:
        carry_by_batch(plan, store, options, progress)
        return
    engine = engines.DaskEngine(options.dask) if options.dask is not None else engines.Processes(
        min(options.workers or engines.cores(), len(numbers)))
    try:
        carry_live(plan, numbers, engine, store, progress)
    finally:
        progress.end()
        engine.close()


def carry_by_batch(plan, store, options, progress):
    engine = batch.Slurm(options.slurm) if options.slurm is not None else batch.Parallel(options.hosts)
    engine.begin(store)
    numbers = missing(plan, store)
    if not numbers:
        return
    serial = engines.Processes(1)
    try:
        records = pilot(plan, numbers, serial)
    finally:
        serial.close()
    known = [record for record in records if record['status'] != 'overtime']
    if known:
        store.keep(known)
    done = {record['number'] for record in known}
    numbers = [number for number in numbers if number not in done]
    progress.add(len(known), sum(record['status'] != 'ok' for record in known))
    if not numbers:
        return
    try:
        carry_batch(numbers, engine, store, progress, median_seconds(records))
    except KeyboardInterrupt:
        print('\n' + engine.farewell(), file=sys.stderr)
        raise
    finally:
        progress.end()


def missing(plan, store):
    known, _, builds = store.survey()
    check_builds(builds, f'--output takes another folder: {store.folder} holds runs of')
    return [number for number in range(plan.count) if known.get(number, AGAIN[0]) in AGAIN]


def sum_up(plan, known, store, options):
    """What came of all runs, and how to run a failed one again."""
    counts = collections.Counter(known.values())
    print(f'{len(known):,} of {plan.count:,} runs' + (': ' if known else '')
          + ', '.join(f'{n:,} {status}' for status, n in counts.most_common()))
    if store.damaged:
        print(f'{len(store.damaged):,} damaged parts do not count: {", ".join(sorted(store.damaged)):.300}')
    failed = [number for number in sorted(known) if known[number] != 'ok']
    if failed:
        details = store.details(failed[:SHOWN_FAILURES])
        for number in failed[:SHOWN_FAILURES]:
            parameters = ', '.join(f'{path} = {json.dumps(value)}' for path, value in plan.parameters(number)[1].items())
            print(f'run {number} {known[number]}: {details[number]}\n  {parameters}\n  again: {again(options, number)}')
        if len(failed) > SHOWN_FAILURES:
            print(f'and {len(failed) - SHOWN_FAILURES:,} more: `status` in the results')
    files = [name for name in ('results.h5', CSV, PARTIAL_CSV) if os.path.exists(store.path(name))]
    if files:
        print(f'In {store.folder}: {", ".join(files)}')


def again(options, number):
    return f'rosrun rigid_body_sim sweep {shlex.quote(os.path.abspath(options.file))} --only {number}'


def chart(options, store):
    if not os.path.exists(store.results):
        raise Refused(f'there are no results in {store.folder} to draw')
    metric, *parameters = options.chart
    target = store.path(re.sub(r'[^\w.-]+', '_', '-'.join([metric, *parameters])) + '.png')
    charts.draw(store.results, target, metric, *parameters)
    print(target)
    return 0


def folder_of_results(options):
    return options.output or folder_of(options.file)


def interrupt(*_):
    raise KeyboardInterrupt


def run(options):
    if options.work:
        folder, name, which = options.work
        batch.work(folder, name, int(which))
        return 0
    store = Store(folder_of_results(options))
    if options.chart:
        return chart(options, store)
    plan = read_plan(options.file, options.folder)
    if options.only is not None:
        return run_only(plan, options)
    if options.dry_run:
        return dry_run(plan, options)
    if store.begun() and not options.resume:
        raise Refused(f'{store.folder} holds a sweep already: --resume goes on with it, --output takes another folder')
    if not store.has_plan() and options.resume:
        raise Refused(f'{store.folder} holds no sweep to go on with')
    if store.begun() and store.fingerprint() != plan.fingerprint():
        raise Refused(f'{store.folder} holds a sweep of another file or {"program" if plan.program else "scene"}: --resume needs '
                      'the same, --output takes another folder')
    print(describe(plan))
    return run_sweep(plan, store, options)


def run_sweep(plan, store, options):
    store.begin(plan)
    numbers, code = missing(plan, store), 0
    try:
        if numbers:
            carry(plan, numbers, store, options)
    except KeyboardInterrupt:
        print('Interrupted. What is done is kept; the same command with --resume goes on.', file=sys.stderr)
        code = INTERRUPTED
    try:
        known = store.gather(plan, versions())
    except KeyboardInterrupt:
        print('Interrupted before the results were put together. What is done is kept; the same command with --resume goes on.',
              file=sys.stderr)
        return INTERRUPTED
    sum_up(plan, known, store, options)
    return code or (CANNOT if len(known) < plan.count else 0)


def open_standard_streams():
    """Where a daemon has closed standard input, output or error, a file opened later would take its place."""
    for descriptor, name, mode in ((0, 'stdin', 'r'), (1, 'stdout', 'w'), (2, 'stderr', 'w')):
        try:
            os.fstat(descriptor)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # open() takes the lowest number that is free
            setattr(sys, name, open(descriptor, mode, encoding='utf-8'))


def main(program, words=None):
    """`program` is the path of sweep itself, `words` are its arguments: those of the process where there are none."""
    open_standard_streams()
    options = arguments(words)
    options.folder = package_folder(program)
    signal.signal(signal.SIGTERM, interrupt)
    try:
        return run(options)
    except Refused as error:
        for fault in error.faults[:SHOWN_FAULTS]:
            print(f'sweep: {fault}', file=sys.stderr)
        if len(error.faults) > SHOWN_FAULTS:
            print(f'sweep: and {len(error.faults) - SHOWN_FAULTS} more', file=sys.stderr)
        return BAD_FILE
    except OSError as error:
        has_runs = not options.work and Store(folder_of_results(options)).begun()
        print(f'sweep: {error.filename or "the results"}: {error.strerror or error}.'
              + (' What is stored stays: --resume goes on' if has_runs else ''), file=sys.stderr)
        return CANNOT
    except KeyboardInterrupt:
        print('Interrupted.', file=sys.stderr)
        return INTERRUPTED
