"""Files in the place of a server: what comes back is checked as strictly."""

import json
import re

import pytest
from study_toys import inlined, toy_study

from sag.cli import main
from sag.errors import SagError
from sag.study.handouts import read_returned, write_handouts
from sag.study.store import Store


@pytest.fixture
def store(study):
    return Store(study.answers)


@pytest.fixture
def sessions(study, store, tmp_path):
    """What the files of two raters hold."""
    return [inlined(path.read_text(), "session") for path in write_handouts(study, store, 2, tmp_path / "files")]


def returned(study, session, path, count: int = 3, /, **changes):
    """The file that a rater sends back after some answers."""
    answers = [
        {"turn": turn, "scores": {"scene": 1 + place % 5, "human": 5}, "seconds": 4.5, "plays": 1}
        for place, (turn, *_) in enumerate(session["turns"][:count])
    ]
    path.write_text(json.dumps({"study": study.name, "rater": session["rater"], "answers": answers, **changes}))
    return path


def test_a_file_carries_everything_and_each_rater_has_one(study, store, tmp_path):
    paths = write_handouts(study, store, 3, tmp_path / "files")
    assert len({path.name for path in paths}) == 3
    text = paths[0].read_text()
    assert sorted(inlined(text, "scenes")) == sorted(study.scenes) and len(text) < 3e6
    assert inlined(text, "session")["place"] == "file"
    markup = re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)
    assert not re.search(r"https?:|src=|url\(", markup)
    assert [rater.place for rater in store.raters().values()] == ["file"] * 3


def test_answers_come_back(study, store, sessions, tmp_path):
    files = [returned(study, session, tmp_path / f"{place}.json") for place, session in enumerate(sessions)]
    found = read_returned(study, store.raters(), files)
    assert len(found) == 6 and {one.rater for one in found} == set(store.raters())
    assert [one.scores["scene"] for one in found[:3]] == [1, 2, 3]
    assert [one.item for one in found[:3]] == study.session(0)[:3]


def test_a_file_that_comes_twice_or_with_more_counts_once(study, store, sessions, tmp_path):
    less, more = (returned(study, sessions[0], tmp_path / f"{count}.json", count) for count in (2, 5))
    assert len(read_returned(study, store.raters(), [less, more, less])) == 5


def changed(session, **changes):
    """A file with one answer that was changed."""
    turn = session["turns"][0][0]
    return [{"turn": turn, "scores": {"scene": 3, "human": 3}, "seconds": 1, "plays": 1, **changes}]


FORGERIES = {
    "scores": (lambda mine, other: {"answers": changed(mine, scores={"scene": 6, "human": 3})}, "that cannot be one"),
    "turn": (lambda mine, other: {"answers": changed(mine, turn="0.forged")}, "is not signed by this study"),
    "rater": (lambda mine, other: {"rater": other["rater"]}, "is not signed by this study"),
    "no rater": (lambda mine, other: {"rater": None}, "is not signed by this study"),
    "study": (lambda mine, other: {"study": "another"}, "is of another study"),
    "twice": (lambda mine, other: {"answers": changed(mine) * 2}, "answers motion 1 twice"),
    "no answers": (lambda mine, other: {"answers": None}, "is no file of answers"),
    "no object": (lambda mine, other: {"answers": [3]}, "an answer that cannot be one"),
}  # fmt: skip


@pytest.mark.parametrize("name", FORGERIES)
def test_forgeries_are_refused_by_name(study, store, sessions, tmp_path, name):
    make, said = FORGERIES[name]
    file = returned(study, sessions[0], tmp_path / "answers-x.json", **make(*sessions))
    with pytest.raises(SagError, match=rf"answers-x\.json.*{said}|answers-x\.json {said}"):
        read_returned(study, store.raters(), [file])


def test_files_of_another_key_or_of_the_server_are_refused(study, store, sessions, tmp_path):
    other = toy_study(tmp_path / "other")
    (path,) = write_handouts(other, Store(other.answers), 1, tmp_path / "theirs")
    stranger = returned(study, inlined(path.read_text(), "session"), tmp_path / "stranger.json")
    served = store.enrol("server")
    token = study.signer.session(served.name)
    session = {"rater": token, "turns": [[study.signer.turn(served.name, 0, study.session(served.number)[0])]]}
    for file in (stranger, returned(study, session, tmp_path / "served.json")):
        with pytest.raises(SagError, match="is not signed by this study"):
            read_returned(study, store.raters(), [file])


def test_files_that_contradict_each_other_are_refused(study, store, sessions, tmp_path):
    first = returned(study, sessions[0], tmp_path / "first.json")
    second = returned(study, sessions[0], tmp_path / "second.json", answers=changed(sessions[0]))
    with pytest.raises(SagError, match=r"second\.json answers motion 1 of rater \w+ otherwise"):
        read_returned(study, store.raters(), [first, second])


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff\xfe", b"{}", b"[" * 100_000, b'{"answers": 3}'])
def test_what_is_no_file_of_answers_is_named(study, store, tmp_path, content):
    (tmp_path / "x.json").write_bytes(content)
    with pytest.raises(SagError, match=r"x\.json is no file of answers"):
        read_returned(study, store.raters(), [tmp_path / "x.json"])


def test_the_command_writes_files(study, tmp_path, capsys):
    assert main(["study", "files", str(study.folder), "--raters", "2", "--out", str(tmp_path / "f")]) == 0
    assert "2 files are in" in capsys.readouterr().out and len(list((tmp_path / "f").glob("study-*.html"))) == 2
    assert main(["study", "files", str(study.folder), "--raters", "0"]) == 2
    assert "--raters is 0" in capsys.readouterr().err
