"""Velocity Fréchet distance: sees the jitter and the jumps that Motion FID cannot see; ours, not the paper's."""

from __future__ import annotations

from typing import Any

from jaxtyping import Float
from torch import Tensor

from sag.metrics.checking import check_fps, check_joints
from sag.metrics.frechet import Gaussian
from sag.metrics.sides import Real, TwoGaussians
from sag.types import GENERATED

SLOWEST = 0.01
"""Coordinates of the real side that deviate by less than this (m/s) are taken to deviate by this much."""


def joint_velocities(joints: Float[Tensor, "b t j 3"], fps: float) -> Float[Tensor, "b t-1 3*j"]:
    """Velocity of every joint at every step, metres a second, in the frame of the joints; computed in float64."""
    return joints.double().diff(dim=1).flatten(2) * fps


def velocity_frechet(
    real: Float[Tensor, "n t j 3"], generated: Float[Tensor, "m t j 3"], fps: float
) -> Float[Tensor, ""]:
    """The velocity Fréchet distance of two sets of motions at once; see `VelocityFrechet`.

    Args:
        real: true motions, 65 frames, metres, camera frame of frame 0.
        generated: motions to judge, likewise.
        fps: frames a second.

    Raises:
        SagError: motions that are too short, have different joints or are not finite, or an empty set.

    Example:
        >>> import torch
        >>> walks = torch.arange(65.0)[:, None, None] / 30 * torch.rand(8, 1, 1, 3, generator=torch.manual_seed(0))
        >>> walks = walks + torch.rand(19, 3, generator=torch.manual_seed(1))
        >>> jittered = walks + 0.01 * torch.randn(walks.shape, generator=torch.manual_seed(2))
        >>> velocity_frechet(walks, walks + 5, fps=30).round(decimals=4)
        tensor(0., dtype=torch.float64)
        >>> bool(velocity_frechet(walks, jittered, fps=30) > 10)
        True
    """
    metric = VelocityFrechet(fps, joints=real.shape[2]).to(real.device)
    metric.update(real, real=True)
    metric.update(generated, real=False)
    return metric.compute()


class VelocityFrechet(TwoGaussians):
    """Fréchet distance between the joint velocities of generated and of true motions. Ours.

    The velocity of a step is one vector of 3 j numbers, v_t = fps (x_{t+1} - x_t), and all 64 steps of a motion count,
    the one off the given frame 0 too. Each coordinate is divided by its deviation s over the true motions:

    d = |(m_r - m_g) / s|^2 + tr(C_r + C_g - 2 (C_r^1/2 C_g C_r^1/2)^1/2), with C = diag(1/s) cov(v) diag(1/s)

    The idea that frame-to-frame differences judge smoothness is old; the distance and its scaling are ours. No unit.

    Reacts to jitter of any joint (white noise of 1 cm moves a joint by 0.4 m/s at 30 frames a second), to a jump off
    the given frame, to motion that is too slow or too fast, and to people who never stand still. Blind to where
    motions happen, to the scene, to the order in which steps follow each other, and to anything slower than a step:
    drift of a pose, a path that ends in a wall. Where two sets of true motions stand is its floor: print it beside.

    Args:
        fps: frames a second.
        joints: number of joints of a frame.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.velocity_frechet import VelocityFrechet
        >>> motions = torch.randn(8, 65, 19, 3, generator=torch.manual_seed(0)).cumsum(1) / 30
        >>> metric = VelocityFrechet(fps=30, joints=19)
        >>> metric.update(motions, real=True)
        >>> metric.update(2 * motions, real=False)
        >>> round(float(metric.compute()) / (3 * 19), 2)
        1.0
    """

    title = "the velocity Fréchet distance"

    def __init__(self, fps: float, joints: int, **options: Any) -> None:
        super().__init__(3 * joints, GENERATED, check_fps(self.title, fps), **options)
        self.fps, self.joints = float(fps), joints

    def update(self, joints: Float[Tensor, "b t j 3"], real: Real) -> None:
        """Adds motions to a side.

        Args:
            joints: 65 frames, metres, camera frame of frame 0.
            real: whether these are true motions, for all or for each.

        Raises:
            SagError: another number of frames or joints, a coordinate that is not finite, or no truth values.
        """
        check_joints(self.title, joints, self.joints, exact=True)
        self._add_features(joint_velocities(joints, self.fps), real)

    def _distance(self, real: Gaussian, generated: Gaussian) -> Float[Tensor, ""]:
        scale = real.covariance.diagonal().clamp_min(SLOWEST**2).sqrt()
        return _divided(real, scale).distance(_divided(generated, scale))


def _divided(gaussian: Gaussian, scale: Float[Tensor, " d"]) -> Gaussian:
    """The Gaussian of the features after each coordinate is divided by its scale."""
    return Gaussian(gaussian.mean / scale, gaussian.covariance / scale.outer(scale))
