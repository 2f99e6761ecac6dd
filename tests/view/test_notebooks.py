"""The notebooks run from end to end, and show what they say; they are stored without outputs."""
# SPDX-License-Identifier: BSD-3-Clause

from pathlib import Path

import pytest

MISSING = "no Jupyter here: apt-get install python3-nbconvert python3-ipykernel"
nbformat = pytest.importorskip("nbformat", reason=MISSING)
pytest.importorskip("ipykernel", reason=MISSING)
preprocessors = pytest.importorskip("nbconvert.preprocessors", reason=MISSING)

FOLDER = Path(__file__).resolve().parents[2] / "docs/notebooks"


def executed(name):
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "stored with outputs"
    preprocessors.ExecutePreprocessor(timeout=300, kernel_name="python3").preprocess(notebook)
    return [output for cell in code for output in cell.outputs]


def pictures_in(outputs):
    return [o for o in outputs if "image/png" in o.get("data", {})]


def test_host_authors_get_a_law_into_their_loop():
    outputs = executed("for_host_authors")
    assert len(pictures_in(outputs)) == 2
    said = "".join(o.get("text", "") for o in outputs)
    assert "closed form" in said and "node 1" in said


def test_analysts_fit_run_and_view():
    pytest.importorskip("scipy", reason="no scipy here: apt-get install python3-scipy")
    outputs = executed("for_analysts")
    assert len(pictures_in(outputs)) == 2
    (page,) = [o["data"]["text/html"] for o in outputs if "text/html" in o.get("data", {})]
    assert "srcdoc=" in page and "A sled with the measured friction" in page and len(page) > 500_000
    assert any("the sled stops after" in o.get("text", "") for o in outputs)
