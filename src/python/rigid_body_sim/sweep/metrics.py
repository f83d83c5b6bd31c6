# SPDX-License-Identifier: BSD-3-Clause
"""What is measured in a run. A metric is made for a run before its first step; `observe` is called at the beginning and
after each step, where there is one; `value` is called at the end and gives a number or an array of any shape."""
import copy
import functools
import json
import math

import numpy

from . import meshes, users_code
from .tree import Refused, replaced

REFERENCES_KEPT = 16


def number_above_zero(value, what):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not (0 < value < math.inf):
        raise Refused(f'{what}: {value!r} (allowed: a number above 0)')
    return value


def with_defaults(argument, short, defaults):
    """The argument as a mapping with all its keys. What is no mapping stands for the key `short`."""
    given = {} if argument is None else argument if isinstance(argument, dict) else {short: argument}
    unknown = [key for key in given if key not in defaults]
    if unknown:
        raise Refused(f'{unknown[0]}; unknown key; keys: {" ".join(defaults)}')
    return {**defaults, **given}


def check_bodies(bodies):
    names = bodies if isinstance(bodies, list) else [bodies]
    if not names or not all(isinstance(name, str) for name in names):
        raise Refused(f"{bodies!r} (allowed: the name of a body, a list of names, or 'all')")


def bodies_of(world, bodies):
    """Indices of bodies in the arrays of a world."""
    if bodies == 'all':
        return list(range(len(world.names)))
    places = {name: k for k, name in enumerate(world.names)}
    names = bodies if isinstance(bodies, list) else [bodies]
    for name in names:
        if name not in places:
            raise Refused(f"no body is named '{name}' (there are: {', '.join(world.names):.300})")
    return [places[name] for name in names]


def no_argument(argument):
    if argument is not None:
        raise Refused(f'{argument!r} (allowed: nothing)')


class Final:
    """Some of the 13 numbers of a body at the end: an array; of several bodies, an array (bodies, numbers)."""

    @staticmethod
    def check(argument):
        check_bodies(argument)
        return argument

    def __init__(self, bodies, run, columns):
        self.bodies, self.columns = bodies_of(run.world, bodies), columns
        self.is_one = isinstance(bodies, str) and bodies != 'all'

    def value(self, world):
        values = world.states[self.bodies, self.columns]
        return values[0] if self.is_one else values


class Posture:
    """Whether bodies stand as at the beginning: none is lower by more than `drop`, m, and none is tilted from its first
    upright by more than `tilt`, degrees."""

    DEFAULTS = {'bodies': 'all', 'drop': 0.1, 'tilt': 45.0}

    @staticmethod
    def check(argument):
        given = with_defaults(argument, 'bodies', Posture.DEFAULTS)
        check_bodies(given['bodies'])
        number_above_zero(given['drop'], 'drop')
        number_above_zero(given['tilt'], 'tilt')
        return given

    def __init__(self, argument, run):
        self.bodies, self.drop = bodies_of(run.world, argument['bodies']), argument['drop']
        self.least = math.cos(math.radians(min(argument['tilt'], 180.0)))
        self.height, self.up = self.now(run.world)

    def now(self, world):
        """Heights, and the world's vertical in each body's frame."""
        return world.positions[self.bodies, 2], vertical_in_body(world.orientations[self.bodies])

    def value(self, world):
        height, up = self.now(world)
        tilted = numpy.sum(up * self.up, axis=1) < self.least
        return float(not (numpy.any(tilted) or numpy.any(height < self.height - self.drop)))


def vertical_in_body(orientations):
    """The third row of the rotation matrices of unit quaternions."""
    x, y, z, w = orientations.T
    return numpy.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)


def energy(world):
    totals = world.totals()
    return totals.kinetic_energy + totals.potential_energy


class Energy:
    """Kinetic and potential energy of the dynamic bodies at the end, J."""

    check = staticmethod(no_argument)

    def __init__(self, argument, run):
        pass

    def value(self, world):
        return energy(world)


class EnergyChange:
    """Energy at the end less that at the beginning, J."""

    check = staticmethod(no_argument)

    def __init__(self, argument, run):
        self.before = energy(run.world)

    def value(self, world):
        return energy(world) - self.before


class Penetration:
    """The deepest penetration at the end of any step, m."""

    check = staticmethod(no_argument)

    def __init__(self, argument, run):
        self.deepest = 0.0

    def observe(self, world, report):
        if report is not None:
            self.deepest = max(self.deepest, report.deepest_penetration)

    def value(self, world):
        return self.deepest


class Rest:
    """Whether bodies move at no more than `speed`, m/s and rad/s."""

    DEFAULTS = {'speed': 0.01, 'bodies': 'all'}

    @staticmethod
    def check(argument):
        given = with_defaults(argument, 'speed', Rest.DEFAULTS)
        check_bodies(given['bodies'])
        number_above_zero(given['speed'], 'speed')
        return given

    def __init__(self, argument, run):
        self.bodies, self.speed = bodies_of(run.world, argument['bodies']), argument['speed']
        if argument['bodies'] == 'all':
            self.bodies = slice(None)

    def holds(self, world):
        return all(numpy.max(numpy.einsum('ij,ij->i', part, part), initial=0.0) <= self.speed ** 2 for part in (
            world.velocities[self.bodies], world.angular_velocities[self.bodies]))


class TimeToRest(Rest):
    """The time since the beginning of the run from which on the bodies rest until its end, s; not a number where they move then."""

    since = math.nan

    def __init__(self, argument, run):
        super().__init__(argument, run)
        self.begin = run.world.time

    def observe(self, world, report):
        if not self.holds(world):
            self.since = math.nan
        elif math.isnan(self.since):
            self.since = world.time - self.begin

    def value(self, world):
        return self.since


class DistanceToReference:
    """Distance of the body that is farthest from its position in a reference run at the same time, m. The reference is
    the same scene with other values at some paths."""

    @staticmethod
    def check(argument):
        if not isinstance(argument, dict) or not argument:
            raise Refused(f'{argument!r} (allowed: paths of the scene with their values in the reference)')
        return argument

    def __init__(self, argument, run):
        self.scene, self.begin = run.task.scene, run.world.time
        self.references, self.positions_of = run.plan.references, run.positions_of
        try:
            for path, value in argument.items():
                self.scene = replaced(self.scene, path, value)
            self.step = run.step_of(self.scene)
        except Refused as error:
            raise Refused(*(f'the reference: {fault}' for fault in error.faults))

    def value(self, world):
        seconds = world.time - self.begin
        steps = round(seconds / self.step)
        if not math.isclose(steps * self.step, seconds, rel_tol=1e-9):
            raise ValueError(f'steps of {self.step} s of the reference never end at {seconds} s')
        return float(numpy.max(numpy.linalg.norm(world.positions - self.positions(steps), axis=1)))

    def positions(self, steps):
        """Those of the reference, which many runs of a sweep may share."""
        key = (json.dumps(self.scene), steps)
        positions = self.references.get(key)
        if positions is None:
            positions = self.positions_of(self.scene, steps)
            if len(self.references) >= REFERENCES_KEPT:
                self.references.clear()
            self.references[key] = positions
        return positions


class States:
    """The states of bodies at the beginning and every so many steps: an array (samples, bodies, 13)."""

    DEFAULTS = {'every': 1, 'bodies': 'all'}

    @staticmethod
    def check(argument):
        given = with_defaults(argument, 'every', States.DEFAULTS)
        check_bodies(given['bodies'])
        if not isinstance(given['every'], int) or given['every'] < 1:
            raise Refused(f'every: {given["every"]!r} (allowed: a whole number of steps from 1)')
        return given

    def __init__(self, argument, run):
        self.bodies, self.every, self.samples = bodies_of(run.world, argument['bodies']), argument['every'], []
        self.begin = run.world.steps

    def observe(self, world, report):
        if (world.steps - self.begin) % self.every == 0:
            self.samples.append(world.states[self.bodies])

    def value(self, world):
        return numpy.array(self.samples)


class Python:
    """What a function(world, parameters) of the user's file returns at the end: a number or an array of numbers. The world is
    a copy, so that no metric changes another."""

    def __init__(self, code, run):
        self.function, self.parameters = run.files.function(**code), copy.deepcopy(run.task.parameters)

    def value(self, world):
        return self.function(world.copy(), self.parameters)


KINDS = {'final_position': functools.partial(Final, columns=slice(0, 3)),
         'final_pose': functools.partial(Final, columns=slice(0, 7)),
         'final_velocity': functools.partial(Final, columns=slice(7, 13)),
         'stood': Posture, 'energy': Energy, 'energy_change': EnergyChange, 'penetration': Penetration,
         'time_to_rest': TimeToRest, 'distance_to_reference': DistanceToReference, 'states': States, 'python': Python}


def kind_and_argument(entry, kinds):
    """'energy' or {final_position: ball}."""
    if isinstance(entry, str) and entry in kinds:
        return entry, None
    if isinstance(entry, dict) and len(entry) == 1 and next(iter(entry)) in kinds:
        return next(iter(entry.items()))
    raise Refused(f'{entry!r:.100} (allowed: one of {", ".join(kinds)}, alone or with what it takes)')


def named(name):
    if not isinstance(name, str) or '/' in name or '\0' in name or name in ('', '.'):
        raise Refused("it is no name (allowed: any word without '/')")
    return name


def checked(name, entry, folder):
    named(name)
    kind, argument = kind_and_argument(entry, KINDS)
    if kind == 'python':
        return {'name': name, 'kind': kind, 'argument': users_code.checked(argument, folder)}
    made = KINDS[kind]
    argument = getattr(made, 'func', made).check(argument)
    if kind == 'distance_to_reference':
        argument = {path: meshes.from_root_at(path, value, folder) for path, value in argument.items()}
    return {'name': name, 'kind': kind, 'argument': argument}


def made_for(run, entry):
    try:
        return KINDS[entry['kind']](entry['argument'], run)
    except Refused as error:
        raise Refused(*(f'measure.{entry["name"]}: {fault}' for fault in error.faults))
