"""Photographs: their lens, a person's place in them, the window that they make, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from sag.data.base import Windows
from sag.data.photo import PhotoDataModule, Place, read_photograph, read_pose, standing_pose, write_photo
from sag.errors import SagError
from sag.geometry.camera import project, to_world
from sag.skeleton import GTA_IM_19, PROX_16, Skeleton

SIZE = (240, 400)
"""Rows and columns."""

CAMERA = np.array([[300.0, 0, 200], [0, 300, 120], [0, 0, 1]])


def written(path: Path, exif: dict[int, float] | None = None, orientation: int = 1, size=SIZE) -> Path:
    """A picture whose red grows to the right and whose green grows downward."""
    colours = np.zeros((*size, 3), np.uint8)
    colours[..., 0] = np.linspace(0, 250, size[1])
    colours[..., 1] = np.linspace(0, 250, size[0])[:, None]
    tags = Image.Exif()
    tags[0x0112] = orientation
    tags.get_ifd(0x8769).update(exif or {})
    Image.fromarray(colours).save(path, quality=95, exif=tags)
    return path


def test_the_lens_is_that_of_film_of_35_mm(tmp_path):
    photo = read_photograph(written(tmp_path / "a.jpg", {0xA405: 26}, size=(300, 400)))
    assert photo.focal == pytest.approx(26 * 500 / math.hypot(36, 24))
    camera = photo.camera(None)
    assert camera[0, 2] == 200 and camera[1, 2] == 150 and camera[0, 0] == camera[1, 1] == photo.focal
    assert photo.fov(photo.camera(50)) == pytest.approx(50)


def test_it_is_turned_as_its_exif_tells(tmp_path):
    photo = read_photograph(written(tmp_path / "a.jpg", {0xA405: 26}, orientation=6))
    assert photo.size == SIZE[::-1]
    assert photo.colour[5, 5, 1] > 200 and photo.colour[-5, 5, 1] > 200  # the lower left corner is the upper left now
    assert photo.focal == pytest.approx(26 * math.hypot(*SIZE) / math.hypot(36, 24))


def test_a_picture_that_was_cropped_has_no_lens(tmp_path):
    same = {0xA405: 26, 0xA002: 4000, 0xA003: 2400}
    assert read_photograph(written(tmp_path / "a.jpg", same)).focal is not None
    photo = read_photograph(written(tmp_path / "b.jpg", same | {0xA003: 3000}))
    with pytest.raises(SagError, match=r"b\.jpg does not tell its lens .* by --fov"):
        photo.camera(None)


@pytest.mark.parametrize("name", ["grey.png", "clear.png", "web.webp"])
def test_other_pictures_are_read_too(name, tmp_path):
    mode = {"grey.png": "L", "clear.png": "RGBA"}.get(name, "RGB")
    Image.new(mode, (30, 20), 9 if mode == "L" else (9,) * len(mode)).save(tmp_path / name, lossless=True)
    assert (read_photograph(tmp_path / name).colour == 9).all()


def test_refuses_what_is_no_photograph(tmp_path):
    (tmp_path / "a.jpg").write_bytes(b"no picture")
    whole = written(tmp_path / "b.jpg").read_bytes()
    (tmp_path / "c.jpg").write_bytes(whole[: len(whole) // 2])
    for name, said in (("a.jpg", "is no JPEG, PNG or WEBP"), ("c.jpg", "is damaged"), ("d.jpg", "does not exist")):
        with pytest.raises(SagError, match=said):
            read_photograph(tmp_path / name)
    with pytest.raises(SagError, match="--fov is 200"):
        read_photograph(tmp_path / "b.jpg").camera(200)


@pytest.mark.parametrize("skeleton", [GTA_IM_19, PROX_16], ids=lambda s: s.name)
def test_a_person_stands_with_equal_sides(skeleton):
    pose = standing_pose(skeleton)
    assert np.allclose(pose[list(skeleton.mirror)] * [1, -1, 1], pose)
    assert pose[skeleton.index("head")[0], 2] - pose[skeleton.feet, 2].min() == pytest.approx(1.53, abs=0.02)
    assert (pose[skeleton.index("left_hip", "left_wrist"), 1] > 0).all() and not pose[skeleton.root_index].any()


@pytest.mark.parametrize("pitch", [0.0, 20.0])
def test_the_person_is_upright_at_the_pixel_and_the_distance(pitch):
    place = Place(CAMERA, (250.0, 130.0), 4.0, pitch, facing=0.0)
    joints = place.standing(standing_pose(GTA_IM_19))
    root = joints[GTA_IM_19.root_index]
    seen = project(torch.from_numpy(root)[None], torch.from_numpy(CAMERA)[None])[0]
    assert np.allclose(seen, [250, 130]) and root[2] == pytest.approx(4)
    world = to_world(torch.from_numpy(joints)[None], torch.from_numpy(place.world2cam(0.95))[None])[0].numpy()
    assert np.allclose(world[GTA_IM_19.root_index], [0, 0, 0.95])
    assert world[GTA_IM_19.index("head")[0], 2] == pytest.approx(0.95 + 0.647)
    assert np.allclose(np.linalg.norm(place.turn, axis=1), 1) and np.linalg.det(place.turn) == pytest.approx(1)


def test_ways_to_face_are_those_that_the_camera_sees():
    def nose(facing: float) -> np.ndarray:
        joints = Place(CAMERA, (200.0, 120.0), 4.0, 0.0, facing).standing(standing_pose(GTA_IM_19))
        head, neck = joints[GTA_IM_19.index("head", "neck")]
        return np.sign(np.round(head - neck, 3))[[0, 2]]

    assert [nose(way).tolist() for way in (0, 90, 180, 270)] == [[0, 1], [1, 0], [0, -1], [-1, 0]]


def module(tmp_path: Path, start=(250.0, 130.0), depth: np.ndarray | None = None) -> PhotoDataModule:
    photo = read_photograph(written(tmp_path / "a.png"))
    place = Place(CAMERA, start, 4.0)
    joints = place.standing(standing_pose(GTA_IM_19))
    return write_photo(tmp_path / "photo", photo, place, joints, GTA_IM_19, (36, 64), 30.0, depth)


def test_the_window_has_the_start_at_its_centre_and_the_camera_follows(tmp_path):
    depth = np.full((36, 64), 3.5)
    data = module(tmp_path, depth=depth)
    batch = Windows(data.cache, "test", GTA_IM_19)[0]
    root = batch.motion.start
    assert torch.allclose(project(root, batch.scene.intrinsics), torch.tensor([[32.0, 18.0]]), atol=1e-3)
    assert batch.scene.intrinsics[0, 0, 0] == pytest.approx(300 * 64 / 400)
    picture, camera = data.picture_with_camera(0)
    assert picture.shape == (*SIZE, 3) and np.allclose(camera, CAMERA)
    # The colour of the start in the photograph is that in the middle of the window.
    middle = batch.scene.image[0, :2, 17:19, 31:33].mean(dim=(1, 2)) * 255
    assert np.allclose(middle, picture[130, 250, :2], atol=6)
    # Beyond the photograph, to the right of it, the window is black and has no depth.
    assert not batch.scene.image[0, :, :, -5:].any() and not batch.scene.depth[0, :, -5:].any()
    assert batch.scene.depth[0, 18, 32] == pytest.approx(3.5, abs=1e-3)
    assert not batch.scene.person.any() and data.fps == 30 and not data.recorded
    # The first pose stands on the floor, which is 8.5 cm below the ankles.
    feet = to_world(batch.motion.joints[:, 0], batch.world2cam)[0, GTA_IM_19.feet]
    assert feet[:, 2].min() == pytest.approx(data.ankle_height, abs=1e-3)


def test_refuses_places_that_are_none(tmp_path):
    with pytest.raises(SagError, match=r"--start 401,20 is not in .*a\.png, which has 400 x 240 pixels"):
        module(tmp_path, (401.0, 20.0))
    for values, said in (
        ({"distance": 0.1}, "--distance is 0.1"),
        ({"distance": math.nan}, "--distance is nan"),
        ({"distance": 4.0, "pitch": 90.0}, "--pitch is 90"),
        ({"distance": 4.0, "facing": math.inf}, "--facing is inf"),
    ):
        with pytest.raises(SagError, match=said):
            Place(CAMERA, (1.0, 1.0), **values)


def test_poses_come_from_files(tmp_path):
    pose = standing_pose(GTA_IM_19) @ np.array([[0, 0, 1.0], [-1, 0, 0], [0, -1, 0]]) + [1, 2, 3]
    for name, joints in (("one", pose), ("motions", np.tile(pose, (2, 3, 5, 1, 1)))):
        np.savez(tmp_path / f"{name}.npz", joints=joints)
        found = read_pose(tmp_path / f"{name}.npz", GTA_IM_19)
        assert np.allclose(found, pose - pose[GTA_IM_19.root_index])
    for joints, said in ((pose[:16], "must be 19 and 3"), (pose * 100, "metres"), (pose * np.nan, "finite")):
        np.savez(tmp_path / "wrong.npz", joints=joints)
        with pytest.raises(SagError, match=said):
            read_pose(tmp_path / "wrong.npz", GTA_IM_19)
    with pytest.raises(SagError, match="cannot be read"):
        read_pose(tmp_path / "none.npz", GTA_IM_19)


def test_skeletons_whose_joints_have_other_names_need_a_pose():
    names = ("pelvis", "right_ankle", "left_ankle")
    groups = {"body": names}
    odd = Skeleton(
        "odd", names, (("pelvis", "right_ankle"), ("pelvis", "left_ankle")), "pelvis", groups, {"all": ("body",)}
    )
    with pytest.raises(SagError, match=r"how odd stands is not known \(pelvis\); give the first pose by --pose"):
        standing_pose(odd)
