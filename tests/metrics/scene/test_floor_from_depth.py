"""The floor from depth: level, steps, ramps, furniture, what nobody saw."""

import pytest
import torch
from torch import Tensor

from sag.errors import SagError
from sag.geometry.camera import pixel_centres
from sag.metrics.scene.floor_from_depth import floor_under_feet
from sag.types import DepthMap

HEIGHT = 4.0
"""Of the camera over the ground: it looks straight down at the origin, x to the right."""

LOOKING_DOWN = torch.tensor([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, HEIGHT], [0, 0, 0, 1]])
CAMERA = torch.tensor([[80.0, 0, 100], [0, 80, 100], [0, 0, 1]])


def seen(heights, finer: int = 1) -> DepthMap:
    """What the camera sees of a ground whose height is this function of x, metres (upright faces stay unseen)."""
    size = 200 * finer
    camera = CAMERA * torch.tensor([finer, finer, 1])[:, None]
    rays = (pixel_centres(size, size, like=CAMERA) - size / 2) / (80 * finer)
    depth = torch.full((size, size), HEIGHT)
    for _ in range(60):  # towards the first surface along the ray
        depth = (HEIGHT - heights(rays[..., 0] * depth)).minimum(depth)
    return DepthMap(depth[None], camera[None])


def walk(start: float, end: float, heights=torch.zeros_like) -> Tensor:
    """Two ankles along x, the first frame on the floor."""
    x = torch.linspace(start, end, 65)
    return torch.stack([x, torch.full_like(x, 0.33), heights(x) + 0.085], -1)[None, :, None].repeat(1, 1, 2, 1)


def floor_of(world: Tensor, cloud: DepthMap, **options: float) -> Tensor:
    return floor_under_feet(world, [0, 1], cloud, LOOKING_DOWN[None], **options)[0]


def test_level_ground_wherever_the_body_is():
    world = walk(-1.5, 1.5)
    for lift in (-0.5, 0, 1):
        moved = torch.cat([world[:, :1], world[:, 1:] + torch.tensor([0, 0, lift])], dim=1)
        torch.testing.assert_close(floor_of(moved, seen(torch.zeros_like)), torch.zeros(65, 2), atol=1e-5, rtol=0)


def test_a_step_up_and_down():
    def step(x):
        return 0.15 * (x > 0)

    for start, end in ((-1.5, 1.5), (1.5, -1.5)):
        world = walk(start, end, step)
        away = world[0, :, 0, 0].abs() > 0.15
        expected = step(world[0, :, :, 0])
        torch.testing.assert_close(floor_of(world, seen(step))[away], expected[away], atol=1e-3, rtol=0)


def test_a_ramp_within_half_a_square():
    def ramp(x):
        return 0.15 * (x + 1.5).clamp_min(0)

    world = walk(-1.5, 0.5, ramp)
    assert (floor_of(world, seen(ramp)) - ramp(world[0, :, :, 0])).abs().max() < 0.15 * 0.1


def test_furniture_is_no_floor_unless_it_is_asked_for():
    def seat(x):
        return 0.45 * (x > 0.5)

    world = walk(-1, 1.5)
    assert floor_of(world, seen(seat)).abs().max() < 1e-3
    assert floor_of(world, seen(seat), rise=0.5).max() == pytest.approx(0.45, abs=1e-3)


def test_a_few_wrong_points_below_are_no_floor():
    cloud = seen(torch.zeros_like, finer=2)
    wrong = torch.rand(cloud.depth.shape, generator=torch.manual_seed(0)) < 0.01
    cloud.depth[wrong] += 0.5
    assert floor_of(walk(-1.5, 1.5), cloud).abs().quantile(0.95) < 1e-3


def test_unseen_ground_takes_the_nearest_that_was_seen():
    def step(x):
        return 0.15 * (x > 0)

    cloud = seen(step)
    cloud.depth[:, :, 110:] = 0  # all but the step's first 40 cm
    floor = floor_of(walk(-1.5, 3, step), cloud)
    assert floor[-1].tolist() == pytest.approx([0.15, 0.15], abs=1e-3)


def test_without_any_point_the_level_of_the_lower_foot_in_frame_0_is_all_there_is():
    world = walk(-1, 1)
    world[..., 2] += 0.7
    world[:, 0, 1, 2] += 0.2
    nothing = DepthMap(torch.zeros(1, 200, 200), CAMERA[None])
    torch.testing.assert_close(floor_of(world, nothing), torch.full((65, 2), 0.7))
    torch.testing.assert_close(floor_of(world, nothing, ankle_height=0.185), torch.full((65, 2), 0.6))


def test_a_camera_elsewhere_that_sees_the_same_ground():
    def step(x):
        return 0.15 * (x > 0)

    turn = torch.eye(4)
    turn[:2, :2] = torch.tensor([[0.6, -0.8], [0.8, 0.6]])
    turn[:3, 3] = torch.tensor([3.0, -2, 5])
    world = walk(-1.5, 1.5, step)
    moved = world @ turn[:3, :3].T + turn[:3, 3]
    found = floor_under_feet(moved, [0, 1], seen(step), (LOOKING_DOWN @ turn.inverse())[None])[0] - 5
    away = world[0, :, 0, 0].abs() > 0.2
    torch.testing.assert_close(found[away], step(world[0, :, :, 0])[away], atol=1e-3, rtol=0)


def test_batches_types_and_pictures_of_any_size():
    world, cloud = walk(-1.5, 1.5), seen(lambda x: 0.1 * (x > 0))
    both = DepthMap(torch.cat([cloud.depth, seen(torch.zeros_like).depth]), CAMERA.expand(2, 3, 3))
    found = floor_under_feet(world.expand(2, 65, 2, 3), [0, 1], both, LOOKING_DOWN.expand(2, 4, 4))
    assert torch.equal(found[0], floor_of(world, cloud)) and found[1].abs().max() < 1e-3
    assert floor_of(world.double(), cloud).dtype == torch.float64
    assert floor_under_feet(world[:0], [0, 1], cloud[:0], LOOKING_DOWN[None][:0]).shape == (0, 65, 2)
    away = world[0, :, 0, 0].abs() > 0.2
    fine = seen(lambda x: 0.1 * (x > 0), finer=4)
    torch.testing.assert_close(floor_of(world, fine)[away], floor_of(world, cloud)[away], atol=1e-3, rtol=0)


def test_refuses():
    with pytest.raises(SagError, match="a depth cloud for each of 2 motions, not 1"):
        floor_under_feet(walk(0, 1).expand(2, 65, 2, 3), [0, 1], seen(torch.zeros_like), LOOKING_DOWN.expand(2, 4, 4))


def test_a_run_in_low_precision_changes_no_height():
    world, cloud = walk(-1.5, 1.5), seen(torch.zeros_like)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        found = floor_of(world, cloud)
    assert torch.equal(found, floor_of(world, cloud)) and floor_of(world.bfloat16(), cloud).dtype == torch.float32
