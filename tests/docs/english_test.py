#!/usr/bin/env python3
"""Every page of the tree can be read at the first attempt: no sentence has more than 40 words, and none begins
with a word that stands for a noun it does not name ("Those of before ..."). All pages together say how sentences
hang together (because, but, for example), and seldom use "that of" for a noun or "Where" for a condition.

    tests/docs/english_test.py            runs the test
    tests/docs/english_test.py PAGE...    prints the sentences of these pages that break the rules
    tests/docs/english_test.py --rates    prints the words of each part, and the rates per 1000 words of all pages
"""
# SPDX-License-Identifier: BSD-3-Clause

import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LONGEST = 40  # words
VAGUE_BEGINNING = re.compile(r"(Who|Whose|Of|Those|One that)\b")
CONNECTIVE = re.compile(r"\b(because|since|so|but|although|whereas|however|therefore|thus|for example|for instance|"
                        r"such as|instead|usually|otherwise|note that)\b", re.I)
PRONOUN_OF = re.compile(r"\b(that|those) of\b", re.I)
CONDITION_AS_PLACE = re.compile(r"Where\b")
# Pages that are rewritten with the code they describe; a page leaves this list when it has no offence.
PENDING = set()
# Pages of laws have these sections in this order.
LAW_SECTIONS = ["Equations", "Parameters", "State", "Energy", "Step", "Limits", "Example", "Sources"]
# Logbooks keep the words of the day on which they were written.
LOGBOOKS = ROOT / "docs" / "log"


def pages():
    found = [ROOT / "README.md"]
    for folder in ("api", "docs", "host_mock", "plugins", "tests"):
        found += sorted((ROOT / folder).rglob("*.md"))
    return [page for page in found if LOGBOOKS not in page.parents]


def blocks(text):
    """Paragraphs, items of lists and cells of tables; without headings, code and displayed formulas."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"^ *```.*?^ *```[^\n]*$", "\n", text, flags=re.S | re.M)
    text = re.sub(r"\$\$.*?\$\$", "X", text, flags=re.S)
    block = ""
    for line in text.splitlines():
        if not line.strip() or line.startswith("    "):
            yield block
            block = ""
        elif re.match(r" *\|", line):
            yield block
            block = ""
            yield from re.split(r"(?<!\\)\|", line)
        elif re.match(r" *([-*] |[0-9]+\. |#+ )", line):
            yield block
            # A heading is no sentence.
            block = "" if line.startswith("#") else re.sub(r"^ *([-*] |[0-9]+\. )", "", line)
        else:
            block += " " + line.strip()
    yield block


def plain(text):
    """Code and formulas count as one word, links as their text, pictures as nothing."""
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"`[^`]*`|\$[^$]*\$", "X", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return text.replace("*", "").strip()


def sentences(text):
    for block in blocks(text):
        for sentence in re.split(r"(?<=[.!?])[\"')]*\s+(?=[A-Z0-9\"'(])", plain(block)):
            if sentence:
                yield sentence


def words(sentence):
    return sum(any(c.isalnum() for c in word) for word in sentence.split())


def offences(text):
    for sentence in sentences(text):
        if words(sentence) > LONGEST:
            yield f"{words(sentence)} words: {sentence}"
        if VAGUE_BEGINNING.match(sentence):
            yield f"begins with '{sentence.split()[0]}': {sentence}"


def rates(said):
    """How often each pattern stands in 1000 words of these sentences."""
    thousands = sum(words(sentence) for sentence in said) / 1000
    count = {
        "connectives": sum(len(CONNECTIVE.findall(sentence)) for sentence in said),
        "that of, those of": sum(len(PRONOUN_OF.findall(sentence)) for sentence in said),
        "Where first": sum(bool(CONDITION_AS_PLACE.match(sentence)) for sentence in said),
    }
    return {name: number / thousands for name, number in count.items()}


def print_rates():
    parts = {}
    for page in [*pages(), *sorted(LOGBOOKS.glob("*.md"))]:
        part = str(page.parent.relative_to(ROOT)) if page.parent != ROOT else page.name
        part = "plugins" if part.startswith("plugins") else part
        parts[part] = parts.get(part, 0) + sum(map(words, sentences(page.read_text())))
    for part, number in sorted(parts.items()):
        print(f"{number:7} {part}")
    print(f"{sum(parts.values()) - parts[str(LOGBOOKS.relative_to(ROOT))]:7} all but logbooks")
    for name, rate in rates([sentence for page in pages() for sentence in sentences(page.read_text())]).items():
        print(f"{rate:7.2f} {name}")


class English(unittest.TestCase):
    def test_pages_have_short_sentences_with_a_subject(self):
        self.assertGreater(len(pages()), 20)
        for page in pages():
            name = str(page.relative_to(ROOT))
            with self.subTest(page=name):
                if name in PENDING:
                    continue
                self.assertEqual(list(offences(page.read_text())), [])

    def test_pages_connect_sentences_and_repeat_nouns(self):
        found = rates([sentence for page in pages() for sentence in sentences(page.read_text())])
        self.assertGreater(found["connectives"], 6)
        self.assertLess(found["that of, those of"], 0.2)
        self.assertLess(found["Where first"], 0.2)

    def test_pages_of_laws_have_the_same_sections(self):
        laws = [page for page in pages() if page.parent.parent.name == "plugins"]
        self.assertGreater(len(laws), 5)
        for page in laws:
            with self.subTest(page=page.name):
                self.assertEqual(re.findall(r"^## (.*)", page.read_text(), re.M), LAW_SECTIONS)

    def test_bibliography_names_pages_that_cite(self):
        bibliography = ROOT / "docs/bibliography.md"
        links = 0
        for row in re.findall(r"^\| [^|]+ \| [0-9]{4} \|.*", bibliography.read_text(), re.M):
            authors, year, _, _, pages_that_cite, _ = [cell.strip() for cell in row[1:-1].split("|")]
            citation = re.compile(re.escape(re.split(r",| and | \*", authors)[0]) + r"\b[^;|]{0,70}?" + year)
            for page in re.findall(r"\]\(([^)]*)\)", pages_that_cite):
                links += 1
                with self.subTest(work=f"{authors} {year}", page=page):
                    text = (bibliography.parent / page).read_text()
                    self.assertRegex(re.sub(r"\s+", " ", text), citation)
        self.assertGreater(links, 100)

    def test_finds_long_and_vague_sentences(self):
        long = "Word" + 40 * " word" + "."
        self.assertEqual(len(list(offences(long))), 1)
        self.assertEqual(len(list(offences("- " + long))), 1)
        self.assertEqual(len(list(offences("| a | " + long + " |"))), 1)
        self.assertEqual(len(list(offences("    " + long))), 0)
        self.assertEqual(len(list(offences("```\n" + long + "\n```"))), 0)
        self.assertEqual(len(list(offences("Word" + 38 * " word" + " $a + b$."))), 0)
        self.assertEqual(len(list(offences("A sentence. Those of before stay."))), 1)
        self.assertEqual(len(list(offences("A sentence. One that is vague."))), 1)
        self.assertEqual(len(list(offences("A sentence. One node is clear."))), 0)
        self.assertEqual(len(list(offences("## What must hold"))), 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["--rates"]:
        print_rates()
    elif len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        for page in sys.argv[1:]:
            for offence in offences(Path(page).read_text()):
                print(f"{page}: {offence}")
    else:
        unittest.main()
