# SPDX-License-Identifier: BSD-3-Clause
"""Runs the measurements of docs/effects.md and puts their tables between its marks. Called by effects_report."""
import csv
import io
import json
import pathlib
import re
import subprocess
import sys

import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / 'docs/effects.md'
CHART = ROOT / 'docs/pictures/effects_cost.png'
STAGES = {'gravity': 'forces.gravity', 'buoyancy': 'forces.buoyancy', 'drag': 'forces.drag',
          'collision': 'broadphase.pairs', 'friction': 'contacts.friction', 'rolling': 'contacts.rolling',
          'restitution': 'contacts.restitution', 'gyroscopic': 'rotation.gyroscopic', 'rotation': 'rotation.integrate'}


def run(*command):
    print('effects_report:', ' '.join(map(str, command[:3])), file=sys.stderr)
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False).stdout


def put(page, mark, text):
    """Replaces what stands between two marks of the page."""
    pattern = re.compile('(<!-- %s -->\n).*?(<!-- end -->)' % mark, re.DOTALL)
    if not pattern.search(page):
        raise SystemExit('effects_report: docs/effects.md has no mark "%s"' % mark)
    return pattern.sub(lambda found: found.group(1) + text.strip() + '\n' + found.group(2), page)


def scenes(tools):
    rows = ['| scene | ' + ' | '.join(STAGES) + ' |', '|---|' + ':-:|' * len(STAGES)]
    for file in sorted((ROOT / 'scenes').glob('*.yaml')):
        stages = {stage['name']: stage['active'] for stage in json.loads(run(tools / 'explain', file, '--json'))['stages']}
        rows.append('| %s | %s |' % (file.stem, ' | '.join('on' if stages[name] else '' for name in STAGES.values())))
    return '\n'.join(rows)


def costs(tools):
    """The cost of each effect alone and what a pair costs beyond the two: a table, and the chart."""
    families = {}
    for row in csv.DictReader(io.StringIO(run(tools / 'effects_benchmark'))):
        families.setdefault(row['family'], {})[row['effect'], row['second']] = float(row['ns_per_body_and_step'])
    tables = []
    figure, axes = plt.subplots(1, len(families), figsize=(11, 4), constrained_layout=True)
    for axis, (family, times) in zip(axes, families.items()):
        base = times['nothing', '']
        names = [effect for effect, second in times if not second and effect != 'nothing']
        alone = {name: times[name, ''] - base for name in names}
        lines = ['Balls %s: %.0f ns a body and step without any of these.\n' % (family, base),
                 '| beyond that, ns | alone | ' + ' | '.join('with ' + name for name in names) + ' |',
                 '|---|--:|' + '--:|' * len(names)]
        for k, name in enumerate(names):
            cells = ['%.0f' % (times[name, other] - base) if name != other and (name, other) in times
                     else ('%.0f' % (times[other, name] - base) if name != other else '') for other in names]
            lines.append('| %s | %.0f | %s |' % (name, alone[name], ' | '.join(cells)))
        tables.append('\n'.join(lines))
        for k, name in enumerate(names):
            axis.barh(k, alone[name], color='#30638e', height=0.35)
            pairs = [times.get((name, other), times.get((other, name))) - base - alone[other]
                     for other in names if other != name]
            axis.plot(pairs, [k + 0.3] * len(pairs), 'o', color='#d1495b', markersize=4)
        axis.set_yticks(range(len(names)), names)
        axis.invert_yaxis()
        axis.axvline(0.0, color='black', linewidth=0.8)
        axis.set_xlabel('ns a body and step, beyond %.0f ns' % base)
        axis.set_title('Balls ' + family)
        axis.grid(axis='x', alpha=0.3)
    axes[0].plot([], [], 'o', color='#d1495b', markersize=4, label='beside another effect')
    axes[0].barh(0, 0, color='#30638e', label='alone')
    axes[0].legend(loc='lower right', fontsize='small')
    figure.savefig(CHART, dpi=110)
    return '\n\n'.join(tables)


def machine():
    info = pathlib.Path('/proc/cpuinfo').read_text()
    model = re.search(r'model name\s*: (.*)', info).group(1)
    return 'Measured on %d cores of an %s.' % (info.count('processor\t'), model)


def main():
    tools = pathlib.Path(sys.argv[1])
    page = PAGE.read_text()
    page = put(page, 'scenes', scenes(tools))
    page = put(page, 'ballistic', machine() + '\n\n' + run(tools / 'ballistic_benchmark'))
    page = put(page, 'cost', machine() + '\n\n' + costs(tools))
    page = put(page, 'proof', run(ROOT / 'scripts/effects_proof', '--probes', str(tools)))
    PAGE.write_text(page)


if __name__ == '__main__':
    main()
