#!/usr/bin/env python3
"""Which lines and branches of api, plugins and host_mock the tests run through, as clang counts in the sources.

    tests/coverage.py                          all tests but those of other solvers
    tests/coverage.py loader_test kit_test     these programs alone
    tests/coverage.py --add loader_test        these on top of what was run before
    tests/coverage.py --add                    nothing anew: what was run before
    tests/coverage.py --files 20               also each folder, and the files where most was missed: lines, then branches
    tests/coverage.py --table                  and writes the figures into docs/reliability.md
    tests/coverage.py --least 95 90            fails where an area has less of its lines (95 %) or branches (90 %)

A branch is one outcome of a condition that stands in the source: of an if, a loop, ?:, a case, each operand of && and
||. What a compiler adds, as the edges of exceptions, is none, and neither is a condition that is known when compiled.
What is compiled several times, as templates are, counts as reached where it is in one of them; constexpr functions
that ran in the compiler alone are left out. Counts are kept in files that all processes map, so that those of
children that crash are there too. Exit code: 0, or 1 where --least is missed.
"""
import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "tests" / "support"))
import marked_part  # noqa: E402

BUILD = SOURCE / "build" / "coverage"
COUNTS = BUILD / "counts"
PAGE = SOURCE / "docs" / "reliability.md"
AREAS = ("api", "plugins", "host_mock")
# The head of a function that may run in the compiler.
CONSTEXPR = re.compile(r"(?<!if )\bconst(?:expr|eval)\b[^;{}=]*\([^;{}=]*\)[^;{}=]*\{")
# They build what is built, or look at how; no line is run through in them alone.
LEFT_OUT = r"^installed|^kit\.first_law|^new_law|^python\.(wheel|install|bindings|page|readme)|portable|^hosts_install"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", help="test programs, all tests if none is named")
    parser.add_argument("--add", action="store_true", help="keep the counts of what was run before")
    parser.add_argument("--files", type=int, default=0, help="how many files to list")
    parser.add_argument("--table", action="store_true", help="write the figures into docs/reliability.md")
    parser.add_argument("--least", nargs=2, type=float, metavar=("LINES", "BRANCHES"), default=(0.0, 0.0),
                        help="percent of each area that must be reached")
    parser.add_argument("--jobs", default=os.cpu_count(), type=int, help="processes of the build and of the tests")
    return parser.parse_args()


def build(programs, jobs):
    subprocess.run(["cmake", "--preset", "coverage", "-DILAW_TESTS=ON", "-DILAW_LAMMPS=OFF", "-DILAW_SOLVERS=OFF"],
                   cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "-j", str(jobs), *(["--target", *programs] if programs else []), "--",
                    "--quiet"], check=True)


def run_tests(options):
    """All tests, or the programs named; a test that fails here is no matter."""
    if not options.add:
        for file in COUNTS.glob("*.profraw"):
            file.unlink()
    COUNTS.mkdir(exist_ok=True)
    counting = {**os.environ, "LLVM_PROFILE_FILE": str(COUNTS / "%m%c.profraw")}
    if not options.programs and not options.add:
        subprocess.run(["ctest", "--test-dir", BUILD, "-j", str(options.jobs), "--timeout", "900", "-E", LEFT_OUT],
                       check=False, env=counting)
    for program in options.programs:
        subprocess.run([BUILD / "bin" / program, "--gtest_brief=1"], check=False, env=counting)


def is_elf(file):
    with file.open("rb") as opened:
        return opened.read(4) == b"\x7fELF"


def exported(form):
    """The report of llvm-cov on all programs and libraries of the build."""
    files = [file for file in sorted(BUILD.rglob("*")) if file.is_file() and not file.is_symlink()
             and (os.access(file, os.X_OK) or file.suffix == ".so") and file.suffix != ".o" and is_elf(file)]
    objects = [word for file in files for word in ("-object", str(file))]
    return subprocess.run(["llvm-cov", "export", f"-format={form}", "-skip-functions", "-skip-expansions",
                           "-ignore-filename-regex=^/usr/|/tests/", f"-instr-profile={COUNTS / 'all.profdata'}",
                           *objects[1:]], check=True, capture_output=True, text=True).stdout


def name_of(file):
    """Relative to the tree; ccache makes paths relative to the build."""
    return os.path.relpath(BUILD / file, SOURCE)


def lines_reached():
    """By file and line, whether the line was executed."""
    lines, name = collections.defaultdict(dict), ""
    for record in exported("lcov").splitlines():
        key, _, text = record.partition(":")
        if key == "SF":
            name = name_of(text)
        elif key == "DA":
            line, count = text.split(",")[:2]
            lines[name][int(line)] = int(count) > 0
    return lines


def count_at(segments, place):
    """How often the code at a place (line, column) was run."""
    before = [segment for segment in segments if tuple(segment[:2]) <= place]
    return before[-1][2] if before else 0


def branches_reached():
    """By file, place of the condition and outcome, whether that outcome occurred."""
    branches = collections.defaultdict(dict)
    for file in json.loads(exported("text"))["data"][0]["files"]:
        found = collections.defaultdict(lambda: [0, 0])
        for branch in file["branches"]:
            counts = found[tuple(branch[:4])]
            counts[0] += branch[4]
            counts[1] += branch[5]
        known = branches[name_of(file["filename"])]
        for place, counts in found.items():
            if not any(counts) and count_at(file["segments"], place[:2]) > 0:
                continue  # known when compiled: it was run, and went neither way
            known.update({(*place, outcome): count > 0 for outcome, count in enumerate(counts)})
    return branches


def compiled_only(name, hits):
    """Lines of a file's constexpr functions of which no line was run: they work when laws are compiled."""
    text, lines = (SOURCE / name).read_text(), set()
    for found in CONSTEXPR.finditer(text):
        end, depth = found.end(), 1
        while depth > 0:
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        own = range(text.count("\n", 0, found.start()) + 1, text.count("\n", 0, end) + 2)
        if not any(hits.get(line) for line in own):
            lines.update(own)
    return lines


def leave_out_compiled(lines, branches):
    for name in list(lines):
        if name.split("/")[0] in AREAS:
            left_out = compiled_only(name, lines[name])
            lines[name] = {line: hit for line, hit in lines[name].items() if line not in left_out}
            branches[name] = {place: hit for place, hit in branches[name].items() if place[0] not in left_out}


def share(of, folder):
    hit = [one for name, places in of.items() if name.startswith(folder + "/") for one in places.values()]
    return sum(hit), len(hit)


def unreached(of):
    """Files by the number of their lines or branches that nothing reached."""
    missed = {name: sorted({place for place, hit in places.items() if not hit}) for name, places in of.items()}
    return sorted(missed.items(), key=lambda found: -len(found[1]))


def percent(part):
    return f"{100.0 * part[0] / max(part[1], 1):.1f} % of {part[1]}"


def table(lines, branches, folders=AREAS):
    rows = ["| | lines | branches |", "| --- | --- | --- |"]
    rows += [f"| {folder} | {percent(share(lines, folder))} | {percent(share(branches, folder))} |"
             for folder in folders]
    return "\n".join(rows)


def print_files(lines, branches, count):
    folders = {os.path.dirname(name) for name in lines if name.split("/")[0] in AREAS}
    print(table(lines, branches, sorted(folders)))
    for name, places in unreached(lines)[:count]:
        print(f"{len(places):5}  {name}: {' '.join(map(str, places))}")
    for name, places in unreached(branches)[:count]:
        said = (f"{line}:{column}{'TF'[outcome]}" for line, column, _, _, outcome in places)
        print(f"{len(places):5}  {name}: {' '.join(said)}")


def main():
    options = arguments()
    if options.programs or not options.add:
        build(options.programs, options.jobs)
        run_tests(options)
    subprocess.run(["llvm-profdata", "merge", "-o", COUNTS / "all.profdata", *COUNTS.glob("*.profraw")], check=True)
    lines, branches = lines_reached(), branches_reached()
    leave_out_compiled(lines, branches)
    print(table(lines, branches))
    if options.files > 0:
        print_files(lines, branches, options.files)
    if options.table:
        marked_part.write(PAGE, "<!-- coverage -->", "<!-- end of the coverage -->", table(lines, branches))
    reached = [(share(of, area), least) for area in AREAS for of, least in zip((lines, branches), options.least)]
    return 0 if all(100.0 * hit >= least * count for (hit, count), least in reached) else 1


if __name__ == "__main__":
    sys.exit(main())
