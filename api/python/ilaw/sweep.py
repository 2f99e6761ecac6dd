"""`ilaw run --set`: a scene with several values of its keys, a process for each run."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import copy
import itertools
import json
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any, NamedTuple, Optional, Sequence

from ._command import (DONE, FAILED, BadInput, HeldFolder, Progress, complain, remove_pictures, run_command,
                       write_whole)  # fmt: skip
from ._exact import Scene
from ._results import Run
from ._variants import Failed, Scenes
from .runs import program
from .table import table_of


class Setting(NamedTuple):
    pointer: str
    name: str  # in the names of folders
    values: list[Any]


class Variant(NamedTuple):
    name: str
    file: Path
    steps: int


def no_number(text: str) -> None:
    raise ValueError(text)


def values_of(text: str) -> list[Any]:
    """Between commas: the shortest text that is JSON, or a word."""
    parts, values = text.split(","), []
    while parts:
        value, count = parts[0], 1
        for most in range(1, len(parts) + 1):
            try:
                value, count = json.loads(",".join(parts[:most]), parse_constant=no_number), most
                break
            except ValueError:
                pass
        values.append(value)
        parts = parts[count:]
    return values


def tokens_of(pointer: str) -> list[str]:
    return [token.replace("~1", "/").replace("~0", "~") for token in pointer.split("/")[1:]]


def read_settings(texts: Sequence[str]) -> list[Setting]:
    """Folders are named by the last key, or by the whole pointer if that is not unique."""
    settings = []
    for text in texts:
        pointer, _, values = text.partition("=")
        if not pointer.startswith("/") or not values:
            raise BadInput(f"--set {text}: expected /pointer=value,value,...")
        if re.search("~(?![01])", pointer):
            raise BadInput(f"--set {text}: expected a JSON pointer before '='")
        settings.append(Setting(pointer, tokens_of(pointer)[-1], values_of(values)))
    names = [setting.name for setting in settings]
    return [one._replace(name=one.pointer[1:].replace("/", ".")) if names.count(one.name) > 1 else one for one in settings]


def set_value(scene: Scene, pointer: str, value: Any) -> None:
    """The objects that own the last key may themselves be left out in the scene."""
    def place(part: Any, token: str) -> Any:
        if isinstance(part, dict):
            return token
        if isinstance(part, list) and re.fullmatch("0|[1-9][0-9]*", token) and int(token) < len(part):
            return int(token)
        raise BadInput(f"{pointer}: found no such key to set")

    part: Any = scene
    *owners, last = tokens_of(pointer)
    for token in owners:
        key = place(part, token)
        part = part.setdefault(key, {}) if isinstance(part, dict) else part[key]
    part[place(part, last)] = value


def folder_name(text: str) -> str:
    """One _ for all brackets, quotes and commas in a row."""
    return re.sub(r"([_=])_+", r"\1", re.sub(r"[^A-Za-z0-9=.+_-]+", "_", text)).rstrip("_")[:100]


def name_of(settings: Sequence[Setting], values: Sequence[Any]) -> str:
    texts = [value if isinstance(value, str) else json.dumps(value, separators=(",", ":")) for value in values]
    return "_".join(folder_name(f"{setting.name}={text}") for setting, text in zip(settings, texts))


def count_steps(scenes: Scenes, scene: Scene) -> int:
    """Refuses what `ilaw run` refuses. A state at rest is sought in one step here, since the run itself will find it."""
    rest = scene.get("prestress")
    if isinstance(rest, dict):
        steps = rest.get("steps", 1)
        with contextlib.suppress(Failed):
            scenes.probe({**scene, "prestress": {**rest, "steps": min(steps, 1) if isinstance(steps, int) else steps}})
        scene = {key: value for key, value in scene.items() if key != "prestress"}
    return scenes.probe(scene).steps


def make_variants(scenes: Scenes, settings: Sequence[Setting]) -> list[Variant]:
    """All combinations of values, each as a file. Refuses what `ilaw run` refuses."""
    source = scenes.parse()
    variants: dict[str, Variant] = {}
    for k, values in enumerate(itertools.product(*(setting.values for setting in settings))):
        scene = copy.deepcopy(source)
        name = name_of(settings, values)
        try:
            for setting, value in zip(settings, values):
                set_value(scene, setting.pointer, value)
            steps = count_steps(scenes, scene)
        except BadInput as reason:
            raise BadInput(f"{name}: {reason}") from None
        except Failed:  # in its first step: its run will say so
            steps = 1
        name += f"_{k}" if name in variants else ""
        scene.pop("expect", None)  # its values belong to the scene as it is
        variants[name] = Variant(name, Path(scenes.quick_room.name) / f"{k}.json", steps)
        variants[name].file.write_text(json.dumps(scene), encoding="utf-8")
    return list(variants.values())


class Sweep:
    """Runs that are processes: a law that crashes takes no other run with it."""

    def __init__(self, options: argparse.Namespace, progress: Progress, variants: list[Variant]) -> None:
        self.options, self.progress, self.lock = options, progress, threading.Lock()
        self.done = dict.fromkeys((variant.name for variant in variants), 0.0)  # steps
        self.total = float(sum(variant.steps for variant in variants))
        self.running: set[subprocess.Popen[str]] = set()
        self.stopped = False
        self.passed = ["--audit"] * options.audit
        for name in ("checkpoint_every", "tolerance"):
            if getattr(options, name) is not None:
                self.passed.append(f"--{name.replace('_', '-')}={getattr(options, name)}")

    def run(self, variant: Variant) -> int:
        """In a group of its own: Ctrl-C reaches this process alone, which passes it on. What the run says is said."""
        command = [program(), "run", self.options.scene, "--read-from", variant.file, "--out", self.options.out / variant.name,
                   "--json-lines", *self.passed]  # fmt: skip
        with self.lock:
            if self.stopped:
                return FAILED
            child = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True)
            self.running.add(child)
        assert child.stderr
        for line in child.stderr:
            told = re.match(r'\{"task":\s*"(\w+)".*"done":\s*(\d+(?:\.\d*)?(?:e[+-]?\d+)?)[,}]', line)
            with self.lock:
                if told and told[1] == "run":
                    self.done[variant.name] = float(told[2])
                    self.progress.set(sum(self.done.values()), self.total)
                elif not told:
                    print(line, end="", file=sys.stderr, flush=True)
        code = child.wait()
        with self.lock:
            self.running.discard(child)
            if code < 0:
                complain(f"{variant.name}: its process ended: {signal.strsignal(-code)}", FAILED)
        return code

    def stop(self) -> None:
        """Those that run end at their next step, and no other is started."""
        with self.lock:
            self.stopped = True
            for child in self.running:
                child.terminate()

    def run_all(self, variants: list[Variant]) -> list[int]:
        with concurrent.futures.ThreadPoolExecutor(self.options.threads) as pool:
            futures: list[concurrent.futures.Future[int]] = []
            try:
                futures += [pool.submit(self.run, variant) for variant in variants]
                concurrent.futures.wait(futures)
            except KeyboardInterrupt:
                self.stop()
            codes = [future.result() for future in futures]
            return codes + [FAILED] * (len(variants) - len(codes))


def sweep(options: argparse.Namespace) -> int:
    with Scenes(options.scene, 1) as scenes:
        try:
            variants = make_variants(scenes, read_settings(options.set))
        except BadInput as reason:
            raise BadInput(f"{options.scene}: {reason}; nothing was run") from None
        with HeldFolder(options.out, "sweep.csv") as folder:
            remove_pictures(folder)
            with Progress("runs", "steps", options.json_lines) as progress:
                runs = Sweep(options, progress, variants)
                codes = runs.run_all(variants)
            written = [Run(folder / one.name) for one in variants if (folder / one.name / "summary.json").is_file()]
            if written:
                write_whole(folder / "sweep.csv", "".join(",".join(row) + "\n" for row in table_of(written, [])))
    failed = sum(code != DONE for code in codes)
    print(f"{len(codes)} runs, {failed} failed{' or interrupted' * runs.stopped}; their summaries in {folder / 'sweep.csv'}")
    return FAILED if failed else DONE


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = argparse.ArgumentParser(prog="ilaw run")
    parser.add_argument("scene", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--set", action="append", required=True)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--checkpoint-every")
    parser.add_argument("--tolerance")
    parser.add_argument("--audit", action="store_true")
    parser.add_argument("--json-lines", action="store_true")
    options = parser.parse_args(arguments)
    return run_command(lambda: sweep(options))


if __name__ == "__main__":
    sys.exit(main())
