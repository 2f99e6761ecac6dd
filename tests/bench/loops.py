#!/usr/bin/env python3
"""Makes the table "What forbids the rest" of docs/log/loops.md.

    ILAW_PATH=$PWD/build/release/lib/ilaw \\
        tests/bench/loops.py build/release/bin/ilaw build/release/bin/ilaw_bench_dividers

Time in cache by `ilaw bench`; instructions, divisions and roots are counted in the loop that the case runs
through at level v4: the longest one of each function that is named by its words. "pipes": what its arithmetic takes
at least where none waits for another, by the times that the second program measures.
"""
import argparse
import functools
import json
import os
import pathlib
import re
import subprocess
import sys

FRICTION = '{"friction": 0.3}'
KINETIC = '{"friction": 0.3, "kinetic_friction": 0.2, "decay": 1.0}'
LOCAL = ["local_frame", "interleaved,"]
FLOATS = ["local_frame", "rows_of_float"]
HOLDING = '{"strength": 1e12, "toughness": 1e12}'


def spring(**more):
    return ["--parameters", json.dumps({"stiffness": 10000, **more})]


# What, law, options of ilaw bench, words of the functions that a node runs through, times that the row's bar allows.
CASES = [
    ("contact", "contact", [], [["step_block", "transverse", *LOCAL]], 1.2),
    ("contact, full $H$", "contact", ["--delassus", "full"], [["step_block", "full_", "local_frame"]], 1.3),
    # 0.6 of what doubles are allowed, for half of the bytes.
    ("contact, floats", "contact", ["--float"], [["step_block", "transverse", *FLOATS]], 1.44),
    ("coulomb", "coulomb", ["--parameters", FRICTION], [["try_block", *LOCAL, "::inelastic"]], 1.2),
    ("coulomb, floats", "coulomb", ["--parameters", FRICTION, "--float"],
     [["try_block", *FLOATS, "::inelastic"]], 1.44),
    ("coulomb, kinetic", "coulomb", ["--parameters", KINETIC], [["try_block", *LOCAL, "::falling"]], 2.0),
    ("tie", "tie", [], [["try_block", "transverse", *LOCAL]], 1.2),
    ("tie, full $H$", "tie", ["--delassus", "full"], [["try_block", "full_", "local_frame"]], 1.3),
    ("postit, no memory", "postit", ["--parameters", FRICTION], [["try_block", *LOCAL, "<false, false>::pulled"]], 1.5),
    ("penalty, explicit", "penalty", spring(), [["step_block", "transverse", *LOCAL, "form<false", "kind)0>"]], 1.2),
    ("penalty, implicit", "penalty", spring(integration="implicit"),
     [["step_block", "transverse", *LOCAL, "form<true", "kind)0>"]], 1.2),
    ("penalty, implicit, friction", "penalty", spring(integration="implicit", friction=0.3),
     [["step_block", "transverse", *LOCAL, "form<true", "kind)2>"]], 1.2),
    ("cohesive, holding", "cohesive", ["--parameters", HOLDING],
     [["ask_block", "transverse", *LOCAL]], 1.5),
]
SKIPPED = 77  # what ctest is told where nothing can be counted
SCOPE = "(scope)1"  # impulse and state, with the velocity before the step


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@functools.cache
def functions_of(library):
    """Name, address and size of each function, in the order of their addresses."""
    lines = (line.split(maxsplit=3) for line in output_of("nm", "-n", "-S", "-C", library).splitlines())
    return [(re.sub(r"ilaw::kit::\w+::(detail::)?|\(anonymous namespace\)::", "", fields[3]),
             int(fields[0], 16), int(fields[1], 16)) for fields in lines if len(fields) == 4 and fields[2] in "tTwW"]


def loop_at(library, address, size):
    """Instructions of the longest loop with vectors of eight doubles in a function; none where it has no such."""
    text = output_of("objdump", "-d", "--no-show-raw-insn", f"--start-address={address}",
                     f"--stop-address={address + size}", library)
    matches = (re.match(r"\s*([0-9a-f]+):\s+(.*)", line) for line in text.splitlines())
    code = [(int(m[1], 16), m[2]) for m in matches if m]
    place = {at: k for k, (at, _) in enumerate(code)}
    longest = []
    for k, (_, what) in enumerate(code):
        jump = re.match(r"j\w+\s+([0-9a-f]+)", what)
        start = place.get(int(jump[1], 16), k) if jump else k
        body = [w for _, w in code[start:k + 1]]
        if start < k and not any(re.match(r"j\w+\s|ret|call", w) for w in body[:-1]):
            if any("zmm" in w for w in body) and len(body) > len(longest):
                longest = body
    return longest


def loop_of(library, words):
    """The loop of the first function with these words in its name that has one."""
    for name, address, size in functions_of(library):
        if SCOPE in name and all(word in name for word in words):
            if loop := loop_at(library, address, size):
                return loop
    raise SystemExit(f"{library}: no function of {', '.join(words)} has a loop with vectors of eight doubles")


def works(instruction):
    """Whether it takes a pipe of vector arithmetic: no load or store, and no copy of a register."""
    is_move = re.match(r"vmov\w+\s", instruction) and ("(" in instruction or "{" not in instruction)
    return instruction.startswith("v") and "zmm" in instruction and not is_move and "broadcast" not in instruction


def nodes_of(loop):
    """Eight, or sixteen where a vector of floats makes it two of doubles (run_steps.hpp)."""
    return 16 if any(re.match(r"vcvtps2pd|v\w+ps\s", w) and "zmm" in w for w in loop) else 8


def busy_pipes(loop, product, bits):
    """A product or comparison takes a pipe that multiplies, and the rest no less than a choice of bits."""
    products = sum(bool(re.match(r"vmulpd|vcmp\w*pd", w)) for w in loop)
    return max(products * product, sum(map(works, loop)) * bits) / nodes_of(loop)


def row(case, given, folder, dividers):
    what, law, options, functions, bar = case
    loop = [instruction for words in functions for instruction in loop_of(folder / f"{law}.so", words)]
    nodes = nodes_of(loop)
    divisions = sum(w.startswith("vdivpd") for w in loop) * 8 // nodes
    roots = sum(w.startswith("vsqrtpd") for w in loop) * 8 // nodes
    busy = (divisions * dividers[0] + roots * dividers[1]) / 8.0
    result = json.loads(output_of(given.ilaw, "bench", law, *options, "--nodes", "2000", "--repetitions",
                                  str(given.repetitions), "--json"))[0]
    size = result["bytes_per_node"]
    print(f"| {what} | {size:.0f} | {bar * size / given.triad:.1f} | {result['ns_per_node']:.1f} | "
          f"{busy:.1f} ({divisions} + {roots}) | {busy_pipes(loop, *dividers[2:]):.1f} | {len(loop) / nodes:.0f} |",
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ilaw")
    parser.add_argument("dividers")
    parser.add_argument("--triad", type=float, default=12.5, help="GB/s beyond the cache")
    parser.add_argument("--repetitions", type=int, default=15)
    given = parser.parse_args()
    dividers = [float(number) for number in re.findall(r"[\d.]+", output_of(given.dividers))]
    if not dividers:
        print("this processor has no vectors of eight doubles")
        return SKIPPED
    print("| case | bytes | aim, ns | in cache, ns | dividers, ns | pipes, ns | instructions |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for case in CASES:
        row(case, given, pathlib.Path(os.environ["ILAW_PATH"]), dividers)
    return 0


if __name__ == "__main__":
    sys.exit(main())
