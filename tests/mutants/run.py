#!/usr/bin/env python3
"""Do the tests notice? Breaks one line at a time, builds the nearest tests, and runs them.

    tests/mutants/run.py                   all mutants of mutants.json, in a copy of the tree below build/mutants
    tests/mutants/run.py --only window     those whose name holds this word
    tests/mutants/run.py --check           only whether each still fits the sources, exactly once

A mutant is caught when a test fails, hangs for minutes, or the compiler refuses it. Prints a line for each and the
score of each area. Exit codes: 0 all fit (and at least 90 % are caught), 1 otherwise.
"""
import argparse
import collections
import json
import os
import pathlib
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
MUTANTS = pathlib.Path(__file__).with_name("mutants.json")
GOAL = 0.9
BUILD = "build/dev"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="mutants whose name holds this word")
    parser.add_argument("--check", action="store_true", help="do not build: see whether mutants fit the sources")
    parser.add_argument("--jobs", default=os.cpu_count(), type=int, help="processes of a build")
    return parser.parse_args()


def misfits(mutants):
    """What a mutant replaces must stand in its file once, else nobody knows what was tested."""
    for mutant in mutants:
        count = (SOURCE / mutant["file"]).read_text().count(mutant["from"])
        if count != 1:
            yield f"{mutant['name']}: {mutant['file']} has {count} times: {mutant['from']}"


def copy_of_tree(folder):
    """The files under version control, so that the tree itself is never touched."""
    files = subprocess.run(["git", "ls-files"], cwd=SOURCE, check=True, capture_output=True, text=True).stdout
    for name in files.splitlines():
        source, target = SOURCE / name, folder / name
        if target.exists() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target)


def quietly(command, folder, seconds=600):
    """Whether a command ends well, in time."""
    try:
        return subprocess.run(command, cwd=folder, capture_output=True, timeout=seconds).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def tests_pass(mutant, tree, jobs):
    """Builds what holds the nearest tests and runs them; "not compiled" where the compiler noticed."""
    build = ["cmake", "--build", BUILD, "-j", str(jobs), "--target", *mutant["targets"]]
    if not quietly(build, tree, 1800):
        return "not compiled"
    programs = [target for target in mutant["targets"] if target.endswith("_test")]
    for program in programs:
        filters = [f"--gtest_filter={mutant['tests']}"] if "tests" in mutant else []
        if not quietly([f"{BUILD}/bin/{program}", "--gtest_brief=1", *filters], tree):
            return "caught"
    return "survived"


def main():
    options = arguments()
    mutants = [m for m in json.loads(MUTANTS.read_text()) if options.only in m["name"]]
    wrong = list(misfits(mutants))
    print("\n".join(wrong) if wrong else f"{len(mutants)} mutants fit the sources")
    if wrong or options.check:
        return 1 if wrong else 0

    tree = SOURCE / "build" / "mutants"
    copy_of_tree(tree)
    configure = ["cmake", "-S", ".", "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DILAW_TESTS=ON",
                 "-DCMAKE_CXX_FLAGS_DEBUG=-O1", "-DCMAKE_C_FLAGS_DEBUG=-O1"]
    subprocess.run(configure, cwd=tree, check=True, stdout=subprocess.DEVNULL)
    score = collections.defaultdict(list)
    for mutant in mutants:
        file = tree / mutant["file"]
        whole = file.read_text()
        file.write_text(whole.replace(mutant["from"], mutant["to"]))
        try:
            outcome = tests_pass(mutant, tree, options.jobs)
        finally:
            file.write_text(whole)
        score[mutant["area"]].append(outcome != "survived")
        print(f"{outcome:12}  {mutant['area']:8}  {mutant['name']}", flush=True)
    for area, caught in sorted(score.items()):
        print(f"{area}: {sum(caught)} of {len(caught)} caught")
    everything = [one for caught in score.values() for one in caught]
    return 0 if sum(everything) >= GOAL * len(everything) else 1


if __name__ == "__main__":
    sys.exit(main())
