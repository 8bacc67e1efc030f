"""Motions on disk: read back as written, and refused in one sentence where they do not fit the data set."""

from pathlib import Path

import numpy as np
import pytest

from sag.data.motion_file import MotionFile, read_motions, write_motions
from sag.errors import SagError


@pytest.fixture
def joints(toy) -> np.ndarray:
    """The true motions of the test windows, two samples of each."""
    rows = toy.cache.rows("test")
    return np.repeat(toy.cache.joints[rows][:, None], 2, axis=1)


def saved(path: Path, **arrays: object) -> Path:
    np.savez(path / "motions.npz", **arrays)
    return path / "motions.npz"


def test_comes_back_as_it_was_written(toy, joints, tmp_path):
    path = tmp_path / "made.npz"
    rows = toy.cache.rows("test")
    write_motions(path, MotionFile(path, joints, rows, 30.0, "gta_im_19"))
    read = read_motions(path)
    assert np.array_equal(read.joints, joints) and np.array_equal(read.index, rows)
    assert (read.fps, read.skeleton) == (30.0, "gta_im_19")


def test_without_an_index_there_is_one_motion_for_each_test_window_in_order(toy, joints, tmp_path):
    read = read_motions(saved(tmp_path, joints=joints[:, 0]))
    assert read.joints.shape == (4, 1, 65, 19, 3)
    assert read.by_window(toy) == {int(row): place for place, row in enumerate(toy.cache.rows("test"))}


def test_an_index_may_name_some_of_the_windows_in_any_order(toy, joints, tmp_path):
    rows = toy.cache.rows("test")
    read = read_motions(saved(tmp_path, joints=joints[[3, 1]], index=rows[[3, 1]]))
    assert read.by_window(toy) == {int(rows[3]): 0, int(rows[1]): 1}


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda a: a | {"joints": a["joints"][:, :, 1:]}, r"must be \(n, 65, j, 3\)"),
        (lambda a: a | {"joints": a["joints"].astype(int)}, "floating-point"),
        (lambda a: {"motion": a["joints"]}, "no array `joints`"),
        (lambda a: a | {"joints": a["joints"] * np.where(np.arange(4) == 2, np.nan, 1)[:, None, None, None, None]},
         "motion 2 has coordinates that are not finite"),
        (lambda a: a | {"joints": a["joints"][:0]}, "must be"),
        (lambda a: a | {"index": np.arange(3)}, "whole number for each motion"),
        (lambda a: a | {"fps": np.array([1, 2])}, "fps must be one number"),
    ],
    ids=["64 frames", "integers", "no joints", "NaN", "empty", "short index", "two fps"],
)  # fmt: skip
def test_refuses_to_read(change, sentence, joints, tmp_path):
    with pytest.raises(SagError, match=sentence):
        read_motions(saved(tmp_path, **change({"joints": joints})))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda a: a | {"joints": 1000 * a["joints"]}, "convert the joints to metres"),
        (lambda a: a | {"joints": a["joints"] + np.float32(3)}, "m from the window's own"),
        (lambda a: a | {"joints": a["joints"] * np.array([1, -1, 1], np.float32)}, "m from the window's own"),
        (lambda a: a | {"joints": a["joints"][:, :, :, :16]}, "16 joints, not the 19"),
        (lambda a: a | {"skeleton": np.array("prox_16")}, "of skeleton prox_16"),
        (lambda a: a | {"fps": np.array(20.0)}, "20 frames a second, toy has 30; resample"),
        (lambda a: {"joints": a["joints"][:3]}, "3 motions and no index, but toy has 4 test windows"),
        (lambda a: a | {"index": np.array([0, 13, 14, 15])}, "names 0, which is no test window"),
        (lambda a: a | {"index": np.array([12, 12, 13, 14])}, "a window twice"),
    ],
    ids=["millimetres", "elsewhere", "y up", "joints", "skeleton", "fps", "number", "unknown window", "twice"],
)
def test_refuses_what_does_not_fit_the_data_set(change, sentence, toy, joints, tmp_path):
    with pytest.raises(SagError, match=sentence):
        read_motions(saved(tmp_path, **change({"joints": joints}))).by_window(toy)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 cut", b"\x93NUMPY no"], ids=["empty", "cut zip", "no npy"])
def test_refuses_damaged_files(content, tmp_path):
    path = tmp_path / "damaged.npz"
    path.write_bytes(content)
    with pytest.raises(SagError, match=r"damaged\.npz"):
        read_motions(path)
    with pytest.raises(SagError, match="does not exist"):
        read_motions(tmp_path / "nothing.npz")


def test_executes_nothing(tmp_path):
    with pytest.raises(SagError, match="plain arrays"):
        read_motions(saved(tmp_path, joints=np.array([{"a": 1}], dtype=object)))
