#!/usr/bin/env python3
"""Do the tests notice? Faults of one line, the chosen ones compiled into one copy of the tree, switched on one by one.

    tests/mutants/run.py                   all mutants of mutants.json
    tests/mutants/run.py --only window     those whose name holds this word
    tests/mutants/run.py --area kit        those of an area (AREAS)
    tests/mutants/run.py --last 24         the last ones of mutants.json
    tests/mutants/run.py --near            by the nearest tests of each alone: survivors may be caught by others
    tests/mutants/run.py --check           only whether each still fits the sources, exactly once
    tests/mutants/run.py --table           and writes the score into docs/reliability.md

The copy is build/mutants; the environment variable ILAW_MUTANT is the number of the mutant that its programs have,
0 for none. The nearest tests come first ("program", or "program:filter"), then all of the mutant's area, until one
fails, crashes or hangs: that has caught it. Exit codes: 0 at least 90 % are caught in every area, 1 otherwise.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "support"))
import marked_part  # noqa: E402

MUTANTS = pathlib.Path(__file__).with_name("mutants.json")
PAGE = SOURCE / "docs" / "reliability.md"
TREE = SOURCE / "build" / "mutants"
BUILD = TREE / "build" / "dev"
GOAL = 0.9
HANGS = 300  # seconds
# Every program that runs through the sources of an area.
AREAS = {"plugins": ["laws_test"],
         "kit": ["kit_test", "laws_test"],
         "loader": ["loader_test", "loader_memory_test", "unusual_hosts_test"],
         "coupled": ["coupled_test", "host_test", "closed_forms_test", "prestress_test"],
         "check": ["check_test"],
         "study": ["converge_test", "study_test"],
         "stress": ["stress_test"],
         "results": ["forces_test", "fields_test", "summary_test", "runs_test", "checkpoint_test", "resume_test"],
         "cli": ["program_test", "runs_test", "resume_test", "keys_test", "study_test", "question_page_test"],
         "host": ["host_test", "bars_test", "blocks_test", "bodies_test", "scene_keys_test", "closed_forms_test",
                  "prestress_test", "mesh_test", "proximity_filter_test", "keys_test", "checkpoint_test"]}
SWITCH = """#pragma once
#include <cstdlib>
// Read when a program or law is loaded, so that evaluate stays pure.
[[maybe_unused]] static const int ilaw_mutant = [] {
  const char* text = std::getenv("ILAW_MUTANT");
  return text ? std::atoi(text) : 0;
}();
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="mutants whose name holds this word")
    parser.add_argument("--area", choices=sorted(AREAS), action="append", help="mutants of this area; to be repeated")
    parser.add_argument("--last", type=int, default=0, help="this many from the end of mutants.json")
    parser.add_argument("--near", action="store_true", help="the nearest tests of each alone")
    parser.add_argument("--check", action="store_true", help="do not build: see whether mutants fit the sources")
    parser.add_argument("--table", action="store_true", help="write the score into docs/reliability.md")
    parser.add_argument("--jobs", default=os.cpu_count(), type=int, help="processes of the build and of the tests")
    return parser.parse_args()


def place_of(mutant, text):
    """Where a mutant's "from" stands: "in" is the text around it, with @ in its place."""
    around = mutant.get("in", "@")
    whole = around.replace("@", mutant["from"])
    count = text.count(whole)
    if count != 1:
        raise ValueError(f"{mutant['name']}: {mutant['file']} has {count} times: {whole}")
    begin = text.index(whole) + around.index("@")
    return begin, begin + len(mutant["from"])


def switched(mutant):
    """Both forms of an expression, or of a statement."""
    number, before, after = mutant["number"], mutant["from"], mutant["to"]
    if not before.endswith(";") and re.match(r"\s*(if\b|return\b|&&|\|\|)|.*[^=<>!]=[^=]", before):
        raise ValueError(f"{mutant['name']}: neither an expression nor a statement: {before}")
    for text in (before, after):
        if text.count("(") != text.count(")"):
            raise ValueError(f"{mutant['name']}: parentheses do not balance: {text}")
    if before.endswith(";"):
        return f"{{ if (ilaw_mutant == {number}) {{ {after} }} else {{ {before} }} }}"
    return f"(ilaw_mutant == {number} ? ({after}) : ({before}))"


def with_mutants(file, mutants):
    text = (SOURCE / file).read_text()
    places = sorted(((place_of(mutant, text), mutant) for mutant in mutants), key=lambda found: found[0])
    for ((_, end), one), ((begin, _), other) in zip(places, places[1:]):
        if begin < end:
            raise ValueError(f"{one['name']}, {other['name']}: at the same place")
    for (begin, end), mutant in reversed(places):
        text = text[:begin] + switched(mutant) + text[end:]
    return f'#include "{TREE / "mutant_switch.hpp"}"\n' + text


def write(file, text):
    """Leaves what is the same alone, which need not be built again."""
    if file.exists() and file.read_text() == text:
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def copy_tree(by_file):
    files = subprocess.run(["git", "ls-files"], cwd=SOURCE, check=True, capture_output=True, text=True).stdout
    for name in files.splitlines():
        source, target = SOURCE / name, TREE / name
        if name in by_file:
            write(target, by_file[name])
        elif source.exists() and (not target.exists() or target.read_bytes() != source.read_bytes()):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, target)  # as new, or what was built of an older copy would do
    write(TREE / "mutant_switch.hpp", SWITCH)


def build(programs, jobs):
    configure = ["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DILAW_TESTS=ON",
                 "-DILAW_UNITY=ON", "-DILAW_LAMMPS=OFF", "-DILAW_SOLVERS=OFF", "-DCMAKE_CXX_FLAGS_DEBUG=-O1",
                 "-DCMAKE_C_FLAGS_DEBUG=-O1"]
    if shutil.which("ccache"):
        configure += ["-DCMAKE_C_COMPILER_LAUNCHER=ccache", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "-j", str(jobs), "--target", *sorted(programs), "--", "--quiet"],
                   check=True)


def passes(test, number):
    """Whether a program's tests pass with a mutant, in time."""
    program, _, chosen = test.partition(":")
    command = [BUILD / "bin" / program, "--gtest_brief=1", "--gtest_fail_fast"]
    if chosen:
        command.append(f"--gtest_filter={chosen}")
    try:
        return subprocess.run(command, capture_output=True, timeout=HANGS,
                              env={**os.environ, "ILAW_MUTANT": str(number)}).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def tests_of(mutant, near):
    return list(dict.fromkeys(mutant["tests"] + ([] if near else AREAS[mutant["area"]])))


def caught_by(mutant, near):
    """The first tests that fail with it; none where it survives."""
    begin = time.monotonic()
    found = next((test for test in tests_of(mutant, near) if not passes(test, mutant["number"])), "")
    return found, time.monotonic() - begin


def table(score):
    rows = ["| area | mutants | caught |", "| --- | --- | --- |"]
    rows += [f"| {area} | {len(caught)} | {sum(caught)} |" for area, caught in sorted(score.items())]
    everything = [one for caught in score.values() for one in caught]
    return "\n".join(rows + [f"| all | {len(everything)} | {sum(everything)} |"])


def main():
    options = arguments()
    everything = json.loads(MUTANTS.read_text())
    by_file = collections.defaultdict(list)
    for number, mutant in enumerate(everything, 1):
        mutant["number"] = number
        by_file[mutant["file"]].append(mutant)
    try:
        for file, mutants in by_file.items():
            with_mutants(file, mutants)
    except ValueError as misfit:
        print(misfit)
        return 1
    print(f"{len(everything)} mutants fit the sources")
    if options.check:
        return 0

    chosen = [mutant for mutant in everything[-options.last:]
              if options.only in mutant["name"] and mutant["area"] in (options.area or AREAS)]
    copy_tree({file: with_mutants(file, [one for one in mutants if one in chosen]) for file, mutants in by_file.items()
               if any(one in chosen for one in mutants)})
    tests = {test for mutant in chosen for test in tests_of(mutant, options.near)}
    build({test.partition(":")[0] for test in tests}, options.jobs)
    score, survivors = collections.defaultdict(list), []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        broken = [test for test, good in zip(tests, pool.map(lambda test: passes(test, 0), tests)) if not good]
        if broken:
            print("fail without any mutant: " + ", ".join(sorted(broken)))
            return 1
        for mutant, (test, seconds) in zip(chosen, pool.map(lambda one: caught_by(one, options.near), chosen)):
            score[mutant["area"]].append(bool(test))
            print(f"{'caught' if test else 'SURVIVED':8} {seconds:6.1f} s  {mutant['area']:8} {mutant['name']}"
                  + (f"  ({test})" if test else ""), flush=True)
    print(table(score))
    if options.table:
        marked_part.write(PAGE, "<!-- score of the mutants -->", "<!-- end of the score -->", table(score))
    return 0 if all(sum(caught) >= GOAL * len(caught) for caught in score.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
