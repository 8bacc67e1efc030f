"""Motion FID of motions that are weighted by group: what bootstraps and extrapolations are made of."""

from __future__ import annotations

from collections.abc import Callable

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.metrics.fid.clips import ClipFeatures, grouped
from sag.metrics.frechet import Gaussian

_MOST_SUMS = 2**27
"""Numbers (1 GiB) that the sums of all groups may take for one encoder, one clip length and one side."""


def places_of_groups(name: str, group: Int[Tensor, " b"], motions: int) -> Int[Tensor, " b"]:
    """The place of each motion's group among all groups, 0, 1, ..., on the CPU.

    Args:
        name: of the figure, as its refusal begins.
        group: of each motion, any whole numbers.
        motions: how many there are.

    Raises:
        SagError: not one group for each motion.
    """
    if len(group) != motions:
        raise SagError(f"{name} needs the group of each of {motions} motions, not {len(group)}")
    return torch.unique(group.cpu(), return_inverse=True)[1]


def weighted_motion_fid(
    generated: ClipFeatures, real: ClipFeatures, group: Int[Tensor, " b"], weights: Float[Tensor, "w g"]
) -> dict[str, Float[Tensor, " w"]]:
    """Motion FID as if each group of motions were there as often as its weight says, on both sides.

    One encoder and clip length is worked on at a time, so that memory does not grow with their number.

    Args:
        generated: features of generated motions.
        real: features of as many real ones.
        group: the group of each motion, 0, 1, ..., the same on both sides.
        weights: rows of weights, 0 or more, one figure each.
    """
    device = next(iter(real.values())).device
    group, weights = group.to(device), weights.to(device)
    distances = {}
    for key in real:
        sides = [_weighted(side[key], group, weights.shape[1]) for side in (real, generated)]
        distances[key] = torch.stack([sides[0](row).distance(sides[1](row)) for row in weights])
    return grouped(distances)


def _weighted(features: Float[Tensor, "b c d"], group: Int[Tensor, " b"], groups: int) -> Callable[[Tensor], Gaussian]:
    """The Gaussian of features as a function of the groups' weights."""
    c, d = features.shape[1:]
    if groups * d * d > _MOST_SUMS:
        return lambda weights: _of_weighted_clips(features.flatten(0, 1), weights[group].repeat_interleave(c))
    parts = [features[group == place].double().flatten(0, 1) for place in range(groups)]
    counts = features.new_tensor([len(part) for part in parts], dtype=torch.float64)
    totals = torch.stack([part.sum(0) for part in parts])
    products = torch.stack([part.T @ part for part in parts])
    return lambda weights: Gaussian.of_sums(
        weights @ counts, weights @ totals, (weights @ products.flatten(1)).unflatten(0, (d, d))
    )


def _of_weighted_clips(clips: Float[Tensor, "n d"], weights: Float[Tensor, " n"]) -> Gaussian:
    """For groups so many that a matrix for each would not fit: slower, and no larger than the features."""
    there = weights > 0
    wide, weights = clips[there].double(), weights[there]
    weighted = wide * weights[:, None]
    return Gaussian.of_sums(weights.sum(), weighted.sum(0), wide.T @ weighted)
