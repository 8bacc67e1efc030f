"""Units inside the networks: z-scores by training statistics, or plain metres."""

from __future__ import annotations

from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor, nn

from sag.types import Motion

Units = Literal["zscore", "metres"]

REACH = 3.5
"""Standard deviations that a generator's tanh spans to either side of the mean, in z-scores."""

REACH_METRES = (1.1, 4.0)
"""What it spans in metres: a pose about its root, a motion about its start."""

SPEED_MARGIN = 1.1
"""alpha is this much above the 99.9th percentile of the training set's root speed."""


class MotionScale(nn.Module):
    """Means and deviations of the training motion, kept with the weights.

    Generators make metres of their tanh with it, critics look at scaled motion, and alpha (paper, 3.2.1)
    is its speed limit in metres a frame.

    Args:
        joints: joints of the skeleton.
        root: place of the root.
        units: `metres` leaves means 0 and deviations 1.
    """

    speed_limit: Tensor
    trajectory_std: Tensor
    pose_mean: Tensor
    pose_std: Tensor
    motion_mean: Tensor
    motion_std: Tensor
    initial_mean: Tensor
    initial_std: Tensor

    def __init__(self, joints: int, root: int, units: Units = "zscore") -> None:
        super().__init__()
        self.root = root
        self.units = units
        self.register_buffer("speed_limit", torch.tensor(0.065))
        self.register_buffer("trajectory_std", torch.ones(3))
        for name in ("pose", "motion", "initial"):
            self.register_buffer(f"{name}_mean", torch.zeros(joints, 3))
            self.register_buffer(f"{name}_std", torch.ones(joints, 3))

    @torch.no_grad()
    def fit(self, motion: Motion) -> None:
        """Takes the statistics of the true motion of the training split (65 frames, metres)."""
        speed = motion.trajectory.diff(dim=1).norm(dim=-1)
        self.speed_limit.copy_(SPEED_MARGIN * _quantile(speed, 0.999))
        if self.units == "metres":
            return
        self.trajectory_std.copy_(motion.trajectory[:, 1:].std(dim=(0, 1)).clamp_min(0.05))
        moving = motion.trajectory[:, 1:, None] + motion.pose[:, 1:]
        initial = self._initial(motion)
        for name, values, least in (
            ("pose", motion.pose[:, 1:].flatten(0, 1), 0.03),
            ("motion", moving.flatten(0, 1), 0.05),
            ("initial", initial, 0.02),
        ):
            getattr(self, f"{name}_mean").copy_(values.mean(dim=0))
            getattr(self, f"{name}_std").copy_(values.std(dim=0).clamp_min(least))

    def initial_pose(self, motion: Motion) -> Float[Tensor, "b p"]:
        """Frame 0 as a condition: see `sag.types.Condition`."""
        return ((self._initial(motion) - self.initial_mean) / self.initial_std).flatten(1)

    def _initial(self, motion: Motion) -> Float[Tensor, "b j 3"]:
        pose = motion.pose[:, 0].clone()
        pose[:, self.root] = motion.start
        return pose

    def pose(self, unit: Float[Tensor, "b t j 3"]) -> Float[Tensor, "b t j 3"]:
        """Root-relative joints (metres) of a tanh, with the root at zero."""
        reach = REACH if self.units == "zscore" else REACH_METRES[0]
        pose = self.pose_mean + reach * self.pose_std * unit
        return pose - pose[:, :, self.root, None]

    def motion(self, unit: Float[Tensor, "b t j 3"]) -> Float[Tensor, "b t j 3"]:
        """Joints relative to the start (metres) of a tanh."""
        reach = REACH if self.units == "zscore" else REACH_METRES[1]
        return self.motion_mean + reach * self.motion_std * unit

    def vectors(self, motion: Motion) -> Float[Tensor, "b t c"]:
        """X relative to its start as one vector of z-scores for each frame, the root included."""
        joints = motion.trajectory[:, :, None] + motion.pose
        return ((joints - self.motion_mean) / self.motion_std).flatten(2)

    def continued(self, given: Motion, vectors: Float[Tensor, "b n c"]) -> Motion:
        """Frame 0 of `given` and the frames that such vectors stand for; R and P are read off X."""
        joints = self.motion_mean + self.motion_std * vectors.unflatten(2, (-1, 3))
        trajectory = joints[:, :, self.root]
        return given.first.continued(trajectory, joints - trajectory[:, :, None])


def _quantile(values: Tensor, fraction: float) -> Tensor:
    """`torch.quantile` without its limit on the number of values."""
    flat = values.flatten()
    rank = max(1, round(fraction * len(flat)))
    return flat.kthvalue(rank).values
