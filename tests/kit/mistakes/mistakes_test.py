#!/usr/bin/env python3
"""Mistakes of law authors, each a law of its own: the compiler names it, and says in one line what to write.

Needs CXX, a g++.
"""
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import subprocess
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
INCLUDE = HERE.parents[2] / "api/include"


def laws_of(file):
    """Names, messages and first lines of laws: "// message" above "WRONG(law)" or above "struct law {"."""
    message, laws = "", []
    for number, line in enumerate(file.read_text().splitlines(), 1):
        found = re.fullmatch(r"WRONG\((\w+)\)|struct (\w+) \{", line)
        if line.startswith("// "):
            message = line[3:]
        elif found and message:
            laws.append((found[1] or found[2], message, number))
        if found or not line:
            message = ""
    return laws


def said_of(file):
    what = ["-c", "-o", "/dev/null"] if file.name == "wrong_status.cpp" else ["-fsyntax-only"]
    command = [os.environ.get("CXX", "g++"), "-std=c++20", "-Wall", "-Wextra", "-Wno-psabi", "-ftemplate-backtrace-limit=0",
               f"-I{INCLUDE}", *what, file]  # fmt: skip
    return subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env=os.environ | {"LC_ALL": "C"}).stdout.splitlines()  # fmt: skip


def law_of(laws, number, origin):
    """The law in whose lines an error is, or whose name is in the lines before it that say where it comes from."""
    names = [law for law, _, first in laws if (first <= number if number else re.search(rf"\b{law}\b", origin))]
    return names[-1] if names else ""


def messages_of(file, laws):
    """The first of each law, in quotes of ASCII."""
    messages, origin, name = {}, "", "no law"  # errors of one origin follow each other
    for line in said_of(file):
        found = re.fullmatch(r"(.*):(\d+):\d+: error: (?:static assertion failed: )?(.*?)(?: \[-Werror=.*)?", line)
        if found:
            number = int(found[2]) if found[1] == str(file) else 0
            if number or origin:
                name = law_of(laws, number, origin)
            messages.setdefault(name, re.sub("::(baseline|v3|v4)::", "::", found[3]))
            origin = ""
        elif "required" in line or "In " in line:
            origin += line + "\n"
    return messages


class Mistakes(unittest.TestCase):
    def test_are_named_by_the_compiler_in_one_line(self):
        for name in ("wrong_laws.cpp", "wrong_steps.cpp", "wrong_status.cpp"):
            with self.subTest(file=name):
                laws = laws_of(HERE / name)
                self.assertTrue(laws)
                self.assertEqual(messages_of(HERE / name, laws), {law: message for law, message, _ in laws})

    def test_right_laws_go_with_headers_of_the_standard(self):
        self.assertEqual(said_of(HERE / "right_law.cpp"), [])


if __name__ == "__main__":
    unittest.main()
