import pytest
import torch
from torch import nn

from sag.geometry.camera import project
from sag.models.cao.blocks import Hourglass, Seen
from sag.models.cao.goal_net import GoalNet, goal_loss
from sag.models.cao.heat_maps import heat_maps, map_size
from sag.models.cao.path_net import KNOT_EVERY, KNOTS, PathNet, Spline
from sag.models.cao.pose_net import PoseNet
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19
from sag.types import Batch, Condition

JOINTS, FEATURE, TOLD = 19, 16, 16 + 57
SIZES = [(36, 64), (37, 65), (72, 128)]


def seen_of(batch: Batch, scale: MotionScale, size: tuple[int, int] | None = None) -> Seen:
    count = len(batch)
    image = batch.scene.image if size is None else torch.rand(count, 3, *size)
    joints = project(batch.motion.joints[:, 0], batch.scene.intrinsics)
    feature = torch.randn(count, FEATURE, requires_grad=True)
    condition = Condition(feature, scale.initial_pose(batch.motion))
    return Seen(image, heat_maps(joints, map_size(*image.shape[-2:])), condition)


@pytest.fixture
def seen(batch: Batch, scale: MotionScale) -> Seen:
    return seen_of(batch, scale)


def goal_map(seen: Seen, pixels: torch.Tensor) -> torch.Tensor:
    return heat_maps(pixels[:, None], (seen.joints.shape[-2], seen.joints.shape[-1]))


def goal_net() -> GoalNet:
    made = GoalNet(JOINTS, FEATURE, (8, 8, 16, 16), latent=4)
    nn.init.normal_(made.out.weight)
    return made


def idle(network: nn.Module) -> list[str]:
    return [name for name, p in network.named_parameters() if p.grad is None or not p.grad.abs().sum()]


@pytest.mark.parametrize("size", SIZES)
def test_goal_maps_have_a_quarter_of_the_pictures_size(size: tuple[int, int], batch: Batch, scale: MotionScale) -> None:
    seen = seen_of(batch, scale, size)
    made = goal_net()
    assert made.sample(seen, torch.randn(4, 4)).shape == (4, *map_size(*size))
    predicted, mean, log_variance = made(seen, goal_map(seen, torch.full((4, 2), 20.0)), torch.randn(4, 4))
    assert predicted.shape == (4, *map_size(*size))
    assert mean.shape == log_variance.shape == (4, 4)


def test_goal_gradients_reach_every_parameter_and_the_feature(seen: Seen) -> None:
    made = goal_net()
    goal = goal_map(seen, torch.full((4, 2), 20.0))
    error, divergence = goal_loss(*_with_truth(made(seen, goal, torch.randn(4, 4)), goal))
    (error + divergence).backward()
    assert not idle(made)
    assert seen.condition.feature.grad.abs().sum() > 0


def _with_truth(found: tuple, goal: torch.Tensor) -> tuple:
    return found[0], goal[:, 0], *found[1:]


def test_an_untrained_goal_net_says_nothing(seen: Seen) -> None:
    assert not GoalNet(JOINTS, FEATURE, (8, 8, 16, 16), latent=4).sample(seen, torch.randn(4, 4)).any()


def test_goal_loss_is_zero_for_the_truth_and_one_for_nothing() -> None:
    true = heat_maps(torch.tensor([[[60.0, 36.0]]]), (18, 32))[:, 0]
    normal = (torch.zeros(1, 5), torch.zeros(1, 5))
    assert [x.item() for x in goal_loss(true, true, *normal)] == [0.0, 0.0]
    error, _ = goal_loss(torch.zeros_like(true), true, *normal)
    assert error.item() == pytest.approx(1, rel=1e-3)


def test_divergence_is_that_of_a_normal_distribution() -> None:
    mean, log_variance = torch.full((2, 3), 0.7), torch.full((2, 3), -0.4)
    own, prior = torch.distributions.Normal(0.7, torch.tensor(-0.2).exp()), torch.distributions.Normal(0.0, 1.0)
    _, divergence = goal_loss(torch.zeros(2, 4, 4), torch.zeros(2, 4, 4), mean, log_variance)
    assert divergence.item() == pytest.approx(3 * torch.distributions.kl_divergence(own, prior).item(), rel=1e-5)


@pytest.mark.parametrize("size", [(18, 32), (9, 16), (5, 7), (2, 3)])
def test_an_hourglass_keeps_any_size(size: tuple[int, int]) -> None:
    assert Hourglass(8, 3)(torch.randn(2, 8, *size)).shape == (2, 8, *size)


def test_an_hourglass_sees_the_whole_map() -> None:
    made = Hourglass(8, 3).eval()
    x = torch.randn(1, 8, 16, 16, requires_grad=True)
    made(x)[0, :, 0, 0].sum().backward()
    assert x.grad[0, :, 12, 12].abs().sum() > 0


def path_of(made: PathNet, seen: Seen, batch: Batch, pixels: torch.Tensor) -> torch.Tensor:
    return made(seen, goal_map(seen, pixels), batch.motion.start, batch.scene.intrinsics)


@pytest.mark.parametrize("size", SIZES)
def test_a_path_has_64_places(size: tuple[int, int], batch: Batch, scale: MotionScale) -> None:
    made = PathNet(JOINTS, TOLD, channels=16)
    assert path_of(made, seen_of(batch, scale, size), batch, torch.full((4, 2), 20.0)).shape == (4, 64, 3)


def test_path_gradients_reach_every_parameter_and_the_feature(seen: Seen, batch: Batch) -> None:
    made = PathNet(JOINTS, TOLD, channels=16)
    path_of(made, seen, batch, torch.full((4, 2), 20.0)).square().sum().backward()
    assert not idle(made)
    assert seen.condition.feature.grad.abs().sum() > 0


def test_a_path_stays_in_the_picture_at_its_knots(seen: Seen, batch: Batch) -> None:
    made = PathNet(JOINTS, TOLD, channels=16).eval()
    nn.init.normal_(made.out[-1].weight, std=5.0)
    path = path_of(made, seen, batch, torch.full((4, 2), 20.0)) + batch.motion.start[:, None]
    pixels = project(path[:, KNOT_EVERY - 1 :: KNOT_EVERY], batch.scene.intrinsics)
    rows, columns = batch.scene.image.shape[-2:]
    assert ((pixels > -1e-3) & (pixels < torch.tensor([columns, rows]) + 1e-3)).all()


def test_another_goal_is_another_path(seen: Seen, batch: Batch) -> None:
    made = PathNet(JOINTS, TOLD, channels=16).eval()
    paths = [path_of(made, seen, batch, torch.full((4, 2), place)) for place in (8.0, 30.0)]
    assert not torch.allclose(*paths)


def test_a_spline_goes_through_its_knots_and_straight_on() -> None:
    spline, knots = Spline(), torch.randn(2, KNOTS, 3)
    assert torch.allclose(spline(knots)[:, KNOT_EVERY - 1 :: KNOT_EVERY], knots, atol=1e-5)
    straight = torch.arange(65.0)[None, :, None] * torch.tensor([0.01, 0, -0.02])
    assert torch.allclose(spline.smoothed(straight), straight[:, 1:], atol=1e-5)


def pose_net(scale: MotionScale) -> PoseNet:
    return PoseNet(scale, JOINTS, TOLD, channels=16, layers=2)


def test_refining_begins_at_the_guess(seen: Seen, batch: Batch, scale: MotionScale) -> None:
    made = pose_net(scale)
    nn.init.zeros_(made.out.weight)
    path = batch.motion.trajectory[:, 1:]
    motion = made(seen, batch.motion, path)
    assert torch.allclose(motion.trajectory[:, 1:], path)
    assert torch.allclose(motion.pose, batch.motion.pose[:, :1].expand_as(motion.pose))


def test_a_pose_hangs_on_its_root(seen: Seen, batch: Batch, scale: MotionScale) -> None:
    made = pose_net(scale)
    nn.init.normal_(made.out.weight)
    assert not made(seen, batch.motion, batch.motion.trajectory[:, 1:]).pose[:, :, GTA_IM_19.root_index].any()


def test_a_frame_heeds_every_other(seen: Seen, batch: Batch, scale: MotionScale) -> None:
    made = pose_net(scale)
    path = batch.motion.trajectory[:, 1:].clone().requires_grad_()
    made(seen, batch.motion, path).pose[:, 1].abs().sum().backward()
    assert path.grad[:, -1].abs().sum() > 0


def test_pose_gradients_reach_every_parameter_and_the_feature(seen: Seen, batch: Batch, scale: MotionScale) -> None:
    made = pose_net(scale)
    made(seen, batch.motion, batch.motion.trajectory[:, 1:]).joints.square().sum().backward()
    assert not idle(made)
    assert seen.condition.feature.grad.abs().sum() > 0
