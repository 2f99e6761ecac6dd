#!/usr/bin/env python3
"""A tyre block slides over a road at six temperatures and six speeds: master curve, heat, and wear.

    docs/results/tyre_block.py build/release/bin/ilaw --picture docs/results/img/tyre_block.png      (laws: ILAW_PATH)

The scene is host_mock/scenes/tyre_block.json with the initial temperature of the block and the speed of the road of
each run. Prints the table of docs/results/tyre_block.md at 0.3 m/s; the other speeds are run for the picture alone.
"""
# SPDX-License-Identifier: BSD-3-Clause
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from case_script import parser_of, save

SCENE = Path(__file__).resolve().parents[2] / "host_mock" / "scenes" / "tyre_block.json"
TEMPERATURES = (333.0, 313.0, 303.0, 293.0, 283.0, 273.0)
SPEEDS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
TABLE_SPEED = 0.3


def shift(temperature):
    """a_T of the page of rubber: log10 a_T = -8.86 (T - T_s)/(101.5 + T - T_s), T_s = 293 K."""
    above = temperature - 293.0
    return 10 ** (-8.86 * above / (101.5 + above))


def master_curve(reduced_speed):
    """mu over a_T v, with mu_0 = 0.4, mu_m = 1.2, v_m = 0.1 m/s and c = 0.5."""
    return 0.4 + 0.8 * np.exp(-(0.5**2) * np.log10(reduced_speed / 0.1) ** 2)


def flash(time, flux):
    """Rise of the surface of a half space under a constant flux: 2 q sqrt(t/(pi k rho c)) (Carslaw, Jaeger 1959)."""
    return 2 * flux * np.sqrt(time / (np.pi * 0.25 * 1150 * 1800))


def run(program, temperature, speed, cfl=0.9):
    """mu of the block; mu, slip speed and temperature of its nodes on the road (a column each); and the summary."""
    scene = json.loads(SCENE.read_text())
    scene["model"]["blocks"][0]["thermal"]["initial_temperature"] = temperature
    scene["interfaces"][0]["obstacle"]["velocity"] = [-speed, 0.0, 0.0]
    scene["time"]["cfl"] = cfl
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scene.json").write_text(json.dumps(scene))
        done = subprocess.run([program, "run", "scene.json", "--out", "out"], cwd=folder, text=True, capture_output=True)
        if done.returncode:
            raise SystemExit(done.stderr)
        with open(Path(folder) / "out" / "history.csv") as file:
            rows = list(csv.reader(file))
        summary = json.loads((Path(folder) / "out" / "summary.json").read_text())
    table = dict(zip(rows[0], np.array(rows[1:], float).T))
    nodes = sorted(name[:-2] for name in table if name.endswith(".T"))
    of_nodes = lambda quantity: np.array([table[f"{node}.{quantity}"] for node in nodes]).T  # noqa: E731
    found = {"time": table["time"], "mu": -table["road.F0"] / table["road.F2"], "node_mu": -of_nodes("r0") / of_nodes("r2"),
             "temperature": of_nodes("T"), "slip": of_nodes("v0") + speed}  # fmt: skip
    return found, summary


def error_of_friction(found):
    """The largest difference of a node's mu at the end of a run from the law's formula at its speed and temperature."""
    page = master_curve(shift(found["temperature"][-1]) * found["slip"][-1])
    return np.abs(found["node_mu"][-1] - page).max()


def line(temperature, found, summary):
    """A row of the table: at the end of the run."""
    coldest, warmest = found["temperature"][-1].min(), found["temperature"][-1].max()
    energy, heat = summary["energy"], summary["heat"]
    wear = summary["interfaces"][0]["amounts"]["wear"] / 4  # of four nodes
    return (f"| {temperature:g} | {coldest:.1f} to {warmest:.1f} | {found['mu'][-1]:.4f} | {error_of_friction(found):.0e} | "
            f"{heat['friction']:.3f} | {heat['stored']:.3f} | "
            f"{wear * 1e9:.1f} | {heat['friction'] / energy['dissipated_friction'] - 1:.0e} | {heat['balance_error']:.0e} | "
            f"{energy['balance_error']:.0e} |")  # fmt: skip


def picture(runs, file):
    figure, (by_speed, reduced, heating) = plt.subplots(1, 3, figsize=(9.6, 3.2))
    colors = plt.cm.coolwarm(np.linspace(1, 0, len(TEMPERATURES)))
    for temperature, color in zip(TEMPERATURES, colors):
        ends = [runs[temperature, speed][0] for speed in SPEEDS]
        v = np.logspace(-2.2, 0.7, 200)
        by_speed.plot(v, master_curve(shift(temperature) * v), color=color, lw=0.8, ls=":")
        by_speed.plot(SPEEDS, [end["mu"][-1] for end in ends], "o-", color=color, lw=1.2, ms=3.5)
        for end in ends:
            label = f"{temperature:g} K" if end is ends[0] else None
            seen = shift(end["temperature"][-1]) * end["slip"][-1]
            reduced.plot(seen[:2], end["node_mu"][-1][:2], "o", color=color, ms=3, label=label)
        found = runs[temperature, TABLE_SPEED][0]
        heating.plot(found["time"], found["temperature"].mean(axis=1) - temperature, color=color, lw=1.2)
    v = np.logspace(-6, 3.5, 300)
    reduced.plot(v, master_curve(v), "k-", lw=0.7, zorder=0)
    t = np.linspace(0, 0.1, 100)
    heating.plot(t, flash(t, 0.34 * 1.2 * 2e5 * TABLE_SPEED), "k:", lw=1.0, label=r"$2q\sqrt{t/(\pi k\rho c)}$, $\mu=1.2$")
    by_speed.set(xscale="log", xlabel="speed of the road [m/s]", ylabel="friction")
    reduced.set(xscale="log", xlabel=r"$a_T\,v$ [m/s]", ylabel="friction")
    heating.set(xlabel="time [s]", ylabel=f"rise at {TABLE_SPEED:g} m/s [K]")
    reduced.legend(fontsize=7, frameon=False, loc="upper left")
    heating.legend(fontsize=7, frameon=False)
    save(figure, file)


def main():
    given = parser_of(__doc__).parse_args()
    speeds = SPEEDS if given.picture else (TABLE_SPEED,)
    runs = {(temperature, speed): run(given.program, temperature, speed) for temperature in TEMPERATURES for speed in speeds}
    print("| start [K] | surface [K] | friction | error of friction | heat [J] | in the block [J] | wear [nm] | "
          "heat / friction - 1 | heat | energy |")  # fmt: skip
    print("| --- " * 10 + "|")
    for temperature in TEMPERATURES:
        print(line(temperature, *runs[temperature, TABLE_SPEED]))
    if given.picture:
        picture(runs, given.picture)


if __name__ == "__main__":
    main()
