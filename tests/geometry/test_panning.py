"""A moved picture: what it shows, where it is known, and that its camera still sees the same points."""

import pytest
import torch

from sag.geometry.camera import point_cloud, project
from sag.geometry.panning import in_picture, offset_to, panned
from sag.types import Scene


@pytest.fixture
def scene() -> Scene:
    """Two pictures of 36 x 64 whose centre sees the points (0, 0, z)."""
    intrinsics = torch.tensor([[60.0, 0, 32], [0, 60, 18], [0, 0, 1]]).expand(2, 3, 3)
    return Scene(torch.rand(2, 3, 36, 64), 1 + torch.rand(2, 36, 64), torch.rand(2, 36, 64) > 0.7, intrinsics)


def test_a_point_at_the_centre_leaves_the_scene_as_it_is(scene):
    point = torch.tensor([[0.0, 0, 2], [0.007, -0.007, 1]])  # less than half a pixel off
    offset = offset_to(scene, point)
    assert offset.tolist() == [[0, 0], [0, 0]]
    moved = panned(scene, offset)
    for name in ("image", "depth", "person", "intrinsics"):
        assert torch.equal(getattr(moved, name), getattr(scene, name))


def test_a_point_comes_to_the_centre_within_half_a_pixel(scene):
    point = torch.tensor([[0.3, -0.1, 1.7], [-0.55, 0.21, 3.1]])
    pixel = project(point, panned(scene, offset_to(scene, point)).intrinsics)
    assert ((pixel - torch.tensor([32, 18])).abs() <= 0.5 + 1e-4).all()


def test_pixels_go_where_they_are_sent_and_nothing_is_made_up(scene):
    moved = panned(scene, torch.tensor([[3, -2], [-64, 0]]))
    assert torch.equal(moved.image[0, :, :34, 3:], scene.image[0, :, 2:, :-3])
    assert torch.equal(moved.depth[0, :34, 3:], scene.depth[0, 2:, :-3])
    assert torch.equal(moved.person[0, :34, 3:], scene.person[0, 2:, :-3])
    for empty in (moved[0:1].depth[:, :, :3], moved[0:1].depth[:, 34:], moved[0:1].image[..., :3], moved[1:].image):
        assert not empty.any()
    assert not moved.person[0, :, :3].any()


def test_every_known_pixel_is_still_the_same_point_of_the_room(scene):
    moved = panned(scene, torch.tensor([[5, 4], [-7, 1]]))
    before, after = (point_cloud(s.depth, s.intrinsics) for s in (scene, moved))
    assert torch.allclose(after[0, 4:, 5:], before[0, :-4, :-5], atol=1e-5)
    assert torch.allclose(after[1, 1:, :-7], before[1, :-1, 7:], atol=1e-5)


def test_what_lies_outside_or_behind_is_not_in_the_picture(scene):
    assert in_picture(scene, torch.tensor([[0.5, 0.2, 1], [0.0, 0, -2]])).tolist() == [True, False]
    assert in_picture(scene, torch.tensor([[0.6, 0.0, 1], [0.0, 0.4, 1]])).tolist() == [False, False]
