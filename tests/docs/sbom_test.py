#!/usr/bin/env python3
"""ilaw.spdx.json lists all sources with their sums, and every library that the programs contain or need.

Debian 12 has no library for SPDX: the document is held to a JSON schema of the members that it has, its licenses to
the list of SPDX by license_expression, its sums and relations to the tree.
"""
# SPDX-License-Identifier: BSD-3-Clause

import hashlib
import json
import os
import re
import subprocess
import unittest
from pathlib import Path

import jsonschema
from license_expression import get_spdx_licensing

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["ILAW_BUILD"])
DOCUMENT = json.loads((BUILD / "ilaw.spdx.json").read_text())
SCHEMA = json.loads((Path(__file__).parent / "sbom.schema.json").read_text())
PARTS = {package["name"]: package for package in DOCUMENT["packages"]}
# The part that a library at run time belongs to.
LIBRARIES = {
    r"libvtk": "VTK", r"libz\.": "ZLIB", r"libgomp|libomp": "OpenMP", r"libtinyxml2": "tinyxml2", r"liblammps": "LAMMPS",
    r"libmpi": "MPI", r"libstdc\+\+": "libstdc++", r"libgcc_s": "libgcc", r"libc\.|libm\.|libdl\.|ld-linux": "glibc",
    r"libilaw": "ilaw",
}  # fmt: skip


def licenses():
    for entry in DOCUMENT["packages"] + DOCUMENT["files"]:
        stated = [entry["licenseConcluded"], entry.get("licenseDeclared", "NOASSERTION")]
        yield from stated + entry.get("licenseInfoFromFiles", []) + entry.get("licenseInfoInFiles", [])


def installed():
    """Programs and libraries of the build that are installed."""
    yield from (BUILD / "bin" / name for name in ("ilaw", "ilaw-check", "ilaw-describe"))
    yield from BUILD.glob("lib/libilaw_*.so")
    yield from BUILD.glob("lib/ilaw/*.so")


class Sbom(unittest.TestCase):
    def test_has_the_form_of_spdx(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)
        jsonschema.validate(DOCUMENT, SCHEMA, jsonschema.Draft7Validator)

    def test_licenses_are_on_the_list_of_spdx(self):
        known = get_spdx_licensing()
        for name in set(licenses()) - {"NOASSERTION", "NONE"}:
            self.assertEqual(known.validate(name, strict=True).errors, [], name)

    def test_relations_join_elements_of_the_document(self):
        elements = [entry["SPDXID"] for entry in [DOCUMENT] + DOCUMENT["packages"] + DOCUMENT["files"]]
        self.assertEqual(len(elements), len(set(elements)))
        joined = [(one["spdxElementId"], one["relatedSpdxElement"]) for one in DOCUMENT["relationships"]]
        self.assertLessEqual({element for pair in joined for element in pair}, set(elements))
        self.assertEqual({related for _, related in joined}, set(elements) - {"SPDXRef-DOCUMENT"})

    def test_sums_are_those_of_the_tree(self):
        sums = []
        for file in DOCUMENT["files"]:
            content = (ROOT / file["fileName"]).read_bytes()
            for stated in file["checksums"]:
                found = hashlib.new(stated["algorithm"], content).hexdigest()
                self.assertEqual(stated["checksumValue"], found, file["fileName"])
            sums.append(hashlib.sha1(content).hexdigest())
        code = PARTS["ilaw"]["packageVerificationCode"]["packageVerificationCodeValue"]
        self.assertEqual(code, hashlib.sha1("".join(sorted(sums)).encode()).hexdigest())

    def test_no_source_is_left_out(self):
        listed = {file["fileName"].removeprefix("./") for file in DOCUMENT["files"]}
        sources = {str(path.relative_to(ROOT)) for folder in ("api", "plugins", "host_mock")
                   for path in (ROOT / folder).rglob("*") if path.suffix in (".c", ".cpp", ".h", ".hpp", ".in", ".f90")}
        self.assertEqual(sources - listed, set())
        self.assertLess(300, len(sources))

    def test_every_library_at_run_time_is_a_part(self):
        self.assertLessEqual(12, len(list(installed())))
        for file in installed():
            header = subprocess.run(["objdump", "-p", file], check=True, capture_output=True, text=True).stdout
            for needed in re.findall(r"NEEDED +(\S+)", header):
                names = [name for pattern, name in LIBRARIES.items() if re.match(pattern, needed)]
                self.assertEqual(len(names), 1, f"{file} needs {needed}")
                self.assertIn(names[0], PARTS, f"{file} needs {needed}")

    def test_every_package_that_the_build_finds_is_a_part(self):
        for folder in ("api", "host_mock"):
            for file in (ROOT / folder).rglob("CMakeLists.txt"):
                text = file.read_text()
                is_example = re.search(r"^project\(", text, re.M)  # a project of its own, which users build
                if is_example or (file.parent.name == "lammps" and "LAMMPS" not in PARTS):
                    continue
                for name in re.findall(r"^find_package\((\w+)", text, re.M):
                    self.assertIn(name, {*PARTS, "Threads"}, file)  # threads are glibc's


if __name__ == "__main__":
    unittest.main()
