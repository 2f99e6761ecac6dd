#!/usr/bin/env python3
"""Makes the table of all laws of docs/benchmarks.md from what `ilaw bench` writes.

    ILAW_PATH=$PWD/build/release/lib/ilaw build/release/bin/ilaw bench --cases tests/laws/*/cases.json \\
        --nodes 2000 10000000 --out results
    tests/bench/laws_table.py results/bench.csv

Of several such files, medians.
"""
import argparse
import collections
import csv
import re
import statistics
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


def runs_of(files):
    """By law and case: what few nodes took and many, one row of each per file."""
    cases = collections.defaultdict(list)
    for file in files:
        of_file = collections.defaultdict(list)
        with open(file) as rows:
            for row in csv.DictReader(rows):
                of_file[row["law"], row["case"]].append(row)
        for (law, case), rows in of_file.items():
            if len(rows) != 2:
                sys.exit(f"laws_table.py: {file}: {law}, {case}: {len(rows)} numbers of nodes, needs 2")
            cases[law, case].append(sorted(rows, key=lambda row: int(row["nodes"])))
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench", nargs="+", help="bench.csv, each case with two numbers of nodes")
    parser.add_argument("--local", action="store_true", help="only the cases in the local frame with rows and no outputs")
    given = parser.parse_args()
    cases = {key: runs for key, runs in runs_of(given.bench).items() if not given.local or key[1].endswith("local aos")}
    print("| law | case | bytes | in cache, ns | beyond, ns | ratio | aim |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for (law, case), runs in cases.items():
        few, many = zip(*runs)

        def median(rows, key):
            return statistics.median(float(row[key]) for row in rows)

        aim, size = aim_of(law, case), float(many[0]["bytes_per_node"])
        name = case.replace("; ", ", ")
        if given.local:  # the frame and the layout are those of all rows, and a scalar H is usual
            name = name.removesuffix(" H local aos").removesuffix(", scalar")
        print(f"| {law} | {name} | {size:.0f} | "
              f"{median(few, 'ns_per_node'):.1f} | {median(many, 'ns_per_node'):.1f} | "
              f"{median(many, 'ratio'):.2f} | {aim if aim else '-'} |")


if __name__ == "__main__":
    main()
