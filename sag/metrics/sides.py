"""The real and the generated side of a Fréchet distance, as sums of feature vectors and of their products."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.frechet import Gaussian
from sag.metrics.plotted import PlottedMetric

SIDES = ("real", "generated")
"""What state and messages call the two sides."""


class TwoSided(PlottedMetric, ABC):
    """A distance of two sets of feature vectors whose state is their counts, sums and sums of products in float64.

    Args:
        title: the metric's name, as its refusals begin.
        dimension: numbers of a feature vector.
        settings: numbers that decide what features are, kept among the states.
        options: of `torchmetrics.Metric`.
    """

    higher_is_better = False
    is_differentiable = False
    full_state_update = False
    plot_lower_bound = 0.0

    def __init__(self, title: str, dimension: int, settings: Sequence[float], **options: Any) -> None:
        super().__init__(**options)
        self.title = title
        self._batch_alone = False
        # A collection takes metrics of equal states for one: those of other settings must differ on any motions.
        self.add_state("settings", torch.tensor(settings, dtype=torch.float64), dist_reduce_fx="max")
        for side in SIDES:
            for name, shape in (("count", ()), ("sum", (dimension,)), ("products", (dimension, dimension))):
                self.add_state(f"{side}_{name}", torch.zeros(shape, dtype=torch.float64), dist_reduce_fx="sum")

    def forward(self, *args: Any, **kwargs: Any) -> Tensor:
        """Adds motions as `update` does, and says the distance between the two sides of this batch alone.

        It is NaN when the batch has fewer than 2 vectors on a side: there is nothing to compare.
        """
        self._batch_alone = True
        try:
            return super().forward(*args, **kwargs)
        finally:
            self._batch_alone = False

    def compute(self) -> Float[Tensor, ""]:
        """The distance; 0 where the two sides are equal.

        Raises:
            SagError: a side has no motions, or too few for a covariance.
        """
        counts = [getattr(self, f"{side}_count") for side in SIDES]
        if self._batch_alone and min(counts) < 2:
            return torch.full_like(counts[0], torch.nan)
        return self._distance(*(self._gaussian(side) for side in SIDES))

    @abstractmethod
    def _distance(self, real: Gaussian, generated: Gaussian) -> Float[Tensor, ""]:
        """How far the two sides are apart."""

    def _add(self, features: Float[Tensor, "b n d"], real: bool | Bool[Tensor, " b"]) -> None:
        """Adds the n vectors of each of b motions to the side that the motion is on.

        Raises:
            SagError: not one truth value for each motion.
        """
        chosen = torch.as_tensor(real, device=features.device)
        if chosen.dim() and len(chosen) != len(features):
            raise SagError(f"{self.title} needs real as one truth value for each of {len(features)} motions")
        features, chosen = features.double(), chosen.expand(len(features))
        for side, rows in zip(SIDES, (features[chosen].flatten(0, 1), features[~chosen].flatten(0, 1))):
            for name, added in (("count", len(rows)), ("sum", rows.sum(0)), ("products", rows.T @ rows)):
                setattr(self, f"{side}_{name}", getattr(self, f"{side}_{name}") + added)

    def _gaussian(self, side: str) -> Gaussian:
        """Mean and covariance of a side."""
        count, total, products = (getattr(self, f"{side}_{name}") for name in ("count", "sum", "products"))
        if count < 2:
            raise SagError(f"{self.title} needs 2 {side} motions or more; update it with real={side == 'real'}")
        return Gaussian.of_sums(count, total, products)
