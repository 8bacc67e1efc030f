"""Nothing that a rater gets tells whose motion it is; the owner's file does."""

import base64
import json
import os
import stat

import numpy as np
import pytest
from study_toys import METHODS, served, toy_study
from study_toys import Client as Rater
from viewer_windows import window

from sag.errors import SagError
from sag.study.folder import TRUTH, read_study
from sag.study.sessions import all_scenes, page_for, session_of
from sag.study.store import Rater as Enrolled

NAMED = ("csgn_as_published", "without_geometry", "everything_on")
"""Methods whose names cannot stand in base64 by chance."""


def everything_shown(study) -> str:
    """All that a rater may ever get, without scripts that are the same in every study."""
    page = page_for(study, session_of(study, Enrolled("ann", 3, "file", "")), all_scenes(study))
    return page.partition("<style>")[0] + page.partition('<script id="session"')[2].rpartition("<script>")[0]


def test_nothing_that_is_shown_tells_the_method(tmp_path):
    facts = {"data": "rooms_of_ours", "fingerprint": "fingerprint-of-ours", "windows": (98765431, 98765432, 98765433)}
    study = toy_study(tmp_path / "study", methods=NAMED, **facts)
    shown = everything_shown(study)
    telling = [*NAMED, "csgn", TRUTH, "ground truth", "room 1", *map(str, (*facts["windows"], facts["data"]))]
    assert [word for word in telling if word in shown] == []
    assert all(word in (study.folder / "private/study.json").read_text() for word in (*NAMED, TRUTH))
    for scene in json.loads(all_scenes(study)).values():
        assert [row["name"] for row in scene["rows"]] == [""] and scene["name"] == "" and scene["truth"] is None
        assert {tuple(motion["figures"]) for motion in scene["rows"][0]["motions"]} == {()}
        assert {motion["touched"] for motion in scene["rows"][0]["motions"]} == {None}


def test_only_the_owner_can_read_the_key(study):
    private = study.folder / "private"
    assert stat.S_IMODE(os.stat(private).st_mode) == 0o700
    assert stat.S_IMODE(os.stat(private / "study.json").st_mode) == 0o600
    assert study.key.hex() not in everything_shown(study)


def test_the_owner_finds_the_right_motion_behind_every_name(study):
    for place, name in enumerate(study.scenes):
        scene = json.loads(all_scenes(study))[name]
        for motion, packed in zip(scene["motions"], scene["rows"][0]["motions"]):
            item = study.items[motion]
            assert item.scene == place
            made = window(rows=METHODS, samples=1)
            method = study.settings.methods[item.method]
            wanted = made.truth if method == TRUTH else made.rows[METHODS.index(method)].motions[0]
            steps = np.frombuffer(base64.b64decode(packed["joints"]["places"]), "<i2").reshape(wanted.joints.shape)
            assert np.abs(steps * packed["joints"]["step"] - wanted.joints).max() < 1e-3


def test_order_and_names_of_motions_differ_between_studies(tmp_path):
    """Where a motion stands in the page does not tell its method, even to who has made a study too."""
    orders = set()
    for turn in range(6):
        study = toy_study(tmp_path / f"{turn}", scenes=1, repeats=0)
        (scene,) = json.loads(all_scenes(study)).values()
        orders.add(tuple(study.items[motion].method for motion in scene["motions"]))
    assert len(orders) > 1


def test_turns_do_not_tell_methods_by_their_order(study):
    firsts = {study.items[study.session(rater)[0]].method for rater in range(40)}
    assert firsts == {0, 1, 2, 3}


def test_private_files_are_not_served(study):
    with served(study) as server:
        rater = Rater(server.server_address[1])
        for path in ("/private/study.json", "/../private/study.json", "/scenes/../../private/study.json", "/study.json",
                     "/scenes/%2e%2e/%2e%2e/private/study.json", "/public/page.html", "/scenes/"):  # fmt: skip
            status, body, _ = rater.ask("GET", path)
            assert status == 404 and b"key" not in body


def test_a_note_is_text(tmp_path):
    study = toy_study(tmp_path / "s", note="Please <b>read</b>.\n\nThank you & goodbye.")
    page = page_for(study, None)
    assert "<p>Please &lt;b&gt;read&lt;/b&gt;.</p><p>Thank you &amp; goodbye.</p>" in page


def test_a_study_comes_back_from_its_folder(study):
    again = read_study(study.folder)
    assert again == study and again.session(5) == study.session(5)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"format": 1}', '{"format": 9, "key": "00"}'])
def test_a_damaged_private_file_is_named(study, text):
    (study.folder / "private/study.json").write_text(text)
    with pytest.raises(SagError, match=r"private/study\.json (cannot be read|is of format 9)"):
        read_study(study.folder)


def test_a_study_is_not_written_over(study):
    with pytest.raises(SagError, match="holds a study already"):
        toy_study(study.folder)
