"""Depth probe: how much of a scene's depth can be read off a scene feature by a linear map."""

from __future__ import annotations

from typing import Any

import torch
import torch.nn.functional as F
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.metrics.plotted import PlottedMetric

CELLS = (9, 16)
"""Rows and columns of the depth map that is read off."""

RIDGE = 1.0
"""Weight of the penalty on the map's coefficients, for features of deviation 1: places are few, and features long."""


class DepthProbe(PlottedMetric):
    """Error of depth that a ridge regression reads off scene features, in places it was not fitted to. Ours.

    With y the logarithm of a picture's depth averaged over 9 x 16 cells, x the feature, and two folds of places,

        rmse = sqrt(mean_p (y - B_p' x - b_p)^2), explained = 1 - mean_p (y - B_p' x - b_p)^2 / mean_p (y - m_p)^2

    where B_p and b_p are fitted, and the mean map m_p is taken, on the fold that p is not in. A probe in the sense of
    Alain and Bengio, "Understanding intermediate layers using linear classifier probes" (2016): unlike `DepthError` it
    needs no decoder, so that systems with and without depth supervision (paper, 3.1) can be compared.

    Reacts to what the feature knows of depth. Blind to whether a generator makes use of it, and to the scale and order
    of its channels. A feature that does not look has `explained` 0. The penalty that a few dozen places need shrinks
    the map, so that even a feature that is linear in depth does not reach 1.

    Args:
        channels: length of the feature.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.depth_probe import DepthProbe
        >>> noise = torch.Generator().manual_seed(0)
        >>> feature = torch.randn(400, 2, generator=noise)
        >>> depth = (feature[:, :1, None] * 0.3 + 1).exp().expand(-1, 18, 32)
        >>> metric = DepthProbe(channels=2)
        >>> metric.update(feature, depth, fold=torch.arange(400) % 2)
        >>> {name: round(float(value), 2) for name, value in metric.compute().items()}
        {'rmse': 0.14, 'explained': 0.75}
    """

    higher_is_better = None
    title = "the depth probe"

    moments: Tensor

    def __init__(self, channels: int, **options: Any) -> None:
        super().__init__(**options)
        self.channels = channels
        size = 1 + channels + CELLS[0] * CELLS[1]
        self.add_state("moments", torch.zeros(2, size, size, dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, feature: Float[Tensor, "b f"], depth: Float[Tensor, "b h w"], fold: Int[Tensor, " b"]) -> None:
        """Adds pictures; those without any known depth are left out.

        Args:
            feature: of the pictures.
            depth: measured planar z, metres; 0 is unknown.
            fold: 0 or 1; pictures of one place belong in one fold.

        Raises:
            SagError: a feature has another length, or is not finite.
        """
        if feature.shape[1] != self.channels or not feature.isfinite().all():
            raise SagError(f"{self.title} needs finite features of {self.channels} numbers, not {tuple(feature.shape)}")
        known = (depth > 0).flatten(1).any(1)
        ones = feature.new_ones(len(feature), 1, dtype=torch.float64)
        rows = torch.cat([ones, feature.double(), depth_map(depth)], dim=1)
        for number in (0, 1):
            chosen = rows[known & (fold == number)]
            self.moments[number] += chosen.T @ chosen

    def compute(self) -> dict[str, Tensor]:
        """`rmse` of the logarithm of depth, lower is better, and `explained`, the share of its variance.

        Both are left out where a fold has fewer than two pictures, which tell nothing.
        """
        counts = self.moments[:, 0, 0]
        if counts.min() < 2:
            return {}
        errors = [self._errors(fitted=1 - number, tried=number) for number in (0, 1)]
        probed, mean = (sum(part) for part in zip(*errors))
        cells = CELLS[0] * CELLS[1]
        explained = torch.where(mean > 0, 1 - probed / mean.clamp_min(1e-300), 0.0)  # nothing, where all is alike
        return {"rmse": (probed.clamp_min(0) / counts.sum() / cells).sqrt(), "explained": explained}

    def _errors(self, fitted: int, tried: int) -> tuple[Tensor, Tensor]:
        """Summed squared errors of a probe, and of the mean map, of one fold in the other."""
        split = 1 + self.channels
        own = self.moments[fitted] / self.moments[fitted, 0, 0]
        mean, cross = own[0, 1:split], own[1:split, 1:split] - own[0, 1:split].outer(own[0, 1:split])
        scale = cross.diagonal().clamp_min(1e-12).sqrt()
        ridge = RIDGE * torch.eye(self.channels, dtype=cross.dtype, device=cross.device)
        joint = own[1:split, split:] - mean.outer(own[0, split:])
        slope = torch.linalg.solve(cross / scale.outer(scale) + ridge, joint / scale[:, None]) / scale[:, None]
        constant = own[0, split:] - mean @ slope
        still = torch.cat([own[:1, split:], torch.zeros_like(slope)])
        return self._error(torch.cat([constant[None], slope]), tried), self._error(still, tried)

    def _error(self, linear: Float[Tensor, "x y"], tried: int) -> Tensor:
        """Summed squared error of a linear map over the pictures of a fold."""
        moments, split = self.moments[tried], len(linear)
        squares = moments[split:, split:].diagonal().sum() - 2 * (linear * moments[:split, split:]).sum()
        return squares + (linear * (moments[:split, :split] @ linear)).sum()


def depth_map(depth: Float[Tensor, "b h w"]) -> Float[Tensor, "b c"]:
    """The logarithm of depth averaged over cells; a cell without known depth takes the picture's mean.

    Args:
        depth: measured planar z, metres; 0 is unknown.
    """
    known = (depth > 0).double()
    logarithm = torch.where(depth > 0, depth, 1.0).double().log()
    share = F.adaptive_avg_pool2d(known[:, None], CELLS).flatten(1)
    total = F.adaptive_avg_pool2d(logarithm[:, None], CELLS).flatten(1)
    overall = total.sum(1, keepdim=True) / share.sum(1, keepdim=True).clamp_min(1e-12)
    return torch.where(share > 0, total / share.clamp_min(1e-12), overall)
