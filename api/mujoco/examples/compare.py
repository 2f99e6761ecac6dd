#!/usr/bin/env python3
"""Writes the table of the page: how far held bodies slip in a minute, by a law and by MuJoCo's own contacts.

    compare.py HOLD            HOLD is the program that is made of hold.cpp
    compare.py HOLD --seconds 5
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import re
import subprocess
from pathlib import Path

CASES = {
    "pinch": ["pinch.xml", "left"],
    "gripper": ["gripper.xml", "palm"],
    "gripper, swung": ["gripper.xml", "palm", "--swing", "0.05"],
}
CONTACTS = {
    "MuJoCo, pyramidal": ["--pyramidal", "--impratio", "1"],
    "MuJoCo, elliptic": ["--impratio", "1"],
    "MuJoCo, elliptic, impratio 10": ["--impratio", "10"],
    "MuJoCo, elliptic, impratio 10, noslip 10": ["--impratio", "10", "--noslip", "10"],
    "coulomb": ["--law", "coulomb"],
}


def short(number):
    return f"{float(f'{number:.2g}'):g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="HOLD", type=Path)
    parser.add_argument("--seconds", type=float, default=61, help="end of the runs; the first second does not count")
    given = parser.parse_args()
    print("| case | contacts | step [ms] | slip [um/s] | after | a step [us] |\n" + "| --- " * 6 + "|")
    for case, model in CASES.items():
        for contacts, options in CONTACTS.items():
            refined = "swung" in case and ("coulomb" in contacts or "noslip" in contacts)
            for step in (2, 1, 0.5) if refined else (2,):
                command = [given.program.resolve(), *model, *options, "--step", step / 1e3, "--seconds", given.seconds]
                done = subprocess.run(list(map(str, command)), cwd=Path(__file__).parent, text=True, check=True,
                                      stdout=subprocess.PIPE)  # fmt: skip
                found = re.match(r"slip (\S+) m in (\S+) s, (\S+) us", done.stdout).groups()
                slip, time, spent = map(float, found)
                after = f"{time:.0f} s, lost" if slip >= 0.05 else f"{time:.0f} s"
                print(f"| {case} | {contacts} | {step:g} | {short(1e6 * slip / time)} | {after} | {short(spent)} |", flush=True)


if __name__ == "__main__":
    main()
