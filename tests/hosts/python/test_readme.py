"""The programs of README.md, in C and in Python, run and give what the page says."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

PAGE = (Path(os.environ["ILAW_SOURCE"]) / "README.md").read_text()


def code(language):
    (text,) = re.findall(rf"```{language}\n(.*?)```", PAGE, re.S)
    return text


def test_c_bounces_a_ball(tmp_path):
    source, program = tmp_path / "ball.c", tmp_path / "ball"
    source.write_text(code("c"))
    loader = Path(os.environ["ILAW_LOADER"])
    subprocess.run(
        [os.environ.get("CC", "cc"), "-std=c99", "-Wall", "-Wextra", "-Wno-unused-value", "-pedantic", "-Werror",
         f"-I{os.environ['ILAW_INCLUDE']}", source, loader, f"-Wl,-rpath,{loader.parent}", "-o", program],
        check=True,
    )
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    height = float(re.search(r"height (\S+) m", done.stdout)[1])
    fall = np.sqrt(0.1)  # 0.5 m under 10 m/s^2, then half of the speed upwards
    flight = 0.6 - fall
    assert height == pytest.approx(0.5 * 10 * fall * flight - 5 * flight**2, abs=2e-3)
    assert re.search(r"/\* ([0-9.]+): it is in the air", code("c"))[1] == f"{height:.3f}"


def test_python_slides_blocks():
    names = {}
    exec(compile(code("python"), "README.md", "exec"), names)  # noqa: S102
    assert names["u"][:, 0] == pytest.approx(np.array([1, 4, 9]) / 6, abs=3e-3)
    assert np.abs(names["v"][:2]).max() < 1e-14
