# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps for tests: a folder with a file, and the program as people call it."""
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / 'src/tools/sweep'
PATIENCE = 300


class SweepCase(unittest.TestCase):
    """A test with a folder of its own."""

    maxDiff = None

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix='sweep'))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, text, name='s.yaml'):
        path = self.folder / name
        path.write_text(text, encoding='utf-8')
        return path

    def command(self, *arguments):
        return ['/usr/bin/python3', str(PROGRAM), str(self.folder / 's.yaml'), *map(str, arguments)]

    def sweep(self, *arguments, **options):
        options.setdefault('timeout', PATIENCE)
        return subprocess.run(self.command(*arguments), text=True, capture_output=True, check=False, **options)

    def sound(self, *arguments, **options):
        """A sweep that ends well; returns what it prints."""
        done = self.sweep(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def interrupted(self, when, *arguments, **options):
        """A sweep that gets Ctrl-C as soon as `when` holds: its exit code, and what it says."""
        process = subprocess.Popen(self.command(*arguments), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   start_new_session=True, **options)
        while not when() and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        said = ''.join(process.communicate(timeout=PATIENCE))
        return process.returncode, said

    def parts(self, output='s.sweep'):
        return sorted((self.folder / output / 'parts').glob('part-*.h5'))

    def results(self, output='s.sweep'):
        """All columns of the results, texts as str, by their names."""
        found = {}
        with h5py.File(self.folder / output / 'results.h5', 'r') as file:
            file.visititems(lambda name, item: found.__setitem__(name, item) if isinstance(item, h5py.Dataset) else None)
            return {name: (item.asstr() if item.dtype == object else item)[()] for name, item in found.items()}

    def hashes(self, output='s.sweep'):
        """The hash of each run by its number."""
        table = self.results(output)
        self.assertEqual(set(table['status']), {'ok'})
        return dict(zip(table['number'].tolist(), table['hash'].tolist()))
