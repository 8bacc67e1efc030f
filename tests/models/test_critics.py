"""A view is defined by what it does not see."""

import math

import pytest
import torch

from sag.components import Components, Network, build_critics
from sag.geometry.camera import project
from sag.models.critics import CROP_EVERY
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19
from sag.types import Batch, Condition, DepthMap, Motion

ALL = Components()
NONE = Components(False, False, False, False)


def critic(name: str, scale: MotionScale, components: Components = ALL, **network):
    return build_critics(components, Network(width=0.1, critic_norm="layer", **network), GTA_IM_19, scale)[name]


def seen(batch: Batch) -> DepthMap:
    return DepthMap(batch.scene.depth, batch.scene.intrinsics)


def condition(count: int) -> Condition:
    feature = Network(width=0.1).generator_sizes.feature
    return Condition(torch.randn(count, feature), torch.randn(count, 57))


@pytest.mark.parametrize("name", ["trajectory", "pose", "projection", "context"])
def test_every_view_is_scored(name: str, batch: Batch, scale: MotionScale) -> None:
    judge = critic(name, scale)
    assert judge(judge.view(batch.motion, seen(batch)), condition(4)).shape == (4,)


def test_csgn_has_one_critic_of_the_whole_motion(batch: Batch, scale: MotionScale) -> None:
    assert list(build_critics(NONE, Network(width=0.1), GTA_IM_19, scale)) == ["motion"]
    judge = critic("motion", scale, NONE)
    assert judge(judge.view(batch.motion, seen(batch)), condition(4)).shape == (4,)


@pytest.mark.parametrize("name", ["trajectory", "pose", "projection", "context"])
def test_views_are_differentiable_in_the_motion(name: str, batch: Batch, scale: MotionScale) -> None:
    trajectory = batch.motion.trajectory.clone().requires_grad_()
    motion = Motion(batch.motion.start, trajectory, batch.motion.pose)
    critic(name, scale).view(motion, seen(batch)).square().sum().backward()
    assert trajectory.grad.abs().sum() > 0


def test_projection_does_not_change_along_the_ray(batch: Batch, scale: MotionScale) -> None:
    view = critic("projection", scale).view
    joints = batch.motion.joints
    further = joints.clone()
    further[:, 5:, 3] *= 1.3  # one joint moves along its rays
    further[:, 7, 12] *= 0.8  # the root of one frame too
    moved = Motion.from_joints(further, GTA_IM_19.root_index)
    assert torch.allclose(view(batch.motion, seen(batch)), view(moved, seen(batch)), atol=1e-4)


def test_projection_sees_a_step_aside(batch: Batch, scale: MotionScale) -> None:
    view = critic("projection", scale).view
    aside = batch.motion.joints.clone()
    aside[:, 9, 3, 0] += 0.1
    change = view(Motion.from_joints(aside, 12), seen(batch)) - view(batch.motion, seen(batch))
    assert change[:, 3, 0, 9].abs().min() > 0.01
    assert (change.abs() > 1e-5).sum() == len(batch)


def test_projection_starts_at_the_centre(batch: Batch, scale: MotionScale) -> None:
    root = critic("projection", scale).view(batch.motion, seen(batch))[:, GTA_IM_19.root_index, :, 0]
    assert root.abs().max() < 1e-4


def test_projection_is_finite_behind_the_camera(batch: Batch, scale: MotionScale) -> None:
    behind = batch.motion.joints.clone()
    behind[:, 30:, :, 2] -= 8
    assert critic("projection", scale).view(Motion.from_joints(behind, 12), seen(batch)).isfinite().all()


def test_context_sees_only_the_root_at_every_eighth_frame(batch: Batch, scale: MotionScale) -> None:
    view = critic("context", scale).view
    other = Motion(batch.motion.start, batch.motion.trajectory.clone(), torch.randn_like(batch.motion.pose))
    between = [t for t in range(65) if t % CROP_EVERY]
    other.trajectory[:, between] += 1
    assert torch.equal(view(batch.motion, seen(batch)), view(other, seen(batch)))


def test_context_is_relative_to_the_body(batch: Batch, scale: MotionScale) -> None:
    view = critic("context", scale).view
    flat = DepthMap(torch.full_like(batch.scene.depth, 4.0), batch.scene.intrinsics)
    crops = view(batch.motion, flat)
    wanted = 4.0 - batch.motion.roots[:, ::CROP_EVERY, 2]
    assert torch.allclose(crops, wanted[:, :, None, None].expand_as(crops), atol=1e-4)


@pytest.mark.parametrize("crop_scale", [1.0, 3.0])
def test_context_crop_is_a_quarter_of_the_picture_at_a_metre(
    batch: Batch, scale: MotionScale, crop_scale: float
) -> None:
    rows, columns = batch.scene.depth.shape[1:]
    ramp = torch.arange(columns).float().add(0.5).expand_as(batch.scene.depth).contiguous()
    judge = critic("context", scale, crop_scale=crop_scale)
    crops = judge.view(batch.motion, DepthMap(ramp, batch.scene.intrinsics)) + batch.motion.start[:, None, None, 2:]
    first = crops[:, 0]
    assert first.shape[1:] == (rows // 4, columns // 4)
    width = columns / 4 * crop_scale / batch.motion.start[:, 2]  # (W_c / d) pixels
    spacing = width / (columns // 4)
    assert torch.allclose(first[:, 0, 1] - first[:, 0, 0], spacing, rtol=1e-3)
    centre = project(batch.motion.start, batch.scene.intrinsics)[:, 0]
    assert torch.allclose(first.mean((1, 2)), centre, atol=1e-2)


def test_context_takes_unknown_depth_for_far(batch: Batch, scale: MotionScale) -> None:
    nothing = DepthMap(torch.zeros_like(batch.scene.depth), batch.scene.intrinsics)
    assert critic("context", scale).view(batch.motion, nothing).min() > 10


def test_trajectory_critic_does_not_see_the_pose(batch: Batch, scale: MotionScale) -> None:
    view = critic("trajectory", scale).view
    other = Motion(batch.motion.start, batch.motion.trajectory, torch.randn_like(batch.motion.pose))
    assert torch.equal(view(batch.motion, seen(batch)), view(other, seen(batch)))


def test_penalty_without_batch_norm_keeps_samples_apart(batch: Batch, scale: MotionScale) -> None:
    judge = critic("pose", scale)
    view = judge.view(batch.motion, seen(batch)).detach().requires_grad_()
    (gradient,) = torch.autograd.grad(judge(view, condition(4))[0], view)
    assert gradient[0].abs().sum() > 0
    assert gradient[1:].abs().max() == 0


def test_scores_do_not_explode_at_the_start(batch: Batch, scale: MotionScale) -> None:
    judge = critic("projection", scale)
    scores = judge(judge.view(batch.motion, seen(batch)), condition(4))
    assert math.isfinite(scores.sum().item())
    assert scores.abs().max() < 10


@pytest.mark.parametrize("name", ["trajectory", "pose", "projection", "motion"])
@pytest.mark.parametrize("kind", ["plain", "balanced"])
def test_a_balanced_condition_has_half_of_what_a_critic_hears(name: str, kind: str, scale: MotionScale) -> None:
    torch.manual_seed(0)
    components = NONE if name == "motion" else ALL
    shares = []
    for _ in range(5):
        judge = critic(name, scale, components, critic_condition=kind)
        views = torch.randn(200, 3, 64) if name == "trajectory" else torch.randn(200, 19, _judged(name), 65)
        told = condition(200)
        heard = [_first_sum(judge, name, x, c) for x, c in ((views, _silent(told)), (_silent(views), told))]
        motion, scene = (x.var(dim=0).mean() for x in heard)
        shares.append(float(scene / (motion + scene)))
    share = sum(shares) / len(shares)
    assert 0.4 < share < 0.6 if kind == "balanced" else share > 0.8


def _judged(name: str) -> int:
    return {"pose": 6, "projection": 2, "motion": 3}[name]


def _silent(x):
    return x._map(torch.zeros_like) if isinstance(x, Condition) else torch.zeros_like(x)


def _first_sum(judge, name: str, view: torch.Tensor, told: Condition) -> torch.Tensor:
    """What the first convolution makes of a view and a condition, before its norm and away from the ends of time."""
    block = judge.network.blocks[0]
    caught: list[torch.Tensor] = []
    conv = block[1] if name == "trajectory" else block.conv
    hook = conv.register_forward_hook(lambda module, given, made: caught.append(made))
    with torch.no_grad():
        judge(view, told)
    hook.remove()
    return caught[0][..., 1:-1]
