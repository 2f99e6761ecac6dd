# SPDX-License-Identifier: BSD-3-Clause
"""The law coulomb beside LAMMPS' own pair granular, as in.shear has them, at several steps: what they cost, and how far
each is from its own finest step. Grains move chaotically, and so errors do not vanish with the step: the line "other
places" has what other places of the grains at the beginning make. Writes a table in Markdown.

    ILAW_PATH=PREFIX/lib/ilaw python3 compare.py --ilaw PREFIX/share/ilaw/lammps/ilaw.lmp
"""
import argparse
import dataclasses
import os
import pathlib
import re
import resource
import subprocess
import tempfile

INPUT = pathlib.Path(__file__).resolve().parent / "in.shear"
SOFT = 5e6  # Pa


@dataclasses.dataclass
class Result:
    step: float
    seconds: float  # of CPU
    rows: list  # time, kinetic energy, coordination number, overlap; empty where grains leave the box
    energy: float = float("nan")  # errors
    contacts: float = float("nan")

    @property
    def overlap(self):
        return max((row[3] for row in self.rows), default=float("nan"))

    def compare(self, finest):
        if self.rows:
            self.energy, self.contacts = (error(self.rows, finest.rows, column) for column in (1, 2))
        return self

    def __str__(self):
        shown = [f"{1e6 * self.step:.3g}", f"{self.seconds:.1f}"]
        for value in (self.energy, self.contacts, self.overlap):
            shown.append(f"{100 * value:.1f} %" if value == value else "-")
        return " | ".join(shown)


def error(rows, finest, column):
    """Root mean square over all times, as part of the largest value of the finest."""
    squares = [(row[column] - other[column]) ** 2 for row, other in zip(rows, finest)]
    return (sum(squares) / len(squares)) ** 0.5 / max(row[column] for row in finest)


def run(arguments, model, young, step, seed=4711):
    variables = dict(ilaw=arguments.ilaw, model=model, young=young, dt=step, seed=seed, across=arguments.across,
                     layers=arguments.layers, settling=arguments.settling, shearing=arguments.shearing,
                     sweeps=arguments.sweeps)
    command = [arguments.lmp, "-in", INPUT, "-log", "none", "-nocite"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(command, cwd=folder, env=dict(os.environ, OMP_NUM_THREADS="1"), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if "Lost atoms" in done.stdout:
        return Result(step, seconds, [])
    if done.returncode != 0:
        raise RuntimeError(done.stdout[-2000:])
    tables = re.findall(r"^Step .*\n((?: *\d.*\n)+)", done.stdout, re.M)
    # The second run begins at the time at which the first ends.
    rows = tables[0].splitlines() + tables[1].splitlines()[1:]
    return Result(step, seconds, [[float(number) for number in row.split()[1:]] for row in rows])


def study(arguments, model, name, young=SOFT):
    # As waves in the grains have it, the steps of pair granular go with the inverse root of the modulus.
    steps = arguments.steps if model == "coulomb" else [step * (SOFT / young) ** 0.5 for step in arguments.own_steps]
    finest = run(arguments, model, young, steps[0])
    results = [finest]
    print(f"| {name} | {finest} |", flush=True)
    for step in steps[1:]:
        results.append(run(arguments, model, young, step).compare(finest))
        print(f"| {name} | {results[-1]} |", flush=True)
    if arguments.places:
        print(f"| {name}, other places | {run(arguments, model, young, steps[-2], seed=4712).compare(finest)} |",
              flush=True)
    return results[1:]


def cheapest(results, bound):
    """The fastest result of those whose errors are both within the bound."""
    good = [result for result in results if result.energy <= bound and result.contacts <= bound]
    return min(good, key=lambda result: result.seconds, default=None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ilaw", required=True, help="the script ilaw.lmp that loads the fixes")
    parser.add_argument("--lmp", default="lmp")
    parser.add_argument("--across", type=int, default=10, help="grains along a side of the box")
    parser.add_argument("--layers", type=int, default=10)
    parser.add_argument("--settling", type=float, default=0.08, help="seconds")
    parser.add_argument("--shearing", type=float, default=0.04, help="seconds")
    parser.add_argument("--steps", type=float, nargs="+", default=[2.5e-5, 5e-5, 1e-4, 2e-4], help="of coulomb, in s")
    parser.add_argument("--own-steps", type=float, nargs="+", default=[5e-6, 1e-5, 2e-5, 4e-5],
                        help="of pair granular, at a modulus of 5 MPa")
    parser.add_argument("--places", action="store_true", help="run from other places, too")
    parser.add_argument("--sweeps", type=int, default=10)
    parser.add_argument("--young", type=float, nargs="+", default=[SOFT], help="moduli of pair granular, in Pa")
    parser.add_argument("--bound", type=float, default=0.1, help="errors at which to compare")
    arguments = parser.parse_args()

    print(f"{arguments.across ** 2 * arguments.layers} grains\n")
    print("| model | step [us] | CPU [s] | error of kinetic energy | of coordination number | largest overlap |")
    print("| --- | --- | --- | --- | --- | --- |")
    law = cheapest(study(arguments, "coulomb", "coulomb"), arguments.bound)
    names = {young: f"granular, {young:.0e} Pa" for young in arguments.young}
    own = {young: cheapest(study(arguments, "granular", name, young), arguments.bound)
           for young, name in names.items()}
    print(f"\nErrors within {100 * arguments.bound:.0f} %:")
    for young, name in names.items():
        if law and own[young]:
            print(f"- {name} over coulomb: step {own[young].step / law.step:.2g}, CPU "
                  f"{own[young].seconds / law.seconds:.2g}, overlap {own[young].overlap / law.overlap:.2g}")
        else:
            print(f"- not reached by {name if law else 'coulomb'}")


if __name__ == "__main__":
    main()
