# SPDX-License-Identifier: BSD-3-Clause
"""rigid_body_sim_accuracy and accuracy_probe as a user meets them: short runs, resumed runs, refusals."""
import glob
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOL = ROOT / 'src/tools/rigid_body_sim_accuracy'


def probe_path():
    """In the build that runs this test: its folder comes with the environment, else the one of this tree."""
    for prefix in os.environ.get('CMAKE_PREFIX_PATH', '').split(':') + [str(ROOT / 'build/devel')]:
        path = os.path.join(prefix, 'lib/rigid_body_sim/accuracy_probe_with_peers')
        if os.path.isfile(path):
            return path
    raise RuntimeError('accuracy_probe_with_peers is not built')


PROBE = probe_path()
PAGE = ROOT / 'scripts/accuracy_page.py'


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.out = os.path.join(self.folder, 'out')

    def tool(self, *arguments, probe=PROBE, **options):
        options.setdefault('timeout', 300)
        return subprocess.run(['/usr/bin/python3', str(TOOL), self.out, '--probe', probe, *arguments], text=True,
                              capture_output=True, check=False, **options)

    def short(self, *arguments, **options):
        return self.tool('--problems', 'projectile', '--engines', 'ours', '--quick', *arguments, **options)

    def results(self):
        with open(os.path.join(self.out, 'results.json'), encoding='utf-8') as file:
            return json.load(file)

    def fake_probe(self, text):
        """A program in place of the probe, which hands what it does not do itself to the true one."""
        path = os.path.join(self.folder, 'probe')
        with open(path, 'w', encoding='utf-8') as file:
            file.write('#!/bin/bash\n' + text + f'\nexec {PROBE} "$@"\n')
        os.chmod(path, 0o755)
        return path


class Probe(unittest.TestCase):
    def refused(self, *arguments):
        done = subprocess.run([PROBE, *arguments], text=True, capture_output=True, check=False)
        self.assertEqual(2, done.returncode, done.stderr)
        self.assertEqual('', done.stdout)
        return done.stderr

    def test_one_measurement(self):
        done = subprocess.run([PROBE, '--problem', 'projectile', '--setting', 'interactive', '--step', '0.01'],
                              text=True, capture_output=True, check=True)
        row = json.loads(done.stdout)
        self.assertEqual(200, row['steps'])
        self.assertLess(row['error'], 1e-12)
        self.assertGreater(row['cpu_seconds'], 0)
        self.assertIsNone(row['failure'])

    def test_the_error_or_the_time_alone(self):
        for only, absent in (('error', ['cpu_seconds', 'cpu_spread']), ('time', ['error'])):
            done = subprocess.run([PROBE, '--problem', 'projectile', '--setting', 'interactive', '--step', '0.01', '--only', only],
                                  text=True, capture_output=True, check=True)
            row = json.loads(done.stdout)
            self.assertEqual(absent, [name for name in ('error', 'cpu_seconds', 'cpu_spread') if row[name] is None])

    def test_the_time_alone_ends_where_it_takes_too_long(self):
        done = subprocess.run([PROBE, '--problem', 'projectile', '--setting', 'interactive', '--step', '0.01', '--only', 'time',
                               '--max-seconds', '1e-9'], text=True, capture_output=True, check=True)
        row = json.loads(done.stdout)
        self.assertEqual({'kind': 'too slow', 'detail': '1 of 200 steps took 1e-09 s'}, row['failure'])
        self.assertIsNone(row['cpu_seconds'])

    def test_bad_input_names_what_is_allowed(self):
        ok = {'--problem': 'projectile', '--setting': 'interactive', '--step': '0.01'}

        def given(**changes):
            changed = {**ok, **{'--' + name: value for name, value in changes.items()}}
            return [word for pair in changed.items() if pair[1] is not None for word in pair]

        self.assertIn('bounce_elastic', self.refused(*given(problem='no_such')))
        self.assertIn('ours preview', self.refused(*given(engine='no_such')))
        self.assertIn('ours preview', self.refused(*given(setting='no_such')))
        self.assertIn('1e-6 to 1', self.refused(*given(step='0')))
        self.assertIn('1e-6 to 1', self.refused(*given(step='nan')))
        self.assertIn('s, 1e-6 to 1', self.refused(*given(step='fast')))
        self.assertIn('--step is missing', self.refused(*given(step=None)))
        self.assertIn('1 to 1000', self.refused(*given(repetitions='0')))
        self.assertIn('error or time', self.refused(*given(only='both')))
        self.assertIn('above 0', self.refused(*given(**{'max-seconds': 'nan'})))
        self.refused('--no-such-option')
        self.refused('stray')


class Runs(Folder):
    def test_a_short_run_leaves_tables_and_charts(self):
        done = self.tool('--problems', 'projectile', 'sliding_stop', '--engines', 'ours', '--quick')
        self.assertEqual(0, done.returncode, done.stderr)
        result = self.results()
        self.assertTrue(result['whole'])
        # Problems, each with the settings as they are at every other step, and 12 changed ones at every fourth.
        self.assertEqual(2 * (4 * 5 + 12 * 3), len(result['rows']))
        for row in result['rows']:
            self.assertEqual(2, row['runs'])
            self.assertIsNone(row['failure'], row)
        names = {os.path.basename(path) for path in glob.glob(self.out + '/*')}
        self.assertEqual({'header.json', 'errors.yaml', 'errors.sweep', 'times.yaml', 'times.sweep', 'results.csv', 'results.json',
                          'projectile.svg', 'projectile.png', 'sliding_stop.svg', 'sliding_stop.png'}, names)
        with open(self.out + '/results.csv', encoding='utf-8') as file:
            self.assertEqual(1 + len(result['rows']), len(file.readlines()))

    def test_sub_steps_and_tolerances_are_swept_and_change_errors_where_they_should(self):
        done = self.tool('--problems', 'sliding_stop', 'mass_ratio', 'rolling_oblique', '--engines', 'ours', '--quick',
                         '--passes', '1')
        self.assertEqual(0, done.returncode, done.stderr)
        result = self.results()

        def errors_at_60(problem):
            return {r['setting']: r['error'] for r in result['rows']
                    if r['problem'] == problem and abs(r['step'] - 1 / 60) < 1e-9}

        at_60 = errors_at_60('sliding_stop')
        sub_steps = [at_60[s] for s in ('preview, 1 sub-step', 'preview, 2 sub-steps', 'preview', 'preview, 8 sub-steps')]
        self.assertEqual(sorted(sub_steps, reverse=True), sub_steps)
        self.assertGreater(sub_steps[0], 2 * sub_steps[3])
        at_60 = errors_at_60('rolling_oblique')
        self.assertGreater(at_60['interactive, 2 sub-steps'], 2 * at_60['interactive, 32 sub-steps'])
        at_60 = errors_at_60('mass_ratio')
        self.assertGreater(at_60['accurate, tolerance 0.01'], 10 * at_60['accurate, tolerance 1e-08'])
        self.assertGreater(at_60['reference, tolerance 1e-06'], 10 * at_60['reference'])
        bases = {r['setting']: r['base'] for r in result['rows']}
        self.assertEqual('', bases['preview'])
        self.assertEqual('preview', bases['preview, 1 sub-step'])
        self.assertEqual('accurate', bases['accurate, tolerance 0.01'])
        # Whichever is soonest to 1e-3 is said, and none is sooner.
        good = [r for r in result['rows']
                if r['problem'] == 'sliding_stop' and not r['failure'] and r['error'] <= 1e-3]
        soonest = result['derived']['sliding_stop']['soonest']['0.001']
        self.assertEqual(min(r['cpu_seconds'] for r in good), soonest['cpu_seconds'])
        written, text = self.page()
        self.assertEqual(0, written.returncode, written.stderr)
        table = text[text.index('The effect of sub-steps and tolerance'):]
        self.assertIn('| preview as it is | 1 sub-step | 2 sub-steps | 8 sub-steps |', table)
        self.assertIn('| reference as it is | tolerance 1e-06 | tolerance 1e-09 |', table)
        chart = pathlib.Path(self.out, 'sliding_stop.svg').read_text(encoding='utf-8')
        for label in ('preview, other sub-steps', 'interactive, other sub-steps', 'accurate, other tolerance',
                      'reference, other tolerance'):
            self.assertIn(f'<!-- ours {label} -->', chart)

    def interrupted(self, sweep, *arguments):
        """A run that gets Ctrl-C while it makes the runs of a sweep."""
        process = subprocess.Popen(['/usr/bin/python3', str(TOOL), self.out, *arguments], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline and not glob.glob(f'{self.out}/{sweep}.sweep/parts/*.h5'):
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=120)[0]
        self.assertEqual(130, process.returncode)
        self.assertIn('--resume', said)
        self.assertFalse(self.results()['whole'])

    def test_interrupted_and_resumed_it_gives_what_one_run_gives(self):
        self.assertEqual(0, self.short('--no-charts').returncode)
        whole = {(r['problem'], r['setting'], r['step']): (r['error'], r['runs']) for r in self.results()['rows']}
        shutil.rmtree(self.out)
        hurry = os.path.join(self.folder, 'hurry')
        slow = self.fake_probe(f'[ "$1" = --list ] || [ -e {hurry} ] || sleep 0.3')
        asked = ('--probe', slow, '--problems', 'projectile', '--engines', 'ours', '--quick', '--no-charts')
        self.interrupted('errors', *asked)
        self.assertFalse(os.path.exists(self.out + '/times.sweep'))
        pathlib.Path(hurry).touch()
        self.assertEqual(0, self.short('--no-charts', '--resume', probe=slow).returncode)
        for part in glob.glob(self.out + '/times.sweep/parts/*.h5'):
            os.remove(part)
        os.remove(hurry)
        self.interrupted('times', *asked, '--resume')
        pathlib.Path(hurry).touch()
        done = self.short('--no-charts', '--resume', probe=slow)
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertTrue(self.results()['whole'])
        again = {(r['problem'], r['setting'], r['step']): (r['error'], r['runs']) for r in self.results()['rows']}
        self.assertEqual(whole, again)

    def page(self):
        docs = os.path.join(self.folder, 'docs')
        done = subprocess.run(['/usr/bin/python3', str(PAGE), self.out, docs], text=True, capture_output=True,
                              check=False)
        path = pathlib.Path(docs) / 'accuracy.md'
        return done, path.read_text(encoding='utf-8') if path.exists() else None

    def test_without_other_engines_it_says_so_and_so_does_the_page(self):
        alone = ('import json, sys; c = json.load(sys.stdin); '
                 'c["engines"] = [e for e in c["engines"] if e["engine"] == "ours"]; '
                 'c["problems"] = [p for p in c["problems"] if p["name"] == "projectile"]; print(json.dumps(c))')
        probe = self.fake_probe(f'[ "$1" = --list ] && {{ {PROBE} --list | /usr/bin/python3 -c \'{alone}\'; exit; }}')
        done = self.tool('--quick', probe=probe)
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertIn('No other engine is built in', done.stdout)
        written, text = self.page()
        self.assertEqual(0, written.returncode, written.stderr)
        self.assertIn('No other engine was built in', text)
        self.assertIn('Nowhere in this run', text)
        self.assertIn('Soonest of ours: to 1e-3 `', text)
        self.assertNotIn('The effect of sub-steps and tolerance', text)  # nothing on a flight

        result = self.results()
        result['whole'] = False
        pathlib.Path(self.out, 'results.json').write_text(json.dumps(result), encoding='utf-8')
        shutil.rmtree(os.path.join(self.folder, 'docs'))
        written, text = self.page()
        self.assertEqual(1, written.returncode)
        self.assertIn('interrupted', written.stderr)
        self.assertIsNone(text)

    def test_a_crash_of_the_engine_is_a_failure_of_that_run_and_not_the_end(self):
        probe = self.fake_probe('[[ "$*" == *"--setting preview"* ]] && kill -SEGV $$')
        done = self.short('--no-charts', probe=probe)
        self.assertEqual(0, done.returncode, done.stderr)
        for row in self.results()['rows']:
            self.assertEqual('crashed' if row['setting'].startswith('preview') else None, row['failure'])

    def test_errors_that_differ_from_run_to_run_are_a_failure(self):
        counter = os.path.join(self.folder, 'n')
        probe = self.fake_probe(f'[ "$1" = --list ] || {{ echo >> {counter}; {PROBE} "$@" | '
                                f'sed "s/\\"error\\":[^,]*/\\"error\\":$(wc -l < {counter})e-5/"; exit; }}')
        self.assertEqual(0, self.short('--no-charts', '--workers', '1', probe=probe).returncode)
        self.assertEqual({'not repeatable'}, {row['failure'] for row in self.results()['rows']})


class Refusals(Folder):
    def refused(self, done, *words):
        self.assertEqual(1, done.returncode, done.stdout + done.stderr)
        self.assertNotIn('Traceback', done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertFalse(os.path.exists(self.out + '/results.json'))

    def test_names_that_are_not_there(self):
        self.refused(self.tool('--problems', 'no_such'), 'no_such', 'projectile')
        self.refused(self.tool('--engines', 'no_such'), 'no_such', 'ours')
        self.refused(self.tool(probe='/no/such/probe'), '/no/such/probe')

    def test_a_folder_that_is_a_file_or_below_one(self):
        pathlib.Path(self.out).write_text('')
        self.refused(self.short(), 'cannot write into ' + self.out)
        self.out += '/below'
        self.refused(self.short(), 'cannot write into ' + self.out)

    def test_a_full_disk(self):
        def full():
            resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000))
        self.refused(self.short(preexec_fn=full), 'cannot write into ' + self.out, '--resume')

    def test_a_folder_in_use_and_one_that_is_not(self):
        self.refused(self.short('--resume'), 'no ' + self.out)
        os.makedirs(self.out)
        header = pathlib.Path(self.out) / 'header.json'
        header.write_text('mine\n')
        self.refused(self.short(), '--resume')
        self.refused(self.short('--resume'), 'is not as ours are')
        self.assertEqual('mine\n', header.read_text())

    def test_resuming_with_other_settings(self):
        self.assertEqual(0, self.short('--no-charts').returncode)
        os.remove(self.out + '/results.json')
        self.refused(self.short('--no-charts', '--resume', '--seed', '2'), '"seed"')

    def test_bad_arguments(self):
        for arguments in (['--passes', '0'], ['--max-seconds', 'nan'], ['--passes', 'two']):
            self.assertEqual(2, self.short(*arguments).returncode)


if __name__ == '__main__':
    unittest.main()
