"""Spatio-temporal graph convolution between graph levels (Conv_st in Tables 7, 8 and 11).

Tensors are laid out joints first, (b, v, c, t): one small product over the nodes and one convolution
over time, without permutations.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.skeleton import Level

Norm = Literal["batch", "layer", "none"]

SLOPE = 0.2
"""Negative slope of every LeakyReLU."""

ASYMMETRY = 0.5
"""Spread of the random part of the adjacency. Left and right are each other's image under a symmetry of
every level, so from a symmetric start both sides of the body would move bit for bit alike for ever."""


def normalization(kind: Norm, channels: int) -> nn.Module:
    """The norm after a convolution over (n, channels, ...): batch as in the paper, layer, or none."""
    if kind == "batch":
        return nn.BatchNorm1d(channels)
    return nn.GroupNorm(1, channels) if kind == "layer" else nn.Identity()


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
        self.weight = nn.Parameter(deviation * torch.randn(len(start), out_channels, in_channels, 3))
        self.bias = nn.Parameter(torch.zeros(out_channels))
        self.stride, self.padding = stride, padding

    def forward(
        self, x: Float[Tensor, "b v c t"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b w d s"]:
        """Convolves the nodes' values, set beside a condition that is the same for all nodes and frames.

        The condition's channels come last. Its share of the output differs only where the kernel meets the
        padding, so three frames of it say all: first, middle and last.
        """
        if condition is None:
            return self._convolve(x, self.weight) + self.bias[:, None]
        own = self.weight[:, :, : x.shape[2]]
        constant = condition[:, None, :, None].expand(-1, x.shape[1], -1, 3)
        first, middle, last = self._convolve(constant, self.weight[:, :, x.shape[2] :]).unbind(-1)
        y = self._convolve(x, own)
        shares = [first[..., None], middle[..., None].expand(*middle.shape, y.shape[-1] - 2), last[..., None]]
        return y + torch.cat(shares, dim=-1) + self.bias[:, None]

    def _convolve(self, x: Tensor, weight: Tensor) -> Tensor:
        """Aggregates over nodes first when the target level is the smaller one: the same sum, cheaper."""
        _, source, target = self.adjacency.shape
        return self._aggregate_first(x, weight) if target <= source else self._convolve_first(x, weight)

    def _aggregate_first(self, x: Tensor, weight: Tensor) -> Tensor:
        kernels, nodes, target = self.adjacency.shape
        b, _, c, t = x.shape
        mixing = self.adjacency.permute(2, 0, 1).reshape(target * kernels, nodes)
        mixed = torch.matmul(mixing, x.reshape(b, nodes, c * t)).view(b * target, kernels * c, t)
        flat = weight.permute(1, 0, 2, 3).reshape(len(self.bias), kernels * c, 3)
        return F.conv1d(mixed, flat, None, self.stride, self.padding).unflatten(0, (b, target))

    def _convolve_first(self, x: Tensor, weight: Tensor) -> Tensor:
        kernels, nodes, target = self.adjacency.shape
        b, _, c, _ = x.shape
        channels = len(self.bias)
        flat = weight.reshape(kernels * channels, c, 3)
        convolved = F.conv1d(x.flatten(0, 1), flat, None, self.stride, self.padding)
        mixing = self.adjacency.permute(2, 1, 0).reshape(target, nodes * kernels)
        return torch.matmul(mixing, convolved.reshape(b, nodes * kernels, -1)).view(b, target, channels, -1)


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
        self.up = up

    def forward(
        self, x: Float[Tensor, "b v c t"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b w d s"]:
        """Convolves after the activation and normalises over all nodes alike."""
        told = None if condition is None else F.leaky_relu(condition, SLOPE)
        y = self.conv(F.leaky_relu(x, SLOPE), told)
        y = self.norm(y.flatten(0, 1)).view_as(y)
        return y.repeat_interleave(2, dim=-1) if self.up else y
