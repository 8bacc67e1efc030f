"""Spatio-temporal graph convolution between graph levels (Conv_st in Tables 7, 8 and 11).

Tensors are (b, v, c, t) to whoever calls, but lie in memory as (v, b, t, c): nodes are mixed by one product of
matrices and windows of time convolved by another, and nothing is ever transposed, in no derivative either.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.temporal import TAPS, BatchNorm, Doubling, LayerNorm, told, windows
from sag.skeleton import Level

Norm = Literal["batch", "layer", "none"]

SLOPE = 0.2
"""Negative slope of every LeakyReLU."""

ASYMMETRY = 0.5
"""Spread of the random part of the adjacency. Left and right are each other's image under a symmetry of
every level, so from a symmetric start both sides of the body would move bit for bit alike for ever."""


def normalization(kind: Norm, channels: int) -> nn.Module:
    """The norm after a convolution over (n, channels, frames): batch as in the paper, layer, or none."""
    if kind == "batch":
        return BatchNorm(channels)
    return LayerNorm(channels) if kind == "layer" else nn.Identity()


def partitions(source: Level, target: Level) -> Float[np.ndarray, "3 source target"]:
    """ST-GCN's spatial partition, for levels that may differ: same place, nearer the root, further from it.

    Each column of a partition sums to 1, or is empty.
    """
    same = source.shared(target)
    fine = (source.adjacency @ same) if len(source.nodes) >= len(target.nodes) else (same @ target.adjacency)
    touching = (fine > 0) & (same == 0)
    nearer = source.distance[:, None] <= target.distance[None]
    parts = np.stack([same, touching & nearer, touching & ~nearer]).astype(float)
    return parts / np.maximum(parts.sum(axis=1, keepdims=True), 1)


class GraphConv(nn.Module):
    """Convolves over nodes and time and changes the graph level in one operator.

    The adjacency is learned; it starts at the partitions plus a random, asymmetric part.

    Args:
        in_channels: channels of a node.
        out_channels: channels of a node afterwards.
        source: level of the input.
        target: level of the output.
        stride: temporal stride; 1 where a condition is given.
        padding: zero frames on both ends; the temporal kernel is 3.
    """

    def __init__(
        self, in_channels: int, out_channels: int, source: Level, target: Level, stride: int = 1, padding: int = 1
    ) -> None:
        super().__init__()
        start = torch.tensor(partitions(source, target), dtype=torch.float32)
        spread = ASYMMETRY / math.sqrt(len(source.nodes))
        self.adjacency = nn.Parameter(start + spread * torch.randn_like(start))
        deviation = math.sqrt(2 / (len(start) * in_channels * 3))
        weight = deviation * torch.randn(len(start), out_channels, in_channels, TAPS)
        self.weight = nn.Parameter(weight.permute(0, 3, 2, 1).contiguous().permute(0, 3, 2, 1))
        self.bias = nn.Parameter(torch.zeros(out_channels))
        self.stride, self.padding = stride, padding

    def forward(
        self, x: Float[Tensor, "b v c t"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b w d s"]:
        """Convolves the nodes' values, set beside a condition that is the same for all nodes and frames.

        The condition's channels come last.
        """
        own, frames = x.shape[2:]
        weight = self.weight.permute(0, 3, 2, 1)
        seen = windows(x.permute(1, 0, 3, 2), self.stride, self.padding)
        y = self._convolve(seen, weight[:, :, :own].flatten(1, 2))
        if condition is not None:
            taps = self._taps(condition, weight[:, :, own:]).flatten(0, 1)
            y = told(y.flatten(0, 1), taps, frames, self.stride, self.padding).view_as(y)
        return y.permute(1, 0, 3, 2)

    def _convolve(self, seen: Float[Tensor, "v b s i"], weight: Float[Tensor, "k i d"]) -> Float[Tensor, "w b s d"]:
        """Mixes nodes before or after the channels, and adds the bias."""
        kernels, source, target = self.adjacency.shape
        _, b, places, inputs = seen.shape
        if self._mixes_first(inputs):
            mixing = self.adjacency.transpose(1, 2).reshape(kernels * target, source)
            mixed = torch.mm(mixing, seen.reshape(source, -1)).view(kernels, -1, inputs)
            y: Tensor = self.bias
            for part, channels in zip(mixed.unbind(), weight.unbind()):
                y = torch.addmm(y, part, channels)
            return y.view(target, b, places, -1)
        channels = weight.transpose(0, 1).reshape(inputs, -1)
        convolved = torch.mm(seen.reshape(-1, inputs), channels).view(source, b * places, kernels, -1)
        mixing = self.adjacency.permute(2, 1, 0).reshape(target, source * kernels)
        mixed = torch.mm(mixing, convolved.transpose(1, 2).reshape(source * kernels, -1))
        return mixed.view(target, b, places, -1) + self.bias

    def _mixes_first(self, inputs: int) -> bool:
        """Whether mixing nodes before the channels takes less arithmetic; the sum is the same.

        Args:
            inputs: channels of a window.
        """
        _, source, target = self.adjacency.shape
        outputs = len(self.bias)
        return inputs * target * (source + outputs) <= source * outputs * (inputs + target)

    def _taps(self, condition: Float[Tensor, "b e"], weight: Float[Tensor, "k 3 e d"]) -> Float[Tensor, "w b 3 d"]:
        """What each tap makes of the condition at each node: nodes differ by the sum of their weights alone."""
        made = torch.matmul(condition, weight).transpose(1, 2)
        mixed = torch.mm(self.adjacency.sum(dim=1).t(), made.flatten(1))
        return mixed.view(-1, *made.shape[1:])


class GraphBlock(nn.Module):
    """LeakyReLU, graph convolution, norm and, on request, upsampling by 2 (appendix 6.1).

    Args:
        conv: the convolution.
        norm: kind of norm.
        up: whether time is repeated twice.
    """

    def __init__(self, conv: GraphConv, norm: Norm, up: bool = False) -> None:
        super().__init__()
        self.conv = conv
        self.norm = normalization(norm, len(conv.bias))
        self.up = Doubling() if up else nn.Identity()

    def forward(
        self, x: Float[Tensor, "b v c t"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b w d s"]:
        """Convolves after the activation and normalises over all nodes alike."""
        told = None if condition is None else F.leaky_relu(condition, SLOPE)
        y = self.conv(F.leaky_relu(x, SLOPE), told)
        by_node = y.transpose(0, 1)
        y = self.norm(by_node.flatten(0, 1)).view_as(by_node).transpose(0, 1)
        return self.up(y)
