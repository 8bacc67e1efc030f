"""What a critic listens to: the motion, the scene feature or both together; what it prefers, and how hard it pulls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Generator, Tensor

from sag.methods.wgan import WGAN
from sag.models.critics import Critic
from sag.types import Batch, Condition, DepthMap, Motion

STEP = 0.1
"""Metres by which a motion is lifted and sunk."""


@dataclass(frozen=True)
class Listening:
    """One critic; shares are per cent.

    Attributes:
        motion: share of the scores' variance that the motion makes, whatever the scene feature is.
        feature: share that the scene feature makes, whatever the motion is. No generator can change it.
        both: the rest, that which motion makes in which scene.
        pull: norm of the score's gradient at a generated motion's joints, scores per metre.
        real: motions that were recorded and score above the one generated for the same window.
        lifted: recorded motions that score above themselves lifted by `STEP` after frame 0.
        sunk: as many metres lower.
    """

    motion: float
    feature: float
    both: float
    pull: float
    real: float
    lifted: float
    sunk: float


def listening_of(method: WGAN, batch: Batch, generator: Generator) -> dict[str, Listening]:
    """All critics of a method, by name.

    Args:
        method: trained, in evaluation.
        batch: at least two windows, each with every other one's scene feature beside its own.
        generator: of the motions that are drawn, from the generator that the critics were trained against.
    """
    with torch.no_grad():
        condition = method.sampler.condition(batch.scene, batch.motion)
        scene = method.seen(condition, batch.scene)
        fake = method.sampler(batch.scene, batch.motion, generator)
    upwards = batch.world2cam[:, :3, 2].to(fake.start)
    moved = [lifted(batch.motion, upwards, height) for height in (STEP, -STEP)]
    critics: Mapping[str, Critic] = method.critics
    return {
        name: Listening(
            *_shares(critic, batch.motion, condition, scene),
            _pull(critic, fake, method.skeleton.root_index, condition, scene),
            *_preferences(critic, batch.motion, (fake, *moved), condition, scene),
        )
        for name, critic in critics.items()
    }


@torch.no_grad()
def _shares(critic: Critic, real: Motion, condition: Condition, scene: DepthMap) -> tuple[float, float, float]:
    """Each recorded motion beside each window's scene feature, with its own initial pose throughout."""
    view = critic.view(real, scene)
    scores = [critic(view, _told(condition, place)) for place in range(len(view))]
    return variance_shares(torch.stack(scores, dim=1))


@torch.no_grad()
def _preferences(
    critic: Critic, real: Motion, others: Sequence[Motion], condition: Condition, scene: DepthMap
) -> list[float]:
    """Recorded motions that score above each of the others, per cent."""
    scores = critic(critic.view(real, scene), condition)
    return [100 * float((scores > critic(critic.view(m, scene), condition)).float().mean()) for m in others]


def _told(condition: Condition, place: int) -> Condition:
    """The scene feature of one window beside all motions, each with its own initial pose."""
    return Condition(condition.feature[[place]].expand_as(condition.feature), condition.initial_pose)


def variance_shares(scores: Float[Tensor, "motions features"]) -> tuple[float, float, float]:
    """Shares of the variance that rows make alone, columns alone, and both together, per cent; 0 where there is none.

    Example:
        >>> import torch
        >>> variance_shares(torch.tensor([[0.0, 2.0], [0.0, 2.0]]))
        (0.0, 100.0, 0.0)
    """
    scores = scores.double()
    total = scores.var(correction=0)
    if total <= 1e-12 * scores.square().mean():
        return 0.0, 0.0, 0.0
    rows, columns = (scores.mean(dim=d).var(correction=0) / total for d in (1, 0))
    return 100 * float(rows), 100 * float(columns), 100 * float((1 - rows - columns).clamp_min(0))


def lifted(motion: Motion, upwards: Float[Tensor, "b 3"], height: float) -> Motion:
    """The motion so many metres higher in all frames but the given one.

    Args:
        motion: camera frame.
        upwards: the world's vertical in that frame, of length 1.
        height: metres.
    """
    trajectory = motion.trajectory.clone()
    trajectory[:, 1:] += height * upwards[:, None]
    return Motion(motion.start, trajectory, motion.pose)


def _pull(critic: Critic, fake: Motion, root: int, condition: Condition, scene: DepthMap) -> float:
    """Mean over motions of the norm of the score's gradient at all joints of the 64 generated frames."""
    joints = fake.joints.detach().requires_grad_()
    score = critic(critic.view(Motion.from_joints(joints, root), scene), condition).sum()
    (gradient,) = torch.autograd.grad(score, joints)
    return float(gradient[:, 1:].flatten(1).norm(dim=1).mean())
