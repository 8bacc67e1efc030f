"""The pinhole camera: there and back, gradients, crops."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from sag.geometry.camera import NEAREST, pixel_centres, point_cloud, project, recentred, unproject


@pytest.fixture
def intrinsics() -> torch.Tensor:
    first = [[410.0, 0, 250], [0, 395, 140], [0, 0, 1]]
    second = [[800.0, 0, 300], [0, 820, 150], [0, 0, 1]]
    return torch.tensor([first, second], dtype=torch.float64)


@given(seed=st.integers(0, 1000), middle=st.sampled_from([(), (5,), (3, 4), (2, 3, 4)]))
@settings(max_examples=20, deadline=None)
def test_projecting_and_unprojecting_gives_the_point_back(seed, middle):
    generator = torch.manual_seed(seed)
    camera = torch.eye(3, dtype=torch.float64).expand(2, 3, 3).clone()
    camera[:, :2] = camera[:, :2] * 400 + 50 * torch.rand(2, 2, 3, generator=generator).double().triu()
    camera[:, 0, 1] = 0
    points = torch.randn(2, *middle, 3, generator=generator).double()
    points[..., 2] = points[..., 2].abs() + NEAREST
    back = unproject(project(points, camera), points[..., 2], camera)
    torch.testing.assert_close(back, points, atol=1e-12, rtol=1e-12)


def test_unprojecting_and_projecting_gives_the_pixel_back(intrinsics):
    pixels = torch.rand(2, 7, 2, dtype=torch.float64) * 500
    depth = torch.rand(2, 7, dtype=torch.float64) * 8 + NEAREST
    torch.testing.assert_close(project(unproject(pixels, depth, intrinsics), intrinsics), pixels, atol=1e-9, rtol=0)


def test_a_point_ahead_is_seen_at_the_principal_point(intrinsics):
    ahead = torch.tensor([0.0, 0, 3], dtype=torch.float64).expand(2, 3)
    torch.testing.assert_close(project(ahead, intrinsics), intrinsics[:, :2, 2])


def test_a_point_behind_the_camera_is_projected_as_if_just_before_it(intrinsics):
    behind = torch.tensor([[0.2, 0.1, -3.0], [0.2, 0.1, 0.0]], dtype=torch.float64)
    before = torch.tensor([0.2, 0.1, NEAREST], dtype=torch.float64).expand(2, 3)
    assert torch.equal(project(behind, intrinsics), project(before, intrinsics))


def test_gradients(intrinsics):
    points = torch.randn(2, 3, 3, dtype=torch.float64)
    points[..., 2] = points[..., 2].abs() + 0.5
    assert torch.autograd.gradcheck(lambda p, k: project(p, k), (points.requires_grad_(), intrinsics.requires_grad_()))
    pixels = torch.rand(2, 3, 2, dtype=torch.float64, requires_grad=True)
    depth = torch.rand(2, 3, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(unproject, (pixels, depth, intrinsics))


def test_pixel_centres_are_halves():
    centres = pixel_centres(2, 3, like=torch.zeros(1))
    assert centres[0, 0].tolist() == [0.5, 0.5]
    assert centres[1, 2].tolist() == [2.5, 1.5]


def test_a_point_cloud_projects_to_its_pixels_and_keeps_its_depth(intrinsics):
    depth = torch.rand(2, 6, 8, dtype=torch.float64) * 5 + 0.5
    depth[:, 0, 0] = 0
    cloud = point_cloud(depth, intrinsics)
    torch.testing.assert_close(cloud[..., 2], depth)
    assert not cloud[:, 0, 0].any()
    seen = project(cloud, intrinsics).flatten(1, 2)[:, 1:]
    expected = pixel_centres(6, 8, like=depth).flatten(0, 1)[1:].expand(2, -1, -1)
    torch.testing.assert_close(seen, expected, atol=1e-9, rtol=0)


def test_a_recentred_crop_sees_the_point_at_its_centre(intrinsics):
    point = torch.tensor([[0.4, -0.2, 3], [1, 0.3, 5]], dtype=torch.float64)
    crop = recentred(intrinsics, point, (288, 512), scale=0.4)
    torch.testing.assert_close(project(point, crop), torch.tensor([[256.0, 144], [256, 144]], dtype=torch.float64))
    shift = torch.tensor([0.1, 0, 0], dtype=torch.float64)
    moved = (project(point + shift, crop) - project(point, crop))[:, 0]
    before = (project(point + shift, intrinsics) - project(point, intrinsics))[:, 0]
    torch.testing.assert_close(moved, 0.4 * before)
