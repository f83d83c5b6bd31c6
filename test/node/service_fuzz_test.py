#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A short run of the service fuzzer, and what its long runs have found."""
import pathlib
import sys
import tempfile
import unittest

import rostest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'fuzz'))
import service_fuzz  # noqa: E402

CALLS = 5000


class ServiceFuzzTest(unittest.TestCase):
    def test_hostile_calls_are_refused_and_change_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            fuzz = service_fuzz.run(CALLS, 1, folder)
        self.assertEqual(sum(fuzz.called.values()), CALLS)
        self.assertEqual([name for name in fuzz.links if not fuzz.called[name]], [])
        for outcome in 'done', 'refused', 'unreadable':
            self.assertGreater(fuzz.outcomes[outcome], 0, outcome)


if __name__ == '__main__':
    rostest.rosrun('rigid_body_sim', 'service_fuzz', ServiceFuzzTest)
