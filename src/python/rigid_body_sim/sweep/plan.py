# SPDX-License-Identifier: BSD-3-Clause
"""What a sweep is: its file read and checked, and its tasks, each with a number, a seed and its parameters.

A task follows from the plan and its number alone. Its random words are those of NumPy's
SeedSequence(seed of the sweep, spawn_key=(number,)): the first is the seed of the task, and each parameter that is drawn
takes the next. So they depend on no other task, on no order and on no worker.
"""
import hashlib
import json
import math
import os
import statistics

import numpy

from . import metrics, stops
from .tree import Refused, read, replaced, split

MOST_RUNS = 10_000_000
MOST_VALUES = 1_000_000  # of one key
MOST_CHECKED = 1000  # values that are tried before the sweep begins
KEYS = ('scene', 'seed', 'duration', 'steps', 'repeats', 'vary', 'stop', 'measure', 'max_seconds')
RUN_SEED = 'run_seed'  # as a value: the seed of the task
DRAWS = {'uniform': 'a smaller and a larger number', 'log_uniform': 'a smaller and a larger number above 0',
         'normal': 'a mean and a standard deviation above 0', 'integers': 'a smaller and a larger whole number'}


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_whole(value, low, high):
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def words_of(seed, number, count):
    """The first random 64-bit words of a task."""
    return [int(word) for word in numpy.random.SeedSequence(seed, spawn_key=(number,)).generate_state(count, numpy.uint64)]


def drawn(kind, a, b, word):
    """A value of a distribution from one random word."""
    if kind == 'integers':
        return a + (word * (b - a + 1) >> 64)
    share = ((word >> 11) + 0.5) * 2.0 ** -53  # above 0 and below 1
    if kind == 'uniform':
        return a + (b - a) * share
    if kind == 'log_uniform':
        return a * (b / a) ** share
    return statistics.NormalDist(a, b).inv_cdf(share)


def spread(kind, a, b, count):
    """Values from a to b, both included, at equal distances or equal ratios. Whole numbers stay whole where all are."""
    shares = [k / (count - 1) for k in range(count)]
    if kind == 'log_range':
        return [a] + [a * (b / a) ** share for share in shares[1:-1]] + [b]
    values = [a + (b - a) * share for share in shares[:-1]] + [b]
    if isinstance(a, int) and isinstance(b, int) and (b - a) % (count - 1) == 0:
        return [a + (b - a) // (count - 1) * k for k in range(count)]
    return values


class Axis:
    """One key of the scene that varies: `values`, or `draw`, a distribution with two numbers or RUN_SEED."""

    def __init__(self, path, values=None, draw=None):
        self.path, self.values, self.draw = path, values, draw

    def as_tree(self):
        return {'path': self.path, 'values': self.values, 'draw': self.draw}


class Task:
    """One run: its number, its seed, its parameters by path in the order of the file, and its scene as a tree."""

    def __init__(self, number, seed, parameters, scene):
        self.number, self.seed, self.parameters, self.scene = number, seed, parameters, scene


class Plan:
    """A whole sweep. `tree` holds all of it, scene and code of the user included, so it can be sent anywhere."""

    def __init__(self, tree):
        self.tree = tree
        self.axes = [Axis(**axis) for axis in tree['axes']]
        self.combinations = math.prod(len(axis.values) for axis in self.axes if axis.values is not None)
        self.count = self.combinations * tree['repeats']
        self.max_seconds = tree['max_seconds']
        self.references = {}  # positions at the end of reference runs, by scene and steps

    @staticmethod
    def from_text(text):
        return Plan(json.loads(text))

    def text(self):
        return json.dumps(self.tree)

    def fingerprint(self):
        """Equal for sweeps with equal results. How long a run may take decides nothing else."""
        decisive = {key: value for key, value in self.tree.items() if key != 'max_seconds'}
        return hashlib.sha256(json.dumps(decisive, sort_keys=True).encode()).hexdigest()

    def parameters(self, number):
        """Seed and parameters of a task. The repeats of a combination follow each other; of the axes the last is the
        fastest."""
        drawn_axes = [axis for axis in self.axes if axis.draw and axis.draw != RUN_SEED]
        seed, *words = words_of(self.tree['seed'], number, 1 + len(drawn_axes))
        combination, found = number // self.tree['repeats'], {}
        for axis in reversed(self.axes):
            if axis.draw == RUN_SEED:
                found[axis.path] = seed
            elif axis.draw:
                found[axis.path] = drawn(*axis.draw, words[drawn_axes.index(axis)])
            else:
                combination, index = divmod(combination, len(axis.values))
                found[axis.path] = axis.values[index]
        return seed, {axis.path: found[axis.path] for axis in self.axes}

    def task(self, number):
        seed, parameters = self.parameters(number)
        scene = self.tree['scene']
        for path, value in parameters.items():
            scene = replaced(scene, path, value)
        return Task(number, seed, parameters, scene)

    def steps(self, step):
        """How many steps a run takes at most, where a step is this long, s."""
        return self.tree['steps'] or max(1, round(self.tree['duration'] / step))


class Reader:
    """Reads a sweep file and collects its faults."""

    def __init__(self, file, find_scene):
        self.file, self.find_scene, self.faults = file, find_scene, []
        try:
            with open(file, encoding='utf-8') as text:
                self.tree, self.lines = read(text.read(), file)
        except (OSError, UnicodeDecodeError) as error:
            raise Refused(f'{file} cannot be read: {getattr(error, "strerror", None) or error}')
        if not isinstance(self.tree, dict):
            raise Refused(f'{file}: no mapping (keys: {" ".join(KEYS)})')
        self.folder = os.path.dirname(os.path.abspath(file))

    def fault(self, path, text):
        place, known = '', path
        while known and known not in self.lines:
            known = known[:-1]
        for key in path:
            place += f'[{key}]' if isinstance(key, int) else ('.' if place else '') + str(key)
        self.faults.append(f'{self.file}:{self.lines.get(known, 1)}: {place}: {text}')

    def whole(self, key, low, high, default):
        value = self.tree.get(key, default)
        if not is_whole(value, low, high):
            self.fault((key,), f'{value!r} (allowed: a whole number from {low} to {high})')
            return low
        return value

    def above_zero(self, key, default=None):
        value = self.tree.get(key, default)
        if value is not None and not (is_number(value) and value > 0):
            self.fault((key,), f'{value!r} (allowed: a number above 0, in s)')
            return 1.0
        return value

    def scene(self):
        """The tree of the scene, with absolute paths of meshes."""
        given = self.tree.get('scene')
        if isinstance(given, dict):
            tree, folder = given, self.folder
        elif isinstance(given, str):
            path = os.path.join(self.folder, given) if '/' in given or given.endswith('.yaml') else self.find_scene(given)
            try:
                with open(path, encoding='utf-8') as text:
                    tree, _ = read(text.read(), path)
            except OSError as error:
                self.fault(('scene',), f'{path} cannot be read: {error.strerror}')
                return {}
            folder = os.path.dirname(os.path.abspath(path))
            if not isinstance(tree, dict):
                raise Refused(f'{path}: no scene')
            tree.setdefault('name', os.path.splitext(os.path.basename(path))[0])
        else:
            self.fault(('scene',), f'{given!r} (allowed: a name of the catalogue, the path of a scene, or a scene)')
            return {}
        for body in tree.get('bodies') or []:
            mesh = body.get('mesh') if isinstance(body, dict) else None
            if isinstance(mesh, str) and not mesh.startswith('package://'):
                body['mesh'] = os.path.join(folder, mesh)
        return tree

    def axis(self, path, given):
        where = ('vary', path)
        try:
            split(path)
        except Refused as error:
            self.fault(where, str(error))
        if isinstance(given, list):
            if not given:
                self.fault(where, 'an empty list (allowed: at least one value)')
            return Axis(path, values=given)
        if given == RUN_SEED:
            return Axis(path, draw=RUN_SEED)
        kinds = ('range', 'log_range', *DRAWS)
        chosen = [kind for kind in kinds if isinstance(given, dict) and kind in given]
        if len(chosen) != 1 or set(given) - {chosen[0], 'count'}:
            self.fault(where, f'{given!r} (allowed: a list, {RUN_SEED}, or a mapping with one of {", ".join(kinds)})')
            return Axis(path, values=[None])
        kind, ends = chosen[0], given[chosen[0]]
        if not (isinstance(ends, list) and len(ends) == 2 and all(is_number(end) for end in ends)):
            self.fault(where + (kind,), f'{ends!r} (allowed: [number, number])')
            return Axis(path, values=[None])
        return self.drawn_axis(path, kind, ends, given) if kind in DRAWS else self.spread_axis(path, kind, ends, given)

    def drawn_axis(self, path, kind, ends, given):
        a, b = ends
        sound = {'uniform': a < b, 'log_uniform': 0 < a < b, 'normal': b > 0,
                 'integers': isinstance(a, int) and isinstance(b, int) and a < b <= a + 2 ** 63}[kind]
        if not sound:
            self.fault(('vary', path, kind), f'{ends!r} (allowed: {DRAWS[kind]})')
        if 'count' in given:
            self.fault(('vary', path, 'count'), "a distribution is drawn from once a run; 'repeats' says how often")
        return Axis(path, draw=[kind, a, b])

    def spread_axis(self, path, kind, ends, given):
        count = given.get('count')
        if not is_whole(count, 2, MOST_VALUES):
            self.fault(('vary', path, 'count'), f'{count!r} (allowed: a whole number from 2 to {MOST_VALUES})')
            return Axis(path, values=[None])
        if ends[0] == ends[1] or (kind == 'log_range' and min(ends) <= 0):
            allowed = 'two different numbers' + (' above 0' if kind == 'log_range' else '')
            self.fault(('vary', path, kind), f'{ends!r} (allowed: {allowed})')
            return Axis(path, values=[None])
        return Axis(path, values=spread(kind, *ends, count))

    def axes(self):
        varied = self.tree.get('vary', {})
        if not isinstance(varied, dict):
            self.fault(('vary',), f'{varied!r:.60} (allowed: a mapping of paths)')
            return []
        return [self.axis(path, given) for path, given in varied.items()]

    def parts(self, key, catalogue):
        """Metrics or stops: the named entries of a mapping, each checked by its class."""
        given, found = self.tree.get(key, {}), []
        if not isinstance(given, dict):
            self.fault((key,), f'{given!r:.60} (allowed: a mapping)')
            return []
        for name, entry in given.items():
            try:
                found.append(catalogue.checked(name, entry, self.folder))
            except Refused as error:
                for text in error.faults:
                    self.fault((key, name), text)
        return found

    def read(self):
        for key in self.tree:
            if key not in KEYS:
                self.fault((key,), f'unknown key; keys: {" ".join(KEYS)}')
        duration = self.above_zero('duration')
        steps = self.whole('steps', 1, 10 ** 12, 1) if 'steps' in self.tree else None
        if (duration is None) == (steps is None):
            self.fault(('duration',), "exactly one of 'duration' (s) and 'steps' says how long a run is")
        tree = {'scene': self.scene(), 'seed': self.whole('seed', 0, 2 ** 64 - 1, 1), 'duration': duration, 'steps': steps,
                'repeats': self.whole('repeats', 1, 10 ** 15, 1), 'axes': [axis.as_tree() for axis in self.axes()],
                'stop': self.parts('stop', stops), 'measure': self.parts('measure', metrics),
                'max_seconds': self.above_zero('max_seconds', 600.0)}
        if self.faults:
            raise Refused(*self.faults)
        plan = Plan(tree)
        if plan.count > MOST_RUNS:
            factors = [f'{len(axis.values):,} of {axis.path}' for axis in plan.axes if axis.values is not None]
            factors.append(f'{plan.tree["repeats"]:,} repeats')
            self.fault(('vary',), f'{" x ".join(factors)} are {plan.count:,} runs (allowed: {MOST_RUNS:,})')
            raise Refused(*self.faults)
        return plan


def checked_numbers(plan):
    """Tasks that together have every value of each axis, the others at their first: their numbers, and the axis."""
    numbers, stride = {0: None}, plan.tree['repeats']
    for axis in reversed(plan.axes):
        if axis.values is not None:
            for k in range(1, len(axis.values)):
                numbers.setdefault(k * stride, axis.path)
            stride *= len(axis.values)
    return dict(list(numbers.items())[:MOST_CHECKED])
