#!/usr/bin/env python3
"""Which lines and branches of api, plugins and host_mock the tests run through, by gcov.

    tests/coverage.py                          all tests, which takes an hour on two cores
    tests/coverage.py loader_test kit_test     these programs alone
    tests/coverage.py --files 20               also the files with the most lines that nothing reached
    tests/coverage.py --table                  and writes the figures into docs/reliability.md

Branches that an exception alone would take are left out: the compiler makes one of every call. What a header's
template or a law is compiled for several times counts as reached where it is in one of them. Exit code: 0.
"""
import argparse
import collections
import gzip
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "tests" / "support"))
import marked_part  # noqa: E402

BUILD = SOURCE / "build" / "coverage"
PAGE = SOURCE / "docs" / "reliability.md"
AREAS = ("api", "plugins", "host_mock")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", help="test programs, all if none is named")
    parser.add_argument("--files", type=int, default=0, help="how many files to list")
    parser.add_argument("--table", action="store_true", help="write the figures into docs/reliability.md")
    parser.add_argument("--jobs", default=os.cpu_count(), type=int, help="processes of the build and of the tests")
    return parser.parse_args()


def run_tests(programs, jobs):
    launcher = ["-DCMAKE_C_COMPILER_LAUNCHER=", "-DCMAKE_CXX_COMPILER_LAUNCHER="]  # no cache: it keeps no .gcno
    subprocess.run(["cmake", "--preset", "coverage", "-DILAW_TESTS=ON", "-DILAW_UNITY=ON", *launcher], cwd=SOURCE, check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "-j", str(jobs), *(["--target", *programs] if programs else []), "--",
                    "--quiet"], check=True)
    for counts in BUILD.rglob("*.gcda"):
        counts.unlink()
    if not programs:
        subprocess.run(["ctest", "--test-dir", BUILD, "-j", str(jobs), "--quiet"], check=False)
    for program in programs:
        subprocess.run([BUILD / "bin" / program, "--gtest_brief=1"], check=False)


class Counts:
    """Of each file of the areas: lines, and branches by line and place, with whether something went there."""

    def __init__(self):
        self.lines = collections.defaultdict(dict)
        self.branches = collections.defaultdict(dict)

    def add(self, report):
        for file in report["files"]:
            path = pathlib.Path(os.path.normpath(pathlib.Path(report["current_working_directory"]) / file["file"]))
            if not path.is_relative_to(SOURCE):
                continue
            name = str(path.relative_to(SOURCE))
            if name.split("/")[0] not in AREAS:
                continue
            for line in file["lines"]:
                number = line["line_number"]
                self.lines[name][number] = self.lines[name].get(number, False) or line["count"] > 0
                for k, branch in enumerate(line["branches"]):
                    if not branch["throw"]:
                        known = self.branches[name].get((number, k), False)
                        self.branches[name][number, k] = known or branch["count"] > 0

    def share(self, of, area):
        hit = [one for name, places in of.items() if name.startswith(area + "/") for one in places.values()]
        return sum(hit), len(hit)

    def unreached(self):
        """Files by the number of their lines that nothing reached."""
        missed = {name: [line for line, hit in places.items() if not hit] for name, places in self.lines.items()}
        return sorted(missed.items(), key=lambda found: -len(found[1]))


def read_counts():
    counts = Counts()
    files = [str(file) for file in BUILD.rglob("*.gcno")]
    with tempfile.TemporaryDirectory() as folder:
        for k in range(0, len(files), 50):
            subprocess.run(["gcov", "--json-format", "--branch-probabilities", "--hash-filenames", *files[k:k + 50]],
                           cwd=folder, check=True, capture_output=True)
            for file in pathlib.Path(folder).glob("*.gcov.json.gz"):
                with gzip.open(file) as text:
                    counts.add(json.load(text))
                file.unlink()
    return counts


def percent(part):
    return f"{100.0 * part[0] / max(part[1], 1):.1f} % of {part[1]}"


def table(counts):
    rows = ["| | lines | branches |", "| --- | --- | --- |"]
    rows += [f"| {area} | {percent(counts.share(counts.lines, area))} | {percent(counts.share(counts.branches, area))} |"
             for area in AREAS]
    return "\n".join(rows)


def main():
    options = arguments()
    run_tests(options.programs, options.jobs)
    counts = read_counts()
    print(table(counts))
    for name, lines in counts.unreached()[:options.files]:
        print(f"{len(lines):5}  {name}: {' '.join(map(str, sorted(lines)[:30]))}")
    if options.table:
        marked_part.write(PAGE, "<!-- coverage -->", "<!-- end of the coverage -->", table(counts))


if __name__ == "__main__":
    main()
