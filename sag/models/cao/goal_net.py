"""GoalNet: where in the picture the person will be in the end, a CVAE over heat maps."""

from __future__ import annotations

import itertools

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.cao.blocks import ConvBlock, Seen, View
from sag.models.cao.heat_maps import spread

BLOCKS = (64, 128, 256, 512)
"""Channels of the view's halves and of the three blocks that halve it, as in a public GoalNet (Yang et al., 2025)."""

LATENT = 200
"""Numbers of the latent variable, as there."""


class GoalNet(nn.Module):
    """p(goal | picture, person): a latent variable and what is seen become a heat map of the goal.

    Args:
        joints: joints of the skeleton.
        feature: length of f.
        blocks: see `BLOCKS`.
        latent: see `LATENT`.
    """

    def __init__(self, joints: int, feature: int, blocks: tuple[int, ...] = BLOCKS, latent: int = LATENT) -> None:
        super().__init__()
        first, *later = blocks
        self.latent = latent
        self.view = View(joints, first)
        self.goal = ConvBlock(1, first)
        channels = (3 * first, *later)
        self.encoder = nn.Sequential(*(ConvBlock(a, b, stride=2) for a, b in zip(channels, later)))
        self.posterior = nn.Linear(later[-1], 2 * latent)
        self.into = nn.Conv2d(latent + feature + 2 * first, later[-1], 3, 1, 1)
        narrowing = (later[-1], *reversed(blocks))
        self.decoder = nn.ModuleList(ConvBlock(a, b) for a, b in itertools.pairwise(narrowing))
        self.out = nn.Conv2d(first, 1, 1)
        nn.init.zeros_(self.out.weight)  # begins with empty maps, as nearly all cells are empty
        nn.init.zeros_(self.out.bias)  # type: ignore[arg-type]

    def forward(
        self, seen: Seen, goal: Float[Tensor, "b 1 h w"], noise: Float[Tensor, "b z"]
    ) -> tuple[Float[Tensor, "b h w"], Float[Tensor, "b z"], Float[Tensor, "b z"]]:
        """The true goal's heat map made again from a sample of the posterior, its mean and its log variance."""
        view = self.view(seen.image, seen.joints)
        code = self.encoder(torch.cat([view, self.goal(goal)], dim=1)).mean(dim=(-2, -1))
        mean, log_variance = self.posterior(code).chunk(2, dim=1)
        latent = mean + torch.exp(0.5 * log_variance) * noise
        return self._decoded(view, seen.condition.feature, latent), mean, log_variance

    def sample(self, seen: Seen, latent: Float[Tensor, "b z"]) -> Float[Tensor, "b h w"]:
        """The heat map of a goal for a latent variable drawn from the standard normal prior."""
        return self._decoded(self.view(seen.image, seen.joints), seen.condition.feature, latent)

    def _decoded(self, view: Tensor, feature: Tensor, latent: Tensor) -> Tensor:
        """Latent variable and f at every place of a small map, doubled up to the size of the view."""
        sizes = _halvings((view.shape[-2], view.shape[-1]), len(self.decoder) - 1)
        small = F.adaptive_avg_pool2d(view, sizes[0])
        told = torch.cat([latent, feature], dim=1)[:, :, None, None].expand(-1, -1, *sizes[0])
        x = self.into(torch.cat([told, small], dim=1))
        for block, size in zip(self.decoder, sizes):
            x = block(F.interpolate(x, size, mode="nearest"))
        return self.out(x)[:, 0]


def goal_loss(
    predicted: Float[Tensor, "b h w"],
    true: Float[Tensor, "b h w"],
    mean: Float[Tensor, "b z"],
    log_variance: Float[Tensor, "b z"],
) -> tuple[Float[Tensor, ""], Float[Tensor, ""]]:
    """Squared error of the heat map, as a share of a bump's own square, and KL divergence from the prior, in nats.

    A mean over all cells, nearly all of them empty, would be so small that the divergence decides alone and the
    latent variable stays unused; a share of the bump is of one size whatever the map's.
    """
    bump = torch.pi * spread(true.shape[1]) ** 2
    error = (predicted - true).square().sum(dim=(1, 2)).mean() / bump
    divergence = 0.5 * (mean.square() + log_variance.exp() - 1 - log_variance).sum(dim=1).mean()
    return error, divergence


def _halvings(size: tuple[int, int], count: int) -> list[tuple[int, int]]:
    """Sizes up to `size`, each about twice the one before."""
    sizes = [size]
    for _ in range(count):
        rows, columns = sizes[0]
        sizes.insert(0, (-(-rows // 2), -(-columns // 2)))
    return sizes
