"""Depth error: how far estimated depth is from measured depth, as the field reports it (Eigen et al. 2014)."""

from __future__ import annotations

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.plotted import PlottedMetric

WITHIN = 1.25
"""Ratio of estimated to measured depth, either way, up to which a pixel is right (delta 1)."""

_NAMES = ("abs_rel", "rmse", "delta1")


def depth_errors(predicted: Float[Tensor, "b h w"], depth: Float[Tensor, "b h w"]) -> dict[str, Float[Tensor, " b"]]:
    """The errors of each picture over the pixels whose depth is known; not a number where none is.

    abs_rel = mean |p - d| / d; rmse = sqrt(mean (p - d)^2), metres; delta1 = share with max(p / d, d / p) < 1.25.

    Args:
        predicted: estimated planar z, metres.
        depth: measured planar z, metres; 0 is unknown.

    Example:
        >>> import torch
        >>> depth = torch.tensor([[[2.0, 4.0, 0.0]]])
        >>> {name: float(error) for name, error in depth_errors(depth + 1, depth).items()}
        {'abs_rel': 0.375, 'rmse': 1.0, 'delta1': 0.0}
    """
    predicted, depth = predicted.double().flatten(1), depth.double().flatten(1)
    known = depth > 0
    wrong = torch.where(known, predicted - depth, 0)
    close = known & (predicted < WITHIN * depth) & (depth < WITHIN * predicted)
    pixels = known.sum(1)
    return {
        "abs_rel": (wrong.abs() / torch.where(known, depth, 1)).sum(1) / pixels,
        "rmse": (wrong.square().sum(1) / pixels).sqrt(),
        "delta1": close.sum(1) / pixels.double(),
    }


class DepthError(PlottedMetric):
    """Mean over pictures of the relative error, the root mean square error and the share of right pixels.

    Eigen, Puhrsch and Fergus, "Depth map prediction from a single image using a multi-scale deep network" (2014), not
    in this paper's protocol: see `depth_errors` for the equations. Only pixels of known depth count. Each picture is
    averaged over its own pixels and then all pictures alike, so one with few known pixels weighs as much as any
    other. Neither scale nor shift is fitted first: depth is in metres, and a wrong scale is an error.

    Reacts to depth that is wrong, and to nothing else: motions, colours and pixels without depth do not enter.
    `abs_rel` and `rmse` are better when lower, `delta1` when higher.

    Args:
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.depth_error import DepthError
        >>> metric = DepthError()
        >>> depth = torch.tensor([[[2.0, 4.0, 0.0]]])
        >>> metric.update(1.5 * depth, depth)
        >>> {name: round(float(error), 3) for name, error in metric.compute().items()}
        {'abs_rel': 0.5, 'rmse': 1.581, 'delta1': 0.0}
    """

    higher_is_better = None
    title = "the depth error"

    errors: Tensor
    pictures: Tensor

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.add_state("errors", torch.zeros(len(_NAMES), dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("pictures", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, predicted: Float[Tensor, "b h w"], depth: Float[Tensor, "b h w"]) -> None:
        """Adds pictures; those without any known depth are left out.

        Args:
            predicted: estimated planar z, metres.
            depth: measured planar z, metres; 0 is unknown.

        Raises:
            SagError: the two are of different sizes, or a value is not finite.
        """
        if predicted.shape != depth.shape or depth.dim() != 3:
            raise SagError(
                f"{self.title} needs estimated and true depth of one size (b, h, w), not {tuple(predicted.shape)} and "
                f"{tuple(depth.shape)}; resample the estimate to the true depth's pixels"
            )
        if not (predicted.isfinite().all() and depth.isfinite().all()):
            raise SagError(f"{self.title} was given depth that is not finite; set unknown true depth to 0")
        each = depth_errors(predicted, depth)
        known = (depth > 0).flatten(1).any(1)
        self.errors = self.errors + torch.stack([each[name][known].sum() for name in _NAMES])
        self.pictures = self.pictures + known.sum()

    def compute(self) -> dict[str, Tensor]:
        """The mean over pictures of `abs_rel`, `rmse` (metres) and `delta1`.

        Raises:
            SagError: no picture with known depth was given.
        """
        self._require(self.pictures, "picture with known depth")
        return dict(zip(_NAMES, self.errors / self.pictures))
