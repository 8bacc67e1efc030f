import pytest
import torch

from sag.components import Components, Network, build_encoder, build_generator
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19, PROX_16
from sag.types import Batch, Motion

SMALL = Network(width=0.1)


@pytest.fixture(params=[True, False], ids=["separate", "joint"])
def sampler(request: pytest.FixtureRequest, scale: MotionScale) -> Sampler:
    generator = build_generator(Components(separate=request.param), SMALL, GTA_IM_19, scale)
    return Sampler(build_encoder(SMALL), generator, scale).eval()


def sampled(sampler: Sampler, batch: Batch, seed: int = 0) -> Motion:
    return sampler(batch.scene, batch.motion, torch.Generator().manual_seed(seed))


def test_a_motion_starts_at_the_given_frame(sampler: Sampler, batch: Batch) -> None:
    motion = sampled(sampler, batch)
    assert motion.joints.shape == (4, 65, 19, 3)
    assert torch.allclose(motion.joints[:, 0], batch.motion.joints[:, 0], atol=1e-6)


def test_the_root_is_at_the_root(sampler: Sampler, batch: Batch) -> None:
    motion = sampled(sampler, batch)
    assert motion.pose[:, :, GTA_IM_19.root_index].abs().max() == 0
    assert motion.trajectory[:, 0].abs().max() == 0


def test_the_future_is_not_looked_at(sampler: Sampler, batch: Batch) -> None:
    first = sampled(sampler, batch)
    batch.motion.trajectory[:, 1:] += 1
    batch.motion.pose[:, 1:] *= 2
    assert torch.equal(first.joints, sampled(sampler, batch).joints)


def test_noise_makes_motions_differ(sampler: Sampler, batch: Batch) -> None:
    assert not torch.allclose(sampled(sampler, batch, 0).joints, sampled(sampler, batch, 1).joints)


def test_left_differs_from_right(sampler: Sampler, batch: Batch) -> None:
    motion = sampled(sampler, batch)
    unit = (motion.pose[:, 1:] - sampler.scale.pose_mean) / sampler.scale.pose_std
    left, right = (
        GTA_IM_19.index(*(f"{s}_{n}" for n in ("wrist", "elbow", "knee", "ankle"))) for s in ("left", "right")
    )
    assert (unit[:, :, left] - unit[:, :, right]).abs().mean() > 0.01


def test_speed_is_limited_by_alpha(batch: Batch, scale: MotionScale) -> None:
    generator = build_generator(Components(), SMALL, GTA_IM_19, scale)
    motion = sampled(Sampler(build_encoder(SMALL), generator, scale).eval(), batch)
    assert motion.trajectory.diff(dim=1).abs().max() <= scale.speed_limit * 1.0001


def test_gradients_reach_every_parameter(sampler: Sampler, batch: Batch) -> None:
    sampler.train()
    sampler(batch.scene, batch.motion).joints.square().sum().backward()
    idle = [name for name, p in sampler.named_parameters() if p.grad is None or not p.grad.abs().sum()]
    # The root of a root-relative pose is always zero, so nothing else may be idle.
    assert not idle


def test_metres_leave_the_units_alone(toy) -> None:
    metres = MotionScale(19, GTA_IM_19.root_index, units="metres")
    metres.fit(toy.training_motion)
    assert metres.pose_std.eq(1).all()
    assert metres.trajectory_std.eq(1).all()
    assert 0 < metres.speed_limit < 0.1


def test_alpha_is_above_nearly_all_speeds(toy, scale: MotionScale) -> None:
    speeds = toy.training_motion.trajectory.diff(dim=1).norm(dim=-1)
    assert (speeds < scale.speed_limit).float().mean() >= 0.999


def test_scaled_motion_has_unit_deviation(toy, scale: MotionScale) -> None:
    motion = toy.training_motion
    unit = ((motion.pose[:, 1:] - scale.pose_mean) / scale.pose_std).flatten(0, 1)
    free = scale.pose_std > 0.031
    assert torch.allclose(unit.std(0)[free], torch.ones(int(free.sum())), atol=1e-3)


def test_another_skeleton_has_its_own_shape() -> None:
    generator = build_generator(Components(), SMALL, PROX_16, MotionScale(16, PROX_16.root_index)).eval()
    assert generator.pose(torch.randn(1, generator.pose.blocks[0].conv.weight.shape[2], 6)).shape == (1, 64, 16, 3)


def test_the_pose_can_be_given_velocities_in_place_of_places(batch: Batch, scale: MotionScale) -> None:
    motions = {}
    for sees in ("places", "velocities"):
        torch.manual_seed(0)
        network = Network(width=0.1, pose_sees=sees)
        generator = build_generator(Components(), network, GTA_IM_19, scale)
        motions[sees] = sampled(Sampler(build_encoder(network), generator, scale).eval(), batch)
    places, velocities = motions.values()
    assert torch.equal(places.trajectory, velocities.trajectory)
    assert not torch.allclose(places.pose, velocities.pose, atol=1e-4)
