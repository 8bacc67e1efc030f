"""Pairs of feature sets whose Fréchet distance is known, of more dimensions than members."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor


class KnownPair(NamedTuple):
    """Two sets on common axes.

    Attributes:
        name: what is special about it.
        real: features.
        generated: features.
        distance: the squared Fréchet distance that a calculation without rounding would find.
    """

    name: str
    real: Float[Tensor, "n d"]
    generated: Float[Tensor, "n d"]
    distance: float


def known_pairs(dimension: int, rank: int, seed: int) -> Iterator[KnownPair]:
    """Pairs that share all axes, half of them and none.

    With deviations a and b along common axes the covariances commute, and the distance is |m_a - m_b|^2 + |a - b|^2.
    The deviations fall by a factor of 1,000 from the first axis to the last, as those of features do.
    """
    generator = torch.Generator().manual_seed(seed)
    basis = _orthonormal(dimension, 2 * rank, generator)
    falling = torch.logspace(0, -3, rank, dtype=torch.float64)
    nothing = torch.zeros_like(falling)
    first, second = torch.cat([falling, nothing]), torch.cat([nothing, falling])
    shift = torch.randn(dimension, generator=generator, dtype=torch.float64) / dimension**0.5
    generated = {
        "identical": (first, 0 * shift),
        "wider and moved": (2 * first, shift),
        "spread the other way round": (torch.cat([falling.flip(0), nothing]), 0 * shift),
        "half of the axes shared": (first.roll(rank // 2), 0 * shift),
        "no axis shared": (second, 0 * shift),
    }
    real = _features(first, basis, generator)
    for name, (deviations, mean) in generated.items():
        others = real if name == "identical" else _features(deviations, basis, generator) + mean
        yield KnownPair(name, real, others, float(mean.square().sum() + (first - deviations).square().sum()))


def _features(deviations: Tensor, basis: Tensor, generator: torch.Generator) -> Float[Tensor, "n d"]:
    """As many features as the rank needs, with mean zero and exactly these deviations along the axes."""
    rank = int((deviations > 0).sum())
    scores = torch.randn(rank + 1, rank, generator=generator, dtype=torch.float64)
    scores = torch.linalg.qr(scores - scores.mean(0)).Q * rank**0.5
    return scores * deviations[deviations > 0] @ basis[:, deviations > 0].T


def _orthonormal(rows: int, columns: int, generator: torch.Generator) -> Tensor:
    return torch.linalg.qr(torch.randn(rows, columns, generator=generator, dtype=torch.float64)).Q
