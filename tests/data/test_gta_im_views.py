from dataclasses import replace

import gta_im_files as files
import numpy as np
import pytest
import torch
from gta_im_files import COLUMNS, ROWS, SIZE, Sequence, module

from sag.data.gta_im import GtaImDataModule
from sag.data.gta_im.recording import Recording, joint_places, planar_depth
from sag.data.gta_im.views import person_id
from sag.data.recordings.filters import Limits, pixels_of
from sag.data.recordings.views import WindowFormat, depth_cloud, small_ids
from sag.geometry.camera import point_cloud, project
from sag.skeleton import GTA_IM_19, PROX_16
from sag.types import FRAMES


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> GtaImDataModule:
    """One recording with six windows."""
    folder = tmp_path_factory.mktemp("gta")
    Sequence().write(folder / "FPS-30" / "a")
    data = module(folder, folder / "cache")
    data.setup()
    return data


@pytest.fixture
def recording(tmp_path) -> Recording:
    return Recording.read(Sequence().write(tmp_path / "a", pictured=[0]))


# --- its numbers: joints and cameras ---


def test_joint_places_are_those_of_the_files():
    assert joint_places(GTA_IM_19) == [0, 1, 3, 4, 5, *range(7, 21)]
    assert joint_places(PROX_16) == [0, 1, 3, 4, 5, 7, 8, 9, 10, 14, 15, 16, 17, 18, 19, 20]


def test_world2cam_is_for_row_vectors(recording):
    seen = recording.seen_from(0, slice(3, 9))
    np.testing.assert_allclose(seen, Sequence().in_camera(0, slice(3, 9)), atol=1e-9)
    homogeneous = np.concatenate([recording.joints[3:9], np.ones((6, 21, 1))], -1)
    np.testing.assert_allclose(homogeneous @ recording.world2cam[0], np.dstack([seen, np.ones((6, 21))]), atol=1e-9)


def test_joints_stand_in_the_start_camera_and_the_stored_camera_takes_the_world_there(built):
    cache, sequence = built.cache, Sequence()
    world = sequence.joints[:, joint_places(GTA_IM_19)]
    for row in range(len(cache)):
        start = int(cache.start[row])
        truth = sequence.in_camera(start, slice(start, start + FRAMES))[:, joint_places(GTA_IM_19)]
        np.testing.assert_allclose(cache.joints[row], truth, atol=1e-5)
        column = cache.world2cam[row] @ np.append(world[start + 64, 3], 1)
        np.testing.assert_allclose(column[:3], truth[64, 3], atol=1e-9)


def test_the_start_root_is_at_the_centre(built):
    for split in ("train", "test"):
        roots = torch.from_numpy(built.cache.joints[built.cache.rows(split)][:, 0, GTA_IM_19.root_index])
        pixels = project(roots, torch.from_numpy(built.cache.intrinsics[built.cache.rows(split)]))
        assert (pixels - torch.tensor([SIZE[1] / 2, SIZE[0] / 2])).abs().max() < 1e-3


# --- its numbers: pictures ---


@pytest.mark.parametrize("metres", [0.2, 1.0, 2.5, 7.0, 20.0, 300.0])
def test_depth_comes_back(metres):
    code = files.stored(np.array([[metres]]))
    # One step of the stored number is about metres / code.
    assert planar_depth(code, files.NEAR, files.FAR)[0, 0] == pytest.approx(metres, rel=1 / code[0, 0])


def test_depth_that_is_not_stored_or_not_possible_is_0():
    assert planar_depth(np.array([[0, 1, 49]]), 0.1, 800.0).tolist() == [[0, 0, 0]]
    assert planar_depth(np.array([[2**24 - 1]]), 0.1, 800.0)[0, 0] > 700


def test_colour_depth_and_ids_show_the_same_thing_at_the_same_pixel(built):
    """Each native pixel's colour tells its row and column, so the crop tells where it was taken."""
    cache = built.cache
    row = int(cache.rows("test")[0])
    scale = SIZE[1] / COLUMNS
    offset = cache.intrinsics[row, :2, 2] - files.intrinsics()[:2, 2] * scale
    depth, ids = Sequence().drawn(int(cache.start[row]))
    native = (np.stack(np.meshgrid(np.arange(SIZE[1]), np.arange(SIZE[0])), -1) + 0.5 - offset) / scale
    inside = ((native > 2) & (native < (COLUMNS - 2, ROWS - 2))).all(-1)
    columns, rows = native.astype(int).transpose(2, 0, 1).clip(0, [[[COLUMNS - 1]], [[ROWS - 1]]])
    assert 0.5 < inside.mean() < 1
    # JPG loses colour beside the person's edge: the median tells the place.
    place = np.median(np.abs(cache.image[row][..., :2] + 0.5 - native[..., ::-1])[inside], axis=0)
    assert (place < 2).all()
    np.testing.assert_allclose(
        cache.depth[row][inside] / 1000, np.where(depth <= 20, depth, 0)[rows, columns][inside], rtol=2e-3
    )
    np.testing.assert_array_equal(cache.ids[row][inside] == 255, (ids == files.PERSON)[rows, columns][inside])


def test_outside_the_native_picture_nothing_is_known(tmp_path):
    sequence = Sequence()
    sequence.roots += [0.8, 0, 0]
    sequence.write(tmp_path / "FPS-30" / "a", pictured=[0])
    cache = module(tmp_path, tmp_path).build()
    outside = slice(-5, None)  # the crop follows the person to the right
    assert not cache.image[0][:, outside].any()
    assert not cache.depth[0][:, outside].any() and not cache.ids[0][:, outside].any()
    assert cache.image[0][:, :40].any()


def test_the_person_is_at_the_centre_and_a_skin_before_the_root(built):
    cache = built.cache
    row, (rows, columns) = 0, (SIZE[0] // 2, SIZE[1] // 2)
    assert cache.ids[row, rows, columns] == 255
    skin = cache.joints[row, 0, GTA_IM_19.root_index, 2] - cache.depth[row, rows, columns] / 1000
    assert skin == pytest.approx(files.SKIN, abs=0.01)


def test_ids_that_differ_in_the_lowest_byte_are_not_merged(recording):
    ids = recording.picture(0).ids
    assert {files.PERSON, files.CLOSE_ID, files.WALL} == set(np.unique(ids).tolist())
    assert np.unique(small_ids(ids, files.PERSON)).tolist() == [1, 2, 255]


def test_more_ids_than_a_byte_holds_share_the_last():
    small = small_ids(np.arange(400).reshape(20, 20), person=7).ravel()
    assert small[0] == 0 and small[7] == 255 and (small[8:] != 255).all() and small[399] == 254


def test_the_person_is_what_most_visible_joints_lie_on(recording):
    picture = recording.picture(0)
    joints = recording.seen_from(0, slice(0, 1))[0]
    assert person_id(picture, joints) == files.PERSON
    background = replace(picture, ids=np.zeros_like(picture.ids))
    assert person_id(background, joints) is None


@pytest.mark.parametrize("metres", [-1, 1])
def test_what_stands_before_or_behind_the_joints_is_not_the_person(recording, metres):
    picture = recording.picture(0)
    other = replace(picture, depth=picture.depth + metres, ids=np.full_like(picture.ids, 9))
    assert person_id(other, recording.seen_from(0, slice(0, 1))[0]) is None


# --- its numbers: the cloud ---


@pytest.mark.parametrize("step", [1, 2, 3])
def test_points_of_the_cloud_are_points_of_the_native_depth(recording, step):
    picture = recording.picture(0)
    form = WindowFormat([], 0, SIZE, step, Limits())
    cloud = depth_cloud(picture, files.PERSON, form)
    depth = cloud["cloud_depth"].astype(float) / 1000
    assert depth.shape == form.cloud_size(ROWS, COLUMNS)
    points = point_cloud(torch.from_numpy(depth)[None], torch.from_numpy(cloud["cloud_intrinsics"])[None])[0]
    points = points[torch.from_numpy(depth) > 0].numpy()
    pixels = pixels_of(points, picture.intrinsics)
    np.testing.assert_allclose(pixels % 1, 0.5, atol=1e-6)
    columns, rows = pixels.astype(int).T
    np.testing.assert_allclose(points[:, 2], picture.depth[rows, columns], atol=6e-4)


def test_the_cloud_holds_no_person_no_rim_and_nothing_far(recording):
    picture = recording.picture(0)
    depth = depth_cloud(picture, files.PERSON, files.form())["cloud_depth"]
    rows, columns = np.nonzero(picture.ids == files.PERSON)
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            assert not depth[(rows + down).clip(0, ROWS - 1), (columns + right).clip(0, COLUMNS - 1)].any()
    assert (picture.depth > 20).any() and not depth[picture.depth > 20].any()
    assert depth.max() <= 20000 and (depth > 0).mean() > 0.3
