"""What the metrics of this package have in common as metrics of torchmetrics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from torch import Tensor
from torchmetrics import Metric


class PlottedMetric(Metric):
    """A metric whose figures can be plotted, whose states add up, and which is no loss.

    Attributes:
        is_differentiable: False, metrics are for reading.
        full_state_update: False, `forward` adds the states of a batch to those before it.
        plot_lower_bound: 0, none of the figures can be less unless a metric says so.
    """

    is_differentiable = False
    full_state_update = False
    plot_lower_bound: float | None = 0.0

    def plot(self, val: Tensor | Sequence[Tensor] | dict[str, Tensor] | None = None, ax: Any = None) -> Any:
        """Plots a figure or several over time, as metrics of torchmetrics do.

        Args:
            val: what `compute` or `forward` gave, or a list of that; what `compute` gives now when left out.
            ax: axes of matplotlib to draw on; new ones when left out.

        Returns:
            The figure and the axes of matplotlib.
        """
        return self._plot(val, ax)
