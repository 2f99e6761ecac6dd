#!/usr/bin/env python3
"""Every page of the tree can be read and followed: lines of prose are short, links lead to files and headings that
exist, files and tests that pages name exist, and scenes say what must come out."""
# SPDX-License-Identifier: BSD-3-Clause

import json
import re
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))
from english_test import ROOT, LOGBOOKS, pages  # noqa: E402

LONGEST = 100  # characters of a line of prose
PAGES = [*pages(), *sorted(LOGBOOKS.glob("*.md"))]


def prose(page):
    """Number and text of each line that people read: without code and without formulas that stand alone."""
    text = re.sub(r"^ *```.*?^ *```|^ *\$\$.*?\$\$$", lambda found: "\n" * found[0].count("\n"), page.read_text(),
                  flags=re.S | re.M)
    return [(k, line) for k, line in enumerate(text.split("\n"), 1) if not line.startswith("    ")]


def is_too_long(line):
    """Formulas and code within a line cannot be broken, nor can a long link; rows of tables are lines by nature."""
    if len(line) <= LONGEST or line.startswith("|"):
        return False
    joined = re.sub(r"\$[^$]*\$|`[^`]*`", lambda found: "x" * len(found[0]), line)
    return " " in re.sub(r"^ *([-*] |[0-9]+\. |#+ |> )?", "", joined)


def anchor(heading):
    """The name of a heading in links."""
    return re.sub(r"[^a-z0-9_-]", "", heading.lstrip("# ").lower().replace(" ", "-"))


def leads_somewhere(page, target):
    """Whether a link leads to a file or folder of the tree, and to a heading if it names one; others are not visited."""
    if "://" in target or target.startswith("mailto:"):
        return True
    file, _, heading = target.partition("#")
    to = page.parent / file if file else page
    return to.exists() and (not heading or to.suffix != ".md" or heading in
                            {anchor(line) for _, line in prose(to) if line.startswith("#")})  # fmt: skip


def names_of_tests():
    """Of GoogleTest by suite and name, of ctest up to a variable."""
    def found(pattern, files):
        return {".".join(found.groups()) for file in (ROOT / "tests").rglob(files)
                for found in re.finditer(pattern, file.read_text())}  # fmt: skip

    return found(r"TEST(?:_P|_F)?\((\w+),\s*(\w+)\)", "*.cpp") | found(r"add_test\(NAME ([\w.]*\w)", "CMakeLists.txt")


class Pages(unittest.TestCase):
    def test_have_short_lines(self):
        for page in PAGES:
            with self.subTest(page=page.relative_to(ROOT)):
                self.assertEqual([line for line in prose(page) if is_too_long(line[1])], [])

    def test_have_links_that_lead_somewhere(self):
        links = [(page, number, target) for page in PAGES for number, line in prose(page)
                 for target in re.findall(r"\]\(([^)]*)\)", re.sub(r"`[^`]*`|\$[^$]*\$", "code", line))]  # fmt: skip
        self.assertGreater(len(links), 50)
        self.assertEqual([link for link in links if not leads_somewhere(link[0], link[2])], [])

    def test_name_files_that_exist(self):
        """The pages that lead through the tree name files by the end of their paths, or by all of it."""
        sources = [f"/{file.relative_to(ROOT)}" for folder in ("api", "docs", "host_mock", "plugins", "tests")
                   for file in (ROOT / folder).rglob("*") if file.is_file()]  # fmt: skip
        named = [name for page in ("docs/architecture.md", "docs/contributing.md") for _, line in prose(ROOT / page)
                 for name in re.findall(r"`([A-Za-z0-9_/]+\.(?:cpp|hpp|h|f90|sh|md))`", line)]  # fmt: skip
        self.assertGreater(len(named), 30)
        self.assertEqual([name for name in named if not any(file.endswith(f"/{name}") for file in sources)], [])

    def test_of_contributing_names_every_build_mode(self):
        page = (ROOT / "docs/contributing.md").read_text()
        presets = json.loads((ROOT / "CMakePresets.json").read_text())
        modes = {preset["name"] for preset in presets["configurePresets"]}
        self.assertGreater(len(modes), 4)
        self.assertEqual([mode for mode in modes if f"| `{mode}` |" not in page], [])

    def test_hold_the_promises_by_tests_that_exist(self):
        """promises.txt has a promise in each line, its tests after the last ": "; words in brackets are remarks."""
        lines = [line for line in (ROOT / "tests/abi/promises.txt").read_text().splitlines() if line and line[0] != "#"]
        named = {name for line in lines for name in re.sub(r"\([^)]*\)", "", line.rpartition(": ")[2]).split()}
        self.assertGreater(len(named), 50)
        self.assertEqual(named - names_of_tests(), set())

    def test_know_what_is_too_long(self):
        word, words = 101 * "a", 60 * "a" + " " + 60 * "b"
        for line in (words, "- " + words):
            self.assertTrue(is_too_long(line), line)
        for line in (word, "- " + word, "| " + words + " |", "$" + words + "$", 99 * "a" + "é"):
            self.assertFalse(is_too_long(line), line)
        self.assertEqual(anchor("## Which velocity, which step"), "which-velocity-which-step")


class Scenes(unittest.TestCase):
    def test_of_the_host_say_what_must_come_out(self):
        scenes = sorted((ROOT / "host_mock/scenes").glob("*.json"))
        self.assertGreater(len(scenes), 10)
        self.assertEqual([scene.name for scene in scenes if len(json.loads(scene.read_text()).get("doc", "")) < 60], [])

    def test_of_a_law_are_named_on_its_page(self):
        scenes = sorted((ROOT / "plugins").glob("*/*.json"))
        self.assertGreater(len(scenes), 5)
        for scene in scenes:
            with self.subTest(scene=scene.name):
                self.assertIn(scene.name, (scene.parent / f"{scene.parent.name}.md").read_text())


if __name__ == "__main__":
    unittest.main()
