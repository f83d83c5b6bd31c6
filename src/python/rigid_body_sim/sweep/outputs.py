# SPDX-License-Identifier: BSD-3-Clause
"""What is measured in the standard output of a program."""
import copy
import json
import math

from . import users_code
from .metrics import kind_and_argument, named
from .tree import Refused, split, value_at


class Json:
    """The number, or the array of numbers, at a path of an output that is JSON. null is NaN, true is 1."""

    @staticmethod
    def check(argument, folder):
        if not isinstance(argument, str):
            raise Refused(f'{argument!r} (allowed: a path, such as rows[0].error)')
        split(argument)
        return argument

    @staticmethod
    def value(path, output, parameters, files):
        return with_nan(value_at(json.loads(output), path))


class Python:
    """What a function(output, parameters) of the user's file returns: a number or an array of numbers."""

    check = staticmethod(users_code.checked)

    @staticmethod
    def value(code, output, parameters, files):
        return files.function(**code)(output, copy.deepcopy(parameters))


def with_nan(value):
    """JSON with NaN in place of null."""
    if isinstance(value, list):
        return [with_nan(entry) for entry in value]
    return math.nan if value is None else value


KINDS = {'json': Json, 'python': Python}


def checked(name, entry, folder):
    kind, argument = kind_and_argument(entry, KINDS)
    return {'name': named(name), 'kind': kind, 'argument': KINDS[kind].check(argument, folder)}


def measured(plan, output, parameters):
    """The value of each metric, and what went wrong."""
    values, faults, files = {}, [], users_code.Files()
    for entry in plan.tree['measure']:
        try:
            value = KINDS[entry['kind']].value(entry['argument'], output, parameters, files)
            values[entry['name']] = users_code.numbers(value)
        except Exception as error:  # whatever the output holds or a user's function raises
            faults.append(f'measure.{entry["name"]}: {users_code.said(error, entry["argument"])}')
    return values, faults
