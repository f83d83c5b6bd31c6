# SPDX-License-Identifier: BSD-3-Clause
"""Hands the runs of a sweep to an engine, chunk by chunk, until each has a record.

A chunk that took its worker with it is cut into single runs, and a run that does so three times alone is recorded as
crashed, or as overtime where it could not be interrupted. So one bad run costs no other.
"""
import collections
import sys
import time

from .plan import Plan
from .run import ENDLESS, check_builds, record_of
from .tree import Refused

ATTEMPTS = 3
LEAST_CHUNK_SECONDS, MOST_CHUNK_SECONDS = 2.0, 300.0
CHUNKS_PER_SLOT = 50
LEAST_LAST_SECONDS = 0.2
QUEUED_PER_SLOT = 2
PILOTS, PILOT_SECONDS = 3, 60.0  # how many there are, and what one of them may take


class Progress:
    """A line on the terminal; every tenth part where there is none."""

    def __init__(self, total):
        self.total, self.done, self.failed, self.begin, self.tenth = max(total, 1), 0, 0, time.monotonic(), 0

    def add(self, done, failed):
        self.done, self.failed = self.done + done, self.failed + failed
        self.show()

    def show(self):
        left = (time.monotonic() - self.begin) * (self.total - self.done) / max(self.done, 1)
        text = f'{self.done:,}/{self.total:,} runs' + (f', {duration(left)} left' if 0 < self.done < self.total else '')
        text += f', {self.failed:,} failed' if self.failed else ''
        if sys.stderr.isatty():
            filled = 20 * self.done // self.total
            sys.stderr.write(f'\r\033[K[{"#" * filled}{"." * (20 - filled)}] {text}')
        elif 10 * self.done // self.total > self.tenth:
            self.tenth = 10 * self.done // self.total
            sys.stderr.write(text + '\n')
        sys.stderr.flush()

    @staticmethod
    def end():
        if sys.stderr.isatty():
            sys.stderr.write('\n')


def duration(seconds):
    """A time as people say it."""
    units = ((1e-3, 1e-6, 'us'), (1.0, 1e-3, 'ms'), (120.0, 1.0, 's'), (7200.0, 60.0, 'min'), (172800.0, 3600.0, 'h'))
    for limit, unit, name in units:
        if seconds < limit:
            return f'{seconds / unit:.3g} {name}'
    return f'{seconds / 86400:.3g} days'


class Backlog:
    """The runs that have no record yet."""

    def __init__(self, numbers):
        self.fresh, self.begun = numbers, 0
        self.again, self.suspects, self.attempts = collections.deque(), collections.deque(), collections.Counter()

    def fresh_left(self):
        return len(self.fresh) - self.begun

    def left(self):
        return self.fresh_left() + sum(map(len, self.again)) + len(self.suspects)

    def take(self, size, alone):
        """The next chunk. A run that has ended a worker is given out again when nothing else runs, so that it takes no
        other with it; until then there may be no chunk."""
        if self.again:
            return self.again.popleft()
        if self.fresh_left():
            begin, self.begun = self.begun, min(self.begun + size, len(self.fresh))
            return self.fresh[begin:self.begun]
        return [self.suspects.popleft()] if self.suspects and alone else None

    def lost(self, numbers, why):
        """Takes runs back. Returns the record of one that has been to blame too often."""
        if not why:
            self.again.append(numbers)
        elif len(numbers) > 1:
            self.again.extend([number] for number in numbers)
        elif why == ENDLESS:
            return [record_of(numbers[0], 'overtime', why)]
        else:
            self.attempts[numbers[0]] += 1
            if self.attempts[numbers[0]] == ATTEMPTS:
                return [record_of(numbers[0], 'crashed', f'{why}, {ATTEMPTS} times')]
            self.suspects.append(numbers[0])
        return []


class Pace:
    """How many runs make a chunk, by the time that the runs before have taken."""

    def __init__(self, total, slots):
        self.total, self.slots, self.runs, self.seconds = total, slots, 0, 0.0

    def learn(self, records):
        self.runs += len(records)
        self.seconds += sum(record['seconds'] for record in records)

    def size(self, left):
        """Runs of seconds to minutes; fewer before the end, so that no slot waits for another."""
        if not self.runs:
            return 1
        run = max(self.seconds / self.runs, 1e-6)
        aim = min(max(self.total * run / self.slots / CHUNKS_PER_SLOT, LEAST_CHUNK_SECONDS), MOST_CHUNK_SECONDS)
        last = max(LEAST_LAST_SECONDS / run, left / (2 * self.slots))
        return max(1, min(int(min(aim / run, last)), left))


def carry_live(plan, numbers, engine, store, progress):
    """By an engine that takes one chunk after the other."""
    text, backlog, pace, running = plan.text(), Backlog(numbers), Pace(len(numbers), engine.slots), 0
    while running or backlog.left():
        while running < QUEUED_PER_SLOT * engine.slots:
            chunk = backlog.take(pace.size(backlog.fresh_left()), alone=not running)
            if chunk is None:
                break
            engine.submit(text, chunk)
            running += 1
        for chunk, records, why in engine.wait():
            running -= 1
            records = backlog.lost(chunk, why) if records is None else records
            if records:
                check_builds((record['build'] for record in records if 'build' in record), 'a worker has')
                store.keep(records)
                pace.learn(records)
                progress.add(len(records), sum(record['status'] != 'ok' for record in records))


def pilot(plan, numbers, engine):
    """Records of a few runs that stand for all. One that takes longer than a minute is cut off, as `overtime`; one that ends its
    process has none."""
    chosen = sorted({numbers[k * (len(numbers) - 1) // (PILOTS - 1)] for k in range(PILOTS)})
    short = Plan({**plan.tree, 'max_seconds': min(plan.max_seconds, PILOT_SECONDS)})
    found, left = [], len(chosen)
    for number in chosen:
        engine.submit(short.text(), [number])
    while left:
        for _, records, why in engine.wait():
            left -= 1
            found += records or []
    if not found:
        raise Refused(f'each of the runs {", ".join(map(str, chosen))} ends its process ({why}): try one by --only')
    return found


def carry_batch(numbers, engine, store, progress, run_seconds):
    """By an engine that takes all chunks at once. What its workers leave undone goes out again."""
    earlier, missing = store.part_names(), numbers
    runs_before, failed_before = (n - done for n, done in zip(store.counts(), (progress.done, progress.failed)))

    def report():
        runs, failed = store.counts()
        if runs - runs_before > progress.done:
            progress.add(runs - runs_before - progress.done, failed - failed_before - progress.failed)

    for attempt in range(ATTEMPTS):
        pieces = min(engine.pieces(run_seconds * len(missing)), len(missing))
        chunks = [missing[k * len(missing) // pieces:(k + 1) * len(missing) // pieces] for k in range(pieces)]
        name = f'{time.strftime("%Y%m%d-%H%M%S")}-{attempt}'
        engine.run(store, name, chunks, run_seconds * len(chunks[-1]), report)
        report()
        known = store.status(store.part_names() - earlier)
        missing = [number for number in missing if number not in known]
        if not missing:
            break
        progress.end()
        last = attempt == ATTEMPTS - 1
        print(f'{len(missing):,} runs have no result yet' + ('' if last else ' and go out again'), file=sys.stderr)
    if len(missing) == len(numbers):
        raise Refused(f'{engine.name} has done no run; the end of its log: {store.last_log(name)}')
