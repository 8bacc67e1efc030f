"""An interruption anywhere in a commit of the conversion leaves a journal from which the same cache is made."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from gta_im_files import COLUMNS, ROWS, Sequence, module
from PIL import Image

from sag.data.cache import WindowCache
from sag.data.gta_im import GtaImDataModule
from sag.data.recordings.scratch import JOURNAL, Scratch

SHAPES = {"split": (9,), "cloud_row": (9,)}
FSYNC = os.fsync


@pytest.fixture
def synced(monkeypatch) -> Callable[[int, bool], list[str]]:
    """Interrupts the so-manieth sync of a journal, before or after it; tells the files that were synced."""
    files: list[str] = []

    def interrupt(call: int, after: bool) -> list[str]:
        files.clear()

        def fsync(descriptor: int) -> None:
            files.append(os.readlink(f"/proc/self/fd/{descriptor}"))
            if len(files) == call and not after:
                raise KeyboardInterrupt
            FSYNC(descriptor)
            if len(files) == call:
                raise KeyboardInterrupt

        monkeypatch.setattr("os.fsync", fsync)
        return files

    return interrupt


@pytest.fixture(scope="module")
def root(tmp_path_factory) -> Path:
    """Two recordings of 12 windows, which are committed in two goes; in one of them the person is hidden."""
    made = tmp_path_factory.mktemp("interrupted") / "root"
    for name, room in (("a", 1), ("b", 13)):
        Sequence(68).write(made / "FPS-30" / name, room, pictured=range(4))
    Image.fromarray(np.zeros((ROWS, COLUMNS, 3), np.uint8)).save(made / "FPS-30" / "a" / "00002_id.png")
    return made


def made(root: Path, cache_dir: Path) -> GtaImDataModule:
    return module(root, cache_dir, stride=1, image_size=(18, 32))


def content(cache: WindowCache) -> dict[str, bytes]:
    """Every file of a cache but the one that tells when the others were verified."""
    return {path.name: path.read_bytes() for path in cache.folder.iterdir() if path.name != "verified.json"}


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="tells the files that are synced by /proc")
@pytest.mark.parametrize("after", [False, True], ids=["before", "after"])
def test_an_interruption_in_any_sync_changes_no_byte_of_the_cache(root, tmp_path, synced, after):
    files = synced(0, after)
    whole = content(made(root, tmp_path / "whole").build())
    count = len(files)
    assert sum(Path(name).name == JOURNAL for name in files) >= 2
    for call in range(1, count + 1):
        synced(call, after)
        with pytest.raises(KeyboardInterrupt):
            made(root, tmp_path / str(call)).build()
        synced(0, after)
        assert content(made(root, tmp_path / str(call)).build()) == whole


@pytest.mark.parametrize("after", [False, True], ids=["before", "after"])
def test_what_a_commit_was_about_when_it_was_interrupted_is_not_committed_again(tmp_path, synced, after):
    first = Scratch(tmp_path, SHAPES)
    first.keep({"split": 1})
    first.keep({"split": 2})
    synced(1, after)
    with pytest.raises(KeyboardInterrupt):
        first.commit()
    first.commit()
    second = Scratch(tmp_path, SHAPES)
    assert len(second.outcomes) == 2 and second.filled()["split"].tolist() == [1, 2]


def test_an_interruption_while_arrays_are_written_forgets_the_windows(tmp_path, monkeypatch):
    first = Scratch(tmp_path, SHAPES)
    first.keep({"split": 1})
    with monkeypatch.context() as patched:
        patched.setattr(np.memmap, "flush", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            first.commit()
    first.commit()
    assert Scratch(tmp_path, SHAPES).outcomes == []


@pytest.mark.parametrize("wrong", ["again", "gap", "older"])
def test_lines_that_are_not_the_next_ones_are_not_believed(tmp_path, wrong):
    first = Scratch(tmp_path, SHAPES)
    for split in range(4):
        first.keep({"split": split})
    first.commit()
    lines = (tmp_path / JOURNAL).read_text().splitlines()
    changed = {
        "again": [*lines[:2], *lines[:2]],
        "gap": [*lines[:2], *lines[3:]],
        "older": [*lines[:2], *(json.dumps(json.loads(line)[1]) for line in lines[2:])],
    }
    (tmp_path / JOURNAL).write_text("\n".join(changed[wrong]) + "\n")
    assert len(Scratch(tmp_path, SHAPES).outcomes) == 2
