"""Acceleration and jerk: how smoothly joints move."""

from __future__ import annotations

from abc import ABC
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.metrics.checking import check_fps, check_joints
from sag.metrics.plotted import PlottedMetric


def mean_derivative(joints: Float[Tensor, "b t j 3"], order: int, fps: float) -> Float[Tensor, " b"]:
    """Mean length of a time derivative over joints and frames, by differences of neighbouring frames.

    Args:
        joints: metres, any frame that stands still.
        order: 1 velocity, 2 acceleration, 3 jerk.
        fps: frames a second.

    Returns:
        Metres a second to the power of `order`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.smoothness import mean_derivative
        >>> falling = torch.zeros(1, 65, 1, 3, dtype=torch.float64)
        >>> falling[..., 0, 2] = -9.81 / 2 * (torch.arange(65, dtype=torch.float64) / 30) ** 2
        >>> [round(float(mean_derivative(falling, order, fps=30)), 6) for order in (2, 3)]
        [9.81, 0.0]
    """
    return joints.diff(order, dim=1).norm(dim=-1).mean((1, 2)) * fps**order


class _Smoothness(PlottedMetric, ABC):
    """States of acceleration and jerk, which are the same, so that a collection updates them together."""

    higher_is_better = None

    second_differences: Tensor
    third_differences: Tensor
    motions_differenced: Tensor

    def __init__(self, fps: float, **options: Any) -> None:
        super().__init__(**options)
        self.fps = check_fps(self.title, fps)
        for name in ("second_differences", "third_differences", "motions_differenced"):
            self.add_state(name, torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, joints: Float[Tensor, "b t j 3"]) -> None:
        """Adds motions.

        Args:
            joints: 65 frames, metres, any frame that stands still; frame 0 counts, so that a jump from it does too.

        Raises:
            SagError: another number of frames, or a coordinate that is not finite.
        """
        check_joints(self.title, joints, 1)
        wide = joints.double()
        # Without units of time: metrics of other rates share these states and apply their rate to the result.
        self.second_differences = self.second_differences + mean_derivative(wide, 2, fps=1).sum()
        self.third_differences = self.third_differences + mean_derivative(wide, 3, fps=1).sum()
        self.motions_differenced = self.motions_differenced + len(joints)

    def _mean(self, total: Tensor) -> Tensor:
        self._require(self.motions_differenced)
        return total / self.motions_differenced


class Acceleration(_Smoothness):
    r"""Mean acceleration of joints, m/s^2: the length of second differences over joints, frames and motions.

    .. math:: \frac{1}{63 J} \sum_{t = 1}^{63} \sum_j \lVert x_{t + 1} - 2 x_t + x_{t - 1} \rVert \cdot fps^2

    It reacts to jitter (1 cm of white noise at 30 fps adds about 35 m/s^2, where people have a few), to jumps, also
    from the given frame 0, and to real vigour. It is blind to where a body is and to any constant velocity. Neither
    high nor low is good: the ground truth's figure is the aim, and a frozen body has 0.

    Args:
        fps: frames a second.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.smoothness import Acceleration
        >>> falling = torch.zeros(1, 65, 19, 3)
        >>> falling[..., 2] = -9.81 / 2 * (torch.arange(65)[:, None] / 30) ** 2
        >>> metric = Acceleration(fps=30)
        >>> metric.update(falling)
        >>> round(float(metric.compute()), 2)
        9.81
    """

    title = "acceleration"

    def compute(self) -> Tensor:
        """Mean acceleration, m/s^2.

        Raises:
            SagError: no motion was given.
        """
        return self._mean(self.second_differences) * self.fps**2


class Jerk(_Smoothness):
    r"""Mean jerk of joints, m/s^3: the length of third differences over joints, frames and motions.

    .. math:: \frac{1}{62 J} \sum_t \sum_j \lVert x_{t + 3} - 3 x_{t + 2} + 3 x_{t + 1} - x_t \rVert \cdot fps^3

    It reacts as `Acceleration` does, to jitter more; it is blind to any constant velocity or acceleration. Neither
    high nor low is good: the ground truth's figure is the aim.

    Args:
        fps: frames a second.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.smoothness import Jerk
        >>> joints = torch.zeros(1, 65, 19, 3, dtype=torch.float64)
        >>> joints[..., 0] = 2.0 * (torch.arange(65, dtype=torch.float64)[:, None] / 30) ** 3
        >>> metric = Jerk(fps=30)
        >>> metric.update(joints)
        >>> round(float(metric.compute()), 6)
        12.0
    """

    title = "jerk"

    def compute(self) -> Tensor:
        """Mean jerk, m/s^3.

        Raises:
            SagError: no motion was given.
        """
        return self._mean(self.third_differences) * self.fps**3
