"""Capsules and their footprints in a picture."""

import math

import numpy as np
import pytest
import torch

from sag.geometry.camera import project
from sag.geometry.capsule import footprints, points_in_capsules, squared_distance_to_segment

SIZE = (72, 128)
CAMERA = torch.tensor([[110.0, 0, 60], [0, 115, 37], [0, 0, 1]], dtype=torch.float64)


def random_segments(seed: int, count: int, depth: float) -> tuple[torch.Tensor, torch.Tensor]:
    generator = torch.manual_seed(seed)
    starts = torch.randn(count, 3, generator=generator, dtype=torch.float64)
    starts[:, 2] += depth
    return starts, starts + 0.3 * torch.randn(count, 3, generator=generator, dtype=torch.float64)


@pytest.mark.parametrize(
    ("point", "distance"),
    [((0.5, 0.2, 0), 0.2), ((-0.3, 0.4, 0), 0.5), ((1.3, 0, 0.4), 0.5), ((0.7, 0, 0), 0)],
    ids=["beside", "before the start", "after the end", "on it"],
)
def test_distance_to_a_segment(point, distance):
    start, end = torch.zeros(3, dtype=torch.float64), torch.tensor([1.0, 0, 0], dtype=torch.float64)
    found = squared_distance_to_segment(torch.tensor(point, dtype=torch.float64), start, end).sqrt()
    assert float(found) == pytest.approx(distance)


def test_a_segment_without_length_is_a_point():
    start = torch.tensor([1.0, 2, 3])
    assert float(squared_distance_to_segment(torch.tensor([1.0, 2, 5]), start, start)) == 4


def test_distances_are_those_of_the_cross_product_and_a_cylinder_ends_flat():
    starts, ends = random_segments(0, 40, 0)
    points = torch.randn(500, 1, 3, generator=torch.manual_seed(1), dtype=torch.float64)
    a, b, p = (x.numpy() for x in (starts, ends, points))
    length = np.linalg.norm(b - a, axis=-1)
    to_line = np.linalg.norm(np.cross(p - a, p - b), axis=-1) / length
    to_ends = np.minimum(np.linalg.norm(p - a, axis=-1), np.linalg.norm(p - b, axis=-1))
    beside = abs(((p - a) * (b - a)).sum(-1) / length - length / 2) <= length / 2
    capsule, cylinder = (squared_distance_to_segment(points, starts, ends, s).sqrt() for s in ("capsule", "cylinder"))
    np.testing.assert_allclose(capsule, np.where(beside, to_line, to_ends), atol=1e-9)
    np.testing.assert_allclose(cylinder, np.where(beside, to_line, np.inf), atol=1e-9)
    assert beside.any() and not beside.all()


def test_distance_has_right_gradients():
    points, (starts, ends) = torch.randn(4, 3, dtype=torch.float64), random_segments(0, 4, 2)
    assert torch.autograd.gradcheck(squared_distance_to_segment, [x.requires_grad_() for x in (points, starts, ends)])


@pytest.mark.parametrize("shape", ["capsule", "cylinder"])
def test_share_of_points_inside_is_the_share_of_volume(shape):
    points = torch.rand(400_000, 3, generator=torch.manual_seed(0), dtype=torch.float64) - 0.5
    start, end = torch.tensor([[-0.2, 0, 0]]).double(), torch.tensor([[0.2, 0, 0]]).double()
    volume = math.pi * 0.2**2 * 0.4 + (4 / 3 * math.pi * 0.2**3 if shape == "capsule" else 0)
    inside = points_in_capsules(points, start, end, 0.2, shape).double().mean()
    assert float(inside) == pytest.approx(volume, rel=0.02)


def test_points_inside_grow_with_the_radius_and_with_capsules():
    points = torch.randn(2000, 3, generator=torch.manual_seed(0), dtype=torch.float64)
    starts, ends = random_segments(1, 6, 0)
    small, large = (points_in_capsules(points, starts, ends, r) for r in (0.2, 0.4))
    assert small.any() and not (small & ~large).any() and large.sum() > small.sum()
    each = torch.stack([points_in_capsules(points, a[None], b[None], 0.2) for a, b in zip(starts, ends)])
    assert torch.equal(each.any(0), small)


@pytest.mark.parametrize(("depth", "nearest"), [(3.0, 0.0), (0.2, 0.0), (0.2, 0.3)])
def test_no_point_of_a_capsule_is_seen_outside_its_footprint(depth, nearest):
    starts, ends = random_segments(2, 300, depth)
    boxes = footprints(starts, ends, 0.06, CAMERA, SIZE, nearest)
    generator = torch.manual_seed(3)
    along = torch.rand(300, 500, 1, generator=generator, dtype=torch.float64)
    outward = torch.nn.functional.normalize(torch.randn(300, 500, 3, generator=generator, dtype=torch.float64), dim=-1)
    surface = starts[:, None] + along * (ends - starts)[:, None] + 0.06 * outward
    column, row = project(surface, CAMERA.expand(300, 3, 3), nearest=1e-9).floor().unbind(-1)
    visible = (surface[..., 2] > max(nearest, 1e-6)) & (row >= 0) & (row < SIZE[0]) & (column >= 0) & (column < SIZE[1])
    top, bottom, left, right = (x[:, None] for x in boxes.T)
    # A pixel may be entered at its edge while its centre, which is the point that is tested, is not.
    contained = (row >= top - 1) & (row <= bottom) & (column >= left - 1) & (column <= right)
    assert visible.any() and contained[visible].all()


def test_a_footprint_is_tight():
    start = torch.tensor([[0.0, 0, 3]], dtype=torch.float64)
    top, bottom, left, right = footprints(start, start, 0.06, CAMERA, SIZE)[0].tolist()
    assert (right - left, bottom - top) == pytest.approx((2 * 0.06 / 3 * 110, 2 * 0.06 / 3 * 115), abs=1)


def test_a_capsule_across_the_camera_plane_may_be_anywhere_and_one_behind_nowhere():
    across = torch.tensor([[0.0, 0, -1]], dtype=torch.float64), torch.tensor([[0.0, 0, 1]], dtype=torch.float64)
    assert footprints(*across, 0.06, CAMERA, SIZE)[0].tolist() == [0, 72, 0, 128]
    near = footprints(*across, 0.06, CAMERA, SIZE, nearest=0.5)[0]
    assert near[1] - near[0] < 72
    behind = across[0], across[0] - 0.5
    top, bottom, left, right = footprints(*behind, 0.06, CAMERA, SIZE)[0].tolist()
    assert (top, left) == (bottom, right)
