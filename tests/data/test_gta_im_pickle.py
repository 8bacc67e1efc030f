"""Recordings whose joints and cameras come from `info_frames.pickle` alone."""

import pickle
from pathlib import Path

import gta_im_files as files
import numpy as np
import pytest
from gta_im_files import Sequence, form, module
from scipy.spatial.transform import Rotation

from sag.data.gta_im.bones import BONES, FORWARD
from sag.data.gta_im.filters import usable_starts
from sag.data.gta_im.recording import Recording
from sag.data.recordings import filters as why
from sag.errors import SagError

OTHERS = [f"IK_{number}" for number in range(77)]
"""Names of bones that are not read: 98 with those that are."""


def told(sequence: Sequence, frame: int) -> dict[str, object]:
    """What the pickle says of a frame, its bones in an order of its own."""
    axes, place = files.camera(frame)
    turn = Rotation.from_matrix(axes.T) * FORWARD.inv()
    names = [*BONES, *OTHERS]
    joints = np.concatenate([sequence.joints[frame], np.zeros((len(OTHERS), 3))])
    order = np.random.default_rng(frame).permutation(len(names))
    return {
        **sequence.clips[frame],
        "time": f"{frame:05d}",
        "cam_pos": place.tolist(),
        "cam_rot": turn.as_euler("xyz", degrees=True),
        "cam_field_of_view": 50.0,
        "kpname": [names[bone] for bone in order],
        "kpvalue": joints[order].ravel().tolist(),
    }


def written(folder: Path, changes: dict[int, dict[str, object]] | None = None) -> Path:
    """A recording without its archive."""
    sequence = Sequence()
    Sequence().write(folder)
    (folder / "info_frames.npz").unlink()
    frames = [told(sequence, frame) | (changes or {}).get(frame, {}) for frame in range(sequence.frames)]
    (folder / "info_frames.pickle").write_bytes(pickle.dumps(frames))
    return folder


def without(bone: str, frame: int) -> dict[str, object]:
    """A frame in which a bone lies at the world's origin, as missing ones do."""
    frame_told = told(Sequence(), frame)
    values = np.reshape(frame_told["kpvalue"], (-1, 3))
    values[frame_told["kpname"].index(bone)] = 0
    return {"kpvalue": values.ravel().tolist()}


def test_joints_and_cameras_are_those_of_the_archive(tmp_path):
    alone = Recording.read(written(tmp_path / "alone"))
    beside = Recording.read(Sequence().write(tmp_path / "beside", pictured=[]))
    np.testing.assert_allclose(alone.joints, beside.joints, atol=1e-12)
    np.testing.assert_allclose(alone.world2cam, beside.world2cam, atol=1e-9)
    np.testing.assert_allclose(alone.intrinsics, beside.intrinsics, atol=1e-9)
    assert alone.size == (files.ROWS, files.COLUMNS)


def test_windows_are_those_of_the_archive(tmp_path):
    written(tmp_path / "alone" / "FPS-30" / "a")
    Sequence().write(tmp_path / "beside" / "FPS-30" / "a")
    alone, beside = (module(tmp_path / name, tmp_path / "cache").build() for name in ("alone", "beside"))
    np.testing.assert_allclose(alone.joints, beside.joints, atol=1e-6)
    np.testing.assert_array_equal(alone.image, beside.image)


def test_windows_with_a_missing_bone_are_dropped(tmp_path):
    recording = Recording.read(written(tmp_path / "a", {66: without("SKEL_L_Hand", 66)}))
    assert np.isnan(recording.joints[66]).any() and not np.isnan(recording.joints[65]).any()
    starts, dropped = usable_starts(recording, 1, form())
    assert starts == [0, 1] and dropped == {why.NO_BONE: 4}


def test_a_bone_that_is_never_named_is_missing(tmp_path):
    frame = told(Sequence(), 3)
    names = [f"other_{name}" if name == BONES[0] else name for name in frame["kpname"]]
    recording = Recording.read(written(tmp_path / "a", {3: {"kpname": names}}))
    assert np.isnan(recording.joints[3, 0]).all() and np.isfinite(recording.joints[3, 1:]).all()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"cam_rot": "north"}, r"info_frames\.pickle does not tell .* in frame 7 .*: info_frames\.npz is needed"),
        ({"cam_pos": [1.0, 2.0]}, "tells no possible camera in frame 7"),
        ({"cam_rot": [0.0, float("nan"), 0.0]}, "tells no possible camera in frame 7"),
        ({"cam_field_of_view": 0.0}, "tells no possible camera in frame 7"),
        ({"cam_field_of_view": -50.0}, "tells no possible camera in frame 7"),
        ({"kpvalue": [1.0, 2.0]}, "has no kpname with a kpvalue for each in frame 7"),
        ({"kpname": None}, "has no kpname with a kpvalue for each in frame 7"),
    ],
)
def test_frames_that_tell_too_little_are_refused(tmp_path, change, said):
    with pytest.raises(SagError, match=said):
        Recording.read(written(tmp_path / "a", {7: change}))


def test_a_pickle_of_clip_planes_alone_needs_the_archive(tmp_path):
    folder = Sequence().write(tmp_path / "a", pictured=[])
    (folder / "info_frames.npz").unlink()
    with pytest.raises(SagError, match=r"info_frames\.pickle has no kpname"):
        Recording.read(folder)
