#!/usr/bin/env python3
"""Each member of each public struct is read or set by a test, a host or the checker: none is forgotten in silence.

    members_test.py SOURCE
"""
# SPDX-License-Identifier: BSD-3-Clause
import re
import sys
import unittest
from pathlib import Path

ROOT = Path(sys.argv.pop(1)) if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]
HEADERS = ["ilaw.h", "coupled.h", "search.h"]
COMMENT = re.compile(r"/\*.*?\*/", re.S)
STRUCT = re.compile(r"typedef struct (\w+) \{(.*?)\n\} \1;", re.S)
POINTER_TO_FUNCTION = re.compile(r"\(\s*(?:ILAW_CALL)?\s*\*\s*(\w+)\s*\)")


def members(body):
    for declaration in body.split(";"):
        declaration = " ".join(declaration.split())
        if function := POINTER_TO_FUNCTION.search(declaration):
            yield function.group(1)
        elif declaration:
            for part in declaration.split(","):
                yield re.search(r"(\w+)(?:\[[^\]]*\])*$", part.strip()).group(1)


class EachMember(unittest.TestCase):
    def test_is_used_by_a_test(self):
        texts = "\n".join(path.read_text(errors="replace") for path in sorted((ROOT / "tests").rglob("*"))
                          if path.suffix in {".cpp", ".hpp", ".c", ".h", ".py", ".f90"} and "frozen" not in path.parts)
        used = set(re.findall(r"(?:\.|->)\s*(\w+)", texts))
        missing, count = [], 0
        for header in HEADERS:
            text = COMMENT.sub("", (ROOT / "api" / "include" / "ilaw" / header).read_text())
            for struct, body in STRUCT.findall(text):
                for member in members(body):
                    count += 1
                    if member not in used and member != "reserved":
                        missing.append(f"{header}: {struct}.{member}")
        self.assertGreater(count, 150, "members that were found in the headers")
        self.assertEqual(missing, [])


if __name__ == "__main__":
    unittest.main()
