"""Critics: what each looks at. This file is the paper's idea on one screen (section 3.3).

A critic is a *view* of a motion in its scene and a network that scores the view. The trajectory, pose
and motion critics see the motion alone; P sees it projected into the picture; C sees the depth of the
scene around it. The gradient penalty is taken on the view.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.geometry.camera import project
from sag.models.critic_networks import (
    ContextCriticNetwork,
    GraphCriticNetwork,
    TrajectoryCriticNetwork,
)
from sag.models.scale import MotionScale
from sag.types import Condition, DepthMap, Motion

CROP_EVERY = 8
"""Frames between two crops of the context critic: 0, 8, ..., 64 are nine (appendix 6.1)."""

CROP_NEAREST = 0.3
"""A root nearer to the camera than this (metres) is cropped as if it were here."""

FARTHEST = 20.0
"""Depth (metres) of what the sensor does not see."""


class Critic(nn.Module, ABC):
    """A view and a network that scores it.

    Args:
        network: scores what `forward` lays before it.
        scale: units of the view.
    """

    def __init__(self, network: nn.Module, scale: MotionScale) -> None:
        super().__init__()
        self.network = network
        self.scale = scale

    @abstractmethod
    def view(self, motion: Motion, scene: DepthMap) -> Tensor:
        """What this critic sees of a motion of 65 frames in a scene; differentiable in the motion."""

    def forward(self, view: Tensor, condition: Condition) -> Float[Tensor, " b"]:
        """Scores of views, given the scene feature unless a critic says otherwise."""
        return self.network(view, condition.feature)


class TrajectoryCritic(Critic):
    """Table 10: R at the 64 generated frames, given scene feature and initial pose."""

    network: TrajectoryCriticNetwork

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "b 3 64"]:
        """R in units of its deviation."""
        return (motion.trajectory[:, 1:] / self.scale.trajectory_std).transpose(1, 2)

    def forward(self, view: Float[Tensor, "b 3 64"], condition: Condition) -> Float[Tensor, " b"]:
        """Scores given f and the initial pose."""
        return self.network(view, torch.cat([condition.feature, condition.initial_pose], dim=1))


class PoseCritic(Critic):
    """Table 11: P and R at all 65 frames, R repeated at every joint."""

    network: GraphCriticNetwork

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "b j 6 65"]:
        """P and R in units of their deviations."""
        pose = (motion.pose - self.scale.pose_mean) / self.scale.pose_std
        trajectory = (motion.trajectory / self.scale.trajectory_std)[:, :, None].expand_as(pose)
        return torch.cat([pose, trajectory], dim=-1).permute(0, 2, 3, 1)


class MotionCritic(Critic):
    """CSGN's only critic (M off): X at all 65 frames, seen from the start."""

    network: GraphCriticNetwork

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "b j 3 65"]:
        """P + R in units of its deviation."""
        joints = motion.trajectory[:, :, None] + motion.pose
        return ((joints - self.scale.motion_mean) / self.scale.motion_std).permute(0, 2, 3, 1)

    def forward(self, view: Float[Tensor, "b j 3 65"], condition: Condition) -> Float[Tensor, " b"]:
        """Scores given f and the initial pose, as the trajectory critic has them where M is on."""
        return self.network(view, torch.cat([condition.feature, condition.initial_pose], dim=1))


class SequenceCritic(Critic):
    """HP-GAN's critic and Two-Stage's second: X at all 65 frames, seen from the start, one vector each."""

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "b 65 c"]:
        """P + R in units of its deviation, the joints of a frame in a row."""
        return self.scale.vectors(motion)


class ProjectionCritic(Critic):
    """P, Table 8: X as the camera sees it, so that size and place in the picture must fit (paper, 3.3.1)."""

    network: GraphCriticNetwork

    LIMIT = 3.0
    """Half pictures from the centre at which coordinates are clamped; early samples fly about."""

    GAIN = 6.0
    """Brings the view of recorded motions to a deviation of one, as every other critic's is."""

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "b j 2 65"]:
        """Picture coordinates from the centre, in half picture widths, times `GAIN`."""
        pixels = project(motion.joints, scene.intrinsics)
        rows, columns = scene.depth.shape[1:]
        centre = pixels.new_tensor([columns / 2, rows / 2])
        halves = ((pixels - centre) / (columns / 2)).clamp(-self.LIMIT, self.LIMIT)
        return self.GAIN * halves.permute(0, 2, 3, 1)


class ContextCritic(Critic):
    """C, Table 9: depth of the scene around the root less the root's own, in nine crops (paper, 3.3.2).

    Args:
        network: scores the crops.
        scale: unused; every critic has it.
        crop_scale: size of a crop; at 1, the paper's, it spans a quarter of the picture at 1 m depth.
    """

    network: ContextCriticNetwork

    def __init__(self, network: ContextCriticNetwork, scale: MotionScale, crop_scale: float = 1.0) -> None:
        super().__init__(network, scale)
        self.crop_scale = crop_scale

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "b 9 h w"]:
        """Crops of (H_c / d, W_c / d) pixels, resampled to (H_c, W_c) = a quarter of the picture, in metres."""
        rows, columns = scene.depth.shape[1:]
        roots = motion.roots[:, ::CROP_EVERY]
        distance = roots[..., 2].clamp_min(CROP_NEAREST)
        size = roots.new_tensor([columns, rows])
        centres = 2 * project(roots, scene.intrinsics, CROP_NEAREST) / size - 1
        grid = _unit_grid(rows // 4, columns // 4, like=roots) / 4 * self.crop_scale
        places = centres[:, :, None, None] + grid / distance[:, :, None, None, None]
        depth = torch.where(scene.depth > 0, scene.depth, FARTHEST)
        crops = F.grid_sample(depth[:, None], places.flatten(1, 2), padding_mode="border", align_corners=False)
        return crops[:, 0].unflatten(1, places.shape[1:3]) - distance[:, :, None, None]

    def forward(self, view: Float[Tensor, "b 9 h w"], condition: Condition) -> Float[Tensor, " b"]:
        """Scores of the crops alone: Table 9 has no condition."""
        return self.network(view)


def _unit_grid(rows: int, columns: int, like: Tensor) -> Float[Tensor, "rows columns 2"]:
    """Centres of the cells of a grid over [-1, 1] x [-1, 1], (x, y) each."""
    y = (torch.arange(rows, dtype=like.dtype, device=like.device) + 0.5) * 2 / rows - 1
    x = (torch.arange(columns, dtype=like.dtype, device=like.device) + 0.5) * 2 / columns - 1
    return torch.stack(torch.meshgrid(x, y, indexing="xy"), dim=-1)
