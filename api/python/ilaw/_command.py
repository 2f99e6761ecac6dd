"""What commands in Python share: the folder of results, files that are written whole, progress, tables, refusals."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import contextlib
import difflib
import fcntl
import json
import math
import os
import re
import signal
import sys
import time
from pathlib import Path
from typing import Any, Callable, Iterator, Sequence

DONE, FAILED, BAD_INPUT = 0, 1, 2
RESULTS = ("summary.json", "sweep.csv", "converge.json", "study.json", "bench.csv")  # as in base/files.cpp


class BadInput(Exception):
    """Found before anything was written; the message says what was found and expected."""


def printable(text: str) -> str:
    """No text of a scene steers the terminal."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", lambda found: f"\\x{ord(found[0]):02x}", text)


def complain(text: str, code: int) -> int:
    lines = [printable(line.strip()) for line in text.split("\n")]
    print("ilaw: " + "\n  ".join(lines), file=sys.stderr)
    return code


def meant(word: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(word, known, 1)
    return f" (did you mean '{close[0]}'?)" if close else ""


def interrupt(number: int, frame: Any) -> None:
    raise KeyboardInterrupt


@contextlib.contextmanager
def in_scene(file: Path) -> Iterator[None]:
    """What is refused or fails, with the file."""
    try:
        yield
    except BadInput as reason:
        raise BadInput(f"{file}: {reason}") from None
    except RuntimeError as reason:
        raise RuntimeError(f"{file}: {reason}") from None


def run_command(work: Callable[[], int]) -> int:
    """The exit code of a command; says on stderr what was wrong."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, interrupt)
    try:
        code = work()
        sys.stdout.flush()
        return code
    except BadInput as reason:
        return complain(str(reason), BAD_INPUT)
    except KeyboardInterrupt:
        return complain("interrupted", FAILED)
    except OSError as reason:
        if reason.filename is None:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what is left in the buffer
            return complain(f"standard output: cannot be written: {reason.strerror}", FAILED)
        return complain(f"{reason.filename}: {reason.strerror}", FAILED)
    except RuntimeError as reason:
        return complain(str(reason), FAILED)


class HeldFolder:
    """The folder of --out: made if it does not exist, and held by this process alone, as by `ilaw run`.

    own: the file of results that the command writes there; a folder with those of another command is refused.
    """

    def __init__(self, folder: Path, own: str) -> None:
        self.path, self.lock, self.own = folder, folder / "ilaw.lock", own

    def __enter__(self) -> Path:
        for other in RESULTS:
            if other != self.own and (self.path / other).exists():
                expected = "expected a folder of its own for each command"
                raise BadInput(f"--out {self.path}: found {other}, a result of another command, {expected}")
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            if self.lock.is_symlink():
                raise BadInput(f"{self.lock}: found a symbolic link, expected a file")
            self.file = open(self.lock, "a+", encoding="utf-8")
        except OSError as reason:
            found = "found a file or a place that cannot be written, expected a folder"
            raise BadInput(f"--out {self.path}: {found} ({reason.strerror})") from None
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.file.seek(0)
            expected = "expected a folder of its own for each run"
            raise BadInput(f"--out {self.path}: in use by {self.file.read().strip()}, {expected}") from None
        except OSError:
            pass  # a file system without locks holds nobody back
        self.file.truncate(0)
        print(f"process {os.getpid()} on {os.uname().nodename}", file=self.file, flush=True)
        return self.path

    def __exit__(self, *_: Any) -> None:
        self.lock.unlink(missing_ok=True)
        self.file.close()


def write_whole(file: Path, text: str) -> None:
    """A file with its final name is complete and on the disk."""
    partial = file.with_name(file.name + ".partial")
    partial.unlink(missing_ok=True)
    with open(partial, "x", encoding="utf-8") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())
    partial.replace(file)


def write_json(file: Path, content: Any) -> None:
    write_whole(file, json.dumps(content, indent=2, sort_keys=True) + "\n")


def write_csv(file: Path, digits: int, columns: Sequence[str], rows: Iterator[Sequence[Any]]) -> None:
    """Floats to so many digits; empty if they are not finite."""
    def cell(value: Any) -> str:
        if not isinstance(value, float):
            return str(value)
        return f"{value:.{digits}g}" if math.isfinite(value) else ""

    write_whole(file, "".join(",".join(map(cell, row)) + "\n" for row in (columns, *rows)))


def remove_pictures(folder: Path) -> None:
    """Those that `ilaw plot` drew of earlier results."""
    for file in folder.iterdir():
        if file.suffix in (".png", ".svg") and file.is_file() and not file.is_symlink():
            with file.open("rb") as stream:
                drawn = b"ilaw plot" in stream.read(2000)
            if drawn:
                file.unlink()


def text_of(value: float, form: str) -> str:
    """"-" if there is no number."""
    return format(value, form) if math.isfinite(value) else "-"


def print_rows(rows: Sequence[Sequence[str]]) -> None:
    """Columns as wide as their longest cell; the last one of a row is free."""
    rows = [[printable(cell) for cell in row] for row in rows]
    widths = [max(len(row[c]) for row in rows if c + 1 < len(row)) for c in range(max(map(len, rows)) - 1)]
    for row in rows:
        print("".join(f"{cell:{width + 2}}" for cell, width in zip(row[:-1], widths)) + row[-1])


class Progress:
    """One line on a terminal, or a JSON object per second; as api/check/progress.hpp."""

    def __init__(self, task: str, unit: str, json_lines: bool) -> None:
        self.task, self.unit, self.json_lines, self.is_drawn = task, unit, json_lines, False
        self.is_shown = json_lines or sys.stderr.isatty()
        self.start = time.monotonic()
        self.next = self.start + 0.1  # short work shows nothing
        self.done, self.total = 0.0, 1.0

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *_: Any) -> None:
        if self.json_lines:
            self._show(time.monotonic())
        elif self.is_drawn:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def set(self, done: float, total: float) -> None:
        self.done, self.total = done, total
        now = time.monotonic()
        if self.is_shown and now >= self.next:
            self.next = now + (1.0 if self.json_lines else 0.1)
            self._show(now)

    def _show(self, now: float) -> None:
        part = min(max(self.done / self.total, 0.0), 1.0)
        speed = self.done / max(now - self.start, 1e-9)
        left = max(self.total - self.done, 0.0) / speed if speed > 0.0 else 0.0
        if self.json_lines:
            told = {"task": self.task, "unit": self.unit, "done": self.done, "total": self.total, "percent": 100.0 * part,
                    "per_second": speed, "seconds": now - self.start, "seconds_left": left}  # fmt: skip
            print(json.dumps({k: v if isinstance(v, str) else float(f"{v:.10g}") for k, v in told.items()}),
                  file=sys.stderr, flush=True)  # fmt: skip
            return
        self.is_drawn = True
        bar = f"{'#' * int(30 * part):.<30}"
        unit, rest = next((u, left / s) for u, s, most in (("s", 1, 120), ("min", 60, 7200), ("h", 3600, math.inf))
                          if left < most)  # fmt: skip
        print(f"\r\033[K{self.task} [{bar}] {100 * part:3.0f} %  {rest:.0f} {unit} left ", end="", file=sys.stderr, flush=True)


def sweep_parser(command: str) -> argparse.ArgumentParser:
    """The options that converge and study share; the program has checked their ranges."""
    parser = argparse.ArgumentParser(prog=f"ilaw {command}")
    parser.add_argument("scenes", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--levels", type=int)
    parser.add_argument("--factor", type=float)
    parser.add_argument("--refine", choices=["time", "mesh"])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--json-lines", action="store_true")
    return parser
