#!/usr/bin/env python3
"""The manual pages are those of the programs, and man and mandoc show them without a warning."""
# SPDX-License-Identifier: BSD-3-Clause

import os
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MANUALS = sorted((ROOT / "docs" / "man").glob("*.1"))
ENVIRONMENT = {**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "80"}
# A page has the date of its version alone, which is in the changelog.
ALLOWED = 'WARNING: missing date, using ""'


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT)


class Manuals(unittest.TestCase):
    def test_there_is_one_for_each_program(self):
        self.assertEqual([page.stem for page in MANUALS], ["ilaw-check", "ilaw-describe", "ilaw"])

    def test_are_those_of_the_programs(self):
        programs = [os.environ["ILAW_PROGRAM"], os.environ["ILAW_PROGRAM"] + "-check"]
        done = run(sys.executable, ROOT / "docs" / "make_reference.py", "man", *programs, "--check")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_man_shows_them_without_a_warning(self):
        for page in MANUALS:
            done = run("man", "--warnings=w", "--local-file", page)
            self.assertEqual((done.returncode, done.stderr), (0, ""), page)
            self.assertIn("SEE ALSO", done.stdout)

    def test_mandoc_finds_nothing_wrong(self):
        for page in MANUALS:
            found = run("mandoc", "-T", "lint", "-W", "warning", page).stdout.splitlines()
            self.assertEqual([line for line in found if ALLOWED not in line], [])


if __name__ == "__main__":
    unittest.main()
