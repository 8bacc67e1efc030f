"""PathNet: the way of the root to a goal in the picture, metres."""

from __future__ import annotations

import numpy as np
import torch
from jaxtyping import Float
from scipy.interpolate import CubicSpline
from torch import Tensor, nn

from sag.geometry.camera import NEAREST, unproject
from sag.models.batch_norm import BatchNorm2d
from sag.models.cao.blocks import Hourglass, Residual, Seen, View
from sag.models.cao.heat_maps import cell_centres
from sag.types import FRAMES

KNOT_EVERY = 8
"""Frames from one predicted place to the next; ours."""

KNOTS = (FRAMES - 1) // KNOT_EVERY
"""Places that are predicted; the start is known."""

CHANNELS = 256
"""Of the hourglass, as Newell et al. have it."""

LEVELS = 3
"""How many times the hourglass halves its map."""


class Spline(nn.Module):
    """The smooth way through the start and the knots: a natural cubic spline in each coordinate."""

    matrix: Tensor

    def __init__(self) -> None:
        super().__init__()
        knots = np.arange(0, FRAMES, KNOT_EVERY)
        values = CubicSpline(knots, np.eye(len(knots)), bc_type="natural")(np.arange(1, FRAMES))
        # R is zero at frame 0, so the first knot adds nothing.
        matrix = torch.from_numpy(values[:, 1:]).float()
        self.register_buffer("matrix", matrix, persistent=False)

    def forward(self, knots: Float[Tensor, "b k 3"]) -> Float[Tensor, "b 64 3"]:
        """R at the 64 generated frames from R at the knots, metres."""
        return torch.einsum("tk,bkc->btc", self.matrix, knots)

    def smoothed(self, trajectory: Float[Tensor, "b 65 3"]) -> Float[Tensor, "b 64 3"]:
        """A whole trajectory as far as its knots tell it, metres."""
        return self(trajectory[:, KNOT_EVERY::KNOT_EVERY])


class PathNet(nn.Module):
    """The root's trajectory from picture, person and the heat map of a goal: an hourglass of heat maps and depths.

    For each knot a heat map says where in the picture the root is then, and a second map how much farther from the
    camera than at the start; expectations under the first give a place, which the camera brings into space.

    Args:
        joints: joints of the skeleton.
        told: length of scene feature and initial pose.
        channels: see `CHANNELS`; the view's halves have a quarter of them each.
        levels: see `LEVELS`.
    """

    def __init__(self, joints: int, told: int, channels: int = CHANNELS, levels: int = LEVELS) -> None:
        super().__init__()
        self.view = View(joints + 1, channels // 4)
        self.into = Residual(2 * (channels // 4), channels)
        self.told = nn.Linear(told, channels)
        self.hourglass = Hourglass(channels, levels)
        self.out = nn.Sequential(BatchNorm2d(channels), nn.ReLU(), nn.Conv2d(channels, 2 * KNOTS, 1))
        self.spline = Spline()

    def forward(
        self,
        seen: Seen,
        goal: Float[Tensor, "b 1 h w"],
        start: Float[Tensor, "b 3"],
        intrinsics: Float[Tensor, "b 3 3"],
    ) -> Float[Tensor, "b 64 3"]:
        """R at the 64 generated frames, metres.

        Args:
            seen: what is known at frame 0.
            goal: heat map of where the root is to be in the end.
            start: root at frame 0, metres, camera frame.
            intrinsics: camera matrix in the picture's pixels.
        """
        x = self.into(self.view(seen.image, torch.cat([seen.joints, goal], dim=1)))
        x = self.hourglass(x + self.told(seen.told)[:, :, None, None])
        where, depth = self.out(x).flatten(2).chunk(2, dim=1)
        share = where.softmax(dim=-1)
        pixels = share @ cell_centres((x.shape[-2], x.shape[-1]), like=x).flatten(0, 1)
        farther = (share * depth).sum(dim=-1)
        metres = (start[:, None, 2] + farther).clamp_min(NEAREST)
        return self.spline(unproject(pixels, metres, intrinsics) - start[:, None])
