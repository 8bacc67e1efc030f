"""What is filmed for a layout, and where it is written."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sag.cli import main
from sag.data.layouts import LAYOUTS, Script, write_layout
from sag.data.layouts.script import FilmedRoom, filmed
from sag.data.rooms.windows import usable_starts
from sag.data.workers import shared_out
from sag.errors import SagError

SCRIPT = Script(rooms=2, recordings=2, seconds=2.5)


@pytest.fixture(scope="module")
def scene() -> FilmedRoom:
    return filmed(SCRIPT, 1)


def test_a_script_is_filmed_the_same_every_time(scene: FilmedRoom) -> None:
    again = filmed(SCRIPT, 1).recordings
    other = filmed(Script(rooms=2, recordings=1, seconds=2.5, seed=1), 1).recordings
    assert [len(r.joints) for r in again] == [len(r.contact) for r in again] == [75, 75]
    assert all(np.array_equal(a.joints, b.joints) for a, b in zip(scene.recordings, again))
    assert not np.array_equal(again[0].joints, other[0].joints)


def test_what_is_kept_has_windows(scene: FilmedRoom) -> None:
    counts = [len(list(usable_starts(r, scene.scenery, Counter()))) for r in scene.recordings]
    assert counts == sorted(counts, reverse=True) and counts[-1] >= 2


def test_recordings_have_cameras_of_their_own_or_share_one_with_the_lens_that_is_asked_for(scene: FilmedRoom) -> None:
    own = {tuple(r.camera.place) for r in scene.recordings}
    shared = {(*r.camera.place, r.camera.field) for r in filmed(SCRIPT, 0, field=0.9).recordings}
    assert len(own) == 2 and len(shared) == 1 and shared.pop()[-1] == 0.9


def test_no_recording_is_longer_than_it_was_acted() -> None:
    (recording,) = filmed(Script(rooms=1, recordings=1, seconds=60.0), 0).recordings
    assert 3 * 30 <= len(recording.joints) <= 5 * 30


@pytest.mark.parametrize(
    "wrong",
    [{"rooms": 0}, {"recordings": 0}, {"every": 0}, {"seconds": 2.0}, {"size": (100, 100)}, {"size": (9, 16)}],
)
def test_impossible_scripts_are_refused_by_the_name_of_the_option(wrong: dict[str, object]) -> None:
    with pytest.raises(SagError, match=f"^--{next(iter(wrong))} must"):
        Script(**{"rooms": 1, **wrong})


@pytest.mark.parametrize("workers", [1, 2])
def test_work_comes_back_in_order(workers: int) -> None:
    assert list(shared_out(abs, 5, workers, "counting")) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("name", LAYOUTS)
def test_nothing_is_written_over_and_too_many_rooms_are_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("kept")
    with pytest.raises(SagError, match="full is not empty"):
        write_layout(name, tmp_path / "full", Script(rooms=1))
    with pytest.raises(SagError, match=f"--rooms must be at most {LAYOUTS[name].rooms}"):
        write_layout(name, tmp_path / "new", Script(rooms=99))
    assert [p.name for p in tmp_path.rglob("*")] == ["full", "mine.txt"]


def test_what_is_interrupted_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("sag.data.layouts.shared_out", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_layout("gta-im", tmp_path / "new", Script(rooms=1))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["--layout", "gta-im"], "needs the folder"), (["somewhere"], "with --layout only")],
)
def test_the_command_asks_for_both_the_layout_and_its_folder(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["data", "rooms", *arguments]) == 2
    assert said in capsys.readouterr().err
