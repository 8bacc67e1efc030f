"""Convolutions whose values are averaged over all places at once (row Out of Tables 8 to 11).

A mean of a convolution is the kernel times sums of what lies under each of its taps, and those differ from the sum of
all places by an edge: the convolution itself is never made.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn


def sums_under_taps(x: Tensor, dim: int) -> Tensor:
    """Sums along an axis of what three taps meet, one behind the other in its place, with one zero on both ends."""
    total, last = x.sum(dim, keepdim=True), x.shape[dim] - 1
    return torch.cat([total - x.narrow(dim, last, 1), total, total - x.narrow(dim, 0, 1)], dim)


class PooledConv1d(nn.Conv1d):
    """`torch.nn.Conv1d` with one tap, averaged over time."""

    def forward(self, x: Float[Tensor, "b c t"]) -> Float[Tensor, "b d"]:
        """The mean of the convolution is the convolution of the mean."""
        return F.linear(x.mean(dim=-1), self.weight[..., 0], self.bias)


class PooledConv2d(nn.Conv2d):
    """`torch.nn.Conv2d` with 3 x 3 taps and padding 1, averaged over the picture."""

    def forward(self, x: Float[Tensor, "b c h w"]) -> Float[Tensor, "b d"]:
        """The mean of the convolution over a picture of any size."""
        sums = sums_under_taps(sums_under_taps(x, -2), -1)
        return F.linear(sums.flatten(1) / (x.shape[-2] * x.shape[-1]), self.weight.flatten(1), self.bias)
