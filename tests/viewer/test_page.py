"""The page as text: what it holds, that nothing leads out of it, and what is refused."""

import base64
import dataclasses
import hashlib
import html.parser
import json
import re

import numpy as np
import pytest
from viewer_windows import motion, scene, window

from sag.errors import SagError
from sag.viewer import ShownRow, page

HOSTILE = "</script><script>window.broken = 1</script><!-- \u2028 & \" '"


class Scripts(html.parser.HTMLParser):
    """Scripts and styles of a page as a browser finds them."""

    inside = ""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict, str]] = []
        self.metas: list[dict] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.inside = tag
        if tag in ("script", "style"):
            self.found.append((tag, dict(attrs), ""))
        if tag == "meta":
            self.metas.append(dict(attrs))

    def handle_endtag(self, tag):
        self.inside = ""

    def handle_data(self, data):
        if self.inside in ("script", "style"):
            tag, attributes, before = self.found[-1]
            self.found[-1] = tag, attributes, before + data


def content(text: str) -> dict:
    """The data of a page."""
    return json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL).group(1))


def joints_of(packed: dict) -> np.ndarray:
    steps = np.frombuffer(base64.b64decode(packed["places"]), "<i2")
    return steps.reshape(packed["shape"]) * packed["step"]


def test_motions_come_back_to_a_fraction_of_a_millimetre(skeleton):
    shown = window()
    (found,) = content(page([shown], skeleton, 30))["windows"]
    for row, told in zip(found["rows"][0]["motions"], shown.rows[0].motions):
        assert np.abs(joints_of(row["joints"]) - told.joints).max() < 2e-4
        assert np.frombuffer(base64.b64decode(row["touched"]), "<u2").tolist() == told.touched.tolist()
    assert np.abs(joints_of(found["truth"]["joints"]) - shown.truth.joints).max() < 2e-4
    depth = np.frombuffer(base64.b64decode(found["scene"]["depth"]), "<i2").reshape(found["scene"]["shape"])
    seen = scene().depth > 0
    assert (depth[seen] == np.round(1000 * scene().depth[seen])).all() and (depth[~seen] <= 0).all()


def test_no_name_leads_out_of_the_data(skeleton):
    text = page([window(HOSTILE, (HOSTILE,))], skeleton, 30, HOSTILE)
    plain = page([window()], skeleton, 30)
    assert [found[:2] for found in Scripts(text).found] == [found[:2] for found in Scripts(plain).found]
    assert Scripts(text).found[-1] == Scripts(plain).found[-1]
    told = content(text)
    assert told["title"] == told["windows"][0]["name"] == told["windows"][0]["rows"][0]["name"] == HOSTILE


def test_the_policy_allows_this_script_and_style_alone(skeleton):
    found = Scripts(page([window()], skeleton, 30))
    policy = next(meta["content"] for meta in found.metas if meta.get("http-equiv") == "Content-Security-Policy")
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'" and rules["img-src"] == "data:"
    for tag, attributes, text in found.found:
        if attributes.get("type") != "application/json":
            digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
            assert rules[f"{tag}-src"] == f"'sha256-{digest}'"


def test_it_names_no_other_place(skeleton):
    text = page([window()], skeleton, 30)
    assert not re.search(r"https?:|//[a-z]+\.|@import|url\(|fetch\(|XMLHttpRequest|WebSocket|<link[^>]+http", text)


def test_five_samples_of_a_full_window_are_under_three_megabytes(skeleton):
    shown = window(samples=5)
    noise = np.random.default_rng(0)
    full = dataclasses.replace(
        shown,
        picture=noise.integers(60, 90, (576, 1024, 3), dtype=np.uint8),
        scene=dataclasses.replace(scene(), depth=noise.uniform(1, 9, (288, 512)), hidden=np.zeros((288, 512), bool)),
    )
    assert len(page([full], skeleton, 30)) < 3e6


def test_many_windows_share_the_room(skeleton):
    wide = dataclasses.replace(scene(), depth=np.full((288, 512), 3.0), hidden=np.zeros((288, 512), bool))
    shown = [dataclasses.replace(window(f"room {place}"), scene=wide) for place in range(12)]
    found = content(page(shown, skeleton, 30))["windows"]
    assert {tuple(one["scene"]["shape"]) for one in found} == {(144, 256)}
    assert found[0]["scene"]["stride"] == 2


def test_a_window_may_lack_scene_and_truth(skeleton):
    bare = dataclasses.replace(window(), scene=None, truth=None)
    (found,) = content(page([bare], skeleton, 30))["windows"]
    assert found["scene"] is None and found["truth"] is None


def changed(**changes):
    """A window whose second motion is another."""
    first, second, *rest = window().rows[0].motions
    row = ShownRow("ours", (first, dataclasses.replace(second, **changes), *rest))
    return dataclasses.replace(window(), rows=(row,))


def broken(value: float) -> np.ndarray:
    joints = motion(1).joints.copy()
    joints[4, 2, 1] = value
    return joints


REFUSALS = {
    "nothing": (lambda: [], "at least one window"),
    "not a number": (lambda: [changed(joints=broken(np.nan))], "motion 2 of ours in room 1 has joints that"),
    "far away": (lambda: [changed(joints=broken(1e6))], "motion 2 of ours in room 1 has joints that"),
    "joints": (lambda: [changed(joints=motion(1).joints[:, :16])], "65 frames of 16 joints; a page needs frames of 19"),
    "frames": (lambda: [changed(joints=motion(1).joints[:9], touched=None)], "has not the 65 frames of the first"),
    "none": (lambda: [changed(joints=motion(1).joints[:0], touched=None)], "has 0 frames"),
    "counts": (lambda: [changed(touched=np.arange(3))], "has not the 65 frames"),
    "ten": (lambda: [window(samples=10)], "ours has 10 motions in room 1; a page shows 1 to 9"),
    "rows": (lambda: [window(), window("room 2", ("theirs",))], "room 2: its rows must be those of room 1"),
    "names": (lambda: [window(rows=("ours", "ours"))], "each with a name of its own"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, skeleton):
    made, said = REFUSALS[name]
    with pytest.raises(SagError, match=re.escape(said)):
        page(made(), skeleton, 30)
