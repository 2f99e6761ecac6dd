#!/usr/bin/env python3
"""Do the tests notice? Faults of one line, the chosen ones compiled into one copy of the tree, switched on one by one.

    tests/mutants/run.py                   all mutants of mutants.json
    tests/mutants/run.py --only window     those whose name holds this word
    tests/mutants/run.py --area kit        those of an area (AREAS)
    tests/mutants/run.py --last 24         the last ones of mutants.json
    tests/mutants/run.py --numbers 68 151  these, counted from 1
    tests/mutants/run.py --faults          faults that strangers found, reversed, by the machines of each alone
    tests/mutants/run.py --near            by the nearest tests of each alone: survivors may be caught by others
    tests/mutants/run.py --fresh 7         60 new ones of each area, at places drawn by this seed (fresh.py)
    tests/mutants/run.py --fresh 7 --changed main --count 4 --minutes 3
                                           4 new ones in functions that differ from a commit; ends after 3 minutes
    tests/mutants/run.py --check           only whether each still fits the sources, exactly once
    tests/mutants/run.py --table           and writes the score of these areas into docs/reliability.md

The copy is build/mutants; the environment variable ILAW_MUTANT is the number of the mutant that its programs have,
0 for none. The nearest tests come first ("program", "program:filter", or "ctest NAME"), then the programs of the mutant's area,
the quickest first, until one fails, crashes or hangs: that has caught it. A line per mutant names the tests that ran
and their seconds. Exit codes: 0 at least 90 % are caught in every area, 1 otherwise. With --changed these are too few
for a score, and a survivor may be no fault: 1 if none of at least three is caught, 77 if not one was judged, for want
of time or of places. There, functions of headers are left out, because most sources include them, and only a test that
failed runs without its mutant, too.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import typing

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "support"))
import fresh  # noqa: E402
import marked_part  # noqa: E402

MUTANTS = pathlib.Path(__file__).with_name("mutants.json")
PAGE = SOURCE / "docs" / "reliability.md"
TREE = SOURCE / "build" / "mutants"
BUILD = TREE / "build" / "release"
LOG = SOURCE / "docs" / "log" / "mutants.md"
GOAL, GOAL_OF_MACHINES = 0.9, 0.8
HANGS = 600  # seconds, without a mutant
JUDGED_NOTHING = 77


class Area(typing.NamedTuple):
    folder: str  # sources below it, but those of an area further down
    programs: list  # all that run through them


AREAS = {
    "plugins": Area("plugins", ["laws_test", "check_test:*Shipped*"]),
    "kit": Area("api/include/ilaw/kit", ["kit_test", "laws_test", "ctest kit_probe_is_checked", "check_test:*Shipped*"]),
    "create": Area("api/include/ilaw/create.h", ["kit_test", "plain_c_test", "laws_test"]),
    "plain_c": Area("api/include/ilaw/plain_c.h", ["plain_c_test"]),
    "loader": Area("api/loader", ["loader_test", "ctest loader.refusals", "loader_memory_test", "unusual_hosts_test"]),
    "search": Area("api/search", ["facets_test", "ctest python.search", "mesh_test"]),
    "coupled": Area("api/coupled", ["coupled_test", "ctest python.coupled_calls", "ctest python.coupled_problems", "host_test",
                                    "ctest host.motions", "ctest python.solver_machine"]),
    "check": Area("api/check", ["check_test"]),
    "host": Area("host_mock/host", ["ctest host.refusals", "host_test", "mesh_test", "program_test", "faults_test",
                                    "ctest host.motions", "stress_test"]),
    "results": Area("host_mock/host/results", ["host_test", "mesh_test", "program_test", "ctest host.motions"]),
    "stress": Area("host_mock/instruments/stress", ["stress_test"]),
    "cli": Area("host_mock/cli", ["program_test", "ctest host.refusals", "host_test", "ctest host.motions"]),
    "bench": Area("host_mock/instruments/bench", ["program_test", "ctest host.refusals"]),
    "python": Area("api/python/ilaw", [f"ctest python.{name}" for name in
                                       ("interface", "coupled", "fields", "search", "shapes", "bindings", "solver_machine")]
                   + ["ctest view.plot", "ctest view.page_data", "ctest view.study", "program_test:Sweep.*:Table.*:Plot.*:Picture.*"]),
    "lammps": Area("api/lammps", ["ctest lammps"]), "yade": Area("api/yade", ["ctest yade"]),
    "mujoco": Area("api/mujoco", ["mujoco_test"]), "dealii": Area("api/dealii", ["ctest dealii"]),
    "openradioss": Area("api/openradioss", ["ctest openradioss"])}
SWITCH = """#pragma once
#include <stdlib.h>
static inline int ilaw_mutant_here(void) {
  const char* text = getenv("ILAW_MUTANT");
  return text ? atoi(text) : 0;
}
#ifdef __cplusplus
// Read when a program or law is loaded, so that evaluate stays pure.
[[maybe_unused]] static const int ilaw_mutant = ilaw_mutant_here();
#else
#define ilaw_mutant ilaw_mutant_here()
#endif
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="mutants whose name holds this word")
    parser.add_argument("--area", choices=sorted(AREAS), action="append", help="mutants of this area; to be repeated")
    parser.add_argument("--last", type=int, default=0, help="this many from the end of mutants.json")
    parser.add_argument("--numbers", type=int, nargs="+", default=[], help="these of mutants.json, counted from 1")
    parser.add_argument("--faults", action="store_true", help="those with a \"fault\", by their \"machines\" alone")
    parser.add_argument("--near", action="store_true", help="the nearest tests of each alone")
    parser.add_argument("--fresh", type=int, metavar="SEED", help="mutants at places that this seed draws")
    parser.add_argument("--count", type=int, default=60, help="fresh mutants of each area")
    parser.add_argument("--changed", metavar="COMMIT", help="fresh mutants of functions that differ from this commit")
    parser.add_argument("--minutes", type=float, default=24 * 60, help="what has not ended by then is left out")
    parser.add_argument("--check", action="store_true", help="do not build: see whether mutants fit the sources")
    parser.add_argument("--table", action="store_true", help="write the score into docs/reliability.md")
    parser.add_argument("--jobs", default=os.cpu_count(), type=int, help="processes of the build and of the tests")
    return parser.parse_args()


def area_of(file):
    return max((len(area.folder), name) for name, area in AREAS.items() if f"{file}/".startswith(area.folder + "/"))[1]


def place_of(mutant, text):
    """Where a mutant's "from" stands: "in" is the text around it, with @ in its place. A fresh one says "at"."""
    if "at" in mutant:
        return mutant["at"]
    around = mutant.get("in", "@")
    whole = around.replace("@", mutant["from"])
    count = text.count(whole)
    if count != 1:
        raise ValueError(f"{mutant['name']}: {mutant['file']} has {count} times: {whole}")
    begin = text.index(whole) + around.index("@")
    return begin, begin + len(mutant["from"])


def has_bare_comma(text):
    """Whether a comma stands outside all brackets, where it would be an operator."""
    depth = 0
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            return True
    return False


def stands_apart(before, is_statement):
    """Whether an expression or a statement may begin behind this text."""
    before = re.sub(r"(\s*//[^\n]*)*\s*$", "", before)
    return bool(re.search(r"[;{})]$|\belse$" if is_statement else r"[^\w.>]$|\breturn$|[^-]>$", before))


def switched(mutant):
    """Both forms of an expression, or of a statement."""
    number, before, after = mutant["number"], mutant["from"], mutant["to"]
    if not before.endswith(";") and re.match(r"\s*(if\b|return\b|&&|\|\|)|.*[^=<>!]=[^=]", before):
        raise ValueError(f"{mutant['name']}: neither an expression nor a statement: {before}")
    for text in (before, after):
        if text.count("(") != text.count(")"):
            raise ValueError(f"{mutant['name']}: parentheses do not balance: {text}")
        if not before.endswith(";") and has_bare_comma(text):
            raise ValueError(f"{mutant['name']}: two operands, apart by a comma: {text}")
    if mutant["file"].endswith(".py"):
        return f"(({after}) if __import__('os').environ.get('ILAW_MUTANT') == '{number}' else ({before}))"
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
        if not file.endswith(".py") and not stands_apart(text[:begin], mutant["from"].endswith(";")):
            raise ValueError(f"{mutant['name']}: begins within an expression or a statement: {mutant['from']}")
        text = text[:begin] + switched(mutant) + text[end:]
    return text if file.endswith(".py") else f'#include "{TREE / "mutant_switch.hpp"}"\n' + text


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


def run_until(deadline, command, **options):
    """A command, which ends with all its children at the deadline: TimeoutExpired."""
    with subprocess.Popen(command, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", **options) as process:
        try:
            said, _ = process.communicate(timeout=max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    return process.returncode, said


def build(tests, jobs, deadline):
    """With the options of the tests, so that ccache has what no mutant changes."""
    configure = ["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DILAW_TESTS=ON",
                 "-DILAW_WERROR=ON", "-DILAW_UNITY=ON"]
    if shutil.which("ccache"):
        configure += ["-DCMAKE_C_COMPILER_LAUNCHER=ccache", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    recorded = [line.split("|") for line in (BUILD / "tests" / "programs.txt").read_text().splitlines()]
    needed = {target for test in tests for target in ([test.partition(":")[0]] if not test.startswith("ctest ") else
              [one for targets, names, _ in recorded if test[6:] in names.split() for one in targets.split()])}
    return run_until(deadline, ["cmake", "--build", BUILD, "-j", str(jobs), "--target", *sorted(needed), "--", "--quiet",
                                "-k", "0"])


def source_of(path):
    """A file of the copy as git names it. The compiler names it from its own folder, where ccache is told to."""
    return os.path.relpath(os.path.normpath(BUILD / path), TREE)


def build_fresh(mutants, tests, jobs, deadline):
    """Leaves out the mutants of lines that do not compile, such as constants and swapped arguments of two types."""
    sources = {mutant["file"] for mutant in mutants}
    while True:
        copy_tree({file: with_mutants(file, [one for one in mutants if one["file"] == file]) if
                   any(one["file"] == file for one in mutants) else (SOURCE / file).read_text() for file in sources})
        code, said = build(tests, jobs, deadline)
        wrong = {(source_of(path), int(line) - 1) for path, line in
                 re.findall(r"(?:^|\s)(\S+?):(\d+):(?:\d+:)? (?:error|  required)", said)}
        left = [one for one in mutants if (one["file"], one.get("line")) not in wrong]
        if code == 0 or len(left) == len(mutants):
            code == 0 or sys.exit(said)
            return left
        mutants = left


def passes(test, number, limit):
    """Whether a program's tests pass with a mutant within a limit of seconds, how long they took, and which failed."""
    program, _, chosen = test.partition(":")
    command = [BUILD / "bin" / program, "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={chosen or '*'}"]
    if test.startswith("ctest "):
        command = ["ctest", "--test-dir", BUILD, "-R", f"^{re.escape(test[6:])}$", "--no-tests=error"]
    begin = time.monotonic()
    try:
        code, said = run_until(begin + limit, command,
                               env=os.environ | {"ILAW_MUTANT": str(number), "OMP_WAIT_POLICY": "passive"})
    except subprocess.TimeoutExpired:
        code, said = 1, ""
    return code == 0, time.monotonic() - begin, re.findall(r"\[  FAILED  \] (\w[\w./]*)", said)


def tests_of(mutant, near, usual):
    """The nearest tests, then those of the area by their usual seconds; with --faults the machines alone."""
    if near == "faults":
        return mutant["machines"]
    others = [] if near else sorted(AREAS[mutant["area"]].programs, key=lambda test: usual.get(test, 0.0))
    return list(dict.fromkeys(mutant["tests"] + others))


def caught(mutant, near, usual):
    """Whether a test fails with it, and the tests that ran, with their seconds."""
    ran = []
    for test in tests_of(mutant, near, usual):
        passed, seconds, _ = passes(test, mutant["number"], 60 + 5 * usual[test])
        ran.append(f"{test} {seconds:.1f} s")
        if not passed:
            return True, ran
    return False, ran


def caught_in_time(mutant, usual, deadline):
    """The same until a deadline, None where it was too near. What failed must pass without the mutant."""
    ran = []
    for test in tests_of(mutant, False, usual):
        passed, seconds, failed = passes(test, mutant["number"], max(0.0, deadline - time.monotonic()))
        if time.monotonic() >= deadline:
            return None, ran
        ran.append(f"{test} {seconds:.1f} s")
        if not passed:
            if failed and not test.startswith("ctest "):
                test = f"{test.partition(':')[0]}:{':'.join(failed)}"
            if not passes(test, 0, HANGS)[0]:
                sys.exit(f"fails without any mutant: {test}")
            return True, ran
    return False, ran


def seconds_of_tests():
    """By program, as ctest measured them where the tests ran last."""
    usual = collections.defaultdict(float)
    costs = SOURCE / "build" / "release" / "Testing" / "Temporary" / "CTestCostData.txt"
    for name, _, seconds in re.findall(r"^(\S+) (\d+) ([\d.]+)$", costs.read_text() if costs.exists() else "", re.MULTILINE):
        is_program = re.fullmatch(r"(\w+_test)(\.\d+)?", name)
        usual[is_program[1] if is_program else f"ctest {name}"] += float(seconds)
    return usual


def changed_functions(commit):
    """The sources that differ from a commit and are compiled alone: by file, the lines of their changed functions."""
    text = subprocess.run(["git", "diff", "--function-context", commit, "--", "*.cpp", "*.py"], cwd=SOURCE, check=True,
                          capture_output=True, text=True).stdout
    lines, file = collections.defaultdict(set), None
    for line in text.splitlines():
        if line.startswith("+++ "):
            file = line[6:] if line.startswith("+++ b/") else None
        elif file and (found := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line)):
            lines[file] |= set(range(int(found[1]), int(found[1]) + int(found[2] or 1)))
    return lines


class Score(typing.NamedTuple):
    run: int
    caught: int
    commit: str  # with its date


def commit_here():
    return subprocess.run(["git", "log", "-1", "--format=%cs, %h"], cwd=SOURCE, check=True, capture_output=True,
                          text=True).stdout.strip()


def table(scores, everything):
    """A row per area: its mutants in the list, those that ran, those caught, and the commit they ran on."""
    listed = collections.Counter(mutant["area"] for mutant in everything if mutant["area"] in scores)
    rows = [f"| {area} | {listed[area]} | {score.run} | {score.caught} | {score.commit} |"
            for area, score in sorted(scores.items())]
    run, caught_ones = (sum(column) for column in list(zip(*scores.values()))[:2])
    rows.append(f"| all | {sum(listed.values())} | {run} | {caught_ones} | |")
    return "\n".join(["| area | mutants | run | caught | commit |", "| --- | --- | --- | --- | --- |", *rows])


def table_of_faults(ends):
    """A row per fault: what was reversed, and the machine that caught it, the last that ran."""
    rows = [f"| {mutant['fault']} | {mutant['name']} | {ran[-1].rpartition(' ')[0].rpartition(' ')[0] if found else 'none'} |"
            for mutant, found, ran in sorted(ends, key=lambda end: end[0]["fault"])]
    rows.append(f"| all | {len(ends)} | {sum(found for _, found, _ in ends)} |")
    return "\n".join(["| fault | reversed | caught by |", "| --- | --- | --- |", *rows])


def scores_on_page():
    rows = re.findall(r"^\| (\w+) \| \d+ \| (\d+) \| (\d+) \| (.+) \|$", PAGE.read_text(), re.MULTILINE)
    return {area: Score(int(run), int(found), commit) for area, run, found, commit in rows if area in AREAS}


def read_mutants(options):
    if options.fresh is None:
        mutants = json.loads(MUTANTS.read_text())
    else:
        files = subprocess.run(["git", "ls-files", "*.cpp", "*.hpp", "*.py"], cwd=SOURCE, check=True, capture_output=True,
                               text=True).stdout.split()
        by_area = collections.defaultdict(dict)
        for file in files:
            if any(file.startswith(area.folder + "/") for area in AREAS.values()):
                by_area[area_of(file)][file] = (SOURCE / file).read_text()
        if options.changed:
            lines = changed_functions(options.changed)
            texts = {file: text for area in options.area or AREAS for file, text in by_area[area].items() if file in lines}
            mutants = fresh.draw(texts, options.count, options.fresh, lines)
        else:
            mutants = [mutant for area in sorted(options.area or AREAS)
                       for mutant in fresh.draw(by_area[area], options.count, f"{options.fresh} {area}")]
    for number, mutant in enumerate(mutants, 1):
        mutant.update(number=number, area=area_of(mutant["file"]))
        if options.fresh is not None and mutant["area"] == "plugins":
            mutant["tests"] = tests_of_law(mutant["file"].split("/")[1])
    return mutants


def tests_of_law(law):
    if law == "bond":  # a part of two
        return tests_of_law("cohesive") + tests_of_law("rccm")
    folder = SOURCE / "tests/laws" / law
    return (([f"{law}_test"] if any(folder.glob("*_test.cpp")) else [])
            + ([f"ctest rows.{law}"] if (folder / "rows.json").exists() else []))


def by_file(mutants):
    found = collections.defaultdict(list)
    for mutant in mutants:
        found[mutant["file"]].append(mutant)
    return found


def judge_changed(mutants, tests, jobs, deadline):
    found = []
    try:
        mutants = build_fresh(mutants, tests, jobs, deadline)
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            measured = seconds_of_tests()
            usual = {test: measured[test.partition(":")[0]] for test in tests}
            for mutant, (end, ran) in zip(mutants, pool.map(lambda one: caught_in_time(one, usual, deadline), mutants)):
                found.append(end)
                word = {True: "caught", False: "SURVIVED", None: "no time"}[end]
                print(f"{word:8}  {mutant['area']:7}  {mutant['name']}: {', '.join(ran)}", flush=True)
    except subprocess.TimeoutExpired:
        print("no time for the build of the mutants")
    if all(end is None for end in found):
        return JUDGED_NOTHING
    return 1 if found.count(False) >= 3 and not any(found) else 0


def main():
    options = arguments()
    everything = read_mutants(options)
    try:
        for file, mutants in by_file(everything).items():
            with_mutants(file, mutants)
    except ValueError as misfit:
        print(misfit)
        return 1
    print(f"{len(everything)} mutants fit the sources")
    if options.check:
        return 0

    near = "faults" if options.faults else options.near
    chosen = [mutant for mutant in everything[-options.last:]
              if options.only in mutant["name"] and mutant["area"] in (options.area or AREAS)
              and mutant["number"] in (options.numbers or [mutant["number"]]) and ("fault" in mutant or not options.faults)]
    commit = commit_here()
    tests = sorted({test for mutant in chosen for test in tests_of(mutant, near, {})})
    deadline = time.monotonic() + 60 * options.minutes
    if options.changed:
        return judge_changed(chosen, tests, options.jobs, deadline) if chosen else JUDGED_NOTHING
    chosen = build_fresh(chosen, tests, options.jobs, deadline)
    ends = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        sound = dict(zip(tests, pool.map(lambda test: passes(test, 0, HANGS), tests)))
        if broken := [test for test, (passed, *_) in sound.items() if not passed]:
            print("fail without any mutant: " + ", ".join(broken))
            return 1
        usual = {test: seconds for test, (_, seconds, _) in sound.items()}
        for mutant, end in zip(chosen, pool.map(lambda one: caught(one, near, usual), chosen)):
            ends.append((mutant, *end))
            print(f"{'caught' if end[0] else 'SURVIVED':8}  {mutant['area']:7}  {mutant['name']}: {', '.join(end[1])}",
                  flush=True)
    if options.faults:
        print(table_of_faults(ends))
        if options.table:
            marked_part.write(LOG, "<!-- faults by machines -->", "<!-- end of the faults -->", table_of_faults(ends))
        return 0 if sum(found for _, found, _ in ends) >= GOAL_OF_MACHINES * len(ends) else 1
    score = collections.defaultdict(list)
    for mutant, found, _ in ends:
        score[mutant["area"]].append(found)
    scores = {area: Score(len(found), sum(found), commit) for area, found in score.items()}
    print(table(scores, everything))
    if options.table:
        whole = table(scores_on_page() | scores, everything)
        marked_part.write(PAGE, "<!-- score of the mutants -->", "<!-- end of the score -->", whole)
    return 0 if all(one.caught >= GOAL * one.run for one in scores.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
