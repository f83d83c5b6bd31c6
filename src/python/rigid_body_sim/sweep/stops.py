# SPDX-License-Identifier: BSD-3-Clause
"""What ends a run before its time. `holds` is asked after every step."""
from . import metrics, users_code
from .metrics import Posture, Rest
from .tree import Refused

REST_SECONDS = 0.5  # of simulated time: a ball at the top of its path rests for one step


class AtRest(Rest):
    """All bodies have rested for half a second."""

    since = None

    def holds(self, world):
        if not super().holds(world):
            self.since = None
            return False
        self.since = world.time if self.since is None else self.since
        return world.time - self.since >= REST_SECONDS


class Fell(Posture):
    """A body has fallen: it does not stand as at the beginning."""

    def holds(self, world):
        return not self.value(world)


class Python(metrics.Python):
    """A function(world, parameters) of the user's file returns what counts as true."""

    def holds(self, world):
        return bool(self.function(world, self.parameters))


KINDS = {'at_rest': AtRest, 'fell': Fell, 'python': Python}


def checked(name, argument, folder):
    if name not in KINDS:
        raise Refused(f'unknown key; keys: {" ".join(KINDS)}')
    checked_argument = users_code.checked(argument, folder) if name == 'python' else KINDS[name].check(argument)
    return {'name': name, 'argument': checked_argument}


def made_for(run, entry):
    try:
        return KINDS[entry['name']](entry['argument'], run)
    except Refused as error:
        raise Refused(*(f'stop.{entry["name"]}: {fault}' for fault in error.faults))
