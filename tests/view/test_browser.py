"""The page of `ilaw view` in Chromium without a window: it draws, plays, and asks the network for nothing."""
# SPDX-License-Identifier: BSD-3-Clause

import re

import browser
import pytest
from page import RESTING, TWO_BOXES, Page, run, view

pytestmark = pytest.mark.skipif(not browser.find(), reason="no Chromium here: apt-get install chromium")


@pytest.fixture(scope="module")
def chromium():
    with browser.Browser() as opened:
        yield opened


def open_page(chromium, scene, folder):
    results = run(scene, folder)
    done = view(results, "-o", folder / "run.html")
    assert (done.returncode, done.stderr) == (0, "")
    chromium.complaints.clear(), chromium.addresses.clear()
    chromium.open(folder / "run.html")
    chromium.evaluate("ilawView.ready")
    return Page(folder / "run.html")


@pytest.fixture(scope="module")
def boxes(chromium, tmp_path_factory):
    return open_page(chromium, TWO_BOXES, tmp_path_factory.mktemp("boxes"))


PICTURE = "(ilawView.draw(), document.querySelector('#stage canvas').toDataURL())"


def test_loads_without_a_complaint_or_the_network(chromium, boxes):
    assert chromium.complaints == []
    assert len(chromium.addresses) == 1 and chromium.addresses[0].startswith("file://")
    # A title with marks of HTML is text.
    assert chromium.evaluate("document.querySelector('h1').textContent") == TWO_BOXES["title"]


def test_has_the_frames_and_bodies_of_the_run(chromium, boxes):
    assert chromium.evaluate("Number(document.getElementById('slider').max)") == boxes.frames - 1
    assert chromium.evaluate("ilawView.model.bodies.map(body => body.name)") == ["lower", "upper"]
    assert chromium.evaluate("ilawView.model.obstacles.map(o => o.name)") == ["floor"]
    assert chromium.evaluate("document.getElementById('events').children.length") == len(boxes.run["events"])
    assert chromium.evaluate("document.querySelectorAll('aside canvas').length") == len(boxes.run["curves"])


def test_legends_cover_no_body(chromium, boxes):
    box = "(e => (b => [b.left, b.top, b.right, b.bottom])(document.getElementById(e).getBoundingClientRect()))"
    stage, *legends = [chromium.evaluate(f"{box}('{name}')") for name in ("stage", "legend", "moment")]
    for legend in legends:
        assert legend[0] >= stage[2] or legend[1] >= stage[3], (stage, legend)
    # All of the bodies and the floor below them are in the picture, at the start and at the end.
    inside = """ilawView.show(FRAME), (a => { let most = 0; for (let i = 0; i < a.length; i += 3) {
        const x = new THREE.Vector3(a[i], a[i + 1], a[i + 2]).project(ilawView.camera);
        most = Math.max(most, Math.abs(x.x), Math.abs(x.y)); } return most; })(ilawView.model.place.array)"""
    for frame in (0, boxes.frames - 1):
        assert 0.2 < chromium.evaluate(inside.replace("FRAME", str(frame))) < 1.0


def test_shows_every_frame_where_the_data_have_it(chromium, boxes):
    x, u = boxes.array(boxes.film["points"]), boxes.channel(boxes.film["u"], 3)
    for frame in (0, boxes.frames // 2, boxes.frames - 1):
        chromium.evaluate(f"ilawView.show({frame})")
        shown = chromium.evaluate("Array.from(ilawView.model.place.array)")
        assert shown == pytest.approx((x + u[frame].ravel()).tolist(), abs=1e-6)
        told = chromium.evaluate("document.getElementById('told').textContent")
        assert f"frame {frame + 1} of {boxes.frames}" in told


def test_pictures_differ_in_time_color_scale_and_view(chromium, boxes):
    seen = set()
    middle = boxes.frames // 3
    steps = [
        "ilawView.show(0)", f"ilawView.show({boxes.frames - 1})", f"ilawView.show({middle})",
        "await ilawView.chooseField(-1)",
        "document.getElementById('arrows').click()",
        "document.getElementById('from').value = 'below'; document.getElementById('fit').click()",
        "document.getElementById('scale').value = 3; document.getElementById('scale').onchange()",
    ]  # fmt: skip
    for step in steps:
        chromium.evaluate(f"(async () => {{ {step}; }})()")
        seen.add(chromium.evaluate(PICTURE))
    assert len(seen) == len(steps)
    chromium.evaluate("ilawView.chooseField(0)")
    assert chromium.complaints == []


def test_every_field_can_be_shown_with_its_range(chromium, boxes):
    for k, field in enumerate(boxes.film["fields"]):
        chromium.evaluate(f"ilawView.chooseField({k})")
        bar = chromium.evaluate("document.getElementById('bar').textContent")
        assert field["label"] in bar and (field["name"] == "status" or "all times" in bar)
    assert chromium.complaints == []


def test_plays_to_the_end(chromium, boxes):
    chromium.evaluate("(document.getElementById('speed').value = '4', ilawView.show(0), ilawView.play(true))")
    look = "const look = () => ilawView.state.playing ? setTimeout(look, 50) : done(ilawView.state.position); look();"
    assert chromium.evaluate(f"new Promise(done => {{ {look} }})") == boxes.frames - 1
    assert chromium.complaints == []


def test_a_click_on_an_event_goes_there(chromium, boxes):
    k = len(boxes.run["events"]) // 2
    chromium.evaluate(f"document.getElementById('events').children[{k}].click()")
    assert chromium.evaluate("ilawView.state.shown") == pytest.approx(boxes.run["events"][k]["time"])


def test_points_in_two_dimensions_open(chromium, tmp_path):
    page = open_page(chromium, RESTING, tmp_path)
    assert chromium.evaluate("[ilawView.run.times.length, ilawView.model.bodies.length]") == [page.frames, 1]
    assert chromium.complaints == []
    assert "fields" in chromium.evaluate("document.querySelector('.note').textContent")


def test_the_page_without_its_data_is_below_three_megabytes(boxes):
    bare = re.sub(r'<script type="(text/plain|application/json)".*?</script>', "", boxes.text, flags=re.S)
    assert 5e5 < len(bare) < 3e6
