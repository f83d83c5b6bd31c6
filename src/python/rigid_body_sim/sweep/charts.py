# SPDX-License-Identifier: BSD-3-Clause
"""Charts of a metric over one or two parameters: means, with bands of 95 % confidence of the mean."""
import math
import statistics

import h5py
import numpy

from .tree import Refused

MOST_VALUES = 60  # of a parameter, above which its values are put together in classes
DRAWABLE = ('time', 'steps', 'exit_status', 'seconds', 'cpu_seconds')  # columns that may be drawn like metrics
CLASSES, CLASSES_OF_LINES, MOST_LINES = 20, 5, 8
CROWDED = 60  # letters of the labels of an axis, beyond which they are written aslant


def student(freedom):
    """The 97.5 % point of Student's distribution (expansion about the normal one; Abramowitz and Stegun 26.7.5)."""
    x = statistics.NormalDist().inv_cdf(0.975)
    exact = {1: 12.706, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571}
    if freedom in exact:
        return exact[freedom]
    return (x + (x ** 3 + x) / (4 * freedom) + (5 * x ** 5 + 16 * x ** 3 + 3 * x) / (96 * freedom ** 2)
            + (3 * x ** 7 + 19 * x ** 5 + 17 * x ** 3 - 15 * x) / (384 * freedom ** 3))


def mean_and_band(values):
    """The mean, and half the width of the band about it: NaN of a single value."""
    mean = float(numpy.mean(values))
    if len(values) < 2:
        return mean, math.nan
    return mean, student(len(values) - 1) * float(numpy.std(values, ddof=1)) / math.sqrt(len(values))


def classes(column, most, count):
    """The runs of each value of a parameter as (value, indices); classes of equal size where there are many values."""
    values = list(dict.fromkeys(column.tolist())) if column.dtype == object else numpy.unique(column)
    if len(values) <= most:
        return [(value, numpy.flatnonzero(column == value)) for value in values]
    if column.dtype == object:
        raise Refused(f'{len(values)} values that are no numbers are too many for a chart (at most {most})')
    order = numpy.argsort(column, kind='stable')
    return [(float(numpy.mean(column[part])), part) for part in numpy.array_split(order, count)]


class Table:
    """The runs of results.h5 that are sound."""

    def __init__(self, path):
        with h5py.File(path, 'r') as file:
            self.sound = file['status'].asstr()[()] == 'ok'
            self.parameters = {values.attrs['path']: (values.asstr() if values.dtype == object else values)[()][self.sound]
                               for values in file['parameters'].values()}
            self.metrics = {name: values[()][self.sound] for name, values in file.get('metrics', {}).items() if values.ndim < 3}
            self.tables = {name for name, values in file.get('metrics', {}).items() if values.ndim > 2}
            self.metrics.update({name: file[name][()][self.sound] for name in DRAWABLE
                                 if name in file and name not in self.metrics})

    def metric(self, name):
        """A metric by its name, or one of its numbers: position_2, as results.csv has it."""
        base, _, index = name.rpartition('_')
        values = self.metrics.get(name)
        if values is not None and values.ndim == 1:
            return values
        values = self.metrics.get(base)
        if values is not None and values.ndim == 2 and index.isdigit() and int(index) < values.shape[1]:
            return values[:, int(index)]
        if name in self.tables:
            raise Refused(f"metric '{name}' is a table of each run, and a chart draws a number")
        known = [n if v.ndim == 1 else f'{n}_0 to {n}_{v.shape[1] - 1}' for n, v in self.metrics.items()]
        raise Refused(f"no metric '{name}' (there are: {', '.join(known)})")

    def parameter(self, path):
        if path not in self.parameters:
            raise Refused(f"no parameter '{path}' (there are: {', '.join(self.parameters)})")
        return self.parameters[path]


def logarithmic(values):
    """Whether values are spread over more than two powers of ten at equal ratios rather than equal distances."""
    values = numpy.unique(values)
    return bool(values[0] > 0 and values[-1] / values[0] > 100 and numpy.median(values) < (values[0] + values[-1]) / 4)


def pyplot():
    try:
        import matplotlib
    except ImportError:
        raise Refused('there is no matplotlib (Debian: python3-matplotlib)')
    matplotlib.use('Agg')
    from matplotlib import pyplot as plot
    return plot


def draw_line(axes, column, values, places, **style):
    """The means of values over a parameter, with their bands. `places` has those of values that are words. Returns whether there is
    a band: a single value has none."""
    known = numpy.isfinite(values)
    column, values = column[known], values[known]
    points = [(places[value] if places else value, *mean_and_band(values[part]))
              for value, part in classes(column, len(places) if places else MOST_VALUES, CLASSES)]
    x, mean, half = numpy.array(sorted(points)).reshape(-1, 3).T
    axes.plot(x, mean, marker='o', markersize=3, linewidth=1.4, **style)
    axes.fill_between(x, mean - half, mean + half, color=style['color'], alpha=0.2, linewidth=0)
    return bool(numpy.isfinite(half).any())


def set_scales(axes, column, places):
    heights = numpy.concatenate([line.get_ydata() for line in axes.get_lines()])
    if len(heights) and min(heights) > 0 and max(heights) > 100 * min(heights):
        axes.set_yscale('log')
    if places:
        words = [said(word) for word in places]
        crowded = len(words) * max(map(len, words)) > CROWDED
        axes.set_xticks(list(places.values()), words, rotation=30 if crowded else 0, ha='right' if crowded else 'center')
    elif len(column) and logarithmic(column):
        axes.set_xscale('log')


def said(value):
    """A text of a chart, in which '$' begins no formula."""
    return f'{value:.4g}' if isinstance(value, float) else str(value).replace('$', r'\$')


def draw(results, target, metric, along, lines=None):
    """Draws a chart into a file. `lines` names a second parameter, with a line for each of its values."""
    plot, table = pyplot(), Table(results)
    values, column = table.metric(metric), table.parameter(along)
    if not numpy.isfinite(values).any():
        raise Refused(f"no run has a value of '{metric}' to draw")
    groups = classes(table.parameter(lines), MOST_LINES, CLASSES_OF_LINES) if lines else [(None, slice(None))]
    places = {word: k for k, word in enumerate(dict.fromkeys(column.tolist()))} if column.dtype == object else None
    figure, axes = plot.subplots(figsize=(8, 5))
    bands = False
    for k, (value, chosen) in enumerate(groups):
        colour = plot.get_cmap('viridis')(0.85 * k / max(1, len(groups) - 1))
        bands |= draw_line(axes, column[chosen], values[chosen], places, color=colour, label=said(value))
    set_scales(axes, column, places)
    axes.set_xlabel(said(along))
    axes.set_ylabel(said(metric))
    runs = f'{int(numpy.isfinite(values).sum()):,} runs'
    axes.set_title(f'{said(metric)}: ' + (f'mean of {runs}, with its 95 % confidence band' if bands else f'{runs}, one for each point'),
                   fontsize=10)
    axes.grid(alpha=0.3)
    if lines:
        axes.legend(title=said(lines), fontsize=8, title_fontsize=8)
    figure.tight_layout()
    figure.savefig(target, dpi=120)
    plot.close(figure)
