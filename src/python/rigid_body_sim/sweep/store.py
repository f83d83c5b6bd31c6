# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a sweep: its plan, a part for each chunk of runs that is done, and the results made of them.

A file is written under another name, forced to the disk and renamed, so it is whole or absent. The name of a part holds
the digest of its bytes, so a part that was damaged later is noticed and its runs are made again. Runs are known by their
numbers: one that two parts hold counts once.
"""
import contextlib
import csv
import fcntl
import glob
import hashlib
import io
import json
import math
import os
import re
import signal
import time

import h5py
import numpy

from .plan import Plan
from .program import NOT_STARTED
from .sink import INTERRUPTS, Sink
from .tree import Refused

TEXTS = ('status', 'detail', 'stopped', 'flags', 'host', 'output')
NUMBERS = {'number': numpy.int64, 'hash': numpy.uint64, 'steps': numpy.int64, 'time': float, 'exit_status': numpy.int64,
           'seconds': float, 'cpu_seconds': float}
OF_SCENES_ALONE, OF_PROGRAMS_ALONE = ('hash', 'steps', 'time', 'stopped', 'flags'), ('exit_status', 'output')
UNKNOWN = {'exit_status': NOT_STARTED}  # of a run that has none; 0 in other columns
AGAIN = ('crashed', 'overtime')  # may end otherwise on another day
PART = re.compile(r'part-(?P<first>\d+)-(?P<runs>\d+)-(?P<failed>\d+)-(?P<digest>[0-9a-f]{16})\.h5')
HALF_WRITTEN = re.compile(r'(part-[\w-]+\.h5|plan\.json|jobs\.json|results\.(h5|csv|partial\.csv)|\d+-\d+-\d+\.(json|sbatch))\.\d+\.tmp')
CSV, PARTIAL_CSV = 'results.csv', 'results.partial.csv'
MOST_CSV_RUNS = 100_000
MOST_CSV_NUMBERS = 1_000_000  # of a metric, in all runs
CHUNK_BYTES = 1 << 20
LONGEST_WRITE = 3600.0  # s, of a file


def folder_of(file):
    """The folder of a sweep's results, unless another is asked for."""
    return os.path.splitext(file)[0] + '.sweep'


def write_whole(path, write):
    """Writes a file by `write(file)`, so that it is whole or absent."""
    part = f'{path}.{os.getpid()}.tmp'
    try:
        with open(part, 'w+b') as file:  # HDF5 reads what it has written
            write(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
        folder = os.open(os.path.dirname(path), os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
    except OSError as error:
        if error.errno is not None and error.filename is None:
            error.filename = path
        raise
    finally:
        if os.path.exists(part):
            os.unlink(part)


def of_rank(shape, rank):
    """A shape of more dimensions: what has fewer stands at index 0 of the first ones."""
    return (1,) * (rank - len(shape)) + tuple(shape)


def padded(arrays, shape):
    """Arrays of several shapes as one, with NaN where one has nothing."""
    whole = numpy.full((len(arrays), *shape), numpy.nan)
    for k, array in enumerate(arrays):
        if array is not None:
            array = array.reshape(of_rank(array.shape, len(shape)))
            whole[(k, *(slice(0, n) for n in array.shape))] = array
    return whole


def common_shape(shapes):
    """The smallest shape that holds all."""
    rank = max(map(len, shapes), default=0)
    return tuple(max(lengths) for lengths in zip(*(of_rank(shape, rank) for shape in shapes)))


def table_of(records):
    """Records as columns; metrics as one array each. A run that was cut off has no more than its status and its time."""
    names = list(dict.fromkeys(name for record in records for name in record['values']))
    known = {key for record in records for key in record}
    table = {key: numpy.array([record.get(key, UNKNOWN.get(key, 0)) for record in records], kind) for key, kind in NUMBERS.items() if key in known}
    table.update({key: [record.get(key, '') for record in records] for key in TEXTS if key in known})
    values = {name: [record['values'].get(name) for record in records] for name in names}
    table['metrics'] = {name: padded(arrays, common_shape([a.shape for a in arrays if a is not None]))
                        for name, arrays in values.items()}
    return table


def write_columns(group, table):
    for key in [key for key in NUMBERS if key in table]:
        group.create_dataset(key, data=table[key])
    for key in [key for key in TEXTS if key in table]:
        group.create_dataset(key, data=table[key], dtype=h5py.string_dtype())
    for name, values in table['metrics'].items():
        group.create_dataset('metrics/' + name, data=values)


def read_part(data):
    with h5py.File(io.BytesIO(data), 'r') as file:
        table = {'build': file.attrs.get('build', ''), **{key: file[key][()] for key in NUMBERS if key in file}}
        table.update({key: file[key].asstr()[()] for key in TEXTS if key in file})
        table['metrics'] = {name: values[()] for name, values in file.get('metrics', {}).items()}
    return table


class Store:
    """The folder of one sweep."""

    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        self.parts = os.path.join(self.folder, 'parts')
        self.results = os.path.join(self.folder, 'results.h5')
        self.lock, self.damaged = None, set()

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def has_plan(self):
        return os.path.exists(self.path('plan.json'))

    def begun(self):
        """Whether runs of a sweep are here, or on their way."""
        return self.has_plan() and bool(self.part_names() or os.path.exists(self.path('jobs.json')))

    def plan_text(self):
        with open(self.path('plan.json'), encoding='utf-8') as file:
            return file.read()

    def fingerprint(self):
        try:
            return Plan.from_text(self.plan_text()).fingerprint()
        except (ValueError, KeyError, TypeError, AttributeError):
            raise Refused(f'{self.path("plan.json")} is damaged: --output takes another folder')

    def details(self, numbers):
        """What is said of some runs in results.h5."""
        with h5py.File(self.results, 'r') as file:
            rows = numpy.searchsorted(file['number'][()], numbers)
            return dict(zip(numbers, file['detail'].asstr()[()][rows]))

    def begin(self, plan):
        os.makedirs(self.parts, exist_ok=True)
        self.seize()
        self.clear()
        write_whole(self.path('plan.json'), lambda file: file.write(plan.text().encode()))

    def clear(self):
        """Removes what write_whole() has left half written in processes that were killed. Workers may be writing now, not for
        an hour."""
        for folder in (self.folder, self.parts, self.path('rounds')):
            for path in glob.glob(os.path.join(glob.escape(folder), '*.tmp')):
                with contextlib.suppress(FileNotFoundError):  # one that is whole now
                    is_ours = HALF_WRITTEN.fullmatch(os.path.basename(path)) and os.path.isfile(path)
                    if is_ours and time.time() - os.path.getmtime(path) > LONGEST_WRITE:
                        os.unlink(path)

    def seize(self):
        """Two programs never write into one folder."""
        self.lock = open(self.path('lock'), 'a', encoding='utf-8')
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Refused(f'another sweep is writing into {self.folder}')

    def keep(self, records):
        """Writes the runs of a chunk, which one process has made."""
        data = io.BytesIO()
        with h5py.File(data, 'w') as file:
            write_columns(file, table_of(records))
            file.attrs['build'] = next((record['build'] for record in records if 'build' in record), '')
        digest = hashlib.sha256(data.getbuffer()).hexdigest()[:16]
        failed = sum(record['status'] != 'ok' for record in records)
        name = f'part-{records[0]["number"]:09d}-{len(records)}-{failed}-{digest}.h5'
        write_whole(os.path.join(self.parts, name), lambda file: file.write(data.getbuffer()))

    def part_names(self):
        return {name for name in os.listdir(self.parts) if PART.fullmatch(name)} if os.path.isdir(self.parts) else set()

    def parts_beginning_in(self, numbers):
        """The parts whose first run is one of these. What works on its own share of the runs need not read all parts."""
        return {name for name in self.part_names() if int(PART.fullmatch(name)['first']) in numbers}

    def whole_parts(self, names=None):
        """The tables of parts that are as they were written, in the order of their names."""
        for name in sorted(self.part_names() if names is None else names):
            with open(os.path.join(self.parts, name), 'rb') as file:
                data = file.read()
            if hashlib.sha256(data).hexdigest()[:16] == PART.fullmatch(name)['digest']:
                yield read_part(data)
            else:
                self.damaged.add(name)

    def status(self, names=None):
        """What is known of each run that has a record: its status by its number."""
        return self.survey(names)[0]

    def survey(self, names=None):
        """The status of each run by its number, the shape that holds all values of each metric, and the builds of the physics that
        have made them. A record that may be another on another day stands back behind any other."""
        known, shapes, builds = {}, {}, set()
        for table in self.whole_parts(names):
            builds.add(table['build'])
            for number, status in zip(table['number'].tolist(), table['status']):
                if number not in known or known[number] in AGAIN:
                    known[number] = status
            for name, values in table['metrics'].items():
                shapes.setdefault(name, set()).add(values.shape[1:])
        return known, {name: common_shape(found) for name, found in shapes.items()}, builds - {''}

    def counts(self):
        """How many runs the parts hold, and how many of them have failed, by the names of the parts alone."""
        found = [PART.fullmatch(name) for name in self.part_names()]
        return tuple(sum(int(part[key]) for part in found) for key in ('runs', 'failed'))

    def last_log(self, name):
        """The end of what the workers of a round have said."""
        for path in sorted(glob.glob(glob.escape(self.path('logs', name)) + '*.log')):
            with open(path, encoding='utf-8', errors='replace') as file:
                said = file.read().strip()
            if said:
                return said[-1000:]
        return 'nothing'

    def gather(self, plan, versions):
        """Makes results.h5, and a table of words where that is small, of the parts that are there now: workers may go on and write
        more. Returns the status of each run."""
        names = self.part_names()
        known, shapes, _ = self.survey(names)
        if not known:
            return known

        def write(raw):
            sink, mask = Sink(raw.raw), signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPTS)
            try:
                with h5py.File(sink, 'w') as file:
                    self.fill(file, plan, known, shapes, names, sink.check)
                    file.attrs.update({'runs': len(known), 'planned': plan.count, 'complete': len(known) == plan.count,
                                       'fingerprint': plan.fingerprint(), 'versions': json.dumps(versions)})
                sink.check()
                for old in (CSV, PARTIAL_CSV):  # no table stands beside results of another time
                    with contextlib.suppress(FileNotFoundError):
                        os.unlink(self.path(old))
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, mask)

        write_whole(self.results, write)
        self.write_csv(plan, CSV if len(known) == plan.count else PARTIAL_CSV)
        return known

    def fill(self, file, plan, known, shapes, names, check):
        """The table of the runs in the order of their numbers. `check` raises what has gone wrong so far."""
        numbers = numpy.array(sorted(known), numpy.int64)
        meaningless = OF_SCENES_ALONE if plan.program else OF_PROGRAMS_ALONE
        columns = {key: numpy.full(len(numbers), UNKNOWN.get(key, 0), kind) for key, kind in NUMBERS.items() if key not in meaningless}
        texts = {key: numpy.full(len(numbers), '', object) for key in TEXTS if key not in meaningless}
        metrics = {}
        for entry in plan.tree['measure']:
            shape = shapes.get(entry['name'], ())
            metrics[entry['name']] = file.create_dataset('metrics/' + entry['name'], (len(numbers), *shape), float,
                                                         fillvalue=numpy.nan, **layout((len(numbers), *shape)))
        for table in self.whole_parts(names):
            use = [k for k, (number, status) in enumerate(zip(table['number'].tolist(), table['status']))
                   if known[number] == status]
            use.sort(key=lambda k, order=table['number']: order[k])
            if not use:
                continue
            check()
            rows = numpy.searchsorted(numbers, table['number'][use])
            for key in columns.keys() & table:
                columns[key][rows] = table[key][use]
            for key in texts.keys() & table:
                texts[key][rows] = table[key][use]
            for name, values in table['metrics'].items():
                fill_rows(metrics[name], rows, values[use])
        for key, column in columns.items():
            file.create_dataset(key, data=column)
        for key, column in texts.items():
            file.create_dataset(key, data=column, dtype=h5py.string_dtype())
        self.write_parameters(file, plan, numbers)
        file.create_dataset('plan', data=plan.text(), dtype=h5py.string_dtype())

    @staticmethod
    def write_parameters(file, plan, numbers):
        """A dataset for each path that varies, and the seed of each run. What is no number is JSON."""
        found = [plan.parameters(number) for number in numbers.tolist()]
        file.create_dataset('seed', data=numpy.array([seed for seed, _ in found], numpy.uint64))
        group = file.create_group('parameters')
        for axis in plan.axes:
            values = [parameters[axis.path] for _, parameters in found]
            kind = kind_of(values)
            data = numpy.array(values, kind) if kind else texts_of(values)
            column = group.create_dataset(name_in_file(axis.path), data=data, dtype=kind or h5py.string_dtype())
            column.attrs['path'] = axis.path

    def write_csv(self, plan, name):
        """A line for each run, without metrics that are tables or many numbers, and without the output of programs. Left out where
        it would be large."""
        columns = {}

        def add(name, values, where):
            """A column; where another has this name, with the key of the file that it stands below."""
            while name in columns or name in NUMBERS or name in TEXTS:
                name = f'{where}.{name}'
            columns[name] = values

        with h5py.File(self.results, 'r') as file:
            if len(file['number']) > MOST_CSV_RUNS:
                return
            columns['number'], columns['seed'] = file['number'][()], file['seed'][()]
            for axis in plan.axes:
                values = file['parameters'][name_in_file(axis.path)]
                add(axis.path, (values.asstr() if values.dtype == object else values)[()], 'vary')
            for entry in plan.tree['measure']:
                values = file['metrics'][entry['name']]
                if values.ndim == 1:
                    add(entry['name'], values[()], 'measure')
                elif in_csv(values.shape):
                    for k, column in enumerate(values[()].T):
                        add(f'{entry["name"]}_{k}', column, 'measure')
            columns.update({name: file[name].asstr()[()] for name in TEXTS if name in file and name != 'output'})
            columns.update({name: file[name][()] for name in NUMBERS if name in file and name not in ('number', 'hash')})
            if 'hash' in file:
                columns['hash'] = numpy.array([f'{value:016x}' for value in file['hash'][()].tolist()])
        text = io.StringIO()
        writer = csv.writer(text, lineterminator='\n')
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values())))
        write_whole(self.path(name), lambda file: file.write(text.getvalue().encode()))


def in_csv(shape):
    """Whether results.csv has columns for a metric of this shape, runs first."""
    return len(shape) == 1 or (len(shape) == 2 and math.prod(shape) <= MOST_CSV_NUMBERS)


def kind_of(values):
    """The type that holds all values as they are; None where they are stored as text."""
    if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return None
    whole = [value for value in values if isinstance(value, int)]
    low, high = min(whole, default=0), max(whole, default=0)
    if len(whole) == len(values) and -2 ** 63 <= low and high < 2 ** 63:
        return numpy.int64
    if len(whole) == len(values) and 0 <= low and high < 2 ** 64:
        return numpy.uint64
    return float if max(-low, high) <= 2 ** 53 else None


def texts_of(values):
    """Words as they are, all else as JSON; so is a word that HDF5 does not take, or that would be taken for JSON beside others."""
    mixed = not all(is_word(value) for value in values)
    return [value if is_word(value) and not (mixed and is_json(value)) else json.dumps(value) for value in values]


def is_word(value):
    """Whether HDF5 takes it as it is."""
    return isinstance(value, str) and '\0' not in value and value.encode(errors='replace').decode() == value


def is_json(text):
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return False
    return True


def name_in_file(path):
    """HDF5 takes '/' for a folder."""
    return path.replace('/', ':')


def layout(shape):
    """Checksums for all values, and compression for states."""
    if 0 in shape:
        return {}
    rows = CHUNK_BYTES // (8 * int(numpy.prod(shape[1:])))
    compressed = {'compression': 'gzip', 'compression_opts': 1, 'shuffle': True} if len(shape) > 2 else {}
    return {'chunks': (max(1, min(shape[0], rows)), *shape[1:]), 'fletcher32': True, **compressed}


def fill_rows(dataset, rows, values):
    """Writes values of a part, which may be smaller than the rows of the whole."""
    values = values.reshape(len(values), *of_rank(values.shape[1:], dataset.ndim - 1))
    inner = tuple(slice(0, n) for n in values.shape[1:])
    if rows[-1] - rows[0] + 1 == len(rows):
        dataset[(slice(rows[0], rows[-1] + 1), *inner)] = values
    else:
        for row, value in zip(rows, values):
            dataset[(row, *inner)] = value
