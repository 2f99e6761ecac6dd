#!/usr/bin/env python3
"""The example hosts as programs: blocks on a floor in C, C++, Fortran and Python, and a ball that rolls, against closed
forms; the minimal host beside `ilaw run`, to the bit; and the code that pages for hosts quote."""
# SPDX-License-Identifier: BSD-3-Clause
import functools
import json
import math
import os
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT, BIN = Path(__file__).resolve().parents[2], Path(os.environ["ILAW_BIN"])
BLOCKS = {Path(name).name: name for name in os.environ["ILAW_BLOCKS"].split(":")}
STICK = 2  # of ilaw_status


@functools.cache
def run(program, *arguments):
    """Exit code and output."""
    done = subprocess.run([program, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout


class Blocks(unittest.TestCase):
    """On springs on a floor, friction 0.3, gravity 10, h = 1e-3, three seconds. A row: number, u, friction work, status."""

    def for_each(self, judge):
        self.assertGreaterEqual(len(BLOCKS), 2)
        for name, program in BLOCKS.items():
            with self.subTest(host=name):
                code, text = run(program, "coulomb")
                self.assertEqual(code, 0, text)
                rows = [[float(word) for word in line.split()] for line in text.splitlines()]
                self.assertEqual(len(rows), 7)
                judge(rows)

    def test_friction_takes_the_energy_of_a_slide(self):
        """The work of the impulse, r.(v^- + v)/2, telescopes to m v0^2/2."""

        def judge(rows):
            for k, (mass, speed) in enumerate([(1.0, 1.2), (2.5, 2.0), (0.7, 3.0)]):
                self.assertAlmostEqual(rows[k][4], 0.5 * mass * speed**2, delta=5e-12)

        self.for_each(judge)

    def test_the_floor_carries_from_the_starting_half_kick_on(self):
        """Without it a floor would be g h^2/2 too low."""

        def judge(rows):
            for k in (0, 1, 3, 4, 5):
                self.assertAlmostEqual(rows[k][3], 0.0, delta=1e-12)
                self.assertEqual(rows[k][5], STICK)

        self.for_each(judge)

    def test_a_weak_spring_does_not_move_its_block(self):
        """A spring of 2 against a friction of 4.5: nothing moves, and nothing works."""

        def judge(rows):
            self.assertAlmostEqual(rows[4][1], 0.06, delta=1e-17)
            self.assertAlmostEqual(rows[4][2], 0.08, delta=1e-17)
            self.assertEqual(rows[4][4], 0.0)

        self.for_each(judge)

    def test_a_block_that_is_not_listed_swings_freely(self):
        """About -m g/k, at the frequency of central differences: sin(w_h h/2) = w h/2."""
        h, middle, swing = 1e-3, -0.8 * 10 / 30, math.sqrt(30 / 0.8)
        angle = 3.0 * 2 / h * math.asin(swing * h / 2)

        def judge(rows):
            _, x, _, z, work, status = rows[6]
            self.assertAlmostEqual(z, middle + (0.1 - middle) * math.cos(angle), delta=1e-10)
            self.assertEqual([x, work, status], [0.0] * 3)

        self.for_each(judge)

    def test_all_languages_print_the_same_bits(self):
        """17 significant digits: equal text is equal bits."""
        self.assertEqual({run(program, "coulomb") for program in BLOCKS.values()}, {run(BLOCKS["blocks_c"], "coulomb")})

    def test_refusals_are_passed_on(self):
        for name, program in BLOCKS.items():
            for arguments, words in ((["no_such_law"], ["no_such_law"]), (["contact"], ["friction", "restitution"]),
                                     ([], ["LIBRARY"])):  # fmt: skip
                with self.subTest(host=name, arguments=arguments):
                    code, text = run(program, *arguments)
                    self.assertEqual((code, [word for word in words if word not in text]), (1, []))


class Ball(unittest.TestCase):
    """host_mock/minimal/ball.c, which hands spins to a law: x, v, rolling speed, spin, balance at the end."""

    radius, gravity, rho, tau, h = 0.05, 9.81, 2e-3, 1e-3, 1e-4

    def end(self, *arguments):
        code, text = run(BIN / "ball_c", "rolling", *arguments)
        self.assertEqual(code, 0, text)
        return map(float, text.split())

    def test_rolls_out(self):
        x, v, _, _, balance = self.end(0, 1, 0, 6)
        self.assertAlmostEqual(x, 1.4 * self.radius / (2 * self.rho * self.gravity) - 0.5 * self.h, delta=1e-8)
        self.assertAlmostEqual(v, 0.0, delta=1e-14)
        self.assertAlmostEqual(balance, 1.0, delta=1e-12)

    def test_spins_down(self):
        stops = 0.4 * self.radius**2 * 30 / (self.tau * self.gravity)
        for part, spin, tolerance in ((0.5, 15.0, 30 * self.h / stops), (1.01, 0.0, 1e-12)):
            self.assertAlmostEqual(list(self.end(0, 0, 30, part * stops))[3], spin, delta=tolerance)

    def test_stays_on_a_slope_and_rolls_down_a_steeper_one(self):
        limit = math.atan(self.rho / self.radius)
        x, *_ = self.end(0.98 * limit, 0, 0, 1)
        self.assertAlmostEqual(x, 0.0, delta=1e-15)
        _, v, rolls, *_ = self.end(3 * limit, 0, 0, 1)
        down = math.sin(3 * limit) - math.cos(3 * limit) * self.rho / self.radius
        self.assertAlmostEqual(v, self.gravity / 1.4 * down, delta=1e-11)
        self.assertAlmostEqual(rolls, v, delta=1e-12)


# ---- the minimal host ----

POINTS = [{"mass": 1, "position": [0.3, 0.2, 1.2], "velocity": [-1, -0.5, 0.2]},
          {"mass": 2, "position": [0.3, 0.2, 1.3], "velocity": [0.1, 0, -1], "stiffness": [0, 3, 0]},
          {"mass": 0.5, "position": [0.3, 0.2, 1.4]}]  # fmt: skip
PLANE = {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
LAWS = {"contact": {"restitution": 0.4}, "impact": {"restitution": 0.7, "friction": 0.3},
        "coulomb": {"friction": 0.4, "restitution": 0.3}, "cohesive": {"strength": 30, "toughness": 0.7, "friction": 0.2},
        "postit": {"efficiency_decrease": 3, "adhesion_limit": "inf", "memory": 0.05}, "tie": {"strength": 0.5, "memory": 0.1},
        "penalty": {"stiffness": 1e4, "integration": "implicit", "damping": 10},
        "slip_weakening": {"friction": 0.6, "dynamic_friction": 0.2, "critical_slip": 0.1},
        "rccm": {"normal_stiffness": 1e3, "tangential_stiffness": 500, "adhesion_energy": 0.5, "viscosity": 0.05,
                 "friction": 0.4}}  # fmt: skip


def scene_of(*interfaces):
    return {"model": {"type": "points", "dimension": 3, "points": POINTS}, "time": {"dt": 1e-3, "end": 0.6},
            "loads": [{"type": "gravity", "acceleration": [-1, -2, -10]}], "interfaces": list(interfaces),
            "output": {"watch": [0, 1, 2]}}  # fmt: skip


def random_scene(draw):
    """One that both hosts can read."""
    d, n = draw.randint(1, 3), draw.randint(1, 8)
    cut, law = draw.randint(0, n), draw.choice(list(LAWS)[: None if d > 1 else -2])  # the last two have no form in 1D

    def vector(size):
        return [draw.uniform(-size, size) for _ in range(d)]

    def point():
        mass = math.exp(draw.uniform(-4, 4))
        springs = {"stiffness": [mass * draw.uniform(0, 500) for _ in range(d)]} if draw.random() < 0.3 else {}
        return {"mass": mass, "area": draw.uniform(0.1, 1), "position": vector(0.3), "velocity": vector(2), **springs}

    def interface(nodes):
        shape = draw.choice([{"type": "plane", "point": vector(0.3), "normal": vector(1)},
                             {"type": "sphere", "center": vector(0.5), "radius": draw.uniform(0.05, 0.5)}])  # fmt: skip
        moves = {"velocity": vector(1)} if draw.random() < 0.5 else {}
        return {"law": law, "parameters": LAWS[law], "nodes": nodes, "obstacle": shape | moves}

    loads = [{"type": "gravity", "acceleration": vector(1)}] if draw.random() < 0.7 else []
    loads += [{"type": "force", "nodes": [draw.randrange(n)], "direction": vector(1),
               "history": [[0, 0], [0.1, draw.uniform(-9, 9)], [0.3, 0]]}]  # fmt: skip
    loads += [{"type": "shock", "nodes": [draw.randrange(n)], "time": 0.05 * k, "impulse": vector(1)}
              for k in range(1, draw.randint(1, 3))]  # fmt: skip
    parts = [list(range(cut)), list(range(cut, n))]
    return {"model": {"type": "points", "dimension": d, "points": [point() for _ in range(n)]}, "loads": loads,
            "time": {"dt": draw.choice([1e-3, 7.3e-4]), "end": 0.25}, "interfaces": [interface(part) for part in parts if part],
            "output": {"watch": list(range(n)), "every": draw.randint(1, 5)}}  # fmt: skip


class Minimal(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def minimal(self, scene):
        file = self.folder / "scene.json"
        file.write_text(json.dumps(scene))
        return run.__wrapped__(BIN / "ilaw-minimal", file, self.folder / "minimal")

    def tables(self, scene, *options):
        """Lines of the histories of both, as far as the columns of the minimal host go: `ilaw run` adds those that a scene
        asks for by "balance" and "forces"."""
        code, text = self.minimal(scene)
        self.assertEqual(code, 0, text)
        code, text = run.__wrapped__(BIN / "ilaw", "run", self.folder / "scene.json", *options, "--out", self.folder / "ilaw")
        self.assertEqual(code, 0, text)
        own, other = ((self.folder / name / "history.csv").read_text().splitlines() for name in ("minimal", "ilaw"))
        columns = own[0].count(",") + 1
        return own, [",".join(line.split(",")[:columns]) for line in other]

    def test_has_the_bits_of_ilaw_run_on_shipped_scenes(self):
        """A scene that is no longer read is a fault; their number may grow."""
        read = 0
        for file in sorted([*ROOT.glob("host_mock/scenes/*.json"), *ROOT.glob("plugins/**/*.json")]):
            scene = json.loads(file.read_text())
            code, text = self.minimal(scene)
            with self.subTest(scene=file.name):
                if code == 2:
                    self.assertRegex(text, ": found .*, expected ")
                    continue
                read += 1
                own, other = self.tables(scene)
                self.assertGreater(len(own), 400)
                self.assertTrue(own == other)
        self.assertGreaterEqual(read, 19)

    def test_has_the_bits_of_ilaw_run_on_random_scenes(self):
        for seed in range(60):
            scene = random_scene(random.Random(seed))
            with self.subTest(seed=seed, scene=scene):
                own, other = self.tables(scene)
                self.assertTrue(own == other)

    def test_solves_contacts_that_share_nodes(self):
        """A corner, and a bond to a node that is in contact itself."""
        low, wall = {"point": [0, 0, 1.2]}, {"point": [0.1, 0, 0], "normal": [1, 0, 0], "velocity": [0, 0.1, 0]}
        own, other = self.tables(scene_of(
            {"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "all", "obstacle": PLANE | low},
            {"name": "wall", "law": "coulomb", "parameters": {"friction": 0.2, "restitution": 0.5}, "nodes": [0, 1],
             "obstacle": PLANE | wall},
            {"name": "bond", "law": "cohesive", "parameters": {"strength": 100, "toughness": 1}, "nodes": [1],
             "against": {"nodes": [2], "normal": [0, 0, 1]}}), "--tolerance", "1e-14")  # fmt: skip
        self.assertEqual((own[0], len(own)), (other[0], len(other)))
        for line, expected in zip(own[1:], other[1:]):
            for a, b in zip(line.split(","), expected.split(",")):
                self.assertAlmostEqual(float(a), float(b), delta=1e-12)

    def test_names_what_it_refuses(self):
        friction = {"law": "coulomb", "nodes": "all", "obstacle": PLANE}
        contact = {"law": "contact", "nodes": [0], "obstacle": PLANE}
        for interface, words in (
            (friction | {"parameters": {"fricton": 0.2}}, "fricton"), (friction | {"parameters": {"friction": -1}}, "-1"),
            (contact | {"nodes": [0, 3]}, "/interfaces/0/nodes: found 3, expected a node of 0 to 2"),
            (contact | {"tangent": [1, 0, 0]}, '/interfaces/0: found "tangent", expected one of name, law'),
            ({"law": "contact", "nodes": [0]}, "obstacle"), (contact | {"nodes": "some"}, "/interfaces/0/nodes"),
        ):  # fmt: skip
            with self.subTest(words=words):
                code, text = self.minimal(scene_of(interface))
                self.assertEqual(code, 2)
                self.assertIn(words, text)
        for arguments, code, words in ((["none.json", "out"], 2, ""), (["--help"], 0, "Example: ilaw-minimal"),
                                       ([], 2, "found 0 arguments, expected SCENE.json FOLDER")):  # fmt: skip
            found, text = run(BIN / "ilaw-minimal", *arguments)
            self.assertEqual(found, code)
            self.assertIn(words, text)


# ---- pages ----

HOSTS = ROOT / "tests/hosts"
MINIMAL = ROOT / "host_mock/minimal"
SOURCES = {"c": [MINIMAL / "blocks.c", MINIMAL / "grains.c", ROOT / "tests/device/points.c"],
           "cpp": [HOSTS / "blocks.cpp", MINIMAL / "minimal.cpp"],
           "fortran": [HOSTS / "blocks.f90"], "python": [HOSTS / "python/blocks.py", HOSTS / "python/test_schemes.py"]}  # fmt: skip
# A reader who copies the excerpts of one language leaves out no call that every host must make.
CALLS = {"c": ["ilaw_library_open(", "ilaw_interface_create(", "ilaw_interface_info(", "ilaw_interface_initialise(",
               "ilaw_interface_evaluate(", "ilaw_interface_destroy("],
         "cpp": ["ilaw::library(", "interface.info(", "interface.initialise(", "interface.evaluate("],
         "fortran": ["ilaw_open(", "ilaw_create(", "ilaw_interface_info(", "ilaw_interface_initialise(",
                     "ilaw_interface_evaluate(", "ilaw_interface_destroy("],
         "python": ["ilaw.Interface(", "law.batch(", ".initialise(", ".evaluate("]}  # fmt: skip


class Pages(unittest.TestCase):
    def test_quote_code_that_is_built_and_run(self):
        def stripped(text, language):
            """Pages and sources indent differently; in Python that would be another program."""
            return "\n" + text if language == "python" else re.sub("^ +", "", text, flags=re.M)

        quoted = {language: "" for language in SOURCES}
        for page in [MINIMAL / "README.md", *(ROOT / "docs/hosts").glob("*.md")]:
            for language, text in re.findall(r"```(\w+)\n([^`]*)```", page.read_text()):
                source = "".join(stripped(file.read_text(), language) for file in SOURCES[language])
                self.assertIn(stripped(text, language), source)
                quoted[language] += text
        for language, calls in CALLS.items():
            self.assertEqual([call for call in calls if call not in quoted[language]], [], language)

    def test_of_the_abi_name_every_enumerator_struct_and_function(self):
        """Members are in the header, each with its comment."""
        page = (ROOT / "docs/abi.md").read_text()
        for header, pattern, least in (("ilaw", r"(ILAW_[A-Z0-9_]+) = [-(0-9]", 54),
                                       ("ilaw", r"typedef struct (ilaw_\w+)", 12),
                                       ("loader", r"\n[a-z][^\n(]*?(ilaw_\w+)\(", 12)):  # fmt: skip
            names = set(re.findall(pattern, (ROOT / f"api/include/ilaw/{header}.h").read_text()))
            self.assertGreaterEqual(len(names), least)
            self.assertEqual([name for name in names if f"`{name}`" not in page], [])


if __name__ == "__main__":
    unittest.main()
