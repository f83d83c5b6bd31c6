# SPDX-License-Identifier: BSD-3-Clause
"""What a sweep is: its tasks, each with a number, a seed and its parameters.

A task follows from the plan and its number alone. Its random words are those of NumPy's
SeedSequence(seed of the sweep, spawn_key=(number,)): the first is the seed of the task, and each parameter that is drawn
takes the next. So they depend on no other task, on no order and on no worker.
"""
import hashlib
import itertools
import json
import math
import statistics

import numpy

from .tree import replaced

MOST_CHECKED = 1000  # values that are tried before the sweep begins
RUN_SEED = 'run_seed'  # as a value: the seed of the task


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


class Axis:
    """One key of a scene, or placeholder of a program, that varies: `values`, or `draw`, a distribution with two numbers or
    RUN_SEED."""

    def __init__(self, path, values=None, draw=None):
        self.path, self.values, self.draw = path, values, draw

    def as_tree(self):
        return {'path': self.path, 'values': self.values, 'draw': self.draw}


class Task:
    """One run: its number, its seed, its parameters by path in the order of the file, and its scene as a tree."""

    def __init__(self, number, seed, parameters, scene):
        self.number, self.seed, self.parameters, self.scene = number, seed, parameters, scene


class Plan:
    """A whole sweep. `tree` holds all of it, scene and code of the user included, so it can be sent anywhere; of a
    program its path and the digest of its file. `program` is None where a scene is run."""

    def __init__(self, tree):
        self.tree = tree
        self.axes = [Axis(**axis) for axis in tree['axes']]
        self.combinations = math.prod(len(axis.values) for axis in self.axes if axis.values is not None)
        self.count = self.combinations * tree['repeats']
        self.max_seconds, self.program = tree['max_seconds'], tree.get('program')
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


def checked_numbers(plan):
    """Tasks that together have every value of each axis, the others at their first: their numbers."""
    spans, stride = [], plan.tree['repeats']
    for axis in reversed(plan.axes):
        if axis.values is not None:
            spans.append([k * stride for k in range(1, len(axis.values))])
            stride *= len(axis.values)
    in_turn = (number for numbers in itertools.zip_longest(*spans) for number in numbers if number)
    return [0, *itertools.islice(in_turn, MOST_CHECKED - 1)]
