"""Cuts and zooms of the camera, and what happens in recordings."""

from collections import Counter

import numpy as np
import pytest
from gta_im_files import COLUMNS, ROWS, Sequence, camera, form, intrinsics, module
from scipy.spatial.transform import Rotation

from sag.data.gta_im.cameras import camera_cuts, camera_zooms
from sag.data.gta_im.filters import events
from sag.data.gta_im.recording import Recording


def still(frames: int = 20) -> np.ndarray:
    """A camera that stands, for row vectors."""
    axes, place = camera(0)
    world2cam = np.eye(4)
    world2cam[:3, :3], world2cam[3, :3] = axes.T, -axes @ place
    return np.tile(world2cam, (frames, 1, 1))


def turned(degrees: float) -> np.ndarray:
    """The same camera turned about its place from frame 8 on."""
    world2cam = still()
    turn = Rotation.from_euler("y", degrees, degrees=True).as_matrix()
    world2cam[8:, :, :3] = world2cam[8:, :, :3] @ turn
    return world2cam


def moved(metres: float) -> np.ndarray:
    world2cam = still()
    world2cam[8:, 3, 2] += metres
    return world2cam


FIXED = np.tile(intrinsics(), (20, 1, 1))


@pytest.mark.parametrize("world2cam", [still(), turned(29), moved(0.99)])
def test_a_camera_that_stands_or_moves_does_not_cut(world2cam):
    assert camera_cuts(world2cam, FIXED) == []


@pytest.mark.parametrize(("world2cam", "step", "turn"), [(turned(31), 0, 31), (moved(1.5), 1.5, 0)])
def test_a_camera_that_is_elsewhere_cuts(world2cam, step, turn):
    (cut,) = camera_cuts(world2cam, FIXED)
    assert cut.frame == 7
    assert (cut.step, cut.turn) == (pytest.approx(step, abs=1e-9), pytest.approx(turn, abs=1e-4))


def test_a_cut_tells_both_focal_lengths():
    focal = FIXED.copy()
    focal[8:, :2, :2] *= 1.3
    (cut,) = camera_cuts(turned(90), focal)
    assert cut.focal[1] == pytest.approx(1.3 * cut.focal[0])
    assert camera_zooms(focal, [cut]) == [] and camera_zooms(focal, []) == [(7, 8)]


def test_zooms_are_stretches_in_one_direction():
    focal = FIXED.copy()
    factor = np.ones(20)
    factor[3:9] = 1.01 ** np.arange(6)
    factor[9:] = factor[8] * 0.98 ** np.clip(np.arange(11), 0, 4)
    focal[:, 0, 0] *= factor
    assert camera_zooms(focal, []) == [(3, 8), (9, 13)]
    focal[:, 0, 0] = FIXED[:, 0, 0] * (1 + 0.009 * (np.arange(20) > 4))
    assert camera_zooms(focal, []) == []


def test_events_are_counted_and_told(tmp_path, capsys):
    sequence = Sequence()
    sequence.roots[66:] += [0.5, 0, 0]
    folder = sequence.write(tmp_path / "FPS-30" / "a")
    assert events(Recording.read(folder), form()) == Counter({"root jumps": 1})
    cache = module(tmp_path, tmp_path).build()
    assert cache.index["events"]["root jumps"] == 1 and "1 root jumps" in capsys.readouterr().out
    assert cache.cloud_depth.shape[1:] == (ROWS, COLUMNS)


def test_a_cut_drops_no_window(tmp_path):
    folder = Sequence().write(tmp_path / "FPS-30" / "a", pictured=[0])
    with np.load(folder / "info_frames.npz") as file:
        arrays = dict(file)
    arrays["world2cam_trans"][40:] = turned(80)[-1]
    np.savez(folder / "info_frames.npz", **arrays)
    cache = module(tmp_path, tmp_path).build()
    assert cache.index["events"]["camera cuts"] == 1 and cache.index["dropped"] == {"no picture at the start frame": 5}
    np.testing.assert_allclose(cache.joints[0, 64, 0], Sequence().in_camera(0, slice(64, 65))[0, 0], atol=1e-5)
