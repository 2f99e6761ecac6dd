#!/usr/bin/env python3
"""Numbers in the prose of pages are those of the tables. numbers.txt beside this file has a line for each:

    page; words of the page with the [number] in brackets; first cells of the row, separated by |; column

The number is that of the table, rounded to the digits shown; with % it is a hundred times that of a cell without.
The table stands on the same page, or where the page is written PAGE < PAGE_OF_THE_TABLE.
"""
# SPDX-License-Identifier: BSD-3-Clause

import decimal
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent


def cells(line):
    return [cell.strip().strip("`*") for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]


def rows(page):
    """Each row of each table as its cells and the names of its columns; an empty cell repeats the one above."""
    header, above = None, None
    for line in page.splitlines() + [""]:
        if not line.startswith("|"):
            header = above = None
        elif header is None:
            header = cells(line)
        elif not set(line) <= set("|-: "):
            row = cells(line)
            above = [cell or above[k] if above and k == 0 else cell for k, cell in enumerate(row)]
            yield above, header


def value(page, row, column):
    wanted = cells(row)
    found = {
        line[header.index(column)]
        for line, header in rows(page)
        if column in header and line[: len(wanted)] == wanted
    }
    if len(found) != 1:
        raise LookupError(f"{len(found)} rows begin with {row} and have a column {column}")
    return found.pop()


def is_rounded(shown, cell, percent):
    """Whether the number shown is that of the cell, rounded to the digits shown."""
    exact = decimal.Decimal(re.match(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?", cell)[0])
    if percent and "%" not in cell:
        exact *= 100
    number = decimal.Decimal(shown)
    digit = decimal.Decimal(1).scaleb(number.as_tuple().exponent)
    return abs(number - exact) <= digit / 2


def entries():
    for line in (HERE / "numbers.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            yield [part.strip() for part in line.split(";")]


class Numbers(unittest.TestCase):
    def test_prose_repeats_the_tables(self):
        for where, words, row, column in entries():
            page, _, other = (part.strip() for part in where.partition("<"))
            with self.subTest(page=page, words=words):
                text = (ROOT / page).read_text()
                shown = re.search(r"\[([^]]*)\]", words)[1]
                plain = words.replace("[" + shown + "]", shown)
                self.assertIn(plain, re.sub(r"\s+", " ", text))
                cell = value((ROOT / (other or page)).read_text(), row, column)
                after = words.partition("]")[2].lstrip()
                self.assertTrue(is_rounded(shown, cell, after.startswith("%")), f"the table has {cell}")

    def test_finds_a_number_that_is_not_the_tables(self):
        self.assertTrue(is_rounded("1.3", "1.34", False))
        self.assertTrue(is_rounded("4.1", "0.0412", True))
        self.assertTrue(is_rounded("4.1", "4.12 %", True))
        self.assertFalse(is_rounded("1.50", "1.34", False))
        self.assertFalse(is_rounded("1.37", "1.52", False))
        page = "| a | b | c |\n| --- | --- | --- |\n| x | 1 | 2 |\n| | 3 | 4 |\n"
        self.assertEqual(value(page, "x | 3", "c"), "4")
        self.assertRaises(LookupError, value, page, "x", "c")
        self.assertRaises(LookupError, value, page, "y", "c")


if __name__ == "__main__":
    unittest.main()
