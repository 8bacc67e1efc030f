"""Losses: scores in, scalar out."""

from __future__ import annotations

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor

from sag.processes import drawn, largest, mean


def critic_loss(real: Float[Tensor, " b"], fake: Float[Tensor, " b"]) -> Float[Tensor, ""]:
    """The Wasserstein critic's loss: its negative estimate of the distance."""
    return fake.mean() - real.mean()


def generator_loss(fake: Float[Tensor, " b"]) -> Float[Tensor, ""]:
    """What the generator pays to one critic."""
    return -fake.mean()


def gradient_penalty(
    critic: Callable[[Tensor], Tensor], real: Tensor, fake: Tensor, target: float, axes: int = 1
) -> Float[Tensor, ""]:
    """Mean of (norm of the critic's gradient - target)^2 at random mixtures of real and fake (WGAN-GP).

    Args:
        critic: view to scores, conditions held fixed.
        real: views of true motions, batch first.
        fake: views of generated motions.
        target: the paper's is 0.1; Gulrajani et al. have 1.
        axes: leading axes that keep norms of their own: 1 asks for one norm of a view, 2 for one of each frame.
    """

    def shares(count: int) -> Tensor:
        return torch.rand(count, *[1] * (real.dim() - 1), dtype=real.dtype, device=real.device)

    share = drawn(shares, len(real))
    mixture = (share * real + (1 - share) * fake).detach().requires_grad_()
    (gradient,) = torch.autograd.grad(critic(mixture).sum(), mixture, create_graph=True)
    # A norm's own derivative is undefined at zero, and a dead critic has zero gradient.
    norm = (gradient.square().sum(dim=tuple(range(axes, gradient.dim()))) + 1e-12).sqrt()
    return (norm - target).square().mean()


def berhu(predicted: Float[Tensor, "b h w"], true: Float[Tensor, "b h w"], share: float = 0.2) -> Float[Tensor, ""]:
    """Inverse Huber loss over the pixels whose depth is known (Laina et al., 3DV 2016).

    |e| up to c and (e^2 + c^2) / (2c) above it, with c = `share` of the batch's largest error.

    Args:
        predicted: metres.
        true: metres, 0 where unknown.
        share: of the largest error.
    """
    known = true > 0
    error = (predicted - true).abs()[known]
    threshold = (share * largest(error.max() if error.numel() else error.new_zeros(()))).detach().clamp_min(1e-6)
    each = torch.where(error <= threshold, error, (error.square() + threshold.square()) / (2 * threshold))
    return mean(each)
