from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from prox_files import (
    CAM2WORLD,
    COLOUR,
    COLUMNS,
    ROWS,
    SIZE,
    WALL,
    Take,
    drawn,
    measured,
    module,
    ply,
    write_root,
)

from sag.data.prox.calibration import Sensor
from sag.data.prox.person import with_person
from sag.data.prox.scan import scan_depth
from sag.data.prox.sensor import aligned
from sag.data.recordings.body import body_depth
from sag.data.recordings.filters import HIDDEN, UNREADABLE
from sag.geometry.camera import project, to_world
from sag.skeleton import PROX_16

NAMES = ("N0Sofa_00034_01", "MPH16_00157_01")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    root = write_root(tmp_path_factory.mktemp("prox") / "root")
    for name in NAMES:
        Take().write(root, name)
    return root


@pytest.fixture(scope="module")
def sensor(whole) -> Sensor:
    return Sensor.read(whole)


@pytest.fixture(scope="module", params=["scan", "sensor"])
def batch(request, whole):
    """Test windows by either depth."""
    data = module(whole, whole.parent / "cache", depth=request.param)
    data.setup()
    return request.param, next(iter(data.test_dataloader()))


# --- mirrored pictures ---


def test_stored_pixels_are_those_that_the_unmirrored_camera_sees(batch):
    """The picture's green is its native column, which is where the ray of a stored pixel meets the native picture."""
    scene = batch[1].scene
    focal, centre = scene.intrinsics[:, 0, 0, None], scene.intrinsics[:, 0, 2, None]
    across = (torch.arange(SIZE[1]) + 0.5 - centre) / focal
    column = (COLOUR[0, 0] * across + COLOUR[0, 2]).float()
    inside = (column > 4) & (column < COLUMNS - 5)
    green = 255 * scene.image[:, 1, 2]
    assert inside.float().mean() > 0.6
    assert (green - column)[inside].abs().median() < 1.0
    assert green[0, 60] > green[0, 30], "columns count from the left again"


def test_joints_land_on_the_person(batch):
    _, windows = batch
    pixels = project(windows.motion.joints[:, 0], windows.scene.intrinsics)
    column, row = pixels.long().unbind(-1)
    inside = (row >= 0) & (row < SIZE[0]) & (column >= 0) & (column < SIZE[1])
    person = windows.scene.person[torch.arange(len(row))[:, None], row.clamp(0, 53), column.clamp(0, 95)]
    assert person[inside].all() and inside.float().mean() > 0.9
    root = pixels[:, PROX_16.root_index]
    torch.testing.assert_close(root, torch.tensor([[48.0, 27.0]]).expand_as(root), atol=1e-3, rtol=0)


def test_world_is_the_scans(batch):
    _, windows = batch
    world = to_world(windows.motion.joints, windows.world2cam)
    height = world[0, 0, PROX_16.joints.index("head"), 2] - world[0, 0, PROX_16.joints.index("left_ankle"), 2]
    assert height == pytest.approx(1.55, abs=1e-5)
    expected = CAM2WORLD[:3, :3] @ Take().joints[0, 0] + CAM2WORLD[:3, 3]
    torch.testing.assert_close(world[0, 0, 0], torch.tensor(expected, dtype=torch.float32), atol=1e-5, rtol=0)


# --- depth ---


def test_depth_is_the_walls_beside_the_person(batch):
    kind, windows = batch
    depth, beside = windows.scene.depth, ~windows.scene.person
    known = depth > 0
    assert (depth[beside & known] - WALL).abs().max() < 0.002
    if kind == "scan":
        assert (depth[windows.scene.person] < WALL - 0.5).all()
        assert depth[windows.scene.person].min() > 2.8


def test_the_cloud_is_the_wall_and_knows_no_person(batch):
    kind, windows = batch
    cloud = windows.cloud.depth
    assert (cloud[cloud > 0] - WALL).abs().max() < 0.002
    mask = torch.from_numpy(drawn(Take().joints[0])[1] == 0)
    assert (cloud[0][mask] > 0).all() if kind == "scan" else (cloud[0][mask] == 0).all()
    assert ((cloud > 0).float().mean() == 1) if kind == "scan" else ((cloud > 0).float().mean() > 0.5)


def test_a_slanted_scan_has_the_depth_of_its_plane(tmp_path):
    """The plane z = 3 + x / 2 is met by the ray (x, y, 1) at 3 / (1 - x / 2)."""
    corners = np.array([[x, y, 3 + x / 2] for x, y in ((-5, -9), (5, -9), (5, 9), (-5, 9))])
    world2cam = np.linalg.inv(CAM2WORLD)
    (tmp_path / "a.ply").write_text(ply((corners - world2cam[:3, 3]) @ world2cam[:3, :3], [[0, 1, 2], [0, 2, 3]]))
    intrinsics = np.array([[50.0, 0, 20], [0, 50, 15], [0, 0, 1]])
    depth = scan_depth(tmp_path / "a.ply", world2cam, intrinsics, (30, 40))
    x = (np.arange(40) + 0.5 - 20) / 50
    np.testing.assert_allclose(depth, np.tile(3 / (1 - x / 2), (30, 1)), rtol=1e-5)


def test_past_the_scan_depth_is_not_known(tmp_path):
    corners = np.array([[0.0, -9, 4], [9, -9, 4], [9, 9, 4], [0, 9, 4]])
    (tmp_path / "a.ply").write_text(ply(corners, [[0, 1, 2], [0, 2, 3]]))
    intrinsics = np.array([[50.0, 0, 20], [0, 50, 15], [0, 0, 1]])
    depth = scan_depth(tmp_path / "a.ply", np.eye(4), intrinsics, (30, 40))
    np.testing.assert_array_equal(depth, np.tile(np.where(np.arange(40) < 20, 0, 4), (30, 1)))


# --- the person ---


def test_capsules_lie_before_the_joints(sensor):
    joints = Take().joints[0]
    depth = body_depth(joints, PROX_16, sensor.colour.intrinsics, (ROWS, COLUMNS))
    pixels = (joints @ sensor.colour.intrinsics.T)[:, :2] / joints[:, 2:]
    column, row = pixels.astype(int).T
    before = joints[:, 2] - depth[row, column]
    assert (before > 0.03).all() and (before < 0.15).all()
    assert 0.02 < np.isfinite(depth).mean() < 0.2


def test_a_body_beside_the_picture_is_not_seen(sensor):
    depth = body_depth(Take().joints[0] + [9, 0, 0], PROX_16, sensor.colour.intrinsics, (ROWS, COLUMNS))
    assert np.isinf(depth).all()


def test_the_person_is_filled_in_up_to_the_mask_and_never_behind_the_scene():
    scene, body = np.full((6, 8), 4.0), np.full((6, 8), np.inf)
    body[2:4, 3:5] = 3.0
    body[3, 4] = 4.5
    mask = np.zeros((6, 8), bool)
    mask[1:5, 2:6] = True
    depth = with_person(scene, body, mask)
    np.testing.assert_array_equal(depth[~mask], 4.0)
    assert depth[1, 2] == 3.0 and depth[4, 5] == 4.0
    assert scene[1, 2] == 4.0, "the scan is not written to"


def test_without_masks_the_capsules_are_the_person(tmp_path, batch):
    root = write_root(tmp_path / "root", ("MPH16",))
    Take().write(root, NAMES[1], masks=False)
    data = module(root, tmp_path, depth=batch[0])
    data.setup()
    assert any("1 recordings have no BodyIndexColor" in note for note in data.cache.index["notes"])
    found = next(iter(data.test_dataloader())).scene
    told = batch[1].scene.person[0]
    assert (found.person[0] & told).sum() / (found.person[0] | told).sum() > 0.4
    if batch[0] == "scan":
        assert found.depth[found.person].max() < 3.1


def test_the_depth_cameras_mask_is_moved_with_its_depth(tmp_path, sensor):
    root = write_root(tmp_path / "root", ("MPH16",))
    folder = Take().write(root, NAMES[1], masks=False)
    (folder / "BodyIndex").mkdir()
    mask = np.full(measured().shape, 255, np.uint8)
    mask[20:70, 40:55] = 3
    for path in (folder / "Depth").iterdir():
        Image.fromarray(mask[:, ::-1]).save(folder / "BodyIndex" / path.name)
    data = module(root, tmp_path, depth="sensor")
    data.setup()
    windows = next(iter(data.test_dataloader()))
    moved = np.isin(aligned(measured() / 8000, sensor, (ROWS, COLUMNS)).source, np.flatnonzero(mask != 255))
    assert moved.sum() > 500
    assert (windows.cloud.depth[0][torch.from_numpy(moved)] == 0).all()


def test_hidden_people_and_damaged_pictures_are_dropped_and_counted(tmp_path):
    root = write_root(tmp_path / "root", ("MPH16",))
    take = Take()
    folder = take.write(root, NAMES[1])
    Image.fromarray(np.full((ROWS, COLUMNS), 255, np.uint8)).save(folder / "BodyIndexColor" / f"{take.names[0]}.png")
    Image.fromarray(np.zeros((9, 9), np.uint8)).save(folder / "BodyIndexColor" / f"{take.names[1]}.png")
    torn = folder / "Color" / f"{take.names[2]}.jpg"
    torn.write_bytes(torn.read_bytes()[:900])
    Image.fromarray(np.zeros((ROWS, COLUMNS + 1, 3), np.uint8)).save(folder / "Color" / f"{take.names[3]}.jpg")
    index = module(root, tmp_path).build().index
    # Thrice: in training, validation and test windows.
    assert index["dropped"] == {HIDDEN: 3, UNREADABLE: 9}
    assert any(f"BodyIndexColor/{take.names[1]}.png has (9, 9) pixels" in note for note in index["notes"])
