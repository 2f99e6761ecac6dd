"""The page of the package: its code runs as it stands."""
import os
import re
from pathlib import Path

import numpy as np
import pytest

PAGE = (Path(os.environ["ILAW_SOURCE"]) / "api/python/README.md").read_text()


def test_the_code_of_the_page_runs(tmp_path, monkeypatch, capsys):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile("\n".join(re.findall(r"```python\n(.*?)```", PAGE, re.S)), "README.md", "exec"), names)
    said = capsys.readouterr().out
    assert "'friction' = -0.3 is not allowed: expected a number in [0, inf]" in said
    # v0^2/(2 mu g), to the step's second order
    np.testing.assert_allclose(names["u"][:3, 0], [0.24, 2 / 3, 1.5], atol=0.3 * 10 * 1e-6)
    np.testing.assert_allclose(names["contacts"].impulse[:, 2], [0.1, 0.08, 0.06, 0.04, 0.02], rtol=1e-9)
    for picture in ("friction.png", "cohesive.png"):
        assert (tmp_path / picture).stat().st_size > 10_000
    stress, path = np.array(names["stress"]), names["path"][1:]
    assert stress.max() == pytest.approx(1e6, rel=1e-2)
    assert stress[-1] == 0.0  # broken beyond 2 G/sigma = 2e-4
    work = np.sum(stress * np.diff(names["path"]))
    assert work == pytest.approx(100.0, rel=1e-2)
