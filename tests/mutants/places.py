#!/usr/bin/env python3
"""Chooses places for new mutants at random: lines with an operator, a number or a call in the sources of an area.

    tests/mutants/places.py --area kit --count 12 --seed 35

A person then writes the fault that somebody would make there, or in the next line that allows one. Lines that
already carry a mutant are left out.
"""
import argparse
import json
import random
import re

from run import AREAS, MUTANTS, SOURCE, area_of

FAULTY = re.compile(r" [-+*/<>] | [<>=!]= | && | \|\| |(?<![\w.])\d+(\.\d+)?|\breturn !|smaller\(|larger\(")
NO_CODE = re.compile(r"^\s*(//|#|namespace|template|static_assert|\})")


def lines_of(area):
    """Every line of an area that computes or decides, as (file, number, text)."""
    for path in sorted((SOURCE / AREAS[area].folder).rglob("*.[ch]pp")):
        file = path.relative_to(SOURCE).as_posix()
        if area_of(file) != area:
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = re.sub(r'"[^"]*"|//.*', "", line)
            if FAULTY.search(code) and not NO_CODE.match(code):
                yield file, number, line.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--area", choices=sorted(AREAS), required=True)
    parser.add_argument("--files", default="", help="only in files whose path matches this regular expression")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    taken = {(one["file"], one["from"]) for one in json.loads(MUTANTS.read_text())}
    free = [place for place in lines_of(options.area) if re.search(options.files, place[0])
            and not any(place[0] == file and text in place[2] for file, text in taken)]
    for file, number, text in random.Random(options.seed).sample(free, options.count):
        print(f"{file}:{number}: {text}")


if __name__ == "__main__":
    main()
