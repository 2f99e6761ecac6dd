#!/usr/bin/env python3
"""Writes the parts of ilaw as an SPDX document (version 2.3, JSON): its sources and the libraries of others.

    make_sbom.py SOURCE VERSION FILES PARTS OUT      FILES: a path a line; PARTS: JSON, by ilaw_add_part of CMake

Clauses in brackets are those of the specification, ISO/IEC 5962 as SPDX 2.3.
"""
# SPDX-License-Identifier: BSD-3-Clause

import hashlib
import json
import os
import re
import sys
import time
import uuid
from pathlib import Path

LICENSE = "BSD-3-Clause"
HOME = "https://example.org/ilaw"  # as in docs/codemeta.json
SOURCES = {".c", ".cpp", ".h", ".hpp", ".f", ".f90", ".py", ".sh", ".cmake"}
RELATIONS = {"contained": "STATIC_LINK", "linked": "DYNAMIC_LINK"}  # [11.1]


def identifier(kind, name):
    """[3.2]: letters, digits, '.' and '-'; other characters by their numbers, so that no two names meet."""
    return f"SPDXRef-{kind}-" + re.sub(r"[^A-Za-z0-9.]", lambda found: f"-{ord(found[0]):x}-", name)


def file_entry(source, name, copyright_text):
    """[8]"""
    content = (source / name).read_bytes()
    stated = re.search(rb"SPDX-License-Identifier: ([\w.+-]+)$", content, re.M)
    license_name = stated[1].decode() if stated else LICENSE
    return {
        "SPDXID": identifier("File", name),
        "fileName": f"./{name}",
        "fileTypes": ["SOURCE" if Path(name).suffix in SOURCES else "OTHER"],
        "checksums": [{"algorithm": kind.upper(), "checksumValue": hashlib.new(kind, content).hexdigest()}
                      for kind in ("sha1", "sha256")],
        "licenseConcluded": license_name,
        "licenseInfoInFiles": [license_name if stated else "NONE"],
        "copyrightText": copyright_text,
    }  # fmt: skip


def project_entry(version, files, copyright_text):
    """[7]; the verification code [7.9] is the SHA1 of the sorted SHA1 of all files."""
    sums = sorted(file["checksums"][0]["checksumValue"] for file in files)
    stated = {name for file in files for name in file["licenseInfoInFiles"]} - {"NONE"}
    return {
        "SPDXID": "SPDXRef-Package-ilaw",
        "name": "ilaw",
        "versionInfo": version,
        "supplier": "Organization: the ilaw authors",
        "downloadLocation": "NOASSERTION",
        "homepage": HOME,
        "primaryPackagePurpose": "LIBRARY",
        "filesAnalyzed": True,
        "packageVerificationCode": {"packageVerificationCodeValue": hashlib.sha1("".join(sums).encode()).hexdigest()},
        "licenseConcluded": LICENSE,
        "licenseDeclared": LICENSE,
        "licenseInfoFromFiles": sorted(stated),
        "copyrightText": copyright_text,
    }


def part_entry(part):
    entry = {
        "SPDXID": identifier("Package", part["name"]),
        "name": part["name"],
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": part["license"],
        "licenseDeclared": part["license"],
        "copyrightText": "NOASSERTION",
    }
    return {**entry, "versionInfo": part["version"]} if "version" in part else entry


def relation(first, kind, second):
    return {"spdxElementId": first, "relationshipType": kind, "relatedSpdxElement": second}


def document(source, version, names, parts):
    copyright_text = re.search(r"^Copyright.*", (source / "LICENSE").read_text(), re.M)[0]
    files = [file_entry(source, name, copyright_text) for name in sorted(names)]
    packages = [project_entry(version, files, copyright_text)] + [part_entry(part) for part in parts]
    home = packages[0]["SPDXID"]
    relations = [relation("SPDXRef-DOCUMENT", "DESCRIBES", home)]
    relations += [relation(home, "CONTAINS", file["SPDXID"]) for file in files]
    relations += [relation(home, RELATIONS[part["relation"]], identifier("Package", part["name"])) for part in parts]
    # A document with other contents needs another namespace [6.5]; the same sources and parts give the same.
    unique = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps([packages, files, relations]))
    created = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())))
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"ilaw-{version}",
        "documentNamespace": f"{HOME}/spdx/ilaw-{version}-{unique}",
        "creationInfo": {
            "created": time.strftime("%Y-%m-%dT%H:%M:%SZ", created),
            "creators": ["Organization: the ilaw authors", f"Tool: make_sbom.py-{version}"],
        },
        "packages": packages,
        "files": files,
        "relationships": relations,
    }


def main():
    if len(sys.argv) != 6:
        sys.exit(__doc__)
    source, version, files, parts, out = sys.argv[1:]
    names = Path(files).read_text().split("\n")[:-1]
    recorded = json.loads(Path(parts).read_text())
    text = json.dumps(document(Path(source), version, names, [recorded[name] for name in sorted(recorded)]), indent=1)
    Path(out).write_text(text + "\n")


if __name__ == "__main__":
    main()
