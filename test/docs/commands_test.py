#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every command of README.md, CONTRIBUTING.md and docs/*.md, run as it stands there.

commands.yaml holds what is expected, page by page and in the order of the page. A command without an expectation is a
fault, and so is an expectation without a command. The keys of an entry:
  run       the command, without its comment
  code      its exit status (0)
  says      a regular expression that is found in what it prints
  prepares  true: it prepares a terminal, and every terminal begins with it
  stays     true: it goes on running in a terminal of its own until the next that stays; briefly: until it is ready
  ready     of one that stays: a command that succeeds once it is ready
  excused   why it is not run; `instead` is run in its place
"""
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import yaml

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))
from document import Document  # noqa: E402
from terminal import Display, Terminal  # noqa: E402

PATIENCE = 120.0  # s of wall time before a command counts as hanging
PAGES = ['README.md', 'CONTRIBUTING.md', *sorted('docs/' + page.name for page in ROOT.glob('docs/*.md'))]
EXPECTED = yaml.safe_load((HERE / 'commands.yaml').read_text(encoding='utf-8'))
KEYS = {'run', 'code', 'says', 'prepares', 'stays', 'ready', 'excused', 'instead'}


def read(page):
    return Document((ROOT / page).read_text(encoding='utf-8'))


def free_port():
    with socket.socket() as s:
        s.bind(('localhost', 0))
        return s.getsockname()[1]


def clean_environment(home, display):
    """What a person has who has just logged in."""
    kept = {name: os.environ[name] for name in ('LANG', 'USER', 'LOGNAME') if name in os.environ}
    return dict(kept, HOME=home, DISPLAY=display, PATH='/usr/local/bin:/usr/bin:/bin', TERM='dumb', ROS_HOSTNAME='localhost',
                PYTHONUNBUFFERED='1', ROS_MASTER_URI='http://localhost:%d' % free_port())


class CommandsTest(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        if pathlib.Path(os.environ['RBS_BUILD'], 'devel').resolve() != ROOT / 'devel':
            raise unittest.SkipTest('the pages speak of the build in build/')
        cls.home = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.home, ignore_errors=True)
        display = Display()
        cls.addClassCleanup(display.close)
        cls.environment = clean_environment(cls.home, display.name)
        cls.addClassCleanup(cls.close_staying)
        cls.staying, cls.preparation = None, []

    @classmethod
    def tearDownClass(cls):
        cls.doClassCleanups()  # which nose does not

    @classmethod
    def close_staying(cls):
        if cls.staying:
            cls.staying.close()
            cls.staying = None

    def terminal(self):
        terminal = Terminal(self.environment, ROOT)
        for line in self.preparation:
            self.assertEqual(terminal.run(line, PATIENCE)[0], 0, line)
        return terminal

    def check_page(self, page):
        expected = EXPECTED.get(page) or []
        document = read(page)
        self.assertEqual(document.faults, [])
        self.assertEqual(document.commands, [entry['run'] for entry in expected], 'commands.yaml does not have those of ' + page)
        terminal = self.terminal()
        self.addCleanup(terminal.close)
        faults = [fault for entry in expected for fault in [self.fault_of(entry, terminal)] if fault]
        self.assertEqual(faults, [], '\n'.join(faults))

    def fault_of(self, entry, terminal):
        """Empty if a command does what is expected of it."""
        self.assertEqual(set(entry) - KEYS, set())
        self.assertEqual('excused' in entry, 'instead' in entry, entry['run'])
        line = entry.get('instead', entry['run'])
        print('%7.1f s  %s' % (time.monotonic() % 1e5, line), flush=True)
        if entry.get('stays'):
            return self.fault_of_staying(entry, line)
        code, printed = terminal.run(line, PATIENCE)
        if entry.get('prepares'):
            self.preparation.append(line)
        if code != entry.get('code', 0):
            return '%s: exit status %s\n%s' % (line, code, printed)
        if not re.search(entry.get('says', ''), printed, re.MULTILINE):
            return '%s: does not say "%s" but\n%s' % (line, entry['says'], printed)
        return ''

    def fault_of_staying(self, entry, line):
        briefly = entry['stays'] == 'briefly'
        if not briefly:
            self.close_staying()
        started = self.terminal()
        started.type('exec ' + line if re.match(r'\w+ ', line) else line)
        if not briefly:
            type(self).staying = started
        try:
            return self.fault_until_ready(entry, line, started)
        finally:
            if briefly:
                started.close()

    def fault_until_ready(self, entry, line, started):
        asking = self.terminal()
        self.addCleanup(asking.close)
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline and not started.ends():
            code, _ = asking.run(entry['ready'], PATIENCE)
            if code == 0 and re.search(entry.get('says', ''), started.output(), re.MULTILINE):
                return ''
            time.sleep(0.2)
        return '%s: is not ready\n%s' % (line, started.output())

    def check_blocks(self, page):
        """Files are shown as they are, and scenes can be read."""
        document = read(page)
        for path, text in document.files.items():
            self.assertEqual(text, (ROOT / path).read_text(encoding='utf-8'), '%s shows %s' % (page, path))
        for k, scene in enumerate(document.scenes):
            file = os.path.join(self.home, 'shown.yaml')
            pathlib.Path(file).write_text(scene, encoding='utf-8')
            done = subprocess.run([explain(), file], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, '%s, scene %d: %s' % (page, k + 1, done.stderr))


def explain():
    """The program of the build that runs this test."""
    for prefix in os.environ['CMAKE_PREFIX_PATH'].split(':'):
        path = os.path.join(prefix, 'lib/rigid_body_sim/explain')
        if os.path.isfile(path):
            return path
    raise RuntimeError('explain is not built')


class CoverTest(unittest.TestCase):
    def test_every_page_with_expectations_is_there(self):
        self.assertEqual([page for page in EXPECTED if page not in PAGES], [])

    def test_what_a_page_shows_is_found(self):
        document = Document('Do `rbs\n  status`, see `scripts/common.sh`.\n\n```bash\nrosrun a b  # why\n\n# no\nls \\\n x\n```\n\n'
                            '```yaml\nbodies: []\n```\n<!-- a.py -->\n```python\nx\n```\n')
        self.assertEqual(document.commands, ['rbs status', 'rosrun a b', 'ls   x'])
        self.assertEqual((document.scenes, document.files, document.faults), (['bodies: []\n'], {'a.py': 'x\n'}, []))
        for unclear in ('```\nls\n```\n', 'Do:\n\n    ls\n', '```cpp\nx\n```\n'):
            self.assertEqual(len(Document(unclear).faults), 1, unclear)


def register(name, check, page):
    """The runner goes by the name that the function itself carries."""
    def test(self):
        check(self, page)
    test.__name__ = name
    setattr(CommandsTest, name, test)


# The pages with expectations in their order there, since the simulator that one has started serves the next; the README
# prepares the terminals of all.
for number, name in enumerate([*EXPECTED, *(page for page in PAGES if page not in EXPECTED)]):
    title = re.sub(r'\W', '_', name)
    register('test_%02d_commands_of_%s' % (number, title), CommandsTest.check_page, name)
    register('test_99_blocks_of_%s' % title, CommandsTest.check_blocks, name)


if __name__ == '__main__':
    unittest.main()
