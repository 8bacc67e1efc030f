"""Rooms in GTA-IM's layout: every file is as in the data set, and its loader reads the same windows as the rooms'."""

from __future__ import annotations

import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest
from layouts_checks import like, trains_and_tests, write_by_command
from scipy.ndimage import binary_erosion

from sag.data.cache import DEPTH_UNIT, PERSON
from sag.data.gta_im import GtaImDataModule
from sag.data.gta_im.bones import BONES
from sag.data.gta_im.recording import JOINTS, Recording, planar_depth
from sag.data.layouts import Script
from sag.data.layouts.gta_im import ROOMS, inverse_depth, spread_ids, with_clavicles
from sag.data.layouts.script import FilmedRoom, filmed
from sag.data.rooms.render import render
from sag.data.rooms.windows import stored_window
from sag.skeleton import GTA_IM_19

SCRIPT = Script(rooms=2, recordings=1, seconds=2.5, size=(144, 256), every=5)
SIZE = (36, 64)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two rooms, written by the command."""
    made = tmp_path_factory.mktemp("layouts") / "gta-im"
    write_by_command("gta-im", made, SCRIPT.size, seconds=SCRIPT.seconds, every=SCRIPT.every)
    return made


@pytest.fixture(scope="module")
def scenes() -> list[FilmedRoom]:
    """What was filmed, as the rooms know it."""
    return [filmed(SCRIPT, number) for number in range(SCRIPT.rooms)]


@pytest.fixture(scope="module")
def written(folder: Path) -> list[Recording]:
    """The recordings as the loader reads them."""
    return [Recording.read(path) for path in sorted((folder / "FPS-30").iterdir())]


@pytest.fixture(scope="module")
def module(folder: Path) -> GtaImDataModule:
    data = GtaImDataModule(folder, cache_dir=folder.parent / "cache", image_size=SIZE)
    data.setup()
    return data


# --- the files ---


def test_a_recording_has_the_files_of_the_data_set(folder: Path) -> None:
    recordings = sorted((folder / "FPS-30").iterdir())
    assert [path.name for path in recordings] == ["2020-06-01-10-00-00", "2020-06-01-11-00-00"]
    pictures = {f"{frame:05d}{end}" for frame in range(0, 75, 5) for end in (".jpg", ".png", "_id.png")}
    numbers = {"info_frames.npz", "info_frames.pickle", "realtimeinfo.gz"}
    assert all({path.name for path in recording.iterdir()} == pictures | numbers for recording in recordings)


def test_arrays_agree_with_one_another_far_from_the_origin(folder: Path) -> None:
    with np.load(next((folder / "FPS-30").iterdir()) / "info_frames.npz", allow_pickle=False) as file:
        arrays = dict(file)
    assert {name: (a.dtype, a.shape[1:]) for name, a in arrays.items()} == {
        "joints_2d": (float, (21, 2)), "joints_3d_cam": (float, (21, 3)), "joints_3d_world": (float, (21, 3)),
        "world2cam_trans": (float, (4, 4)), "intrinsics": (float, (3, 3)),
    }  # fmt: skip
    world = arrays["joints_3d_world"]
    assert (np.abs(world[..., :2]) > 300).all()
    homogeneous = np.concatenate([world, np.ones((75, 21, 1))], axis=-1) @ arrays["world2cam_trans"]
    np.testing.assert_allclose(homogeneous[..., :3], arrays["joints_3d_cam"], atol=1e-9)
    pixels = np.einsum("tij,tkj->tki", arrays["intrinsics"], arrays["joints_3d_cam"])
    np.testing.assert_allclose(pixels[..., :2] / pixels[..., 2:], arrays["joints_2d"], atol=1e-9)


def test_the_pickle_tells_what_the_arrays_hold_in_plain_types(folder: Path, written: list[Recording]) -> None:
    raw = (written[0].folder / "info_frames.pickle").read_bytes()
    assert b"numpy" not in raw
    frames = pickle.loads(raw)  # our own file
    assert len(frames) == 75 and len({tuple(frame["kpname"]) for frame in frames}) > 70
    assert {len(frame["kpname"]) for frame in frames} == {98} and {len(f["kpvalue"]) for f in frames} == {294}
    assert {frame.get("cam_far_clip") for frame in frames} == {800.0, None}
    for frame, places in zip(frames, written[0].joints):
        named = dict(zip(frame["kpname"], np.reshape(frame["kpvalue"], (98, 3))))
        for joint, bone, place in zip(JOINTS, BONES, places):
            assert np.array_equal(named.pop(bone), place)
            assert np.array_equal(frame["spine4" if joint == "root" else joint], place)
        assert not np.any(list(named.values()))


def test_the_pickles_camera_is_that_of_the_arrays(written: list[Recording]) -> None:
    """By the recipe of the data set's authors: turned about x, y and z, and then looking along y."""
    for recording in written:
        frame = pickle.loads((recording.folder / "info_frames.pickle").read_bytes())[0]
        turn = np.eye(3)
        for axis, angle in enumerate(np.deg2rad(frame["cam_rot"])):
            c, s, (i, j) = np.cos(angle), np.sin(angle), [(1, 2), (2, 0), (0, 1)][axis]
            about = np.eye(3)
            about[[i, i, j, j], [i, j, i, j]] = c, -s, s, c
            turn = about @ turn
        right, forward, up = turn.T
        cam2world = np.linalg.inv(recording.world2cam[0].T)
        np.testing.assert_allclose(cam2world[:3, :3], np.stack([right, -up, forward], axis=1), atol=1e-9)
        np.testing.assert_allclose(cam2world[:3, 3], frame["cam_pos"], atol=1e-9)
        focal = SCRIPT.size[0] / 2 / np.tan(np.deg2rad(frame["cam_field_of_view"]) / 2)
        assert recording.intrinsics[0, 0, 0] == pytest.approx(focal)


def test_the_pickle_alone_tells_the_same_recording(written: list[Recording], tmp_path: Path) -> None:
    alone = Path(shutil.copytree(written[1].folder, tmp_path / "alone"))
    (alone / "info_frames.npz").unlink()
    read = Recording.read(alone)
    np.testing.assert_allclose(read.joints, written[1].joints, atol=1e-9)
    np.testing.assert_allclose(read.world2cam, written[1].world2cam, atol=1e-9)
    np.testing.assert_allclose(read.intrinsics, written[1].intrinsics, atol=1e-9)


def test_the_rooms_are_those_of_the_default_split(written: list[Recording], module: GtaImDataModule) -> None:
    assert [recording.room for recording in written] == [1, 13]
    train, test = set(module.rooms.train_rooms), set(module.rooms.test_rooms)
    assert set(ROOMS) == train | test and {1} <= train - test and {13} <= test - train
    scenes = {split: set(module.cache.scene[module.cache.rows(split)].tolist()) for split in ("train", "test")}
    assert scenes == {"train": {1}, "test": {13}}


def test_clavicles_lie_between_neck_and_shoulders(scenes: list[FilmedRoom]) -> None:
    joints = scenes[0].recordings[0].joints
    wide = with_clavicles(joints)
    kept = [JOINTS.index(name) for name in GTA_IM_19.joints]
    assert np.array_equal(wide[:, kept], joints)
    for side in ("right", "left"):
        neck, clavicle, shoulder = (wide[:, JOINTS.index(n)] for n in ("neck", f"{side}_clavicle", f"{side}_shoulder"))
        lengths = [
            np.linalg.norm(a - b, axis=-1) for a, b in ((neck, clavicle), (clavicle, shoulder), (neck, shoulder))
        ]
        np.testing.assert_allclose(lengths[0] + lengths[1], lengths[2], atol=1e-9)
        assert (lengths[0] < lengths[1]).all()


# --- the pictures ---


@pytest.mark.parametrize("steps", [300, 1000, 2500, 7000, 20000])
def test_depth_comes_back_within_a_step_of_the_24_bits(steps: int) -> None:
    code = inverse_depth(np.array([[steps]], np.uint16))
    assert planar_depth(code, 0.1, 800.0)[0, 0] == pytest.approx(steps * DEPTH_UNIT, rel=0.5001 / code[0, 0])
    assert inverse_depth(np.zeros((1, 1), np.uint16))[0, 0] == 0


def test_ids_stay_apart_in_colour_alone() -> None:
    ids = np.arange(256, dtype=np.uint8)[None]
    wide = spread_ids(ids)
    assert wide[0, 0] == 0 and len(np.unique(wide)) == 256 and wide.max() < 1 << 24
    grey = np.rint([0.299, 0.587, 0.114] @ np.stack([wide >> 16, wide >> 8 & 255, wide & 255])[:, 0])
    assert len(np.unique(grey)) < 30


def test_pictures_are_those_of_the_rooms(scenes: list[FilmedRoom], written: list[Recording]) -> None:
    for scene, read in zip(scenes, written):
        recording, frame = scene.recordings[0], 5
        matrix = recording.camera.intrinsics(SCRIPT.size)
        drawn = render(scene.scenery.with_person(recording, frame), recording.camera, matrix, SCRIPT.size)
        picture = read.picture(frame)
        assert np.abs(picture.colour.astype(int) - drawn.image).mean() < 3  # JPG
        assert np.array_equal(picture.ids, spread_ids(drawn.ids))
        metres = drawn.depth * DEPTH_UNIT
        assert (np.abs(picture.depth - metres) <= metres**2 / 900 + DEPTH_UNIT / 2 + 1e-6).all()
        np.testing.assert_allclose(picture.intrinsics, matrix)


# --- the same window ---


def test_a_window_is_the_same_through_the_loader_and_from_the_rooms(
    scenes: list[FilmedRoom], module: GtaImDataModule
) -> None:
    cache = module.cache
    assert len(cache.rows("train")) >= 2 and len(cache.rows("test")) >= 2
    for row in range(len(cache)):
        scene = scenes[int(cache.sequence[row])]
        truth = stored_window(scene.recordings[0], scene.scenery, int(cache.start[row]), SIZE)
        np.testing.assert_allclose(cache.joints[row], truth["joints"], atol=1e-4)
        np.testing.assert_allclose(cache.intrinsics[row], truth["intrinsics"], atol=1e-3)
        np.testing.assert_allclose(cache.world2cam[row, :3, :3], truth["world2cam"][:3, :3], atol=1e-9)
        seen = binary_erosion(cache.ids[row] > 0)  # beyond the native picture nothing is known
        assert seen.mean() > 0.4
        assert like(cache.ids[row] == PERSON, truth["ids"] == PERSON)[seen].mean() > 0.99
        metres = cache.depth[row] * DEPTH_UNIT
        assert like(metres, truth["depth"] * DEPTH_UNIT, DEPTH_UNIT + metres**2 / 900)[seen].mean() > 0.98
        assert like(cache.image[row], truth["image"], 6)[seen].mean() > 0.98


def test_it_trains_and_tests(folder: Path, module: GtaImDataModule, tmp_path: Path) -> None:
    assert trains_and_tests("gta_im.yaml", folder, module, tmp_path)
