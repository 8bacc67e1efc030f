"""Networks of the critics: Tables 8 to 11, each with one linear unit behind it for the score."""

from __future__ import annotations

from typing import Literal

import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.batch_norm import BatchNorm2d
from sag.models.graph import SLOPE, GraphBlock, GraphConv, Norm, normalization
from sag.models.pooled import PooledConv1d, PooledConv2d
from sag.models.temporal import TemporalBlock, TemporalConv
from sag.skeleton import Skeleton

LEVELS = (0, 1, 1, 2, 2, 3)
"""Graph levels of a graph critic's tensors, fine to coarse: joints, parts, parts, limbs, limbs, body."""

BLOCKS = (64, 64, 128, 256, 512)
"""Channels after each block of the trajectory critic and of the graph critics in the paper."""

CONTEXT_BLOCKS = (64, 128, 256, 512)
"""Channels after each convolution of the context critic in the paper."""

CriticCondition = Literal["plain", "balanced"]
"""How a condition stands beside what a critic judges: as it is, or weakened so that neither drowns the other."""


def condition_gain(kind: CriticCondition, judged: int, condition: int) -> float:
    """Factor on a condition.

    In the paper 256 numbers of f stand beside 2 or 6 of a joint. With all of one size, nine tenths and more of what the
    first convolution sums up is f then, the same for real and generated motion, and the norm behind it leaves little of
    the motion. Balanced, both have the same share of that sum's variance at the start of training.

    Args:
        kind: `plain` leaves the condition as it is.
        judged: channels of what is judged.
        condition: channels of the condition.
    """
    return (judged / condition) ** 0.5 if kind == "balanced" else 1.0


class GraphCriticNetwork(nn.Module):
    """Tables 8 and 11: graph convolutions from joints to body, pooled over what time is left.

    Args:
        in_channels: of a joint, conditions included: 258 for the projection critic, 262 for the pose critic.
        skeleton: whose levels the graph climbs up.
        norm: kind of norm.
        blocks: channels after each block.
        gain: factor on the condition, see `condition_gain`.
    """

    def __init__(
        self, in_channels: int, skeleton: Skeleton, norm: Norm, blocks: tuple[int, ...] = BLOCKS, gain: float = 1.0
    ) -> None:
        super().__init__()
        self.gain = gain
        levels = [skeleton.levels[i] for i in LEVELS]
        channels = (in_channels, *blocks)
        strides, paddings = (1, 2, 2, 2, 2), (1, 0, 1, 1, 1)  # 65 -> 65 -> 32 -> 16 -> 8 -> 4 frames
        self.blocks = nn.ModuleList(
            GraphBlock(GraphConv(channels[i], channels[i + 1], levels[i], levels[i + 1], strides[i], paddings[i]), norm)
            for i in range(len(blocks))
        )
        self.out = PooledConv1d(channels[-1], channels[-1], 1)
        self.score = nn.Linear(channels[-1], 1)

    def forward(self, x: Float[Tensor, "b j c t"], condition: Float[Tensor, "b d"]) -> Float[Tensor, " b"]:
        """Scores, higher for what looks real; the condition stands beside every joint and frame."""
        x = self.blocks[0](x, self.gain * condition)
        for block in self.blocks[1:]:
            x = block(x)
        return self.score(self.out(F.leaky_relu(x[:, 0], SLOPE)))[:, 0]


class TrajectoryCriticNetwork(nn.Module):
    """Table 10: convolutions over the 64 places of the root.

    Args:
        in_channels: 316 in the paper.
        norm: kind of norm.
        blocks: channels after each block.
        gain: factor on the condition, see `condition_gain`.
    """

    def __init__(self, in_channels: int, norm: Norm, blocks: tuple[int, ...] = BLOCKS, gain: float = 1.0) -> None:
        super().__init__()
        self.gain = gain
        channels = (in_channels, *blocks)
        self.blocks = nn.ModuleList(
            TemporalBlock(
                nn.LeakyReLU(SLOPE),
                TemporalConv(channels[i], channels[i + 1], stride=1 if i == 0 else 2),
                normalization(norm, channels[i + 1]),
            )
            for i in range(len(blocks))
        )
        self.out = PooledConv1d(channels[-1], channels[-1], 1)
        self.score = nn.Linear(channels[-1], 1)

    def forward(self, x: Float[Tensor, "b c t"], condition: Float[Tensor, "b d"]) -> Float[Tensor, " b"]:
        """Scores, higher for what looks real; the condition stands beside every frame."""
        x = self.blocks[0](x, self.gain * condition)
        for block in self.blocks[1:]:
            x = block(x)
        return self.score(self.out(F.leaky_relu(x, SLOPE)))[:, 0]


class ContextCriticNetwork(nn.Module):
    """Table 9: convolutions over the cropped relative depth, one channel for each cropped frame.

    Args:
        crops: frames that are cropped, 9 in the paper.
        norm: kind of norm.
        blocks: channels after each convolution.
    """

    def __init__(self, crops: int, norm: Norm, blocks: tuple[int, ...] = CONTEXT_BLOCKS) -> None:
        super().__init__()
        channels = (crops, *blocks)
        self.blocks = nn.ModuleList(
            nn.Sequential(
                nn.LeakyReLU(SLOPE),
                nn.Conv2d(channels[i], channels[i + 1], 3, stride=2, padding=1),
                _planar(norm, channels[i + 1]),
            )
            for i in range(len(blocks) - 1)
        )
        self.out = PooledConv2d(channels[-2], channels[-1], 3, padding=1)
        self.score = nn.Linear(channels[-1], 1)

    def forward(self, x: Float[Tensor, "b n h w"]) -> Float[Tensor, " b"]:
        """Scores, higher for what looks real."""
        for block in self.blocks:
            x = block(x)
        return self.score(self.out(F.leaky_relu(x, SLOPE)))[:, 0]


def _planar(norm: Norm, channels: int) -> nn.Module:
    """The norm of a picture."""
    if norm == "batch":
        return BatchNorm2d(channels)
    return nn.GroupNorm(1, channels) if norm == "layer" else nn.Identity()
