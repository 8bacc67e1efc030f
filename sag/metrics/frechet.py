"""The Fréchet distance of two Gaussians, right also where covariances have no full rank."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

_RESOLUTION = 4 * torch.finfo(torch.float64).eps
"""Eigenvalues below this share of the largest are rounding; its root would count thousands of times more."""

_WELL_CONDITIONED = 1e-10
"""Share of the largest squared pivot above which all must lie for a Cholesky factor to be taken for the root."""

_BLOCK = 128
"""Columns that a product of triangles handles at a time."""


@dataclass(frozen=True, eq=False)
class Gaussian:
    """Mean and covariance of a set of features, in float64 whatever comes in.

    Attributes:
        mean: of the features.
        covariance: of the features, symmetric, of any rank.
        rank: what the rank cannot exceed, if that is known; it tells small spreads from rounding.

    Example:
        >>> import torch
        >>> near = Gaussian(torch.zeros(2), torch.eye(2))
        >>> near.distance(Gaussian(torch.full((2,), 3.0), 4 * torch.eye(2)))
        tensor(20., dtype=torch.float64)
    """

    mean: Float[Tensor, " d"]
    covariance: Float[Tensor, "d d"]
    rank: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", self.mean.double())
        object.__setattr__(self, "covariance", self.covariance.double())

    @classmethod
    def of_sums(cls, count: Tensor | float, total: Float[Tensor, " d"], products: Float[Tensor, "d d"]) -> Gaussian:
        """The Gaussian of features of which only sums were kept.

        Args:
            count: how many features, at least 2.
            total: their sum.
            products: sum of their outer products with themselves.
        """
        mean = total / count
        return cls(mean, (products - count * mean.outer(mean)) / (count - 1), rank=round(float(count)) - 1)

    @classmethod
    def of(cls, features: Float[Tensor, "n d"]) -> Gaussian:
        """The Gaussian of these features."""
        wide = features.double()
        return cls.of_sums(len(wide), wide.sum(0), wide.T @ wide)

    def same_as(self, other: Gaussian) -> bool:
        """Whether mean and covariance are those of the other to the bit, on the same device."""
        own, others = (self.mean, self.covariance), (other.mean, other.covariance)
        return self.mean.device == other.mean.device and all(map(torch.equal, own, others))

    @cached_property
    def root(self) -> Float[Tensor, "d r"]:
        """A lower triangular matrix of as many columns as the rank; times its transpose it is the covariance.

        Computed once: one distance after another to the same Gaussian costs one matrix' eigenvalues each.
        """
        factor, failed = torch.linalg.cholesky_ex(self.covariance)
        pivots = factor.diagonal().square()
        if len(pivots) and not failed and pivots.min() > _WELL_CONDITIONED * pivots.max():
            return factor
        values, vectors = torch.linalg.eigh(self.covariance)
        values = _above_rounding(values)
        kept = torch.arange(len(values), device=values.device) >= len(values) - self._most(len(values))
        kept &= values > 0
        return torch.linalg.qr((vectors[:, kept] * values[kept].sqrt()).T, mode="r").R.T

    def distance(self, other: Gaussian) -> Float[Tensor, ""]:
        """The squared Fréchet distance, see `frechet_distance`; the root that is taken is this Gaussian's."""
        values = _eigenvalues(_between(self.root, other.covariance))
        if other.rank is None:
            values = _above_rounding(values)
        overlap = values[len(values) - other._most(len(values)) :].clamp_min(0).sqrt().sum()
        spread = self.covariance.trace() + other.covariance.trace()
        return ((self.mean - other.mean).square().sum() + spread - 2 * overlap).clamp_min(0)

    def _most(self, size: int) -> int:
        """How many of so many eigenvalues can be other than 0."""
        return size if self.rank is None else min(size, self.rank)


def frechet_distance(
    mean_a: Float[Tensor, " d"],
    covariance_a: Float[Tensor, "d d"],
    mean_b: Float[Tensor, " d"],
    covariance_b: Float[Tensor, "d d"],
) -> Float[Tensor, ""]:
    """The squared Fréchet (2-Wasserstein) distance of two Gaussians, computed in float64.

    |m_a - m_b|^2 + tr(C_a) + tr(C_b) - 2 tr((C_a^1/2 C_b C_a^1/2)^1/2)

    Any R with R R^T = C_a will do for the root: R^T C_b R has the same eigenvalues other than 0, and being symmetric
    it has no others than real ones. R has as many columns as C_a has rank, so sets smaller than their dimension are
    no special case. Never negative. It reacts to means and covariances alone: sets that differ in anything else are
    at distance zero (Dowson and Landau, 1982).

    Example:
        >>> import torch
        >>> zero, one = torch.zeros(2), torch.eye(2)
        >>> frechet_distance(zero, one, zero + 3, 4 * one)
        tensor(20., dtype=torch.float64)
    """
    return Gaussian(mean_a, covariance_a).distance(Gaussian(mean_b, covariance_b))


def _between(root: Float[Tensor, "d r"], covariance: Float[Tensor, "d d"]) -> Float[Tensor, "r r"]:
    """The lower triangle of root.T @ covariance @ root, in a quarter of the products since root is a triangle."""
    found = root.new_zeros(root.shape[1], root.shape[1])
    for start in range(0, len(found), _BLOCK):
        columns = slice(start, start + _BLOCK)
        half = covariance[start:, start:] @ root[start:, columns]
        for row in range(start, len(found), _BLOCK):
            found[row : row + _BLOCK, columns] = root[row:, row : row + _BLOCK].T @ half[row - start :]
    return found


def _eigenvalues(symmetric: Float[Tensor, "r r"]) -> Float[Tensor, " r"]:
    """Ascending eigenvalues of the lower triangle; on a CPU by NumPy, whose routine is twice as fast as PyTorch's."""
    if symmetric.is_cpu and not symmetric.requires_grad:
        return torch.from_numpy(np.linalg.eigvalsh(symmetric.numpy()))
    return torch.linalg.eigvalsh(symmetric)


def _above_rounding(eigenvalues: Tensor) -> Tensor:
    """Eigenvalues (ascending) with those that rounding alone explains set to 0."""
    if not len(eigenvalues):
        return eigenvalues
    floor = eigenvalues[-1].clamp_min(0) * _RESOLUTION
    return torch.where(eigenvalues > floor, eigenvalues, 0)
