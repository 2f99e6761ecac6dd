#!/usr/bin/env python3
"""What the headers promise for good: what is in a frozen header of a released version is in today's, at the same place,
and each member of each public struct is read or set by a test or by the made problems of `ilaw stress`.

Needs a C compiler, CC.
"""
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TODAY = ROOT / "api/include"
FROZEN = sorted((Path(__file__).parent / "frozen").iterdir())
POINTER_TO_FUNCTION = re.compile(r"\(\s*(?:ILAW_CALL)?\s*\*\s*(\w+)\s*\)")


def code_of(header):
    return re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)


def structs_of(code):
    """The declarations of each struct."""
    return {name: [" ".join(part.split()) for part in body.split(";") if part.strip()]
            for name, body in re.findall(r"typedef struct (\w+) \{([^}]*)\}", code)}  # fmt: skip


def names_of(declarations):
    for declaration in declarations:
        if function := POINTER_TO_FUNCTION.search(declaration):
            yield function[1]
        else:
            yield from (re.search(r"(\w+)(?:\[[^\]]*\])*$", part.strip())[1] for part in declaration.split(","))


def declarations_of(header):
    """Structs, types of functions and others, and enumerators, each with a list of texts."""
    code, found = code_of(header), collections.defaultdict(list)
    found.update(structs_of(code))
    for text in re.findall(r"typedef ([^;{]+);", code):
        found[" ".join(text.split())].append("typedef")
    for name, value in re.findall(r"(ILAW_\w+) = ([^,}]+)[,}]", code):
        found[name].append(" ".join(value.split()))
    return found


def numbers_of(include, expressions):
    """Of constant expressions, as the compiler has them with the header of a folder."""
    lines = "".join(f'  printf("%zu\\n", (size_t)({text}));\n' for text in expressions)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "places.c"
        head = "".join(f"#include <{name}.h>\n" for name in ("ilaw/ilaw", "stddef", "stdio"))
        source.write_text(f"{head}int main(void) {{\n{lines}  return 0;\n}}\n")
        subprocess.run([os.environ.get("CC", "cc"), f"-I{include}", source, "-o", source.with_suffix("")], check=True)
        said = subprocess.run([source.with_suffix("")], check=True, capture_output=True, text=True).stdout
    return dict(zip(expressions, map(int, said.split())))


class Headers(unittest.TestCase):
    def for_each(self):
        """Each frozen folder, with the members of its structs."""
        self.assertGreaterEqual(len(FROZEN), 1)
        for folder in FROZEN:
            structs = structs_of(code_of(folder / "ilaw/ilaw.h"))
            yield folder, {name: list(names_of(body)) for name, body in structs.items()}

    def test_are_the_beginnings_of_todays(self):
        """Every line of a frozen struct is there today, in the same order, before any new one."""
        today = declarations_of(TODAY / "ilaw/ilaw.h")
        for folder, _ in self.for_each():
            frozen = declarations_of(folder / "ilaw/ilaw.h")
            self.assertGreaterEqual(len(frozen), 95)
            for name in frozen.keys() - {"ILAW_ABI_MINOR"}:
                self.assertEqual(today[name][: len(frozen[name])], frozen[name], name)

    def test_keep_members_where_they_were(self):
        """And without padding: a member that was put into it would change nothing that a size shows."""
        for folder, structs in self.for_each():
            self.assertEqual(len(structs), 13)
            places = {(name, member): (f"offsetof({name}, {member})", f"sizeof((({name}*)0)->{member})")
                      for name, members in structs.items() for member in members}  # fmt: skip
            self.assertGreaterEqual(len(places), 140)
            sizes = [f"sizeof({name})" for name in structs]
            expressions = [text for pair in places.values() for text in pair] + sizes
            was, now = numbers_of(folder, expressions), numbers_of(TODAY, expressions)
            for text in expressions:
                if text in sizes:
                    self.assertGreaterEqual(now[text], was[text], text)
                else:
                    self.assertEqual(now[text], was[text], text)
            ends = dict.fromkeys(structs, 0)
            for (name, member), (offset, size) in places.items():
                self.assertEqual(was[offset], ends[name], f"{name}.{member}")
                ends[name] += was[size]
            self.assertEqual(ends, {name: was[f"sizeof({name})"] for name in structs})

    def test_accept_structs_of_version_one(self):
        """The least size that a reader accepts is the size in the frozen header of 1.0."""
        least = set(re.findall(r"ILAW_(\w+)_SIZE_1_0\b", code_of(TODAY / "ilaw/ilaw.h")))
        self.assertEqual(len(least), 11)
        accepted = numbers_of(TODAY, [f"ILAW_{name}_SIZE_1_0" for name in least])
        released = numbers_of(Path(__file__).parent / "frozen/1.0", [f"sizeof(ilaw_{name.lower()})" for name in least])
        for name in least:
            self.assertEqual(accepted[f"ILAW_{name}_SIZE_1_0"], released[f"sizeof(ilaw_{name.lower()})"], name)

    def test_have_no_member_that_no_test_uses(self):
        texts = "\n".join(path.read_text(errors="replace") for folder in ("tests", "host_mock/instruments/stress")
                          for path in (ROOT / folder).rglob("*") if path.suffix in {".cpp", ".hpp", ".c", ".h", ".py", ".f90"}
                          and "frozen" not in path.parts)  # fmt: skip
        used = set(re.findall(r"(?:\.|->)\s*(\w+)", texts)) | {"reserved"}
        members = {f"{struct}.{name}" for header in ("ilaw", "coupled", "search")
                   for struct, body in structs_of(code_of(TODAY / f"ilaw/{header}.h")).items()
                   for name in names_of(body)}  # fmt: skip
        self.assertGreater(len(members), 150)
        self.assertEqual([member for member in sorted(members) if member.split(".")[1] not in used], [])


if __name__ == "__main__":
    unittest.main()
