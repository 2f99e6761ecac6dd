"""The README's first picture: two bars collide, by a law, by a penalty, and in closed form, docs/img/compared.webp."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import base64
import io
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
from make_moving import browser, save_frames
from PIL import Image

from ilaw import plot, view
from ilaw._results import Run, read_grid

LENGTH, SIDE, YOUNG, DENSITY, SPEED, GAP = 0.2, 0.04, 1e6, 1000.0, 3.0, 0.03
ELEMENTS = (32, 4, 4)
WAVE = (YOUNG / DENSITY) ** 0.5
PRESSURE = DENSITY * WAVE * SPEED  # of equal bars at SPEED and -SPEED, for the time 2 LENGTH / WAVE
MEETING = 0.5 * GAP / SPEED
END, FRAMES, SECONDS = MEETING + 1.6 * 2 * LENGTH / WAVE, 44, 5.5
ROWS = {
    "law": "contact, a law of ilaw", "penalty": "penalty, a tenth of the elements' stiffness", "exact": "closed form",
}  # fmt: skip
# Nodes are numbered along x first; the faces that meet are numbered alike.
ROW, FACE = ELEMENTS[0] + 1, (ELEMENTS[1] + 1) * (ELEMENTS[2] + 1)
NODES, PARTNERS = [ROW * k + ROW - 1 for k in range(FACE)], [ROW * (FACE + k) for k in range(FACE)]


def bar(name: str, corner: float, speed: float) -> dict[str, Any]:
    material = {"type": "linear", "young": YOUNG, "poisson": 0.0, "density": DENSITY}
    shape = {"corner": [corner, 0, 0], "size": [LENGTH, SIDE, SIDE], "elements": ELEMENTS}
    return {"name": name, **shape, "velocity": [speed, 0, 0], "material": material}


def scene(law: str) -> dict[str, Any]:
    interface: dict[str, Any] = {"name": "faces", "law": "contact"}
    if law == "penalty":  # of the element's layer at each node, times the share that codes take
        ends = np.array([0.5, *[1.0] * (ELEMENTS[1] - 1), 0.5])
        area = np.outer(ends, ends).ravel() * SIDE**2 / ELEMENTS[1] / ELEMENTS[2]
        stiffness = 0.1 * YOUNG * area / (LENGTH / ELEMENTS[0])
        interface = {"name": "faces", "law": "penalty", "parameters": {"stiffness": {"per_node": stiffness.tolist()}}}
    bars = [bar("left", -LENGTH - GAP / 2, SPEED), bar("right", GAP / 2, -SPEED)]
    return {
        "title": ROWS[law], "model": {"type": "blocks", "blocks": bars}, "time": {"cfl": 0.6, "end": END},
        "interfaces": [{**interface, "nodes": NODES, "against": {"nodes": PARTNERS, "normal": [-1, 0, 0]}}],
        "output": {"forces": ["faces"], "fields": 1},
    }  # fmt: skip


def motion(distance: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacement toward the other bar and stress, at distances from the face that meets it (d'Alembert)."""
    since = time - MEETING
    arrival, leaving = distance / WAVE, (2 * LENGTH - distance) / WAVE  # of the wave, and after its reflection
    moved = SPEED * (MEETING + np.minimum(since, arrival) - np.maximum(since - leaving, 0.0))
    return moved, np.where((since >= arrival) & (since < leaving), PRESSURE, 0.0)


def write_closed_form(results: Path, output: Path) -> None:
    """The frames of a run, with the fields of the closed form."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    shutil.copytree(results, output)
    for time, file in Run(output).field_files():
        grid = read_grid(file)
        x = grid.points[:, 0]
        u = np.zeros_like(grid.points)
        u[:, 0] = -np.sign(x) * motion(np.abs(x) - GAP / 2, time)[0]
        cells = vtk_to_numpy(grid.data.GetCells().GetConnectivityArray()).reshape(-1, 8)
        stress = motion(np.abs(x[cells].mean(axis=1)) - GAP / 2, time)[1]
        for data, name, values in ((grid.data.GetPointData(), "u", u), (grid.data.GetCellData(), "von_mises", stress)):
            array = numpy_to_vtk(values, deep=True)
            array.SetName(name)
            data.AddArray(array)
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(file))
        writer.SetInputData(grid.data)
        writer.Write()


def frames_of(page: Path) -> list[Image.Image]:
    """From the front, with the colors and the scale that all rows share."""
    half = LENGTH + GAP / 2
    stage = "position: fixed; left: 0; top: 0; width: 800px; height: 120px"
    with browser.Browser(1300, 600) as opened:
        opened.open(page)
        opened.evaluate("ilawView.ready")
        for script in (
            f"document.getElementById('stage').style.cssText = '{stage}'",
            "document.getElementById('arrows').checked = false",
            "ilawView.chooseField(ilawView.run.film.fields.findIndex(f => f.name === 'von Mises stress'))",
            f"(document.getElementById('least').value = 0, document.getElementById('most').value = {1.25 * PRESSURE})",
            "document.getElementById('most').onchange()",
            f"(ilawView.model.box.min.set({-half}, 0, 0), ilawView.model.box.max.set({half}, {SIDE}, {SIDE}))",
            "document.getElementById('from').value = 'front'",
            "(ilawView.resize(), ilawView.fit())",
        ):
            opened.evaluate(script)
        last, found = opened.evaluate("ilawView.run.times.length - 1"), []
        for k in range(FRAMES):
            shown = f"ilawView.show({last * k / (FRAMES - 1)}), ilawView.draw()"
            picture = opened.evaluate(f"({shown}, document.querySelector('#stage canvas').toDataURL())")
            layer = Image.open(io.BytesIO(base64.b64decode(picture.partition(",")[2]))).convert("RGBA")
            found.append(Image.alpha_composite(Image.new("RGBA", layer.size, "white"), layer).convert("RGB"))
        return found


def pressures(results: Path) -> tuple[np.ndarray, np.ndarray]:
    names, rows = Run(results).history()
    return rows[:, 0], np.abs(rows[:, names.index("faces.F0")]) / SIDE**2


def compose(pictures: dict[str, list[Image.Image]], curves: dict[str, tuple], k: int) -> Image.Image:
    figure, axes = plot.plt.subplots(len(ROWS) + 1, 1, figsize=(8.0, 5.9), height_ratios=[1.2] * len(ROWS) + [2.0])
    for (name, title), panel in zip(ROWS.items(), axes):
        panel.imshow(pictures[name][k])
        panel.set_title(title, loc="left", pad=1)
        panel.axis("off")
    time = END * k / (FRAMES - 1)
    for color, dash, (name, (t, p)) in zip(("#0072B2", "#E69F00", "#000000"), ("-", "-", "--"), curves.items()):
        axes[-1].plot(1e3 * t, 1e-3 * p, color=color, linestyle=dash, label=ROWS[name].partition(",")[0])
    axes[-1].axvline(1e3 * time, color="#c2185b", linewidth=1.0)
    axes[-1].set(xlim=(0, 1e3 * END), ylim=(0, 1.6e-3 * PRESSURE), xlabel="time (ms)", ylabel="contact pressure (kPa)")
    axes[-1].legend(loc="upper right", ncols=3)
    figure.subplots_adjust(left=0.08, right=0.99, top=0.965, bottom=0.085, hspace=0.16)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    plot.plt.close(figure)
    return Image.open(buffer).convert("RGB")


def draw(folder: Path) -> None:
    curves, pictures = {}, {}
    for name in ("law", "penalty"):
        (folder / f"{name}.json").write_text(json.dumps(scene(name)), encoding="utf-8")
        command = ["ilaw", "run", f"{name}.json", "--out", name]
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        curves[name] = pressures(folder / name)
    write_closed_form(folder / "law", folder / "exact")
    edges = np.array([0.0, MEETING, MEETING, MEETING + 2 * LENGTH / WAVE, MEETING + 2 * LENGTH / WAVE, END])
    curves["exact"] = edges, PRESSURE * np.array([0, 0, 1, 1, 0, 0])
    for name in ROWS:
        view.write(folder / name, folder / f"{name}.html")
        pictures[name] = frames_of(folder / f"{name}.html")
    with plot.plt.rc_context(plot.STYLE):
        frames = [compose(pictures, curves, k) for k in range(FRAMES)]
    save_frames(frames, SECONDS, "compared")
