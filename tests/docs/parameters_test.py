# SPDX-License-Identifier: BSD-3-Clause
"""Tables of parameters on the pages of laws, beside what the built libraries say of themselves."""
import json
import os
import re
import unittest
from pathlib import Path

PLUGINS = Path(__file__).resolve().parents[2] / "plugins"
LIBRARIES = Path(os.environ["ILAW_PATH"])


def rows(page):
    """Names, unit, range and default of each row of the table under "Parameters"."""
    part = page.split("\n## Parameters\n", 1)[1].split("\n## ", 1)[0]
    for line in part.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        names = re.findall(r"`(\w+)`", cells[0]) if line.startswith("| `") and len(cells) == 6 else []
        if names:
            yield names, cells[2], cells[3], cells[4]


def plain(unit):
    return unit.replace("²", "^2").replace("³", "^3").replace("·", ".")


def range_of(parameter):
    """As the pages write it, by numbers."""
    if parameter["kind"] == "choice":
        return parameter["choices"]
    flags, most = parameter["flags"], parameter["maximum"]
    closed = most != "inf" or "allows_infinity" in flags
    return ["excludes_minimum" not in flags, parameter["minimum"], float(most), closed]


def read_range(text):
    if text.startswith("`"):
        return re.findall(r"`(\w+)`", text)
    whole = re.fullmatch(r"(\S+) to (\S+)", text)
    if whole:
        return [True, float(whole[1]), float(whole[2]), True]
    low, high = text[1:-1].split(", ")
    return [text[0] == "[", float(low), float(high), text[-1] == "]"]


def default_of(parameter):
    if "required" in parameter["flags"]:
        return "required"
    return parameter["default"] if parameter["kind"] == "choice" else float(parameter["default"])


def read_default(text):
    text = text.split(":")[0].strip("`")
    try:
        return float(text)
    except ValueError:
        return text


class Parameters(unittest.TestCase):
    def test_pages_name_each_parameter_as_the_library_does(self):
        for file in sorted(LIBRARIES.glob("*.json")):
            page = PLUGINS / file.stem / f"{file.stem}.md"
            if not page.is_file():
                continue
            known = {p["name"]: p for law in json.loads(file.read_text())["laws"] for p in law["parameters"]}
            found = list(rows(page.read_text()))
            with self.subTest(page=page.name):
                self.assertEqual(sorted({name for names, *_ in found for name in names}), sorted(known))
            for names, unit, allowed, default in found:
                if len(names) > 1:
                    continue
                with self.subTest(page=page.name, parameter=names[0]):
                    parameter = known[names[0]]
                    self.assertEqual(plain(unit), "" if parameter["kind"] == "choice" else plain(parameter["unit"]))
                    if not allowed.endswith("`]"):  # up to another parameter
                        self.assertEqual(read_range(allowed), range_of(parameter))
                    self.assertEqual(read_default(default), default_of(parameter))


if __name__ == "__main__":
    unittest.main()
