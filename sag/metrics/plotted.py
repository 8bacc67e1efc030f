"""What the metrics of this package have in common as metrics of torchmetrics."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torchmetrics import Metric

from sag.errors import SagError


class PlottedMetric(Metric):
    """A metric whose figures can be plotted, whose states add up, and which is no loss.

    Attributes:
        title: the metric's name, as its refusals have it.
        is_differentiable: False, metrics are for reading.
        full_state_update: False, `forward` adds the states of a batch to those before it.
        plot_lower_bound: 0, none of the figures can be less unless a metric says so.
    """

    title = ""
    is_differentiable = False
    full_state_update = False
    plot_lower_bound: float | None = 0.0

    settings: Tensor
    _batch_alone = False

    def forward(self, *args: Any, **kwargs: Any) -> Any:
        """Adds what `update` adds, and says what the figures of this batch alone are."""
        self._batch_alone = True
        try:
            return super().forward(*args, **kwargs)
        finally:
            self._batch_alone = False

    def plot(self, val: Tensor | Sequence[Tensor] | dict[str, Tensor] | None = None, ax: Any = None) -> Any:
        """Plots a figure or several over time, as metrics of torchmetrics do.

        Args:
            val: what `compute` or `forward` gave, or a list of that; what `compute` gives now when left out.
            ax: axes of matplotlib to draw on; new ones when left out.

        Returns:
            The figure and the axes of matplotlib.
        """
        return self._plot(val, ax)

    def _keep_settings(self, *numbers: float) -> None:
        """Keeps among the states everything that decides what `update` adds.

        A `MetricCollection` takes metrics whose states are close after their first batch for one, and gives them all
        the same figures ever after. So those of other settings have other states whatever the motions are: 8 bytes
        of a hash, since numbers as such may be close.
        """
        digest = hashlib.blake2b(np.array(numbers, dtype=np.float64).tobytes(), digest_size=8).digest()
        self.add_state("settings", torch.tensor(list(digest), dtype=torch.float64), dist_reduce_fx="max")

    def _require(self, count: Tensor, what: str = "motion") -> None:
        """Refuses to compute a figure of nothing."""
        if not count:
            raise SagError(f"{self.title} was asked for before any {what} was given")
