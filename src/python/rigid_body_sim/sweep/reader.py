# SPDX-License-Identifier: BSD-3-Clause
"""Reads the file of a sweep and checks it: every fault has its place and says what is allowed."""
import hashlib
import os
import sys

from . import meshes, metrics, outputs, program, stops
from .plan import RUN_SEED, Axis, Plan
from .tree import Refused, place_of, read, replaced, split

MOST_RUNS = 10_000_000
MOST_VALUES = 1_000_000  # of one key
KEYS = ('scene', 'program', 'seed', 'duration', 'steps', 'repeats', 'vary', 'stop', 'measure', 'max_seconds')
NOT_OF_PROGRAMS = ('scene', 'duration', 'steps', 'stop')  # keys that mean nothing to a program
DRAWS = {'uniform': 'a smaller and a larger number', 'log_uniform': 'a smaller and a larger number above 0',
         'normal': 'a mean and a standard deviation above 0', 'integers': 'a smaller and a larger whole number'}


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def is_whole(value, low, high):
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def spread(kind, a, b, count):
    """Values from a to b, both included, at equal distances or equal ratios. Whole numbers stay whole where all are."""
    shares = [k / (count - 1) for k in range(count)]
    if kind == 'log_range':
        return [a] + [a * (b / a) ** share for share in shares[1:-1]] + [b]
    values = [a + (b - a) * share for share in shares[:-1]] + [b]
    if isinstance(a, int) and isinstance(b, int) and (b - a) % (count - 1) == 0:
        return [a + (b - a) // (count - 1) * k for k in range(count)]
    return values


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
        self.faults.append(f'{self.file}:{self.lines.get(known, 1)}: {place}: {text:.500}')

    def whole(self, key, low, high, default):
        value = self.tree.get(key, default)
        if not is_whole(value, low, high):
            self.fault((key,), f'{value!r} (allowed: a whole number from {low} to {high})')
            return low
        return value

    def above_zero(self, key, default=None):
        value = self.tree.get(key, default)
        if key in self.tree and not (is_number(value) and value > 0):
            self.fault((key,), f'{value!r} (allowed: a number above 0, in s)')
            return 1.0
        return value

    def scene(self):
        """The tree of the scene, with absolute paths of meshes."""
        given = self.tree.get('scene')
        if isinstance(given, dict):
            tree, folder = given, self.folder
        elif isinstance(given, str):
            is_path = '/' in given or given.endswith(('.yaml', '.yml'))
            path = os.path.join(self.folder, given) if is_path else self.find_scene(given)
            try:
                with open(path, encoding='utf-8') as file:
                    text = file.read()
            except (OSError, ValueError) as error:  # such as bytes that are no UTF-8, or a NUL in the path
                self.fault(('scene',), f'{path} cannot be read: {getattr(error, "strerror", None) or error}')
                return {}
            tree, _ = read(text, path)
            folder = os.path.dirname(os.path.abspath(path))
            if not isinstance(tree, dict):
                raise Refused(f'{path}: no scene')
            tree.setdefault('name', os.path.splitext(os.path.basename(path))[0])
        else:
            self.fault(('scene',), f'{given!r} (allowed: a name of the catalogue, the path of a scene, or a scene)')
            return {}
        return meshes.from_root(tree, folder)

    def length_and_scene(self):
        duration = self.above_zero('duration')
        steps = self.whole('steps', 1, 10 ** 12, 1) if 'steps' in self.tree else None
        if (duration is None) == (steps is None):
            self.fault(('duration',), "exactly one of 'duration' (s) and 'steps' says how long a run is")
        return {'scene': self.scene(), 'duration': duration, 'steps': steps}

    def command(self):
        """The program with its words, where it runs, and the digest of its file."""
        for key in NOT_OF_PROGRAMS:
            if key in self.tree:
                self.fault((key,), "it means nothing to a program; 'program' or 'scene' says what is run")
        words = self.tree['program']
        if not (isinstance(words, list) and words and all(isinstance(word, (str, int, float)) for word in words)):
            self.fault(('program',), f'{words!r:.60} (allowed: a list of words, the program first)')
            return {}
        words = [program.argument_of(word) for word in words]
        self.check_placeholders(words)
        try:
            path = program.found(words[0], self.folder)
        except Refused as error:
            self.fault(('program', 0), str(error))
            return {}
        with open(path, 'rb') as file:
            digest = hashlib.sha256(file.read()).hexdigest()
        return {'program': {'words': [path, *words[1:]], 'folder': self.folder, 'digest': digest}}

    def check_placeholders(self, words):
        varied, used = self.tree.get('vary', {}), set()
        varied = list(varied) if isinstance(varied, dict) else []
        known = dict.fromkeys([*varied, *program.GIVEN])
        for k, word in enumerate(words):
            for name in program.PLACEHOLDER.findall(word):
                used.add(name)
                if k == 0:
                    self.fault(('program', 0), f'{{{name}}}: the program itself does not vary')
                elif name not in known:
                    self.fault(('program', k), f'{{{name}}}: nothing varies it (there are: {", ".join(known)})')
        for name in varied:
            if name in program.GIVEN:
                self.fault(('vary', name), f'each run has its own (allowed: a name other than {", ".join(program.GIVEN)})')
            elif not program.PLACEHOLDER.fullmatch('{' + name + '}'):
                self.fault(('vary', name), 'it is no placeholder (allowed: letters, digits and _, no digit first)')
            elif name not in used:
                self.fault(('vary', name), f'no word of the program has {{{name}}}')

    def axis(self, path, given):
        where = ('vary', path)
        try:
            split(path)
        except Refused as error:
            self.fault(where, str(error))
            return Axis(path, values=[None])
        if isinstance(given, list):
            if not given:
                self.fault(where, 'an empty list (allowed: at least one value)')
            return Axis(path, values=[meshes.from_root_at(path, value, self.folder) for value in given])
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
        sound = {'uniform': a < b and is_number(b - a), 'log_uniform': 0 < a < b and is_number(b / a), 'normal': b > 0,
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
        if not is_number(float(ends[1]) - ends[0]) or (kind == 'log_range' and not is_number(float(ends[1]) / ends[0])):
            self.fault(('vary', path, kind), f'{ends!r}: from one to the other is more than a number holds')
            return Axis(path, values=[None])
        return Axis(path, values=spread(kind, *ends, count))

    def axes(self):
        varied = self.tree.get('vary', {})
        if not isinstance(varied, dict):
            self.fault(('vary',), f'{varied!r:.60} (allowed: a mapping of paths)')
            return []
        return [self.axis(path, given) for path, given in varied.items()]

    def check_overwriting(self, axes, scene):
        """No path may set what another has set, by another spelling or as a part of it. The scene is that of the first run."""
        set_by = {}
        for axis in axes:
            place = place_of(scene, axis.path)
            for other, path in set_by.items():
                if other[:len(place)] == place:
                    self.fault(('vary', axis.path), f"it replaces what '{path}' has set")
                    break
            set_by[place] = axis.path
            try:
                scene = replaced(scene, axis.path, axis.values[0]) if axis.values else scene
            except Refused:
                pass  # the check of the first run says so

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
        of_program = 'program' in self.tree
        what = self.command() if of_program else self.length_and_scene()
        tree = {**what, 'seed': self.whole('seed', 0, 2 ** 64 - 1, 1), 'repeats': self.whole('repeats', 1, 10 ** 15, 1)}
        axes = self.axes()
        tree['axes'] = [axis.as_tree() for axis in axes]
        if not of_program:
            tree['stop'] = self.parts('stop', stops)
        tree['measure'] = self.parts('measure', outputs if of_program else metrics)
        tree['max_seconds'] = self.above_zero('max_seconds', 600.0)
        if not self.faults and not of_program:
            self.check_overwriting(axes, tree['scene'])
        if self.faults:
            raise Refused(*self.faults)
        if not of_program:
            values = [{axis.path: value} for axis in axes for value in axis.values or []]
            tree['meshes'] = meshes.digests([tree['scene'], *values, tree['measure']])
        plan = Plan(tree)
        if plan.count > MOST_RUNS:
            factors = [f'{len(axis.values):,} of {axis.path}' for axis in plan.axes if axis.values is not None]
            factors.append(f'{plan.tree["repeats"]:,} repeats')
            self.fault(('vary',), f'{" x ".join(factors)} are {plan.count:,} runs (allowed: {MOST_RUNS:,})')
            raise Refused(*self.faults)
        return plan
