# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/accuracy.md from the results of rigid_body_sim_accuracy. Usage: accuracy_page.py RESULTS DOCS"""
import json
import os
import shutil
import sys

LEVELS = ('0.001', '1e-06', '1e-09')
SETTINGS = ('preview', 'interactive', 'accurate', 'reference')


def seconds(value):
    if value is None:
        return '–'
    for unit, scale in (('s', 1.0), ('ms', 1e3), ('µs', 1e6)):
        if value * scale >= 1.0 or unit == 'µs':
            return f'{value * scale:.2g} {unit}' if value * scale < 100 else f'{value * scale:.0f} {unit}'


def error_text(row):
    if row is None:
        return ''
    if row['failure']:
        return f'× {row["failure"]}'
    if row['error'] >= 1.0:
        return f'× {row["error"]:.1g}'
    return f'{row["error"]:.1g}'


def usual(result, problem, engine, setting):
    """The row at the default step of a scene, 1/60 s."""
    rows = [r for r in result['rows'] if (r['problem'], r['engine'], r['setting']) == (problem, engine, setting)]
    return min(rows, key=lambda r: abs(r['step'] - 1 / 60)) if rows else None


def noise(result):
    """How far times of the same work differ: where all our settings give the same error to the bit, they do the same."""
    groups = {}
    for r in result['rows']:
        if r['engine'] == 'ours' and not r['failure'] and not r['base']:
            groups.setdefault((r['problem'], r['step'], r['error']), []).append(r['cpu_seconds'])
    ratios = sorted(max(times) / min(times) for times in groups.values() if len(times) == len(SETTINGS))
    if not ratios:
        return ''
    return (f'How noisy the machine was: the same work, timed four times, differs by a factor of {ratios[len(ratios) // 2]:.1f} '
            f'in the median and {ratios[-1]:.1f} at worst, so smaller ratios than that are a draw.')


def needless(result):
    """A sentence for each fidelity that a higher one beats on both error and time, with how often it does."""
    lines = []
    for low, high in zip(SETTINGS, SETTINGS[1:]):
        names = []
        for p in result['catalogue']['problems']:
            a, b = usual(result, p['name'], 'ours', low), usual(result, p['name'], 'ours', high)
            # Where both are exact to rounding, or nearly as dear, there is nothing to choose.
            if a and b and not a['failure'] and not b['failure'] and a['error'] > 1e-12 and b['error'] < a['error'] \
                    and b['cpu_seconds'] < 0.8 * a['cpu_seconds']:
                names.append(p['name'])
        if names:
            lines.append(f'- `{high}` is both cheaper and more accurate than `{low}` on {", ".join(names)}.')
    return lines


def sweeps(result):
    """Errors at 1/60 s of our quality levels with one number changed, on the problems where that matters."""
    engines = [e for e in result['catalogue']['engines'] if e['engine'] == 'ours']
    lines = []
    for preset in SETTINGS:
        columns = [preset] + [e['setting'] for e in engines if e['base'] == preset]
        rows = []
        for p in result['catalogue']['problems']:
            cells = [usual(result, p['name'], 'ours', setting) for setting in columns]
            if None in cells or len({row['error'] for row in cells}) == 1:
                continue
            rows.append([p['name']] + [error_text(row) + (f', {seconds(row["cpu_seconds"] / row["steps"])}'
                                                          if row['cpu_seconds'] else '') for row in cells])
        if rows and len(columns) > 1:
            names = [f'{preset} as it is'] + [name.partition(', ')[2] for name in columns[1:]]
            lines += table(['problem'] + names, rows) + ['']
    return lines


def soonest(result, problem):
    """Which of our settings gets to each level of error first, in a sentence."""
    found = result['derived'][problem]['soonest']
    words = [f'to {level.replace("0.001", "1e-3").replace("e-0", "e-")} `{row["setting"]}` at {step_text(row["step"])} in '
             f'{seconds(row["cpu_seconds"])}' for level, row in found.items() if row]
    return 'Soonest of ours: ' + '; '.join(words) + '.' if words else 'None of ours gets to 1e-3.'


def step_text(step):
    return f'1/{round(1 / step)} s'


def losses(result):
    lines = []
    for problem in result['catalogue']['problems']:
        own = [loss for loss in result['derived'][problem['name']]['losses']]
        if not own:
            continue
        # Where the whole front is more expensive, its two ends are listed.
        ends = [own[0]] + ([own[-1]] if len(own) > 1 else [])
        words = []
        for loss in ends:
            what = f'{loss["error"]:.2g} in {seconds(loss["cpu_seconds"])}'
            ours = 'ours does not get there'
            if loss['ratio'] is not None:
                ours = f'ours takes {loss["ratio"]:.1f} times as long'
            words.append(f'{loss["engine"]} {loss["setting"]} reaches {what}, {ours}')
        lines.append(f'- **{problem["name"]}**: ' + '; '.join(words) + '.')
    return lines


def table(header, rows):
    return ['| ' + ' | '.join(header) + ' |', '|' + '---|' * len(header)] + ['| ' + ' | '.join(r) + ' |' for r in rows]


def page(result):
    problems = result['catalogue']['problems']
    engines = [(e['engine'], e['setting']) for e in result['catalogue']['engines'] if not e['base']]
    machine, build = result['machine'], result['build']
    lines = [
        '<!-- SPDX-License-Identifier: BSD-3-Clause -->', '# The cost of accuracy', '',
        f'Written by `scripts/accuracy_report{" --quick" if result["quick"] else ""} --passes {result["passes"]}` on {result["begun"][:10]}; '
        'do not edit it by hand.', '',
        'Errors are dimensionless: 1e-3 of a distance of 10 m is 1 cm. Every problem has a known answer, and all '
        'engines run the same scene.', '']
    lines += ['## Where another engine is ahead', '',
              'An engine is ahead where one of its points reaches an error in less time than any of ours, at any settings '
              'and any step. The list has the cheapest and the most accurate such point of each problem. Errors below '
              '1e-12 count as equal. ' + noise(result), '']
    lines += losses(result) or ['Nowhere in this run.']

    lines += ['', '## Which solver settings do I need?', '',
              'The table has the error with a step of 1/60 s, which is the default, and the CPU time of a step. × is a '
              'failure, or an answer wrong by its own size.', '']
    rows = []
    for p in problems:
        cells = []
        for setting in SETTINGS:
            row = usual(result, p['name'], 'ours', setting)
            cost = f', {seconds(row["cpu_seconds"] / row["steps"])}' if row and row['cpu_seconds'] else ''
            cells.append(error_text(row) + cost)
        rows.append([f'[{p["name"]}](#{p["name"]})'] + cells)
    lines += table(['problem'] + list(SETTINGS), rows)
    lines += ['', 'Free flight, free rotation and bouncing balls are in closed form at every setting. So the settings only '
              'matter where bodies rest, slide or roll on each other.', ''] + needless(result)
    swept = sweeps(result)
    if swept:
        lines += ['', '## The effect of sub-steps and tolerance', '',
                  'The numbers of a quality level are changed one at a time, at 1/60 s: error, and CPU time of a step. '
                  'Problems on which that changes nothing are left out.', ''] + swept

    lines += ['', '## Other engines at 1/60 s', '', 'The error with a step of 1/60 s.', '']
    others = [e for e in engines if e[0] != 'ours']
    if others:
        lines += table(['problem'] + [' '.join(e) for e in others],
                       [[p['name']] + [error_text(usual(result, p['name'], *e)) for e in others] for p in problems])
    else:
        lines += ['No other engine was built in.']

    lines += ['', '## Problem by problem', '',
              'Charts show the error against the CPU time of the whole run, with a point for each step size. Triangles are our '
              'settings with other sub-steps or another tolerance. The thick line is the Pareto front: no other point is '
              'better in both error and time. Tables have the CPU time of the cheapest step that reaches an error. The '
              'order is the slope of the error against the step (none: errors of rounding, or too few points; negative: '
              'the error grows as steps shrink). "One digit more" is the factor by which the time grows for one more '
              'digit, along the front of that setting.', '']
    for p in problems:
        derived = result['derived'][p['name']]['settings']
        lines += [f'### {p["name"]}', '', p['sentence'], '',
                  f'Compared with {"the exact motion" if p["against"] == "exact" else "an invariant"}. '
                  f'Error: {p["measure"]}.', '', f'![{p["name"]}](pictures/accuracy/{p["name"]}.svg)', '']
        rows = []
        for engine, setting in engines:
            own = derived.get(f'{engine} {setting}')
            if own is None:
                continue
            failed = {r['failure'] for r in result['rows'] if r['failure'] and
                      (r['problem'], r['engine'], r['setting']) == (p['name'], engine, setting)}
            rows.append([f'{engine} {setting}' + (f' (× {", ".join(sorted(failed))})' if failed else '')] +
                        [seconds(own['time_to'][level]) for level in LEVELS] +
                        ['–' if own['order'] is None else f'{own["order"]:.1f}',
                         '–' if own['digit_price'] is None else f'×{own["digit_price"]:.2f}'])
        lines += table(['engine', 'to 1e-3', 'to 1e-6', 'to 1e-9', 'order', 'one digit more'], rows) + ['', soonest(result, p['name']), '']

    lines += [
        '## How it was measured', '',
        f'- Machine: {machine["cpu"]}, {machine["cores"]} cores, {machine["system"]}. Built with GCC '
        f'{build["compiler"]}, `{build["flags"]}`. Seed {result["seed"]}.',
        f'- Every error was measured in {result["passes"]} run(s) of a sweep ([batch.md](batch.md)), on all cores that it was '
        'given. An error that differs between two of them counts as a failure, "not repeatable".',
        f'- The times were measured after it, on this machine, by one process after the other, in {result["passes"]} pass(es), '
        'each in a shuffled order of its own, so that a noisy moment hits no engine alone. Such a run logs nothing. Its time '
        'is the CPU time of its thread, the least of all repetitions.',
        f'- A run that takes over {result["max_seconds"]:g} s of CPU time is "too slow".',
        '- No body sleeps in any engine. Friction of a pair is the geometric mean and restitution the larger of the '
        'two, everywhere.',
        '- Engines and settings:']
    lines += [f'  - {e["engine"]} {e["setting"]} ({e["version"]}): {e["sentence"]}'
              for e in result['catalogue']['engines'] if not e['base']]
    tuned = [f'`{e["setting"]}`' for e in result['catalogue']['engines'] if e['base']]
    if tuned:
        lines += ['  - ours with one number changed: ' + ', '.join(tuned) +
                  ('; in a quick run at every fourth step size' if result['quick'] else '')]
    lines += ['- Steps are the same for all engines: ' + ', '.join(
        step_text(step) for step in max((p['steps'] for p in result['catalogue']['problems']), key=len)) +
              '; without the last where a problem is expensive' +
              ('. This quick run took every other of them.' if result['quick'] else '.')]
    lines += ['- "Not supported": the engine does not offer the effect. That is air resistance that grows with the square '
              'of the speed, and a coefficient of restitution in MuJoCo.',
              '- Stacks are judged by the distance that boxes sink, and not by contact forces, which the engines report '
              'in different ways.', '',
              'To measure one problem by hand:', '',
              '```bash', 'rosrun rigid_body_sim rigid_body_sim_accuracy accuracy --problems sliding_stop', '```', '']
    return '\n'.join(lines)


def main():
    results, docs = sys.argv[1:]
    with open(os.path.join(results, 'results.json'), encoding='utf-8') as file:
        result = json.load(file)
    if not result['whole']:
        sys.exit('accuracy_page: the run was interrupted, so its results make no page; go on with --resume')
    for what, name in (('problems', 'name'), ('engines', 'engine')):  # a run may be of some of them
        result['catalogue'][what] = [one for one in result['catalogue'][what] if one[name] in (result[what] or [one[name]])]
    pictures = os.path.join(docs, 'pictures', 'accuracy')
    os.makedirs(pictures, exist_ok=True)
    for problem in result['catalogue']['problems']:
        shutil.copy(os.path.join(results, problem['name'] + '.svg'), pictures)
    with open(os.path.join(docs, 'accuracy.md'), 'w', encoding='utf-8') as file:
        file.write(page(result))


if __name__ == '__main__':
    main()
