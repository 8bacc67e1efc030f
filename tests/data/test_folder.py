"""A folder of one's own becomes windows: joints, pictures, person, clouds and rooms of any skeleton."""

from pathlib import Path

import numpy as np
import pytest
import torch
from folder_files import COLUMNS, INTRINSICS, ROWS, SKELETON, SKIN, WORLD2CAM, Take, module, write_root, write_skeleton
from PIL import Image

from sag.data.folder import FolderDataModule
from sag.data.folder.split import in_order
from sag.data.recordings.filters import HIDDEN, NO_PICTURE, OTHER_SIZE, ROOT_JUMPS, ROOT_OUTSIDE, TOO_SHORT
from sag.errors import SagError
from sag.geometry.camera import project, to_world
from sag.types import FRAMES, Batch

PELVIS = 0


@pytest.fixture(scope="session")
def data(tmp_path_factory) -> FolderDataModule:
    """Three recordings in three rooms, built; tests do not change them."""
    folder = tmp_path_factory.mktemp("own")
    made = module(write_root(folder / "root"), folder / "cache")
    made.setup()
    return made


@pytest.fixture
def batch(data) -> Batch:
    """The windows of the last room, which tests."""
    return next(iter(data.test_dataloader()))


def one(tmp_path: Path, take: Take, **options: object) -> FolderDataModule:
    """The data module of one recording."""
    take.write(write_skeleton(tmp_path / "root") / "take0")
    return module(tmp_path / "root", tmp_path / "cache", **options)


def test_windows_are_those_that_were_written(data, batch):
    assert data.describe()["windows"] == {"train": 12, "val": 6, "test": 6}
    assert data.cache.index["rooms"] == ["attic", "kitchen", "study"] and data.fps == 30
    joints = Take(room="study", seed=2).arrays["joints"]
    world = to_world(batch.motion.joints, batch.world2cam)
    for window, start in enumerate(data.cache.start[data.cache.rows("test")]):
        written = joints[start : start + FRAMES]
        np.testing.assert_allclose(batch.motion.joints[window], in_camera(written, WORLD2CAM), atol=1e-5)
        np.testing.assert_allclose(world[window], written, atol=1e-4)


def in_camera(joints: np.ndarray, camera: np.ndarray) -> np.ndarray:
    """Places of the world in the frame of a camera."""
    return np.concatenate([joints, np.ones((*joints.shape[:2], 1))], axis=-1) @ camera[:3].T


def test_the_root_is_at_the_centre_and_the_person_in_the_picture(batch):
    start = batch.motion.joints[:, 0]
    pixels = project(start, batch.scene.intrinsics)
    assert torch.allclose(pixels[:, PELVIS], torch.tensor([32.0, 18.0]), atol=1e-3)
    columns, rows = pixels.long().unbind(-1)
    window = torch.arange(len(batch))[:, None]
    on_person = batch.scene.person[window, rows.clamp(0, 35), columns.clamp(0, 63)]
    assert on_person.float().mean() > 0.85
    depth = batch.scene.depth[window, rows, columns]
    assert torch.median((start[..., 2] - depth)[on_person]) == pytest.approx(SKIN, abs=0.02)
    blue = batch.scene.image[:, 2]
    assert blue[batch.scene.person].mean() > 0.6 and blue[~batch.scene.person].mean() < 0.1, "the person is blue"


def test_clouds_are_the_scene_without_the_person(batch):
    depth, person = Take(room="study", seed=2).drawn(0)
    cloud = batch.cloud.depth[0].numpy()
    assert cloud.shape == (ROWS, COLUMNS) and (cloud[person] == 0).all()
    kept = cloud > 0
    np.testing.assert_allclose(cloud[kept], depth[kept], atol=1e-3)
    assert kept.mean() > 0.85
    np.testing.assert_allclose(batch.cloud.intrinsics[0], INTRINSICS)


def test_a_camera_that_moves_is_that_of_the_start(tmp_path):
    take = Take().with_moving_camera()
    cache = one(tmp_path, take).build()
    for window, start in enumerate(cache.start):
        camera = take.arrays["world2cam"][start]
        wanted = in_camera(take.arrays["joints"][start : start + FRAMES], camera)
        np.testing.assert_allclose(cache.joints[window], wanted, atol=1e-5)
    assert len(set(cache.world2cam[:, 2, 3].tolist())) == 6


def test_without_its_pictures_the_person_is_sought_by_the_bones(tmp_path, data, batch):
    root = write_skeleton(tmp_path / "root")
    Take(room="study", seed=2).write(root / "take0", person=False, suffix=".png")
    sought = module(root, tmp_path / "cache")
    sought.setup()
    assert any("1 recordings have no picture of where the person is" in note for note in sought.cache.index["notes"])
    found, told = next(iter(sought.test_dataloader())).scene.person, batch.scene.person
    assert (found & told).sum() / (found | told).sum() > 0.5


@pytest.mark.parametrize("pictured", [range(3), ()])
def test_recordings_that_tell_the_person_in_some_frames_only_are_counted_apart(tmp_path, pictured):
    root = write_root(tmp_path / "root")
    for frame in {*range(6)} - {*pictured}:
        (root / "take1" / f"{frame:05d}_person.png").unlink()
    (said,) = module(root, tmp_path / "cache").remarks()
    some = "pictures of where the person is in some frames only" if pictured else "no picture of where the person is"
    assert said.startswith(f"1 recordings have {some}; there it is sought by the bones")


def test_a_skeleton_of_fewer_joints_takes_its_own(tmp_path, data):
    left_out = "nose"
    fewer = {
        "name": "h36m_16",
        "joints": sorted(set(SKELETON["joints"]) - {left_out}),
        "root": "spine",
        "bones": [["spine", "pelvis"], ["spine", "thorax"], ["thorax", "head"]]
        + [bone for bone in SKELETON["bones"] if not {"spine", left_out} & {*bone}],
        "parts": {**SKELETON["parts"], "head": ["head"]},
    }
    write_skeleton(tmp_path, **fewer)
    made = module(data.root, tmp_path, skeleton=str(tmp_path / "skeleton.yaml"))
    made.setup()
    order = [SKELETON["joints"].index(name) for name in fewer["joints"]]
    np.testing.assert_array_equal(made.cache.joints, data.cache.joints[:, :, order])
    batch = next(iter(made.test_dataloader()))
    centre = project(batch.motion.joints[:, 0], batch.scene.intrinsics)[:, fewer["joints"].index("spine")]
    assert torch.allclose(centre, torch.tensor([32.0, 18.0]), atol=1e-3)


def test_what_cannot_be_a_window_is_dropped_and_counted(tmp_path):
    root = write_skeleton(tmp_path / "root")
    jumping, leaving = Take(72), Take()
    jumping.arrays["joints"][69:] += [0.5, 0, 0]
    leaving.arrays["joints"] += np.arange(70)[:, None, None] * np.array([0.0412, 0, 0], np.float32)
    jumping.write(root / "jumping", pictured=[0, 1, 3, 5, 6])
    leaving.write(root / "leaving", pictured=range(4))
    Take(64).write(root / "short", pictured=[0])
    Take(65).write(root / "hidden", pictured=[0])
    Image.new("L", (COLUMNS, ROWS)).save(root / "hidden/00000_person.png")
    x, _, z = in_camera(leaving.arrays["joints"][:, :1], WORLD2CAM)[:, 0].T
    inside = np.flatnonzero(INTRINSICS[0, 0] * x / z + INTRINSICS[0, 2] < COLUMNS).max()
    assert 64 <= inside < 67
    data = module(root, tmp_path / "cache")
    assert data.plan().dropped == {TOO_SHORT: 1, ROOT_JUMPS: 2, NO_PICTURE: 3 + 2, ROOT_OUTSIDE: 67 - inside}
    assert data.build().index["dropped"][HIDDEN] == 2, "as it is trained and validated on"
    assert data.cache.index["events"] == {ROOT_JUMPS: 1}


def test_pictures_of_another_size_are_left_out(tmp_path):
    root = write_root(tmp_path / "root", ("a", "b"))
    for path in (root / "take1").glob("*.*g"):
        Image.open(path).resize((2 * COLUMNS, 2 * ROWS), Image.Resampling.NEAREST).save(path)
    assert module(root, tmp_path / "cache").plan().dropped == {OTHER_SIZE: 6}


# --- rooms ---


def split_of(root: Path, tmp_path: Path, **options: object) -> dict[str, set[str]]:
    """Names of the rooms in each split."""
    plan = module(root, tmp_path / "cache", **options).plan()
    found = [{plan.rooms[w.recording] for w in plan.windows if (w.split == "test") == test} for test in (False, True)]
    return dict(zip(("train", "test"), found))


def test_the_last_rooms_test(tmp_path):
    root = write_root(tmp_path / "root", (2, 10, "attic", 1))
    assert split_of(root, tmp_path) == {"train": {"1", "2", "10"}, "test": {"attic"}}
    assert split_of(root, tmp_path, test_rooms=(2, "1")) == {"train": {"10", "attic"}, "test": {"1", "2"}}
    assert split_of(root, tmp_path, train_rooms=(2,)) == {"train": {"2"}, "test": {"1", "10", "attic"}}
    assert in_order({"b", "10", "9", "a"}) == ("9", "10", "a", "b")
    with pytest.raises(SagError, match=r"test_rooms tells 'atic'; rooms with windows are 1, 2, 10, attic"):
        split_of(root, tmp_path, test_rooms=("atic",))


def test_one_room_is_divided_by_recording_with_a_warning(tmp_path):
    data = module(write_root(tmp_path / "root", ("a", "a", "a")), tmp_path / "cache")
    plan = data.plan()
    assert {w.recording for w in plan.windows if w.split == "test"} == {2}
    assert any("SPLIT BY RECORDING, NOT BY ROOM" in note for note in plan.notes)


# --- the cache ---


def test_changed_files_and_skeletons_make_another_cache(tmp_path):
    data = one(tmp_path, Take())
    first = data.build().folder
    assert module(data.root, tmp_path / "cache").build().folder == first
    moved = [["spine", "pelvis"], *[bone for bone in SKELETON["bones"] if bone[1] != "spine"]]
    write_skeleton(data.root, root="spine", bones=moved)
    second = module(data.root, tmp_path / "cache").build().folder
    (data.root / "take0/00005.jpg").touch()
    assert len({first, second, module(data.root, tmp_path / "cache").build().folder}) == 3
