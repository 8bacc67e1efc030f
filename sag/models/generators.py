"""Generators: the trajectory's and the pose's (Tables 6 and 7), and one for the whole motion (CSGN)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Generator, Tensor, nn

from sag.models.graph import SLOPE, GraphBlock, GraphConv
from sag.models.noise import LATENT_STEPS, GaussianProcess, Kernel
from sag.models.scale import MotionScale
from sag.models.temporal import BatchNorm, Doubling, TemporalBlock, TemporalConv
from sag.skeleton import Skeleton
from sag.types import GENERATED, Condition, Motion

PoseSees = Literal["places", "velocities"]
"""What the pose generator is given of R: its places relative to frame 0, to scale, or V in shares of its limit."""

LEVELS = (3, 2, 2, 1, 1, 0)
"""Graph levels of the pose generator's tensors, coarse to fine: body, limbs, limbs, parts, parts, joints."""


@dataclass(frozen=True)
class GeneratorSizes:
    """Channels of the generators; the defaults are the paper's.

    Attributes:
        trajectory_noise: of the trajectory's Gaussian process.
        pose_noise: of the pose's.
        feature: length of f.
        blocks: after each of the five blocks.
    """

    trajectory_noise: int = 256
    pose_noise: int = 1024
    feature: int = 256
    blocks: tuple[int, ...] = (512, 256, 128, 64, 32)


class TrajectoryNetwork(nn.Module):
    """Table 6: noise, scene feature and initial pose become 64 velocities in [-1, 1].

    Args:
        in_channels: 569 in the paper.
        blocks: channels after each block.
    """

    def __init__(self, in_channels: int, blocks: tuple[int, ...]) -> None:
        super().__init__()
        channels = (in_channels, *blocks)
        self.blocks = nn.ModuleList(self._block(channels[i], channels[i + 1], first=i == 0) for i in range(len(blocks)))
        self.out = TemporalConv(channels[-1], 3)

    @staticmethod
    def _block(in_channels: int, out_channels: int, first: bool) -> TemporalBlock:
        conv = TemporalConv(in_channels, out_channels, padding=0 if first else 1)
        layers = [nn.LeakyReLU(SLOPE), conv, BatchNorm(out_channels)]
        return TemporalBlock(*layers, *([] if first else [Doubling()]))

    def forward(
        self, noise: Float[Tensor, "b n 6"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b 3 64"]:
        """tanh of the last convolution; the condition stands beside the noise in every latent frame."""
        x = self.blocks[0](noise, condition)
        for block in self.blocks[1:]:
            x = block(x)
        return torch.tanh(self.out(F.leaky_relu(x, SLOPE)))


class PoseNetwork(nn.Module):
    """Table 7: noise and conditions at one node grow into 64 frames of all joints in [-1, 1].

    Args:
        in_channels: 1529 in the paper.
        blocks: channels after each block.
        skeleton: whose levels the graph climbs down.
    """

    def __init__(self, in_channels: int, blocks: tuple[int, ...], skeleton: Skeleton) -> None:
        super().__init__()
        levels = [skeleton.levels[i] for i in LEVELS]
        channels = (in_channels, *blocks)
        self.blocks = nn.ModuleList(
            GraphBlock(
                GraphConv(channels[i], channels[i + 1], levels[i], levels[i + 1], padding=0 if i == 0 else 1),
                norm="batch",
                up=i > 0,
            )
            for i in range(len(blocks))
        )
        self.out = GraphConv(channels[-1], 3, levels[-1], levels[-1])

    def forward(
        self, noise: Float[Tensor, "b n 6"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b 64 j 3"]:
        """tanh of the last convolution; the condition stands beside the noise in every latent frame."""
        x = self.blocks[0](noise[:, None], condition)
        for block in self.blocks[1:]:
            x = block(x)
        return torch.tanh(self.out(F.leaky_relu(x, SLOPE))).permute(0, 3, 1, 2)


class MotionGenerator(nn.Module):
    """What a generator is: noise and conditions in, a `Motion` of 65 frames out, the first as given."""

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """Noise for so many motions."""
        raise NotImplementedError

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """Motions that continue frame 0 of `given` (its later frames are not looked at)."""
        raise NotImplementedError


class SeparateGenerator(MotionGenerator):
    """M on: p(R|S) p(P|R,S), the trajectory first, then the pose that follows it (paper, 3.2).

    Args:
        sizes: channels.
        skeleton: joints and levels.
        scale: units.
        kernel: of the noise.
        pose_sees: what the pose is given of the trajectory.
    """

    def __init__(
        self,
        sizes: GeneratorSizes,
        skeleton: Skeleton,
        scale: MotionScale,
        kernel: Kernel,
        pose_sees: PoseSees = "places",
    ) -> None:
        super().__init__()
        initial = 3 * len(skeleton.joints)
        self.scale, self.pose_sees = scale, pose_sees
        self.trajectory_noise = GaussianProcess(sizes.trajectory_noise, LATENT_STEPS, kernel)
        self.pose_noise = GaussianProcess(sizes.pose_noise, LATENT_STEPS, kernel)
        self.trajectory = TrajectoryNetwork(sizes.trajectory_noise + sizes.feature + initial, sizes.blocks)
        pose_channels = sizes.pose_noise + sizes.feature + 3 * GENERATED + initial
        self.pose = PoseNetwork(pose_channels, sizes.blocks, skeleton)

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """Noise of the trajectory and of the pose."""
        return self.trajectory_noise(count, generator), self.pose_noise(count, generator)

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """R as the sum of V = alpha tanh(F), then P given R."""
        feature, initial = condition.feature, condition.initial_pose
        unit = self.trajectory(noise[0], torch.cat([feature, initial], dim=1))
        trajectory = (self.scale.speed_limit * unit).cumsum(dim=-1).transpose(1, 2)
        places = (trajectory / self.scale.trajectory_std).transpose(1, 2)
        seen = (places if self.pose_sees == "places" else unit).flatten(1)
        pose = self.scale.pose(self.pose(noise[1], torch.cat([feature, seen, initial], dim=1)))
        return given.first.continued(trajectory, pose)


class JointGenerator(MotionGenerator):
    """M off: CSGN, one graph generator for the whole motion, the root included.

    Args:
        sizes: channels; the noise is the pose's.
        skeleton: joints and levels.
        scale: units.
        kernel: of the noise.
    """

    def __init__(self, sizes: GeneratorSizes, skeleton: Skeleton, scale: MotionScale, kernel: Kernel) -> None:
        super().__init__()
        self.scale = scale
        self.motion_noise = GaussianProcess(sizes.pose_noise, LATENT_STEPS, kernel)
        channels = sizes.pose_noise + sizes.feature + 3 * len(skeleton.joints)
        self.motion = PoseNetwork(channels, sizes.blocks, skeleton)

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """Noise of the motion."""
        return (self.motion_noise(count, generator),)

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """X at once; R and P are read off it."""
        x = self.motion(noise[0], torch.cat([condition.feature, condition.initial_pose], dim=1))
        joints = self.scale.motion(x)
        trajectory = joints[:, :, self.scale.root]
        return given.first.continued(trajectory, joints - trajectory[:, :, None])
