"""Noise that is smooth in time (paper, 3.2.1)."""

from __future__ import annotations

import math
from typing import Literal

import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn

Kernel = Literal["exponential", "squared_exponential"]

LATENT_STEPS = 6
"""Latent frames before any upsampling (Tables 6 and 7)."""


def covariance(
    steps: int, sigma: Float[Tensor, " c"], kernel: Kernel = "exponential"
) -> Float[Tensor, "c steps steps"]:
    """k(t1, t2) = exp(-|t1 - t2| / (2 sigma^2)), the paper's kernel, which it prints without a square.

    Args:
        steps: latent frames.
        sigma: how far each channel's values hang together, in latent frames.
        kernel: `squared_exponential` has |t1 - t2|^2 instead.
    """
    times = torch.arange(steps, dtype=sigma.dtype)
    gap = (times[:, None] - times[None]).abs()
    if kernel == "squared_exponential":
        gap = gap**2
    return torch.exp(-gap / (2 * sigma[:, None, None] ** 2))


class GaussianProcess(nn.Module):
    """A Gaussian process over the latent frames, with another correlation for every channel.

    Args:
        channels: 256 for the trajectory, 1024 for the pose (Tables 6 and 7).
        steps: latent frames.
        kernel: see `covariance`.
        sigmas: smallest and largest sigma; channels are spread between them evenly in the logarithm.
    """

    factor: Tensor

    def __init__(
        self,
        channels: int,
        steps: int = LATENT_STEPS,
        kernel: Kernel = "exponential",
        sigmas: tuple[float, float] = (0.3, 5.5),
    ) -> None:
        super().__init__()
        low, high = (math.log(s) for s in sigmas)
        sigma = torch.linspace(low, high, channels, dtype=torch.float64).exp()
        # The squared kernel is singular to rounding for large sigma; the jitter is far below any effect.
        jitter = 1e-9 * torch.eye(steps, dtype=torch.float64)
        factor = torch.linalg.cholesky(covariance(steps, sigma, kernel) + jitter)
        self.register_buffer("factor", factor.float(), persistent=False)

    def forward(self, count: int, generator: Generator | None = None) -> Float[Tensor, "count c steps"]:
        """Independent samples; `generator` makes them repeatable."""
        channels, steps, _ = self.factor.shape
        white = torch.randn(count, channels, steps, generator=generator, device=self.factor.device)
        return torch.einsum("cst,nct->ncs", self.factor, white)
