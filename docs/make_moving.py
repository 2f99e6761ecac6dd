"""Moving pictures of the demo, docs/img/moving_*.webp: frames of `ilaw view` in Chromium without a window."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import base64
import io
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests/view"), str(ROOT / "host_mock")]

import browser  # noqa: E402
from demo_page import MOVING, run_moving  # noqa: E402

FRAMES, SECONDS, MOST_BYTES = 45, 4.5, 600_000
# Colors that say most; the others keep what the page chooses.
FIELDS = {"two_blocks": "pressure", "tread_blocks": "von Mises stress", "stack": "von Mises stress", "hail": "speed",
          "arch": "von Mises stress"}  # fmt: skip
SCENES = {Path(path).name: (path, every) for path, every, _ in MOVING}


def frames_of(page: Path, field: str) -> list[Image.Image]:
    """The view with its color bar and its time; what is clicked on is left out."""
    with browser.Browser(940, 640) as opened:
        opened.open(page)
        opened.evaluate("ilawView.ready")
        opened.evaluate("document.querySelectorAll('#parts input').forEach(box => box.style.display = 'none')")
        is_wanted = f"f => f.name === '{field}' && /^(all interfaces)?$/.test(f.interface)"
        chosen = f"ilawView.run.film.fields.findIndex({is_wanted})"
        opened.evaluate(f"(k => k >= 0 && ilawView.chooseField(k))({chosen})")
        box = "(b => ({x: b.x, y: b.y, width: b.width, height: b.height, scale: 1}))"
        clip = opened.evaluate(f"{box}(document.getElementById('view').getBoundingClientRect())")
        last, found = opened.evaluate("ilawView.run.times.length - 1"), []
        for k in range(FRAMES):
            opened.evaluate(f"(ilawView.show({last * k / (FRAMES - 1)}), ilawView.draw())")
            picture = opened.call("Page.captureScreenshot", seconds=600, format="png", clip=clip)["data"]
            found.append(Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB"))
        return found


def draw(name: str, folder: Path) -> None:
    path, every = SCENES[name]
    frames = frames_of(run_moving(path, every, folder) / "view.html", FIELDS.get(name, ""))
    save_frames(frames, SECONDS, f"moving_{name}")


def save_frames(frames: list[Image.Image], seconds: float, name: str) -> None:
    """In the best quality that keeps the picture small."""
    output = ROOT / f"docs/img/{name}.webp"
    for quality in (75, 60, 45, 30, 15):
        frames[0].save(output, save_all=True, append_images=frames[1:], duration=round(1000 * seconds / len(frames)),
                       loop=0, quality=quality, method=4)  # fmt: skip
        if output.stat().st_size < MOST_BYTES:
            return
    raise RuntimeError(f"{output}: {output.stat().st_size} bytes, expected fewer than {MOST_BYTES}")
