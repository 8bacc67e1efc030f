"""Pictures of rooms: cameras, rays, light and the person."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import trimesh

from sag.data.cache import DEPTH_UNIT, PERSON
from sag.data.rays import RayScene
from sag.data.rooms.cameras import Camera
from sag.data.rooms.figure import Outfit, figure
from sag.data.rooms.filming import Shoot
from sag.data.rooms.lofts import ellipsoid, loft, tapered
from sag.data.rooms.materials import PATTERNS, Material, Palette, noise
from sag.data.rooms.recipe import CLOUD_SIZE, Recipe
from sag.data.rooms.render import Solids, Stand, View, brightness, cloud_depth, render
from sag.data.rooms.surfaces import SurfaceList
from sag.data.rooms.windows import ROOT, Recording
from sag.geometry.camera import recentred

SIZE = (36, 64)
GREY = Material((0.5, 0.5, 0.5))


def ahead(field: float = 0.9) -> Camera:
    """A camera in the origin that looks along x."""
    return Camera.looking(np.zeros(3), 0.0, 0.0, field)


def solids(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Solids:
    surfaces = SurfaceList()
    for number, (centre, size) in enumerate(boxes):
        surfaces.add(np.asarray(trimesh.creation.box(extents=size).triangles) + np.array(centre), number + 1, GREY)
    return Solids.of(surfaces.gathered())


@pytest.fixture(scope="module")
def filmed() -> tuple[Shoot, Recording]:
    shoot = Shoot.of(Recipe(train_rooms=2, test_rooms=1), 0)
    return shoot, next(shoot.recordings())


def test_the_camera_frame_has_x_right_y_down_z_ahead() -> None:
    np.testing.assert_allclose(ahead().to_camera(np.array([2.0, -1.0, 3.0])), [1, -3, 2], atol=1e-12)
    down = Camera.looking(np.array([0, 0, 2.0]), 0.0, np.deg2rad(90), 1.0)
    np.testing.assert_allclose(down.to_camera(np.zeros(3)), [0, 0, 2], atol=1e-12)


def test_world2cam_is_a_rotation_and_agrees_with_the_camera() -> None:
    camera = Camera.looking(np.array([1.0, 2.0, 1.5]), 0.7, 0.3, 1.0)
    np.testing.assert_allclose(camera.turn @ camera.turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(camera.turn) == pytest.approx(1)
    point = np.array([0.3, -0.4, 0.9])
    np.testing.assert_allclose((camera.world2cam @ [*point, 1])[:3], camera.to_camera(point), atol=1e-12)


def test_intrinsics_are_those_that_the_geometry_module_recentres() -> None:
    camera, point = ahead(), np.array([0.4, -0.3, 3.0])
    whole = torch.tensor(camera.intrinsics(SIZE))[None]
    expected = recentred(whole, torch.tensor(point)[None], SIZE, 1.0)[0]
    np.testing.assert_allclose(camera.intrinsics(SIZE, point), expected, atol=1e-5)


def test_depth_is_planar_and_its_rays_go_through_pixel_centres() -> None:
    room = solids(((4.05, 0, 0), (0.1, 20, 20)))
    far_away = solids(((0, 0, 90), (1, 1, 1)))
    picture = render(Stand(room, far_away, np.zeros(3)), ahead(), ahead().intrinsics(SIZE), SIZE)
    np.testing.assert_allclose(picture.depth * DEPTH_UNIT, 4.0, atol=2e-3)
    view = View(ahead(), ahead().intrinsics(SIZE), SIZE)
    back = (view.directions @ ahead().turn.T) @ ahead().intrinsics(SIZE).T
    np.testing.assert_allclose(back[0, :2], 0.5, atol=1e-4)
    np.testing.assert_allclose(back[-1, :2], [SIZE[1] - 0.5, SIZE[0] - 0.5], atol=1e-4)


def test_rays_around_points_hold_every_ray_that_meets_them() -> None:
    ball = np.array([3.0, 0.4, 0.2]) + 0.3 * np.random.default_rng(0).normal(size=(50, 3))
    scene = RayScene(ball[:48].reshape(-1, 3, 3))
    view = View(ahead(), ahead().intrinsics(SIZE), SIZE)
    met = np.flatnonzero(np.isfinite(scene.distance(view.eye, view.directions)))
    assert len(met) > 20
    assert set(met) <= set(view.around(ball[:48]))


def test_what_stands_before_the_lamp_casts_a_shadow() -> None:
    room, person = solids(((0, 0, -0.05), (9, 9, 0.1))), solids(((0, 0, 1), (0.5, 0.5, 0.1)))
    points = np.array([[0.0, 0, 0], [1.5, 0, 0]], np.float32)
    up = np.tile(np.array([0, 0, 1], np.float32), (2, 1))
    dark, bright = brightness(points, up, Stand(room, person, np.array([0, 0, 2.5])))
    assert dark < 0.6 * bright


def test_light_falls_off_with_the_angle() -> None:
    nothing = solids(((0, 0, 90), (1, 1, 1)))
    stand = Stand(nothing, nothing, np.array([0, 0, 2.5]))
    point = np.zeros((1, 3), np.float32)
    facing, aside = (brightness(point, np.array([n], np.float32), stand)[0] for n in ([0, 0, 1], [0, 1, 0]))
    assert facing > aside + 0.3


def test_the_person_stands_in_picture_depth_and_ids(filmed: tuple[Shoot, Recording]) -> None:
    shoot, recording = filmed
    intrinsics = recording.intrinsics(0, SIZE)
    picture = render(shoot.scenery.with_person(recording, 0), recording.camera, intrinsics, SIZE)
    middle = SIZE[0] // 2, SIZE[1] // 2
    assert picture.ids[middle] == PERSON
    root = recording.camera.to_camera(recording.joints[0, ROOT])
    assert picture.depth[middle] * DEPTH_UNIT == pytest.approx(root[2], abs=0.25)
    assert np.isin(picture.ids, [PERSON, *(n for n, _ in shoot.room.geometry.instances)]).all()


def test_the_cloud_knows_nothing_where_the_person_is_and_all_else(filmed: tuple[Shoot, Recording]) -> None:
    shoot, recording = filmed
    stand, camera = shoot.scenery.with_person(recording, 0), recording.camera
    intrinsics = recording.intrinsics(0, CLOUD_SIZE)
    picture = render(stand, camera, intrinsics, CLOUD_SIZE)
    cloud = cloud_depth(stand, camera, intrinsics, CLOUD_SIZE)
    person = picture.ids == PERSON
    assert (cloud[person] == 0).all()
    neighbours = np.zeros_like(person)
    neighbours[:-1] |= person[1:]
    assert (cloud[neighbours] == 0).all()
    kept = cloud > 0
    assert kept.mean() > 0.7
    np.testing.assert_array_equal(cloud[kept], picture.depth[kept])


def test_a_figure_is_closed_around_its_joints(filmed: tuple[Shoot, Recording]) -> None:
    _, recording = filmed
    joints = recording.joints[0]
    surfaces = figure(joints, recording.outfit, recording.scale)
    corners = surfaces.triangles.reshape(-1, 3)
    assert (corners.min(axis=0) < joints.min(axis=0)).all() and (corners.max(axis=0) > joints.max(axis=0)).all()
    assert np.isfinite(corners).all()
    assert (surfaces.ids == PERSON).all()


def test_lofts_are_watertight() -> None:
    limb = tapered(np.array([0, 0, 0.0]), np.array([0.1, 0.2, 0.5]), 0.08, 0.05)
    ball = ellipsoid(np.zeros(3), np.eye(3), np.array([0.1, 0.2, 0.3]))
    ring = np.stack([np.cos(np.arange(8)), np.sin(np.arange(8)), np.zeros(8)], axis=-1)
    for triangles in (limb, ball, loft(np.stack([ring, ring + [0, 0, 1.0]]))):
        mesh = trimesh.Trimesh(*_merged(triangles))
        assert mesh.is_watertight
    assert abs(trimesh.Trimesh(*_merged(ball)).volume) == pytest.approx(4 / 3 * np.pi * 0.006, rel=0.15)


def _merged(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    corners, places = np.unique(triangles.reshape(-1, 3).round(9), axis=0, return_inverse=True)
    faces = places.reshape(-1, 3)
    return corners, faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 0] != faces[:, 2])]


@pytest.mark.parametrize("pattern", PATTERNS)
def test_patterns_mix_two_colours(pattern: str) -> None:
    places = np.random.default_rng(0).uniform(-1, 1, (500, 3)).astype(np.float32)
    palette = Palette([Material((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), pattern, 0.1), GREY])
    colours = palette(np.zeros(500, int), places)
    np.testing.assert_allclose(colours.sum(axis=1), 1, atol=1e-5)
    assert (colours[:, 2].std() > 0.01) == (pattern != "plain")
    np.testing.assert_allclose(palette(np.ones(500, int), places), 0.5)


def test_noise_is_even_and_fixed() -> None:
    cells = np.stack(np.meshgrid(*[np.arange(-15, 15)] * 3), axis=-1).reshape(-1, 3)
    values = noise(cells)
    assert values.min() >= 0 and values.max() < 1
    assert values.mean() == pytest.approx(0.5, abs=0.02)
    np.testing.assert_array_equal(values, noise(cells))


def test_outfits_differ() -> None:
    assert len({Outfit.random(np.random.default_rng(seed)) for seed in range(10)}) > 5
