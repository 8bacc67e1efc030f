"""Checkpoints: every flipped bit and every missing end is noticed, and what was good before stays."""

from __future__ import annotations

import errno
import os
import random
import resource
import signal
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest
import torch

from sag.checkpoints import FOLDER, LAST, PREVIOUS, WholeCheckpoints, newest_good
from sag.errors import Damaged, Diverged, OutOfSpace, SagError
from sag.seal import read_sealed

FLIPS, CUTS = 120, 40

files = WholeCheckpoints()


def content(step: int, value: float = 1.0) -> dict:
    weights = torch.randn(40, 50, generator=torch.Generator().manual_seed(step))
    weights[0, 0] = value
    return {
        "state_dict": {"weights": weights, "steps": torch.tensor(step)},
        "global_step": step,
        "loops": {"a": [1, 2]},
    }


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run's folder with two generations of its checkpoint."""
    for step in (1, 2):
        files.save_checkpoint(content(step), tmp_path / FOLDER / LAST)
    return tmp_path


def step_of(path: Path) -> int:
    return files.load_checkpoint(path)["global_step"]


def names(run: Path) -> list[str]:
    return sorted(path.name for path in (run / FOLDER).iterdir())


def test_two_generations_are_kept(run: Path) -> None:
    assert names(run) == [LAST, PREVIOUS]
    assert [step_of(run / FOLDER / name) for name in names(run)] == [2, 1]
    files.save_checkpoint(content(3), run / FOLDER / LAST)
    assert [step_of(run / FOLDER / name) for name in names(run)] == [3, 2]


def test_other_programs_read_them(run: Path) -> None:
    assert torch.load(run / FOLDER / LAST, weights_only=True)["global_step"] == 2


def test_every_flipped_bit_is_noticed_and_the_one_before_is_found(
    run: Path, capsys: pytest.CaptureFixture[str], tally
) -> None:
    path = run / FOLDER / LAST
    whole, chance = path.read_bytes(), random.Random(0)
    ends = [*range(40), *range(len(whole) - 120, len(whole))]  # the first record, the last one and the seal, each byte
    places = [*ends, *(chance.randrange(len(whole)) for _ in range(FLIPS))]
    for place in places:
        damaged = bytearray(whole)
        damaged[place] ^= 1 << chance.randrange(8)
        path.write_bytes(damaged)
        with pytest.raises(Damaged, match=r"last\.ckpt"):
            files.load_checkpoint(path)
        tally["flips of checkpoints, all noticed"] += 1
    assert newest_good(run) == run / FOLDER / PREVIOUS
    assert "last.ckpt is not as it was written" in capsys.readouterr().err


def test_every_truncation_is_noticed(run: Path, tally) -> None:
    path = run / FOLDER / LAST
    whole, chance = path.read_bytes(), random.Random(1)
    sizes = [0, 1, *range(len(whole) - 110, len(whole)), *(chance.randrange(len(whole)) for _ in range(CUTS))]
    for size in sizes:
        path.write_bytes(whole[:size])
        with pytest.raises(Damaged, match=r"last\.ckpt"):
            files.load_checkpoint(path)
        assert newest_good(run) == run / FOLDER / PREVIOUS
        tally["cuts of checkpoints, all noticed, the one before found"] += 1
    path.write_bytes(whole + b"\0")
    with pytest.raises(Damaged):
        files.load_checkpoint(path)


def test_pytorch_alone_would_not_notice(run: Path) -> None:
    """The control: what the seal is for."""
    whole = (run / FOLDER / LAST).read_bytes()
    start = whole.index(content(2)["state_dict"]["weights"].numpy().tobytes())
    damaged = bytearray(whole)
    damaged[start + 100] ^= 1
    assert torch.load(BytesIO(damaged), weights_only=True)["global_step"] == 2


def test_a_damaged_one_does_not_take_the_place_of_a_good_one(run: Path) -> None:
    (run / FOLDER / LAST).write_bytes(b"rotten")
    files.save_checkpoint(content(3), run / FOLDER / LAST)
    assert [step_of(run / FOLDER / name) for name in names(run)] == [3, 1]


def test_without_any_good_one_there_is_none(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in names(run):
        (run / FOLDER / name).write_bytes(b"rotten")
    assert newest_good(run) is None
    said = capsys.readouterr().err
    assert LAST in said and PREVIOUS in said
    assert newest_good(run / "nothing") is None


def test_checkpoints_of_earlier_versions_are_read_with_a_notice(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    torch.save(content(7), tmp_path / "old.ckpt")
    assert step_of(tmp_path / "old.ckpt") == 7
    assert "without a checksum" in capsys.readouterr().err
    (tmp_path / "old.ckpt").write_bytes((tmp_path / "old.ckpt").read_bytes()[:-1])
    with pytest.raises(Damaged, match="cut short"):
        files.load_checkpoint(tmp_path / "old.ckpt")


class Gadget:
    """What would run a command when it is unpickled."""

    def __reduce__(self) -> tuple[Callable, tuple[str]]:
        return os.system, ("touch executed",)


def test_nothing_foreign_is_executed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    files.save_checkpoint({"state_dict": {}, "x": Gadget()}, tmp_path / "x.ckpt")
    with pytest.raises(Damaged, match=r"x\.ckpt"):
        files.load_checkpoint(tmp_path / "x.ckpt")
    assert not (tmp_path / "executed").exists()


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_weights_that_are_no_numbers_are_not_written(run: Path, value: float) -> None:
    with pytest.raises(Diverged, match="weights is no number any more at step 3"):
        files.save_checkpoint(content(3, value), run / FOLDER / LAST)
    assert [step_of(run / FOLDER / name) for name in names(run)] == [2, 1]


def full(*_: object, **__: object) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def sentence_of(run: Path) -> str:
    with pytest.raises(OutOfSpace) as refused:
        files.save_checkpoint(content(3), run / FOLDER / LAST)
    return str(refused.value)


@pytest.mark.parametrize("where", ["os.fsync", "pathlib.Path.replace", "sag.files._keep"])
def test_a_full_disk_leaves_the_one_before(run: Path, where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(where, full)
    said = sentence_of(run)
    assert "No space left" in said and "intact" in said and len(said.splitlines()) == 1
    assert names(run) == [LAST, PREVIOUS]
    assert [step_of(run / FOLDER / name) for name in names(run)] == [2, 1]


def test_a_file_that_may_not_grow_leaves_the_one_before(run: Path, tally) -> None:
    """At each of twenty sizes the system refuses the next byte in the midst of writing."""
    length = (run / FOLDER / LAST).stat().st_size
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    for size in range(0, length, length // 19):
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            said = sentence_of(run)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        assert "File too large" in said
        assert names(run) == [LAST, PREVIOUS]
        assert [step_of(run / FOLDER / name) for name in names(run)] == [2, 1]
        tally["sizes at which the disk is full, the one before intact"] += 1


def killed_before(call: int, path: Path) -> int:
    """Saves in a process that is killed before its so manieth call to the system; returns how it ended."""
    if not (child := os.fork()):
        calls = iter(range(call + 1))

        def counted(real: Callable) -> Callable:
            def counting(*arguments: object) -> object:
                if next(calls) == call:
                    os.kill(os.getpid(), signal.SIGKILL)
                return real(*arguments)

            return counting

        os.fsync, os.link, Path.replace = (counted(real) for real in (os.fsync, os.link, Path.replace))
        files.save_checkpoint(content(3), path)
        os._exit(0)
    return os.waitpid(child, 0)[1]


def test_a_process_killed_between_any_two_calls_leaves_a_good_one(run: Path) -> None:
    """fsync, link, rename of the one before, rename, fsync of the folder: killed before each of them."""
    found = []
    for call in range(5):
        assert killed_before(call, run / FOLDER / LAST) == signal.SIGKILL
        found.append([step_of(run / FOLDER / name) for name in (LAST, PREVIOUS)])
    assert found == [[2, 1], [2, 1], [2, 1], [2, 2], [3, 2]]
    files.save_checkpoint(content(4), run / FOLDER / LAST)
    assert names(run) == [LAST, PREVIOUS], "what the dead left half written is gone"


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(SagError, match=r"--ckpt_path .*none\.ckpt is no file"):
        files.load_checkpoint(tmp_path / "none.ckpt")
    with pytest.raises(FileNotFoundError):
        read_sealed(tmp_path / "none.ckpt")
