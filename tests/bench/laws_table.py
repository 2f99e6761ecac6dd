#!/usr/bin/env python3
"""Makes the table of all laws of docs/benchmarks.md from what `ilaw bench` writes.

    ILAW_PATH=build/release/lib/ilaw build/release/bin/ilaw bench --cases tests/laws/*/cases.json \\
        --nodes 2000 10000000 --out results
    tests/bench/laws_table.py results/bench.csv
"""
import argparse
import collections
import csv
import re
import sys

# Law, words of the case, ratio that this project aims at: the first that fits. A memory has its aim in cache.
AIMS = [
    ("contact|tie", "memory", None), ("contact|tie", "diagonal|full", 1.3), ("contact|tie", "", 1.2),
    ("coulomb", "diagonal H|full H|elliptical", 4.0), ("coulomb", "kinetic|per node", 2.0), ("coulomb", "", 1.2),
    ("postit", "memory", None), ("postit", "", 1.5),
    ("penalty", "full|Hertz", 3.0), ("penalty", "", 1.2),
    ("cohesive", "holding", 1.5), ("cohesive", "softening", 6.0),
]


def aim_of(law, case):
    return next((aim for laws, words, aim in AIMS if re.fullmatch(laws, law) and re.search(words, case)), None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench", help="bench.csv, each case with two numbers of nodes")
    given = parser.parse_args()
    cases = collections.defaultdict(list)
    with open(given.bench) as rows:
        for row in csv.DictReader(rows):
            cases[row["law"], row["case"]].append(row)
    print("| law | case | bytes | in cache, ns | beyond, ns | aim, ns | ratio | aim |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for (law, case), runs in cases.items():
        if len(runs) != 2:
            sys.exit(f"laws_table.py: {given.bench}: {law}, {case}: {len(runs)} numbers of nodes, needs 2")
        few, many = sorted(runs, key=lambda run: int(run["nodes"]))
        aim, size = aim_of(law, case), float(many["bytes_per_node"])
        allowed = f"{aim * size / float(many['triad_gb_per_s']):.1f}" if aim else "-"
        print(f"| {law} | {case.replace('; ', ', ')} | {size:.0f} | "
              f"{float(few['ns_per_node']):.1f} | {float(many['ns_per_node']):.1f} | {allowed} | "
              f"{float(many['ratio']):.2f} | {aim if aim else '-'} |")


if __name__ == "__main__":
    main()
