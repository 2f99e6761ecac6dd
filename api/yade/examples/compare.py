# SPDX-License-Identifier: BSD-3-Clause
"""settle.py with the law coulomb and with Yade's own, at several steps: what they cost, and how far each is from its
own finest step. Writes a table in Markdown.

    python3 compare.py --count 48
"""
import argparse
import json
import pathlib
import re
import subprocess

SCRIPT = pathlib.Path(__file__).with_name("settle.py")


def run(yade, which, count, step, end):
    said = subprocess.run([yade, "-n", "-x", SCRIPT, which, str(count), str(step), str(end)], check=True, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE).stdout
    return json.loads(re.search(r"^settled (.*)$", said, re.M)[1])


def height(run, time):
    """The mean height of the spheres, between those that were written."""
    rows = run["heights"]
    for (t0, z0), (t1, z1) in zip(rows, rows[1:]):
        if time <= t1:
            return z0 + (z1 - z0) * (time - t0) / (t1 - t0)
    return rows[-1][1]


def error(run, finest, end):
    """Root mean square over the times, over the height that the spheres sink by."""
    times = [end * k / 50 for k in range(5, 51)]
    squares = [(height(run, time) - height(finest, time)) ** 2 for time in times]
    sunk = max(z for _, z in finest["heights"]) - min(z for _, z in finest["heights"])
    return (sum(squares) / len(squares)) ** 0.5 / sunk


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--yade", default="yade")
    parser.add_argument("--count", type=int, default=48, help="spheres")
    parser.add_argument("--end", type=float, default=0.9)
    parser.add_argument("--steps", type=float, nargs="+", default=[5e-4, 1e-3, 2e-3], help="of the law")
    parser.add_argument("--own-steps", type=float, nargs="+", default=[2e-5, 4e-5, 8e-5])
    given = parser.parse_args()
    print("| model | step [1e-3 s] | CPU [s] | error of the height | coordination number | largest overlap |"
          " CPU of a contact and step [us] |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for which, name, steps in (("ilaw", "coulomb", given.steps), ("own", "Mindlin", given.own_steps)):
        finest = None
        for step in steps:
            done = run(given.yade, which, given.count, step, given.end)
            far = f"{100 * error(done, finest, given.end):.2f} %" if finest else "-"
            finest = finest or done
            print(f"| {name} | {1e3 * step:g} | {done['seconds']:.1f} | {far} | {done['coordination']:.2f} | "
                  f"{100 * done['overlap_over_diameter']:.2f} % | {done['microseconds_per_contact']:.1f} |", flush=True)


if __name__ == "__main__":
    main()
