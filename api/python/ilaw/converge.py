"""`ilaw converge`: errors of a scene at smaller and smaller steps (and meshes), and their orders."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import math
import sys
from typing import Optional, Sequence

import numpy as np

from ._command import (DONE, FAILED, HeldFolder, Progress, complain, in_scene, printable, remove_pictures, run_command,
                       sweep_parser, text_of, write_csv, write_json)  # fmt: skip
from ._errors import NORMS, Trace, errors_against_exact, errors_against_run, order_of, scale_of
from ._variants import (Failed, Scenes, check_mesh, exact_of, expect_watched, read_sweep, refined)  # fmt: skip


def converge(options: argparse.Namespace) -> int:
    (file,) = options.scenes
    with Scenes(file, options.threads) as scenes:
        with in_scene(file):
            source = scenes.read()
            sweep = read_sweep(source.get("converge", {}), options)
            check_mesh(source, sweep, "/converge")
            first = refined(source, sweep, sweep.refinement(0))
            probe = scenes.probe(first)
            expect_watched(probe)
            exact = exact_of(first, probe)  # before anything is written
        title, reference = source.get("title", file.stem), "exact solution" if exact else "finest run"
        traces: list[Trace] = []
        errors = []
        interrupted = False
        with HeldFolder(options.out, "converge.json") as folder:
            total = sum(probe.steps * sweep.refinement(k) / sweep.refinement(0) for k in range(sweep.levels))
            with in_scene(file), Progress("converge", "steps", options.json_lines) as progress:
                try:
                    for level in range(sweep.levels):
                        scene = refined(source, sweep, sweep.refinement(level))
                        own = scenes.probe(scene)
                        expect_watched(own, probe)
                        trace = scenes.trace(scene, own.interfaces)
                        if exact:
                            errors.append(errors_against_exact(exact_of(scene, own), trace))
                            none = np.empty((len(trace.u), 0))  # a motion that was compared is not kept
                            trace = trace._replace(u=none, v=none, impulse=none, work=none)
                        traces.append(trace)
                        progress.set(sum(len(trace.u) for trace in traces), total)
                except KeyboardInterrupt:
                    interrupted = True
                except Failed as failure:
                    raise Failed(f"run {len(traces) + 1} of {sweep.levels}: {failure}") from None
            scenes.tell_warnings()
            if not exact:
                errors = [errors_against_run(traces[-1], trace) for trace in traces[:-1]]
            if not errors:
                return complain(f"interrupted after {len(traces)} of {sweep.levels} runs, without an error", FAILED)
            orders = orders_of(traces, errors)
            remove_pictures(folder)
            write_csv(folder / "converge.csv", 10, ("dt", "steps", "seconds", *NORMS),
                      ((t.dt, len(t.u), t.seconds, *e.values()) for t, e in zip(traces, errors)))
            write_json(folder / "converge.json", {
                "title": title, "reference": reference,
                "refined": "mesh and time step" if sweep.with_mesh else "time step", "levels": len(traces),
                "orders": {norm: o if math.isfinite(o) else None for norm, o in orders.items()}})  # fmt: skip
        print(f"{printable(title)}, against the {reference}")
        print_table(traces, errors, orders)
    return complain(f"interrupted after {len(traces)} of {sweep.levels} runs", FAILED) if interrupted else DONE


def orders_of(traces: Sequence[Trace], errors: Sequence[dict[str, float]]) -> dict[str, float]:
    steps = [trace.dt for trace, _ in zip(traces, errors)]
    return {norm: order_of(steps, [e[norm] for e in errors], scale_of(norm, traces[0].dt, len(traces[0].u)))
            for norm in NORMS if errors}  # fmt: skip


def print_table(traces: Sequence[Trace], errors: Sequence[dict[str, float]], orders: dict[str, float]) -> None:
    def cells(values: Sequence[float], form: str) -> str:
        texts = [text_of(value, form).replace("-0.00", "0.00") if form == ".2f" else text_of(value, form)
                 for value in values]  # fmt: skip
        return "".join(f" {text:>10}" for text in texts)

    print(f"{'dt':>12} {'seconds':>10}" + "".join(f" {norm:>10}" for norm in NORMS))
    for trace, own in zip(traces, errors):
        print(f"{trace.dt:12.4g} {trace.seconds:10.2g}" + cells(list(own.values()), ".2e"))
    print(f"{'order':>23}" + cells(list(orders.values()), ".2f"))


def main(arguments: Optional[Sequence[str]] = None) -> int:
    options = sweep_parser("converge").parse_args(arguments)
    return run_command(lambda: converge(options))


if __name__ == "__main__":
    sys.exit(main())
