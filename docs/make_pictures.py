#!/usr/bin/env python3
"""Redraws the pictures of pages whose inputs have changed, or checks that none is older than what it is drawn from.

    docs/make_pictures.py [--all] [PROGRAM]    PROGRAM: build/release/bin/ilaw
    docs/make_pictures.py --check [PROGRAM]

docs/img/inputs.json has a hash for each picture: of scenes and of what their runs give, of tables, of scripts. Pictures
that are measured for minutes have scripts of their own; this one tells which to run. Needs matplotlib.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import functools
import hashlib
import inspect
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Callable, NamedTuple, Optional, Sequence

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "api/python"), str(ROOT / "docs")]
sys.dont_write_bytecode = True

import make_compared  # noqa: E402
import make_gallery  # noqa: E402
import make_moving  # noqa: E402
import make_sketches  # noqa: E402
from ilaw import plot  # noqa: E402
from ilaw._curves import curves_of, visible  # noqa: E402
from ilaw._measured import converge_figure  # noqa: E402

RECORD = ROOT / "docs/img/inputs.json"
PANELS_OF_LAWS = {
    "bouncing_ball": "gap,velocity,summed impulse,status", "penalty_bounce": "gap,velocity,impulse,status",
    "cohesive_pull": "displacement,damage,status,traction over separation",
    "postit_test1": "velocity,impulse,adhesion,ruptures,status",
    "postit_test2": "velocity,impulse,adhesion,ruptures,status",
    "postit_test3": "velocity,impulse,adhesion,ruptures,status",
    "sliding_block_3d": "displacement,velocity,status", "stick_slip": "displacement,velocity,impulse,status",
    "sticking_grains": "gap,velocity,energy,status", "tie_rupture": "displacement,summed impulse,status",
}  # fmt: skip
PANELS_OF_SCENES = {"first_scene": "displacement,velocity,force,status", "pressed_pad": "force,status"}
CONVERGED = ("postit_test1", "postit_test2", "postit_test3", "bouncing_ball_e08", "bouncing_ball_e1", "bar_on_wall",
             "two_bars", "glued_bar", "bar_on_wall_cfl1", "two_bars_cfl1", "glued_bar_cfl1", "postit_3d")  # fmt: skip
# Measured for minutes, and drawn by these: their pictures are only checked here.
MEASURED = {
    "docs/results/img/calculix.png": "docs/results/calculix.py", "docs/results/img/fault.png": "docs/results/fault.py",
    "docs/results/img/tyre_block.png": "docs/results/tyre_block.py",
    "docs/img/mortar_pressure.svg": "docs/results/dual_mortar.py",
    "docs/img/pressure.svg": "docs/results/pressure.py",
    "docs/img/particle_impacts.svg": "docs/results/particle_impacts.py",
    "docs/img/contact_problems.png": "tests/bench/contact_problems.py",
    "docs/img/dealii_peel.svg": "api/dealii/compare.py",
}  # fmt: skip
for study in ("bar_on_wall", "block_impact", "bouncing_ball", "glued_bar", "held_rod", "oblique_impact", "postit_3d"):
    MEASURED[f"docs/results/img/study_{study}.png"] = f"docs/results/tables/study_{study}.csv"


class Picture(NamedTuple):
    path: str
    inputs: Callable[[Path], bytes]  # in an empty folder, which the drawing gets afterwards
    draw: Optional[Callable[[Path], None]]
    files: Sequence[str] = ()


def scene_file(name: str) -> str:
    places = ("host_mock/scenes", "plugins/*")
    return next(str(file.relative_to(ROOT)) for place in places for file in ROOT.glob(f"{place}/{name}.json"))


# ---- pictures of runs ------------------------------------------------------------------------------------------------


def execute(commands: Sequence[str], folder: Path) -> None:
    for name in ("tests", "plugins", "host_mock"):
        if not (folder / name).is_symlink():
            (folder / name).symlink_to(ROOT / name)
    (folder / "results").mkdir(exist_ok=True)
    for command in commands:
        done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{command}\n{done.stdout}{done.stderr}")


def outcome_of(folder: Path) -> bytes:
    """What a picture could show of the histories in a folder: thousandths of the scale of each curve."""
    found = hashlib.sha256()
    for file in sorted((folder / "results").glob("**/history.csv")):
        run = plot.Run(file.parent)
        names, rows = run.history()
        for curve in visible(curves_of(run, names), rows)[0]:
            values = rows[:, curve.index]
            scale = np.abs(values[np.isfinite(values)]).max()
            # The offset keeps round values from the edge between two numbers, where rounding would choose.
            numbers = np.floor(values / scale * 1000.0 + 0.1234567)
            numbers = np.nan_to_num(numbers, nan=1e6, posinf=1e6, neginf=-1e6)
            found.update(curve.column.encode() + numbers.astype("<i4").tobytes())
    return found.digest()


def of_runs(name: str, commands: Sequence[str], scene: Optional[str] = None) -> Picture:
    def inputs(folder: Path) -> bytes:
        if scene:
            (folder / "scene.json").write_text(scene, encoding="utf-8")
        execute([command for command in commands if command.startswith("ilaw run")], folder)
        return "\n".join(commands).encode() + outcome_of(folder)

    def draw(folder: Path) -> None:
        execute([command for command in commands if command.startswith("ilaw plot")], folder)
        (drawn,) = (folder / "results").glob("**/*.png")
        (ROOT / f"docs/img/{name}.png").write_bytes(drawn.read_bytes())

    return Picture(f"docs/img/{name}.png", inputs, draw)


def pictures_of_runs() -> list[Picture]:
    page = (ROOT / "docs/from_question_to_picture.md").read_text(encoding="utf-8")
    commands = re.findall(r"^    (ilaw .*)$", page, re.M)
    found = []
    for name in re.findall(r"\]\(img/([a-z_]*)\.png\)", page):
        found.append(of_runs(name, [c for c in commands if f"results/{name}" in c]))
    scenes = re.findall(r"```json\n(.*?)```", (ROOT / "docs/scenes.md").read_text(encoding="utf-8"), re.S)
    for scene, (name, panels) in zip(scenes, PANELS_OF_SCENES.items()):
        commands = ["ilaw run scene.json --out results", f"ilaw plot results --panels '{panels}'"]
        found.append(of_runs(name, commands, scene))
    for name, panels in PANELS_OF_LAWS.items():
        run = f"ilaw run {scene_file(name)} --out results"
        found.append(of_runs(name, [run, f"ilaw plot results --panels '{panels}'"]))
    return found


def gallery() -> Picture:
    def draw(folder: Path) -> None:
        execute([f"ilaw run {scene_file(name)} --out {name}" for name in make_gallery.SCENES], folder)
        with plot.plt.rc_context(plot.STYLE | {"font.size": 8, "axes.labelsize": 8}):
            make_gallery.gallery(folder)

    curves = json.dumps(make_gallery.SCENES).encode()
    return Picture("docs/img/gallery.png", lambda _: curves, draw, [scene_file(name) for name in make_gallery.SCENES])


def viewer() -> bytes:
    """The page that moving pictures are frames of."""
    return b"".join((ROOT / "api/python/ilaw" / name).read_bytes() for name in ("view.html", "view.js"))


def moving(name: str) -> Picture:
    path, every = make_moving.SCENES[name]
    said = json.dumps([every, make_moving.FIELDS.get(name), make_moving.FRAMES]).encode() + viewer()
    draw = functools.partial(make_moving.draw, name)
    return Picture(f"docs/img/moving_{name}.webp", lambda _: said, draw, [f"{path}.json"])


def compared() -> Picture:
    said = json.dumps([make_compared.scene("law"), make_compared.scene("penalty"), make_compared.ROWS])
    return Picture("docs/img/compared.webp", lambda _: said.encode() + viewer(), make_compared.draw)


# ---- pictures of tables and sketches ---------------------------------------------------------------------------------


def of_table(name: str) -> Picture:
    scene = "docs/results/scenes" if name.startswith("bouncing_ball_") else None
    file = ROOT / (f"{scene}/{name}.json" if scene else scene_file(name.replace("_cfl1", "")))
    title = json.loads(file.read_text(encoding="utf-8"))["title"]
    title += ", at the critical step" if "_cfl1" in name else ""
    table = f"docs/results/tables/{name}.csv"

    def draw(_: Path) -> None:
        with plot.plt.rc_context(plot.STYLE):
            png, svg = plot.save(converge_figure(title, ROOT / table), ROOT / f"docs/results/img/{name}")
        svg.unlink()

    return Picture(f"docs/results/img/{name}.png", lambda _: title.encode(), draw, [table])


def sources_of(function: Callable[[], None]) -> str:
    """Of the function, and of those of its module that it calls."""
    found: dict[str, str] = {}

    def add(name: str) -> None:
        found[name] = inspect.getsource(getattr(make_sketches, name))
        for called in set(re.findall(r"(\w+)\(", found[name])) - set(found):
            if inspect.isfunction(getattr(make_sketches, called, None)):
                add(called)

    add(function.__name__)
    return "".join(found[name] for name in sorted(found))


def of_sketch(function: Callable[[], None]) -> Picture:
    """Its inputs are its code and the rows that it reads: the figure is made, but not written."""

    def inputs(_: Path) -> bytes:
        rows, kept = [], {name: getattr(make_sketches, name) for name in ("save", "page_rows", "table")}

        def read(name: str, *arguments: str) -> object:
            rows.append(kept[name](*arguments))
            return rows[-1]

        make_sketches.save = lambda figure, _: make_sketches.plt.close(figure)
        make_sketches.page_rows = functools.partial(read, "page_rows")
        make_sketches.table = functools.partial(read, "table")
        try:
            function()
        finally:
            vars(make_sketches).update(kept)
        return (sources_of(function) + json.dumps(rows)).encode()

    return Picture(f"docs/img/{function.__name__}.svg", inputs, lambda _: function())


def pictures() -> list[Picture]:
    measured = [Picture(path, lambda _: b"", None, [source]) for path, source in MEASURED.items()]
    runs = [*pictures_of_runs(), gallery(), compared(), *map(moving, make_moving.SCENES)]
    return [*runs, *map(of_table, CONVERGED), *map(of_sketch, make_sketches.PICTURES), *measured]


def hash_of(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16] if file.is_file() else ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--all", action="store_true", help="also those whose inputs are as they were")
    parser.add_argument("program", nargs="?", type=Path, default=ROOT / "build/release/bin/ilaw")
    options = parser.parse_args()
    os.environ["PATH"] = f"{options.program.resolve().parent}:{os.environ['PATH']}"
    record = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.is_file() else {}
    found, old = {}, []
    for picture in pictures():
        with tempfile.TemporaryDirectory() as folder:
            digest = hashlib.sha256(picture.inputs(Path(folder)))
            for file in picture.files:
                digest.update((ROOT / file).read_bytes())
            before = record.get(picture.path)
            now = f"{digest.hexdigest()[:16]} {hash_of(ROOT / picture.path)}"  # inputs, picture
            if picture.draw and not options.check and (options.all or before != now):
                print(picture.path, flush=True)
                picture.draw(Path(folder))
                now = f"{digest.hexdigest()[:16]} {hash_of(ROOT / picture.path)}"
            # A picture that another script draws is new if its bytes are.
            elif before != now and (options.check or before and before.split()[1:] == now.split()[1:]):
                by = "docs/make_pictures.py" if picture.draw else f"what draws it from {picture.files[0]}"
                old.append(f"{picture.path}: found other inputs than it was drawn from: run {by}")
                now = before
            found[picture.path] = now
    if not options.check:
        RECORD.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    files = [*(ROOT / "docs/img").iterdir(), *(ROOT / "docs/results/img").iterdir()]
    strange = {str(file.relative_to(ROOT)) for file in files if file != RECORD} - set(found)
    old += [f"{path}: found a picture that nothing draws" for path in sorted(strange)]
    print(*old, sep="\n", end="\n" if old else "", file=sys.stderr)
    return 1 if old else 0


if __name__ == "__main__":
    sys.exit(main())
