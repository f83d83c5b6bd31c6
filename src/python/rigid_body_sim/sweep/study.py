# SPDX-License-Identifier: BSD-3-Clause
"""What a program needs that rides on a sweep: it writes the file, has the runs made, and reads what came of them."""
import json
import os

import h5py

from . import command
from .plan import Plan
from .program import package_programs
from .store import folder_of


def carry(file, tree, engine=()):
    """Makes the runs of a sweep, or goes on with those that its folder holds. `engine` are words of `sweep` such as
    --workers 4. Returns its exit code."""
    os.makedirs(os.path.dirname(os.path.abspath(file)), exist_ok=True)
    with open(file, 'w', encoding='utf-8') as text:
        json.dump(tree, text, indent=1)
    resume = ['--resume'] if os.path.exists(os.path.join(folder_of(file), 'plan.json')) else []
    return command.main(os.path.join(package_programs(), 'sweep'), [file, *resume, *engine])


def records(file):
    """The runs of a program that have a result: number, parameters, status, detail, exit_status and output of each."""
    results = os.path.join(folder_of(file), 'results.h5')
    if not os.path.exists(results):
        return []
    with h5py.File(results, 'r') as table:
        plan = Plan.from_text(table['plan'].asstr()[()])
        numbers, status = table['number'][()].tolist(), table['exit_status'][()].tolist()
        texts = {key: table[key].asstr()[()].tolist() for key in ('status', 'detail', 'output')}
    return [{'number': number, 'parameters': plan.parameters(number)[1], 'exit_status': status[k],
             **{key: values[k] for key, values in texts.items()}} for k, number in enumerate(numbers)]
