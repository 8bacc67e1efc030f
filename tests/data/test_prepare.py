"""The cache is the one that training builds, and an interrupted conversion goes on."""

import multiprocessing
import os
import shlex
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from gta_im_files import Sequence

from sag.data.command import main
from sag.data.gta_im import GtaImDataModule
from sag.data.gta_im.reader import GTA_IM
from sag.data.recordings.scratch import Scratch, scratch_folder
from sag.errors import SagError

OPTIONS = ["--image_size=[54,96]", "--data.init_args.stride", "1"]


@pytest.fixture
def root(tmp_path) -> Path:
    """Two recordings: four windows to train and validate on, four to test."""
    for name, room in (("a", 1), ("b", 13)):
        Sequence(68).write(tmp_path / "root" / "FPS-30" / name, room, pictured=range(4))
    return tmp_path / "root"


def trained(root: Path, cache_dir: Path, **options: object) -> GtaImDataModule:
    """The data module as training makes it."""
    return GtaImDataModule(root, cache_dir=cache_dir, **{"image_size": (54, 96), "stride": 1, **options})


@pytest.fixture
def interrupted(monkeypatch):
    """Reads windows until so many have been read, then is interrupted; tells how many were read."""
    read: list[int] = []

    def interrupt(after: int | None) -> list[int]:
        read.clear()

        def window(*arguments: object) -> dict[str, np.ndarray] | None:
            if after is not None and len(read) >= after:
                raise KeyboardInterrupt
            read.append(arguments[1])
            return stored(*arguments)

        monkeypatch.setitem(GTA_IM.__dict__, "window", window)
        return read

    stored = GTA_IM.window
    return interrupt


def test_training_finds_the_cache(root, tmp_path, capsys, monkeypatch):
    assert main(["prepare", str(root), "--out", str(tmp_path / "out"), *OPTIONS]) == 0
    said = capsys.readouterr().out
    (folder,) = (tmp_path / "out").iterdir()
    assert f"{folder}: " in said
    monkeypatch.setattr("sag.data.recordings.module.convert", lambda *_: pytest.fail("converted again"))
    assert trained(root, tmp_path / "out").build().folder == folder
    assert main(["prepare", str(root), "--out", str(tmp_path / "out"), *OPTIONS]) == 0


def test_the_command_that_is_told_holds_every_option(root, tmp_path, capsys):
    config = tmp_path / "mine.yaml"
    config.write_text("data: {init_args: {root: elsewhere, limits: {root_step: 0.25}, stride: 2}}\n")
    main(["prepare", str(root), "--out", str(tmp_path / "out"), *OPTIONS, "--config", str(config)])
    fit, run = capsys.readouterr().out.split("lies:\n")[1].replace("\\\n", "").strip().splitlines()
    assert shlex.split(fit)[:2] == ["sag", "fit"]
    assert set(shlex.split(fit)) - set(shlex.split(run)) == {"fit", "configs/methods/erd.yaml"}
    words = shlex.split(run)
    assert words[:2] == ["sag", "run"] and words[words.index(str(config)) - 1] == "--config"
    told = dict(word.removeprefix("--data.init_args.").split("=") for word in words if "=" in word)
    assert told == {
        "root": str(root),
        "cache_dir": str(tmp_path / "out"),
        "image_size": "[54, 96]",
        "stride": "1",
        "limits.root_step": "0.25",
    }


def test_pictures_are_those_of_a_laptops_preset_unless_asked(root, tmp_path, capsys):
    assert main(["prepare", str(root), "--out", str(tmp_path / "out"), "--stride", "1"]) == 0
    assert "configs/presets/quick.yaml" in capsys.readouterr().out
    (folder,) = (tmp_path / "out").iterdir()
    usual = trained(root, tmp_path / "out", image_size=(72, 128))
    assert usual.build().folder == folder


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--strid", "1"], r"--strid.*GtaImDataModule"),
        (["--stride", "many"], r"stride"),
        (["--stride", "0"], r"stride and cloud_step must be at least 1"),
        (["--config", "absent.yaml"], r"absent\.yaml cannot be read"),
    ],
)
def test_wrong_options_are_refused(root, options, said):
    with pytest.raises(SagError, match=said):
        main(["prepare", str(root), *options])


def test_an_interrupted_conversion_goes_on_with_the_same_bytes(root, tmp_path, interrupted, capsys):
    whole = trained(root, tmp_path / "whole").build()
    interrupted(after=5)
    with pytest.raises(KeyboardInterrupt):
        trained(root, tmp_path / "out").build()
    (folder,) = (tmp_path / "out").iterdir()
    assert folder.name == f"{whole.folder.name}.converting"
    capsys.readouterr()
    read = interrupted(after=None)
    resumed = trained(root, tmp_path / "out").build()
    assert "going on after 5 of 12 windows" in capsys.readouterr().out
    assert len(read) == 12 - 5 and resumed.fingerprint == whole.fingerprint
    assert [path.name for path in (tmp_path / "out").iterdir()] == [whole.folder.name]


@pytest.mark.parametrize(("after", "said"), [(5, "goes on with what is finished, in "), (0, "no window was finished")])
def test_an_interrupted_command_says_how_to_go_on(root, tmp_path, interrupted, capsys, after, said):
    interrupted(after=after)
    asked = ["prepare", str(root), "--out", str(tmp_path / "out"), *OPTIONS]
    assert main(asked) == 130
    assert said in capsys.readouterr().out
    interrupted(after=None)
    assert main(asked) == 0
    assert not list((tmp_path / "out").glob("*.converting"))


def test_a_killed_process_leaves_what_it_finished(root, tmp_path, capsys):
    whole = trained(root, tmp_path / "whole").build()
    child = multiprocessing.get_context("fork").Process(target=_killed_after, args=(root, tmp_path / "out", 10))
    child.start()
    child.join(60)
    assert child.exitcode == -signal.SIGKILL
    capsys.readouterr()
    assert trained(root, tmp_path / "out").build().fingerprint == whole.fingerprint
    assert "going on after 8 of 12 windows" in capsys.readouterr().out


def _killed_after(root: Path, cache_dir: Path, count: int) -> None:
    """Converts windows and is killed, without a chance to tidy up, before one more."""
    stored, read = GTA_IM.window, []

    def window(*arguments: object) -> dict[str, np.ndarray] | None:
        if len(read) >= count:
            time.sleep(0.5)  # until what was read before has been put away
            os.kill(os.getpid(), signal.SIGKILL)
        read.append(arguments)
        return stored(*arguments)

    GTA_IM.__dict__["window"] = window
    trained(root, cache_dir).build()


def test_a_changed_file_begins_anew(root, tmp_path, interrupted):
    interrupted(after=5)
    with pytest.raises(KeyboardInterrupt):
        trained(root, tmp_path / "out").build()
    (root / "FPS-30" / "a" / "00000.jpg").touch()
    read = interrupted(after=None)
    trained(root, tmp_path / "out").build()
    assert len(read) == 12


def test_a_line_that_was_cut_off_is_done_again(root, tmp_path, interrupted):
    whole = trained(root, tmp_path / "whole").build()
    interrupted(after=5)
    with pytest.raises(KeyboardInterrupt):
        trained(root, tmp_path / "out").build()
    (journal,) = (tmp_path / "out").glob("*/journal.jsonl")
    journal.write_text(journal.read_text()[:-9])
    read = interrupted(after=None)
    assert trained(root, tmp_path / "out").build().fingerprint == whole.fingerprint and len(read) == 8


def test_damaged_arrays_are_made_again(root, tmp_path, interrupted):
    whole = trained(root, tmp_path / "whole").build()
    interrupted(after=5)
    with pytest.raises(KeyboardInterrupt):
        trained(root, tmp_path / "out").build()
    (joints,) = (tmp_path / "out").glob("*/joints.npy")
    joints.write_bytes(joints.read_bytes()[:1000])
    read = interrupted(after=None)
    assert trained(root, tmp_path / "out").build().fingerprint == whole.fingerprint and len(read) == 12


def test_a_full_disk_is_told_before_anything_is_read(root, tmp_path, monkeypatch, interrupted):
    monkeypatch.setattr("shutil.disk_usage", lambda _: type("Usage", (), {"free": 1000})())
    read = interrupted(after=None)
    with pytest.raises(SagError, match=r"12 windows need .* GB in .*cache_dir"):
        trained(root, tmp_path / "out").build()
    assert read == [] and not list((tmp_path / "out").iterdir())


def test_what_is_not_committed_is_forgotten(tmp_path):
    shapes = {"split": (3,), "cloud_row": (3,)}
    first = Scratch(tmp_path, shapes)
    first.keep({"split": 1})
    first.drop("hidden", "where")
    first.commit()
    first.keep({"split": 2})
    second = Scratch(tmp_path, shapes)
    assert len(second.outcomes) == 2 and second.dropped == {"hidden": 1} and second.first("hidden") == "where"
    assert second.filled()["split"].tolist() == [1] and second.filled()["cloud_row"].tolist() == [-1]


def _hold(cache: Path, inside: multiprocessing.Event, leave: multiprocessing.Event) -> None:
    with scratch_folder(cache):
        inside.set()
        leave.wait(20)


def test_only_one_process_fills_a_folder(tmp_path, capsys):
    fork = multiprocessing.get_context("fork")
    inside, leave = fork.Event(), fork.Event()
    other = fork.Process(target=_hold, args=(tmp_path / "cache", inside, leave))
    other.start()
    assert inside.wait(20)
    fork.Process(target=_leave_soon, args=(leave,)).start()
    with scratch_folder(tmp_path / "cache") as folder:
        assert leave.is_set() and folder.is_dir()
    assert "waiting for another process" in capsys.readouterr().out
    other.join(20)
    assert not list(tmp_path.iterdir())


def _leave_soon(leave: multiprocessing.Event) -> None:
    time.sleep(0.3)
    leave.set()
