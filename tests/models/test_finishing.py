import math

import pytest
import torch

from sag.components import Components, Network, build_encoder, build_generator
from sag.errors import SagError
from sag.models.finishing import KeptBones, Smooth
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19, PROX_16, Skeleton
from sag.types import FRAMES, Batch, Motion

BODIES = [GTA_IM_19, PROX_16]


def bones(skeleton: Skeleton, pose: torch.Tensor) -> torch.Tensor:
    start, end = torch.as_tensor(skeleton.bone_index).T
    return pose[:, :, end] - pose[:, :, start]


def random_motion(skeleton: Skeleton, frames: int = FRAMES) -> Motion:
    joints = torch.randn(2, frames, len(skeleton.joints), 3, generator=torch.Generator().manual_seed(3)).double()
    return Motion.from_joints(joints, skeleton.root_index)


def swing(hertz: float) -> Motion:
    """One joint of PROX's skeleton and the root swing by 1 m, at 30 frames a second."""
    times = torch.arange(FRAMES, dtype=torch.float64) / 30
    wave = torch.sin(2 * math.pi * hertz * times)
    pose = torch.zeros(1, FRAMES, 16, 3, dtype=torch.float64)
    pose[0, :, 5, 0] = wave
    return Motion(torch.zeros(1, 3).double(), torch.stack([wave] * 3, dim=-1)[None], pose)


@pytest.mark.parametrize("skeleton", BODIES, ids=lambda s: s.name)
def test_bones_are_as_long_as_in_frame_0_and_point_where_they_did(skeleton: Skeleton) -> None:
    drawn = random_motion(skeleton)
    kept = KeptBones(skeleton)(drawn)
    lengths = bones(skeleton, kept.pose).norm(dim=-1)
    assert torch.allclose(lengths, bones(skeleton, drawn.pose[:, :1]).norm(dim=-1).expand_as(lengths), atol=1e-12)
    along = torch.nn.functional.cosine_similarity(bones(skeleton, kept.pose), bones(skeleton, drawn.pose), dim=-1)
    assert torch.allclose(along, torch.ones_like(along), atol=1e-12)
    assert torch.equal(kept.trajectory, drawn.trajectory)


@pytest.mark.parametrize("skeleton", BODIES, ids=lambda s: s.name)
def test_the_root_stays_and_lengths_kept_already_change_nothing(skeleton: Skeleton) -> None:
    kept = KeptBones(skeleton)(random_motion(skeleton))
    assert kept.pose[:, :, skeleton.root_index].abs().max() == 0
    assert torch.allclose(KeptBones(skeleton)(kept).pose, kept.pose, atol=1e-12)


def test_gradients_are_exact_and_stay_finite_where_a_bone_has_shrunk_to_nothing() -> None:
    given = random_motion(PROX_16, 3)

    def kept(later: torch.Tensor) -> torch.Tensor:
        pose = torch.cat([given.pose[:, :1], later], dim=1)
        return KeptBones(PROX_16)(Motion(given.start, given.trajectory, pose)).pose

    assert torch.autograd.gradcheck(kept, given.pose[:, 1:].clone().requires_grad_())
    nothing = torch.zeros_like(given.pose[:, 1:]).requires_grad_()
    kept(nothing).sum().backward()
    assert nothing.grad is not None and nothing.grad.isfinite().all()


PASSES = [(0.5, 0.98, 1), (2.5, 0.75, 0.77), (7, 0.08, 0.1), (12, 0, 0.001)]


@pytest.mark.parametrize(("hertz", "least", "most"), PASSES)
def test_slow_swings_pass_and_jitter_does_not(hertz: float, least: float, most: float) -> None:
    inner = slice(4, FRAMES - 4)
    before, after = swing(hertz), Smooth(4)(swing(hertz))
    for name in ("trajectory", "pose"):
        was, became = (getattr(motion, name)[:, inner] for motion in (before, after))
        assert least <= float((was * became).sum() / (was * was).sum()) <= most


def test_frame_0_and_who_walks_evenly_stay_as_they_are() -> None:
    walk = random_motion(GTA_IM_19, 2)
    steps = torch.arange(FRAMES, dtype=torch.float64)
    even = Motion(
        walk.start,
        steps[None, :, None] * walk.trajectory[:, 1:],
        walk.pose[:, :1] + steps[None, :, None, None] * walk.pose[:, 1:],
    )
    smooth = Smooth(4)(even)
    assert torch.allclose(smooth.joints, even.joints, atol=1e-5)
    drawn = random_motion(GTA_IM_19)
    assert torch.equal(Smooth(4)(drawn).joints[:, 0], drawn.joints[:, 0])


@pytest.mark.parametrize("separate", [True, False], ids=["separate", "joint"])
def test_a_generator_finishes_where_asked_and_only_there(separate: bool, batch: Batch, scale: MotionScale) -> None:
    drift, jitter = {}, {}
    for name, network in {
        "free": Network(width=0.1),
        "kept": Network(width=0.1, bones="kept"),
        "smooth": Network(width=0.1, smooth=4),
    }.items():
        torch.manual_seed(0)
        generator = build_generator(Components(separate=separate), network, GTA_IM_19, scale)
        sampler = Sampler(build_encoder(network), generator, scale).eval()
        motion = sampler(batch.scene, batch.motion, torch.Generator().manual_seed(0))
        assert torch.equal(motion.joints[:, 0], batch.motion.joints[:, 0])
        lengths = bones(GTA_IM_19, motion.pose).norm(dim=-1)
        drift[name] = (lengths / lengths[:, :1] - 1).abs().max()
        jitter[name] = motion.joints.diff(dim=1, n=3).norm()
    assert drift["kept"] < 1e-5 < 0.05 < drift["free"]
    assert jitter["smooth"] < 0.3 * jitter["free"]


@pytest.mark.parametrize("reach", [-1, FRAMES])
def test_a_window_that_cannot_be_is_refused(reach: int) -> None:
    with pytest.raises(SagError, match=f"smooth is {reach}"):
        build_generator(Components(), Network(width=0.05, smooth=reach), GTA_IM_19, MotionScale(19, 12))
