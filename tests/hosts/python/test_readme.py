"""The program of README.md runs and gives what the page says."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

PAGE = (Path(os.environ["ILAW_SOURCE"]) / "README.md").read_text()


def test_python_slides_blocks():
    names = {}
    (text,) = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    exec(compile(text, "README.md", "exec"), names)  # noqa: S102
    # No block sinks, because the law acts in the starting half kick too. The distances are v0^2/(2 mu g) to less
    # than h^2 mu g.
    assert names["u"][:, 0] == pytest.approx(np.array([1, 4, 9]) / 6, abs=3e-6)
    assert not names["u"][:, 2].any()
    assert np.abs(names["v"][:2]).max() < 1e-14
