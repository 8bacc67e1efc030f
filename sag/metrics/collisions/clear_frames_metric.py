"""What metrics of clear frames share: their choices, and which frames of a motion are judged."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor

from sag.geometry.capsule import Shape
from sag.metrics.collisions.clear_frames import RADII, THRESHOLDS, ClearFrames, Unit
from sag.metrics.plotted import PlottedMetric


class ClearFramesMetric(PlottedMetric):
    """A metric of clear frames, of which each motion's are drawn by its place in the data set.

    Args:
        bones: places of the two joints of each bone.
        radii: metres.
        thresholds: points that a clear frame may touch.
        frames: sampled from each motion.
        unit: "frame" judges sampled frames; "motion" all 64, a motion being clear when its worst frame is.
        seed: of the sample.
        farthest: pixels of a depth map beyond this depth (metres) are no points.
        shape: of a bone: "capsule" with round ends, "cylinder" with flat ones.
        options: of `torchmetrics.Metric`.

    Raises:
        SagError: more frames than are generated, or none.
    """

    tested: Tensor
    motions: Tensor
    _before = 0

    def __init__(
        self,
        bones: np.ndarray | Sequence[Sequence[int]],
        radii: Sequence[float] = RADII,
        thresholds: Sequence[int] = THRESHOLDS,
        frames: int = 10,
        unit: Unit = "frame",
        seed: int = 0,
        farthest: float = 20.0,
        shape: Shape = "capsule",
        **options: Any,
    ) -> None:
        super().__init__(**options)
        limits = tuple(radii), tuple(thresholds)
        self.clear_frames = ClearFrames(self.title, np.asarray(bones), *limits, frames, unit, seed, farthest, shape)
        self._keep_settings(*self.clear_frames.settings)
        for name, size in {"tested": (), "motions": (), **self._sums()}.items():
            self.add_state(name, torch.zeros(size, dtype=torch.long), dist_reduce_fx="sum")

    @abstractmethod
    def _sums(self) -> dict[str, tuple[int, ...]]:
        """The states that a metric has besides, and their shapes."""

    def forward(self, *args: Any, **kwargs: Any) -> dict[str, Tensor]:
        """Adds what `update` adds, and says what the figures of this batch alone are."""
        self._before = int(self.motions)  # the state is empty while the batch is judged, yet places are counted on
        try:
            return super().forward(*args, **kwargs)
        finally:
            self._before = 0

    def _places(self, index: Int[Tensor, " b"] | None, motions: int) -> list[int]:
        """Places of so many motions in their data set, those that follow on the motions so far when not given."""
        first = self._before + int(self.motions)
        return list(range(first, first + motions)) if index is None else index.tolist()
