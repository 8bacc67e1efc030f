"""The Fréchet distance of two Gaussians, right also where covariances have no full rank."""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor

_RESOLUTION = 4 * torch.finfo(torch.float64).eps
"""Eigenvalues below this share of the largest are rounding; its root would count thousands of times more."""


def frechet_distance(
    mean_a: Float[Tensor, " d"],
    covariance_a: Float[Tensor, "d d"],
    mean_b: Float[Tensor, " d"],
    covariance_b: Float[Tensor, "d d"],
) -> Float[Tensor, ""]:
    """The squared Fréchet (2-Wasserstein) distance of two Gaussians, computed in float64.

    |m_a - m_b|^2 + tr(C_a) + tr(C_b) - 2 tr((C_a^1/2 C_b C_a^1/2)^1/2)

    The matrix under the last root is symmetric, so its eigenvalues are real, and C_a is first reduced to its
    range: sets smaller than their dimension are no special case. Never negative.

    Example:
        >>> import torch
        >>> zero, one = torch.zeros(2), torch.eye(2)
        >>> frechet_distance(zero, one, zero + 3, 4 * one)
        tensor(20., dtype=torch.float64)
    """
    mean_a, covariance_a, mean_b, covariance_b = (x.double() for x in (mean_a, covariance_a, mean_b, covariance_b))
    root = _thin_root(covariance_a)
    overlap = _above_rounding(torch.linalg.eigvalsh(root.T @ covariance_b @ root)).sqrt().sum()
    distance = (mean_a - mean_b).square().sum() + covariance_a.trace() + covariance_b.trace() - 2 * overlap
    return distance.clamp_min(0)


def _thin_root(covariance: Tensor) -> Tensor:
    """A (d, rank) matrix whose product with its own transpose is the covariance."""
    values, vectors = torch.linalg.eigh(covariance)
    values = _above_rounding(values)
    kept = values > 0
    return vectors[:, kept] * values[kept].sqrt()


def _above_rounding(eigenvalues: Tensor) -> Tensor:
    """Eigenvalues (ascending) with those that rounding alone explains set to 0."""
    if not len(eigenvalues):
        return eigenvalues
    floor = eigenvalues[-1].clamp_min(0) * _RESOLUTION
    return torch.where(eigenvalues > floor, eigenvalues, 0)
