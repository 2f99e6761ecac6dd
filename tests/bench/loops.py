#!/usr/bin/env python3
"""Makes the table "What forbids the bars" of docs/benchmarks.md.

    ILAW_PATH=build/release/lib/ilaw tests/bench/loops.py build/release/bin/ilaw build/release/bin/ilaw_bench_dividers

Time in cache by `ilaw bench`; instructions, divisions and roots are counted in the loop that the case runs
through at level v4: the longest one of each function that is named by its words.
"""
import argparse
import functools
import json
import os
import pathlib
import re
import subprocess

FRICTION = '{"friction": 0.3}'
KINETIC = '{"friction": 0.3, "kinetic_friction": 0.2, "decay": 1.0}'
LOCAL = ["local_frame", "interleaved"]
HOLDING = '{"strength": 1e12, "toughness": 1e12}'


def spring(**more):
    return ["--parameters", json.dumps({"stiffness": 10000, **more})]


# What, law, options of ilaw bench, words of the functions that a node runs through, times that the row's bar allows.
CASES = [
    ("contact", "contact", [], [["step_block", "transverse", *LOCAL]], 1.2),
    ("contact, full $H$", "contact", ["--delassus", "full"], [["step_block", "full_", "local_frame"]], 1.3),
    ("coulomb", "coulomb", ["--parameters", FRICTION], [["try_block", *LOCAL, "::plain"]], 1.2),
    ("coulomb, kinetic", "coulomb", ["--parameters", KINETIC], [["try_block", *LOCAL, "::falling"]], 2.0),
    ("tie", "tie", [], [["try_block", "transverse", *LOCAL]], 1.2),
    ("tie, full $H$", "tie", ["--delassus", "full"], [["try_block", "full_", "local_frame"]], 1.3),
    ("postit, no memory", "postit", ["--parameters", FRICTION], [["try_block", *LOCAL, "<false, false>"]], 1.5),
    ("penalty, explicit", "penalty", spring(), [["step_block", *LOCAL, "form<false", "kind)0>"]], 1.2),
    ("penalty, implicit", "penalty", spring(integration="implicit"),
     [["step_block", *LOCAL, "form<true", "kind)0>"]], 1.2),
    ("penalty, implicit, friction", "penalty", spring(integration="implicit", friction=0.3),
     [["step_block", *LOCAL, "form<true", "kind)1>"]], 1.2),
    ("cohesive, holding", "cohesive", ["--parameters", HOLDING],
     [["mark_block", "transverse", *LOCAL], ["finish_block", "transverse", *LOCAL]], 1.5),
]
SCOPE = "(scope)1"  # impulse and state, with the velocity before the step


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@functools.cache
def loops_of(library):
    """Name of each function: instructions of its longest loop with vectors of eight doubles."""
    found = {}
    text = output_of("objdump", "-d", "-C", "--no-show-raw-insn", library)
    for function in text.split("\n\n"):
        head, *lines = function.strip().splitlines()
        code = [(int(m[1], 16), m[2]) for m in (re.match(r"\s*([0-9a-f]+):\s+(.*)", line) for line in lines) if m]
        place = {address: k for k, (address, _) in enumerate(code)}
        longest = []
        for k, (address, what) in enumerate(code):
            jump = re.match(r"j\w+\s+([0-9a-f]+)", what)
            start = place.get(int(jump[1], 16), k) if jump else k
            body = [w for _, w in code[start:k + 1]]
            if start < k and not any(re.match(r"j\w+\s|ret|call", w) for w in body[:-1]):
                if any("zmm" in w for w in body) and len(body) > len(longest):
                    longest = body
        if longest:
            found[re.sub(r"ilaw::kit::\w+::(detail::)?|\(anonymous namespace\)::", "", head)] = longest
    return found


def row(case, given, folder, dividers):
    what, law, options, functions, bar = case
    loops = loops_of(folder / f"{law}.so").items()
    loop = [instruction for words in functions
            for instruction in next(body for name, body in loops if SCOPE in name and all(w in name for w in words))]
    divisions = sum(w.startswith("vdivpd") for w in loop)
    roots = sum(w.startswith("vsqrtpd") for w in loop)
    busy = (divisions * dividers[0] + roots * dividers[1]) / 8.0
    result = json.loads(output_of(given.ilaw, "bench", law, *options, "--nodes", "2000", "--repetitions",
                                  "15", "--json"))[0]
    size = result["bytes_per_node"]
    print(f"| {what} | {size:.0f} | {bar * size / given.triad:.1f} | {result['ns_per_node']:.1f} | "
          f"{busy:.1f} ({divisions} + {roots}) | {len(loop) / 8.0:.0f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ilaw")
    parser.add_argument("dividers")
    parser.add_argument("--triad", type=float, default=12.5, help="GB/s beyond the cache")
    given = parser.parse_args()
    dividers = [float(number) for number in re.findall(r"[\d.]+", output_of(given.dividers))]
    print("| case | bytes | aim, ns | in cache, ns | dividers, ns | instructions |")
    print("| --- | --- | --- | --- | --- | --- |")
    for case in CASES:
        row(case, given, pathlib.Path(os.environ["ILAW_PATH"]), dividers)


if __name__ == "__main__":
    main()
