#!/usr/bin/env python3
"""Prints what interfaces add to a step of `ilaw run`, from runs of ilaw_bench_host.

    ILAW_PATH=$PWD/build/release/lib/ilaw tests/bench/host_table.py build/release/bin/ilaw_bench_host
    ... host_table.py AFTER --before BEFORE      # two builds, run in turn: what became of each time

Medians of runs in turn: a machine that is busy with other work disturbs both programs alike.
"""
import argparse
import csv
import pathlib
import statistics
import subprocess
import sys
import tempfile

COLUMNS = {"law": "law_with_outputs_ns", "interface": "interface_ns", "step": "step_ns", "triad": "triad_gb_per_s"}


def measured(program, given):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "host.csv"
        subprocess.run([program, "--points", *map(str, given.points), "--threads", *map(str, given.threads),
                        "--repetitions", "3", "--out", out] + (["--law", given.law] if given.law else []),
                       check=True, stdout=subprocess.DEVNULL)
        with out.open() as rows:
            return {(int(row["points"]), row["law"], row["situation"], int(row["threads"])):
                    {name: float(row.get(column, "nan")) for name, column in COLUMNS.items()}
                    for row in csv.DictReader(rows)}


def medians(runs):
    return {case: {name: statistics.median(run[case][name] for run in runs) for name in COLUMNS} for case in runs[0]}


def line(cells):
    print("| " + " | ".join(cells) + " |")


def table(header, rows):
    line(header)
    line("---" for _ in header)
    for row in rows:
        line(row)


def ratio(numbers):
    return f"{numbers['interface'] / numbers['law']:.1f}" if numbers["law"] > 1e-2 else "-"


def show(after, before):
    # A single point that starts in flight has come down before the runs end.
    cases = [case for case in after if case[3] == 1 and not (case[0] == 1 and case[2] != "all")]
    header = ["law", "points", "situation", "law, ns", "interface, ns", "interface / law", "step, ns"]
    if before:
        header += ["interface / law before", "interface, before / after", "step, before / after"]
    rows = []
    for case in cases:
        now, (points, law, situation, _) = after[case], case
        row = [law, f"{points:g}", situation, f"{now['law']:.1f}", f"{now['interface']:.1f}", ratio(now),
               f"{now['step']:.1f}"]
        if before:
            then = before[case]
            row += [ratio(then), f"{then['interface'] / now['interface']:.2f}", f"{then['step'] / now['step']:.2f}"]
        rows.append(row)
    table(header, rows)


def show_threads(after):
    rows = []
    for case, numbers in after.items():
        one = after.get(case[:3] + (1,))
        if case[3] > 1 and one:
            rows.append([case[1], f"{case[0]:g}", case[2], str(case[3]), f"{one['step'] / numbers['step']:.2f}",
                         f"{numbers['triad'] / one['triad']:.2f}"])
    if rows:
        print()
        table(["law", "points", "situation", "threads", "times as fast", "the triad"], rows)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program")
    options.add_argument("--before", help="an older ilaw_bench_host")
    options.add_argument("--law", help="this law alone")
    options.add_argument("--points", type=int, nargs="+", default=[1, 1000, 100000])
    options.add_argument("--threads", type=int, nargs="+", default=[1])
    options.add_argument("--runs", type=int, default=5)
    given = options.parse_args()
    programs = [given.program] + ([given.before] if given.before else [])
    runs = {program: [] for program in programs}
    for _ in range(given.runs):
        for program in programs:
            runs[program].append(measured(program, given))
    after = medians(runs[given.program])
    show(after, medians(runs[given.before]) if given.before else None)
    show_threads(after)
    return 0


if __name__ == "__main__":
    sys.exit(main())
