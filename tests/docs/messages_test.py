#!/usr/bin/env python3
"""The page of troubleshooting quotes messages as the code writes them, and has every reason of a bad node."""
# SPDX-License-Identifier: BSD-3-Clause

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/hosts/troubleshooting.md").read_text()
SOURCES = [
    path
    for folder in ("api", "plugins", "host_mock")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in (".cpp", ".hpp", ".h", ".c")
]


def joined(source):
    """The source with literals that follow each other as one."""
    return re.sub(r'"\s*"', "", source)


def quoted(page):
    """Texts in quotes in the first cells of the tables of messages; "..." stands for what differs."""
    for table in re.findall(r"^\| message[^\n]*\n((?:\|[^\n]*\n)+)", page, re.M):
        for row in table.splitlines()[1:]:
            for text in re.findall(r'"([^"]+)"', row.split("|")[1]):
                yield from (part.strip() for part in text.split("..."))


class Messages(unittest.TestCase):
    def test_are_those_of_the_code(self):
        code = "\n".join(joined(path.read_text()) for path in SOURCES)
        found = list(quoted(PAGE))
        self.assertGreater(len(found), 30)
        for text in found:
            with self.subTest(message=text):
                self.assertTrue(text in code, "no source has it")

    def test_has_every_reason_of_a_bad_node(self):
        source = joined((ROOT / "api/include/ilaw/kit/detail/evaluate.hpp").read_text())
        reasons = re.findall(r'"([^"]+)"', re.search(r"reason_texts\[\] = \{(.*?)\};", source, re.S)[1])
        self.assertGreater(len(reasons), 15)
        self.assertEqual([reason for reason in reasons if f'"{reason}"' not in PAGE], [])

    def test_reads_the_first_cells(self):
        page = '| message | what to do |\n| --- | --- |\n| "a ... b", "c" | "d" |\n'
        self.assertEqual(list(quoted(page)), ["a", "b", "c"])


if __name__ == "__main__":
    unittest.main()
