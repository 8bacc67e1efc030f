"""The real and the generated side of a distance between two sets of motions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, TypeAlias

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor, tensor

from sag.errors import SagError
from sag.metrics.frechet import Gaussian
from sag.metrics.plotted import PlottedMetric

SIDES = ("real", "generated")
"""What states and sentences call the two sides."""

Real: TypeAlias = bool | np.bool_ | Bool[Tensor, ""] | Bool[Tensor, " b"]
"""Which side motions are on: whether they are true ones, for all or for each."""


class TwoSides(PlottedMetric, ABC):
    """A distance of generated motions from real ones, which counts the motions of each side.

    Args:
        options: of `torchmetrics.Metric`.
    """

    higher_is_better = False

    real_motions: Tensor
    generated_motions: Tensor

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        for side in SIDES:
            self.add_state(f"{side}_motions", tensor(0), dist_reduce_fx="sum")

    def _chosen(self, real: Real, motions: int) -> dict[str, slice | Tensor]:
        """Which of so many motions are on which side; a side without any may be left out.

        Raises:
            SagError: not one truth value, nor one for each motion.
        """
        each = torch.as_tensor(real).cpu()  # a mask there picks from tensors anywhere
        if each.dtype != torch.bool:
            raise SagError(f"{self.title} needs real as truth values, not {each.dtype}; compare it with 1, say")
        if not each.dim():
            return {"real" if each else "generated": slice(None)}
        if each.shape != (motions,):
            raise SagError(
                f"{self.title} was given {len(each)} values of real for {motions} motions; give one for each, or one"
            )
        return {"real": each, "generated": ~each}

    def _add(self, side: str, name: str, value: Tensor | int) -> None:
        setattr(self, f"{side}_{name}", getattr(self, f"{side}_{name}") + value)

    def _nothing_to_compare(self) -> bool:
        """Whether the batch that `forward` judges has fewer than two motions of a side.

        Raises:
            SagError: the metric as a whole has fewer than two motions of a side.
        """
        for side in SIDES:
            count = int(getattr(self, f"{side}_motions"))
            if count < 2 and not self._batch_alone:
                told = f"update it with real={side == 'real'}"
                raise SagError(f"{self.title} needs at least 2 {side} motions, it was given {count}; {told}")
            if count < 2:
                return True
        return False


class TwoGaussians(TwoSides):
    """A distance of the Gaussians of two sets of feature vectors; state is their sums in float64.

    Args:
        dimension: numbers of a feature vector.
        vectors: feature vectors of each motion.
        settings: numbers that decide what features are.
        options: of `torchmetrics.Metric`.
    """

    def __init__(self, dimension: int, vectors: int, *settings: float, **options: Any) -> None:
        super().__init__(**options)
        self._vectors = vectors
        self._keep_settings(dimension, vectors, *settings)
        for side in SIDES:
            for name, shape in (("sum", (dimension,)), ("products", (dimension, dimension))):
                self.add_state(f"{side}_{name}", torch.zeros(shape, dtype=torch.float64), dist_reduce_fx="sum")

    def compute(self) -> Float[Tensor, ""]:
        """The distance; 0 where the two sides are equal.

        `forward` says that of a batch alone, which is NaN where a side of the batch has fewer than two motions.

        Raises:
            SagError: a side has fewer than two motions.
        """
        if self._nothing_to_compare():
            return tensor(torch.nan, dtype=torch.float64, device=self.device)
        return self._distance(*(self._gaussian(side) for side in SIDES))

    @abstractmethod
    def _distance(self, real: Gaussian, generated: Gaussian) -> Float[Tensor, ""]:
        """How far the two sides are apart."""

    def _add_features(self, features: Float[Tensor, "b n d"], real: Real) -> None:
        """Adds the n vectors of each of b motions to the side that the motion is on.

        Raises:
            SagError: not one truth value, nor one for each motion.
        """
        for side, chosen in self._chosen(real, len(features)).items():
            found = features[chosen].double()
            rows = found.flatten(0, 1)
            self._add(side, "motions", len(found))
            self._add(side, "sum", rows.sum(0))
            self._add(side, "products", rows.T @ rows)

    def _gaussian(self, side: str) -> Gaussian:
        """Mean and covariance of a side."""
        motions, total, products = (getattr(self, f"{side}_{name}") for name in ("motions", "sum", "products"))
        return Gaussian.of_sums(motions * self._vectors, total, products)
