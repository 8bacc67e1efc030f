"""The page in a real browser: it loads, plays, scrubs, switches, asks for nothing, and shows what it should."""

import io
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from chromium import Tab, found_browser, opened_tab
from PIL import Image
from viewer_windows import INTRINSICS, scene, window

from sag.metrics import collision_counts
from sag.skeleton import GTA_IM_19
from sag.viewer import page
from sag.viewer.figures import TOUCH

BROWSER = found_browser()

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")

HOSTILE = "</script><img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("pages")


@pytest.fixture(scope="module")
def file(folder) -> Path:
    """Two windows of two rows, one of them with a hostile name."""
    path = folder / "page.html"
    windows = [window("room 1", ("ours", HOSTILE)), window("room 2", ("ours", HOSTILE))]
    path.write_text(page(windows, GTA_IM_19, 30, HOSTILE))
    return path


@pytest.fixture(scope="module")
def tabs(folder):
    """A browser for all tests."""
    with opened_tab(BROWSER, folder / "profile") as tab:
        yield tab


@pytest.fixture
def tab(tabs: Tab, file: Path) -> Tab:
    """The page, just opened at the size of a desktop, standing still."""
    tabs.browser.events.clear()
    tabs.media(prefers_reduced_motion="reduce", prefers_color_scheme="light")
    tabs.size(1200, 760)
    show(tabs, file)
    return tabs


def show(tab: Tab, file: Path) -> None:
    tab.open(file)
    tab.until("window.sagViewer && sagViewer.drawn > 0")
    settle(tab)


def settle(tab: Tab) -> None:
    """Waits until all that was asked for is drawn."""
    tab.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    tab.until("!sagViewer.stale")


def pixels(tab: Tab, path: Path) -> np.ndarray:
    settle(tab)
    tab.screenshot(path)
    return np.asarray(Image.open(io.BytesIO(path.read_bytes())).convert("RGB")).astype(int)


def blueish(shot: np.ndarray) -> int:
    """Pixels of the scene that have the hue of the first sample."""
    red, green, blue = (shot[60:600, :700, channel] for channel in range(3))
    return int(((blue - red > 60) & (green - red > 35) & (blue > green)).sum())


def test_it_loads_in_silence_and_asks_for_nothing(tab, file):
    assert tab.value("document.title") == HOSTILE
    assert tab.value("document.querySelectorAll('img').length") == 0
    assert [option for option in tab.value("[...document.querySelectorAll('#row option')].map(o => o.text)")] == [
        "ours",
        HOSTILE,
    ]
    assert tab.complaints() == []
    assert set(tab.requests()) == {file.resolve().as_uri()}


def test_the_policy_holds_against_the_page_itself(tab):
    refused = """new Promise(done => {
        document.addEventListener('securitypolicyviolation', event => done(event.violatedDirective));
        fetch('http://127.0.0.1:9/').catch(() => 0); })"""
    assert tab.value(refused) == "connect-src"
    assert not [url for url in tab.requests() if url.startswith("http")]


def test_it_plays_and_pauses_by_key_and_button(tab):
    assert tab.value("sagViewer.state.playing") is False
    tab.press(" ", "Space")
    tab.until("sagViewer.frame > 3")
    tab.value("document.getElementById('play').click()")
    settle(tab)
    frame = tab.value("sagViewer.state.time")
    time.sleep(0.2)
    assert tab.value("sagViewer.state.time") == frame > 0


def test_it_plays_by_itself_unless_motion_is_unwanted(tabs, file):
    tabs.media(prefers_reduced_motion="no-preference")
    tabs.size(600, 500)
    show(tabs, file)
    tabs.until("sagViewer.frame > 1")


def test_it_begins_anew_after_the_end(tab):
    tab.value("sagViewer.seek(64), sagViewer.play(true)")
    tab.until("sagViewer.frame < 20")


def test_frames_by_slider_and_keys(tab):
    tab.value("(s => { s.value = 30; s.dispatchEvent(new Event('input')); })(document.getElementById('frame'))")
    settle(tab)
    assert tab.value("sagViewer.frame") == 30
    assert tab.value("document.getElementById('clock').textContent") == "1.00 s"
    for key in ("ArrowRight", "ArrowRight", "ArrowLeft"):
        tab.press(key)
    assert tab.value("sagViewer.frame") == 31
    tab.press("End")
    assert tab.value("sagViewer.frame") == 64
    tab.press("Home")
    settle(tab)
    assert tab.value("[sagViewer.frame, document.getElementById('frame').value]") == [0, "0"]


def test_speed_by_keys_and_choice(tab):
    tab.press("[")
    assert tab.value("sagViewer.state.speed") == 0.5
    for _ in range(9):
        tab.press("]")
    assert tab.value("[sagViewer.state.speed, document.getElementById('speed').value]") == [2, "2"]


def test_samples_are_switched_and_vanish(tab, tmp_path):
    tab.value("sagViewer.set({touches: false})")
    before = blueish(pixels(tab, tmp_path / "with.png"))
    tab.press("1")
    hidden = blueish(pixels(tab, tmp_path / "without.png"))
    assert before > 500 and hidden < 0.1 * before
    assert tab.value("document.querySelector('#figures tbody input').checked") is False
    tab.value("document.querySelector('#figures tbody input').click()")
    assert blueish(pixels(tab, tmp_path / "again.png")) > 0.9 * before


def test_the_recorded_motion_is_switched(tab, tmp_path):
    before = pixels(tab, tmp_path / "before.png")
    tab.press("g")
    assert tab.value("document.getElementById('truth-button').getAttribute('aria-pressed')") == "true"
    assert (np.abs(pixels(tab, tmp_path / "after.png") - before).sum(-1) > 60).sum() > 300


def test_rows_and_windows_are_switched(tab):
    figures = "[...document.querySelectorAll('#figures tbody tr')].map(line => line.cells[2].textContent)"
    assert tab.value(figures) == ["1.0", "2.0", "3.0", "100.0"]
    tab.press("ArrowDown")
    assert tab.value("sagViewer.state.row") == 1
    assert tab.value(figures) == ["11.0", "12.0", "13.0", "100.0"]
    tab.press("2")
    tab.press(">", shift=True)
    settle(tab)
    assert tab.value("[sagViewer.state.window, sagViewer.state.row]") == [1, 1]
    assert tab.value("sagViewer.state.shown") == [True, False, True, False]
    for name in ("row", "window"):
        choose = "(s => { s.value = 0; s.dispatchEvent(new Event('change')); })"
        tab.value(f"{choose}(document.getElementById('{name}'))")
    assert tab.value("[sagViewer.state.window, sagViewer.state.row]") == [0, 0]


def test_a_guess_of_the_depth_is_told_and_seen_from_the_camera(tabs, folder):
    path = folder / "guessed.html"
    path.write_text(page([replace(window("photo 0"), guessed=True)], GTA_IM_19, 30))
    show(tabs, path)
    assert "All surfaces are a guess" in tabs.value("document.getElementById('legend').textContent")
    assert tabs.value("sagViewer.state.touches") is False
    eye = tabs.value("[sagViewer.orbit.azimuth, sagViewer.orbit.elevation]")
    tabs.press("0")
    assert tabs.value("[sagViewer.orbit.azimuth, sagViewer.orbit.elevation]") == eye
    tabs.press("r")
    assert tabs.value("[sagViewer.orbit.azimuth, sagViewer.orbit.elevation]") != eye


def test_points_light_up_as_the_metric_counts_them(tab):
    found = {}
    for frame in (0, 40, 64):
        tab.value(f"sagViewer.seek({frame})")
        settle(tab)
        found[frame] = tab.value("sagViewer.touching")
    depth = torch.from_numpy(scene().depth)
    bones = torch.as_tensor(GTA_IM_19.bone_index)
    for number, shown in enumerate(window().rows[0].motions):
        joints = torch.from_numpy(shown.joints[list(found)])
        wanted = collision_counts(joints, bones, depth, torch.from_numpy(INTRINSICS), (TOUCH,))[:, 0].tolist()
        assert [counts[number] for counts in found.values()] == pytest.approx(wanted, abs=2)
    assert min(found[64]) > 20 and max(found[0]) < 10


def test_collision_points_are_switched(tab, tmp_path):
    tab.value("sagViewer.seek(64)")
    lit = pixels(tab, tmp_path / "lit.png")
    tab.press("c")
    plain = pixels(tab, tmp_path / "plain.png")
    vermilion = [int(((x[..., 0] > 190) & (x[..., 1] < 110) & (x[..., 2] < 60)).sum()) for x in (lit, plain)]
    assert vermilion[0] > vermilion[1] + 50


def test_the_eye_orbits_follows_and_returns(tab):
    start = tab.value("sagViewer.orbit.azimuth")
    tab.drag((300, 300), (400, 330))
    assert tab.value("sagViewer.orbit.azimuth") > start + 0.3
    tab.press("ArrowLeft", shift=True)
    tab.press("+")
    tab.press("f")
    tab.value("sagViewer.seek(60)")
    settle(tab)
    off = "lengthOf(sub(sagViewer.orbit.target, scaled(sagViewer.bodies().map(b => jointOf(b.joints, content.root))"
    assert tab.value(f"{off}.reduce(add), 1 / 3)))") < 0.02
    tab.press("0")
    assert tab.value("lengthOf(sagViewer.orbit.eye)") < 1e-6
    tab.press("r")
    assert tab.value("sagViewer.orbit.azimuth") == pytest.approx(start)
    assert tab.value("sagViewer.state.follow") is False


def test_points_instead_of_surfaces(tab, tmp_path):
    before = pixels(tab, tmp_path / "surfaces.png")
    tab.press("t")
    assert (np.abs(pixels(tab, tmp_path / "points.png") - before).sum(-1) > 0).sum() > 300


def test_the_motion_runs_in_the_picture_too(tab):
    drawn = "document.getElementById('picture').toDataURL()"
    first = tab.value(drawn)
    tab.value("sagViewer.seek(50)")
    settle(tab)
    assert tab.value(drawn) != first


def test_help_opens_by_key_and_closes(tab):
    tab.press("?")
    assert tab.value("document.getElementById('help').open") is True
    tab.press(" ", "Space")
    assert tab.value("sagViewer.state.playing") is False
    tab.press("Escape")
    tab.until("!document.getElementById('help').open")


def test_every_control_has_a_name(tab):
    nodes = tab.call("Accessibility.getFullAXTree")["nodes"]
    kinds = ("button", "checkbox", "combobox", "slider", "image")
    named = {kind: [] for kind in kinds}
    for node in nodes:
        kind = node.get("role", {}).get("value")
        if kind in named:
            named[kind].append(node.get("name", {}).get("value", ""))
    assert all(named[kind] and all(named[kind]) for kind in kinds), named
    assert "sample 1" in " ".join(named["checkbox"])


def test_it_fits_a_phone_and_answers_to_a_finger(tabs, file, tmp_path):
    tabs.media(prefers_reduced_motion="reduce", prefers_color_scheme="dark")
    tabs.size(375, 667, phone=True)
    show(tabs, file)
    assert tabs.value("document.documentElement.scrollWidth") <= 375
    assert tabs.value("document.getElementById('play').getBoundingClientRect().bottom") <= 667
    dark = pixels(tabs, tmp_path / "phone.png")
    assert dark[4, 4].max() < 60
    start = tabs.value("sagViewer.orbit.azimuth")
    for kind, x in (("touchStart", 100), ("touchMove", 160), ("touchMove", 220), ("touchEnd", None)):
        tabs.call("Input.dispatchTouchEvent", type=kind, touchPoints=[] if x is None else [{"x": x, "y": 250}])
    assert tabs.value("sagViewer.orbit.azimuth") != start
    distance = tabs.value("sagViewer.orbit.distance")
    for kind, gap in (("touchStart", 20), ("touchMove", 60), ("touchMove", 100), ("touchEnd", None)):
        fingers = [] if gap is None else [{"x": 180 + side * gap, "y": 250, "id": side} for side in (-1, 1)]
        fingers = [{**finger, "id": place} for place, finger in enumerate(fingers)]
        tabs.call("Input.dispatchTouchEvent", type=kind, touchPoints=fingers)
    assert tabs.value("sagViewer.orbit.distance") < distance
    tabs.size(1200, 760)


def test_without_webgl_it_says_so_and_goes_on(folder, file):
    with opened_tab(BROWSER, folder / "without", "--disable-3d-apis") as tab:
        tab.media(prefers_reduced_motion="reduce")
        tab.size(900, 700)
        show(tab, file)
        assert "shows no WebGL 2" in tab.value("document.getElementById('missing').innerText")
        before = tab.value("document.getElementById('picture').toDataURL()")
        tab.value("sagViewer.seek(40)")
        settle(tab)
        assert tab.value("document.getElementById('picture').toDataURL()") != before
