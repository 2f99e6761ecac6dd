#!/usr/bin/env python3
"""The paper can be set: its citations and figures exist; it cites all of its references and has the journal's length."""
# SPDX-License-Identifier: BSD-3-Clause

import re
import subprocess
import unittest
from pathlib import Path

PAPER = Path(__file__).resolve().parents[2] / "docs" / "paper"
TEXT = (PAPER / "paper.md").read_text()
SECTIONS = ["Summary", "Statement of need", "State of the field"]


class Paper(unittest.TestCase):
    def test_pandoc_sets_it_without_a_warning(self):
        done = subprocess.run([PAPER / "build.sh"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_every_reference_is_cited(self):
        references = re.findall(r"^@\w+\{(\w+),", (PAPER / "paper.bib").read_text(), re.M)
        cited = re.findall(r"@(\w+\d{4})", TEXT)
        self.assertEqual(sorted(references), sorted(set(cited)))
        self.assertLessEqual(15, len(references))

    def test_figures_are_referred_to(self):
        self.assertEqual(sorted(re.findall(r"\\label\{(\S+)\}", TEXT)), sorted(set(re.findall(r"\\autoref\{(\S+?)\}", TEXT))))

    def test_has_the_sections_and_the_length_of_the_journal(self):
        headings = re.findall(r"^# (.*)", TEXT, re.M)
        self.assertEqual(headings[:3], SECTIONS)
        words = subprocess.run(["pandoc", "--to=plain"], input=TEXT, capture_output=True, text=True, check=True)
        self.assertTrue(750 <= len(words.stdout.split()) <= 1500, len(words.stdout.split()))


if __name__ == "__main__":
    unittest.main()
