# SPDX-License-Identifier: BSD-3-Clause
"""What a soak has found: figures of the quiet points, counts, and what went wrong."""
import collections
import statistics
import sys
import time

import process

MOST_GROWTH = 1.25         # of memory from the second quarter of a life to its last
MOST_DESCRIPTORS = 10      # more at the last quiet point of a life than at its second
MOST_THREADS = 2           # likewise: those of a connection or a study come and go
PROGRESS_PERIOD = 30.0     # s
FEWEST = 8                 # quiet points of a life that are enough to tell growth from noise

Quiet = collections.namedtuple('Quiet', 'minutes life sample')


class Report:
    def __init__(self):
        self.began = self.told = time.monotonic()
        self.counts, self.peaks = collections.Counter(), {}
        self.problems = []
        self.memory = []  # (minutes, MB of the node, MB of RViz)
        self.quiet = []

    def minutes(self):
        return (time.monotonic() - self.began) / 60

    def problem(self, text):
        self.problems.append('%5.1f min: %s' % (self.minutes(), text))
        print(self.problems[-1], file=sys.stderr, flush=True)

    def count(self, what):
        self.counts[what] += 1

    def largest(self, what, value):
        self.peaks[what] = max(self.peaks.get(what, value), value)

    def orphans(self, found):
        if found:
            self.problem('children outlived the node: %s' % found)

    def note(self, node, rviz):
        sample = process.sample(node)
        self.memory.append((self.minutes(), sample.megabytes, process.sample(rviz).megabytes if rviz else float('nan')))
        for what in 'megabytes', 'threads', 'descriptors', 'children', 'zombies':
            self.largest(what, getattr(sample, what))
        if time.monotonic() - self.told > PROGRESS_PERIOD:
            self.told = time.monotonic()
            print('%6.1f min, %.0f MB, %d threads, %d descriptors, %d problems' % (
                self.minutes(), sample.megabytes, sample.threads, sample.descriptors, len(self.problems)),
                file=sys.stderr, flush=True)

    def quiet_point(self, life, pid):
        sample = process.sample(pid)
        self.quiet.append(Quiet(self.minutes(), life, sample))
        if sample.zombies:
            self.problem('%d zombies at a quiet point' % sample.zombies)

    def judge(self):
        """Growth from quiet point to quiet point, life by life."""
        for life in sorted({point.life for point in self.quiet}):
            points = [point.sample for point in self.quiet if point.life == life]
            if len(points) < FEWEST:
                continue
            quarter = len(points) // 4
            early = statistics.median(point.megabytes for point in points[quarter:2 * quarter])
            late = statistics.median(point.megabytes for point in points[-quarter:])
            if late > MOST_GROWTH * early:
                self.problem('memory grew from %.0f to %.0f MB in life %d' % (early, late, life))
            if points[-1].descriptors > points[1].descriptors + MOST_DESCRIPTORS:
                self.problem('descriptors grew from %d to %d in life %d' % (
                    points[1].descriptors, points[-1].descriptors, life))
            if points[-1].threads > points[1].threads + MOST_THREADS:
                self.problem('threads grew from %d to %d in life %d' % (points[1].threads, points[-1].threads, life))

    def table(self, actions, *streams):
        self.judge()
        rows = [('time', '%.0f min' % self.minutes()), ('actions', sum(actions.values()))]
        rows += sorted(self.counts.items())
        rows += [(what, '%.1f' % value) for what, value in self.peaks.items() if what.startswith('longest')]
        first_life = [point.sample for point in self.quiet if point.life == 1]
        for what, unit in ('megabytes', 'memory, MB'), ('threads', 'threads'), ('descriptors', 'descriptors'):
            values = [getattr(sample, what) for sample in first_life]
            rows.append(('%s at the quiet points of the first life: first, last, largest; largest ever' % unit,
                         '%.0f, %.0f, %.0f; %.0f' % (values[0], values[-1], max(values), self.peaks[what])))
        rows.append(('zombies at a quiet point, largest', max(point.sample.zombies for point in self.quiet)))
        for stream in streams:
            rows.append(('%s: messages, stamps that went back, longest silence' % stream.topic,
                         '%d, %d, %.1f s' % (stream.messages, stream.backward, stream.longest)))
            if stream.backward:
                self.problem('%s went back %d times' % (stream.topic, stream.backward))
        rows.append(('problems', len(self.problems)))
        lines = ['| watched | found |', '|---|---|'] + ['| %s | %s |' % row for row in rows]
        return '\n'.join(lines + [''] + ['* ' + problem for problem in self.problems])

    def draw(self, file):
        import matplotlib
        matplotlib.use('Agg')
        from matplotlib import pyplot
        figure, axes = pyplot.subplots(figsize=(8, 3.5))
        minutes, node, rviz = zip(*self.memory)
        axes.plot(minutes, rviz, linewidth=0.6, color='#bbbbbb', label='RViz')
        axes.plot(minutes, node, linewidth=0.8, label='node')
        axes.plot([point.minutes for point in self.quiet], [point.sample.megabytes for point in self.quiet], 'o',
                  markersize=3, color='black', label='node at a quiet point')
        axes.set(xlabel='minutes', ylabel='resident memory, MB', ylim=(0, None))
        axes.legend(frameon=False)
        figure.tight_layout()
        figure.savefig(file)
