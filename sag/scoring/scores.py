"""Scores: a sheet of metrics over all batches of a test, and what it says of its own certainty."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.metrics import DepthError, motion_fid_infinity, motion_fid_interval
from sag.metrics.fid.clips import ClipEncoders, ClipFeatures
from sag.scoring.evaluation import Evaluation
from sag.scoring.judged import Judged
from sag.scoring.lines import lines_of
from sag.scoring.named import named
from sag.types import Batch

FEWEST = 4
"""Motions that can still be split into parts, to see how figures change with their number."""


class Scores:
    """Everything that is measured of one way to make motions.

    Args:
        data: where the windows come from.
        split: "val" or "test"; only test windows have depth clouds.
        encoders: of Motion FID; without them there is none.
        evaluation: the protocol.
        device: where the metrics live.
    """

    def __init__(
        self,
        data: MotionDataModule,
        split: str,
        encoders: ClipEncoders | None,
        evaluation: Evaluation,
        device: torch.device | str = "cpu",
    ) -> None:
        self.data, self.split, self.encoders, self.evaluation = data, split, encoders, evaluation
        self.lines = lines_of(split, data, encoders, evaluation)
        for line in self.lines:
            line.metric.to(device)
        self.depth_error = DepthError().to(device)
        self.motions = 0
        self.kept: list[tuple[ClipFeatures, ClipFeatures, Tensor]] = []

    def update(
        self, batch: Batch, samples: Float[Tensor, "b k t j 3"], depth: Float[Tensor, "b h w"] | None = None
    ) -> Judged:
        """Judges motions of these windows.

        Args:
            batch: the windows.
            samples: metres, camera frame of frame 0.
            depth: what a method takes the depth of the picture to be (metres), if it has an opinion.

        Returns:
            What was worked out on the way.
        """
        if depth is not None:
            self.depth_error.update(depth, batch.scene.depth)
        judged = Judged(batch, samples, self.data, self.encoders)
        for line in self.lines:
            line.feed(line.metric, judged)
        self.motions += len(batch)
        if self.encoders is not None and self.evaluation.resamples and self.split == "test":
            self.kept.append((judged.features, judged.true_features, batch.sequence))
        return judged

    def compute(self) -> dict[str, Tensor]:
        """Every figure by its name, such as `motion_fid/average`."""
        found: dict[str, Tensor] = {}
        for line in self.lines:
            found |= named(line.name, line.metric.compute())
        if self.depth_error.update_called:
            found |= named("depth_error", self.depth_error.compute())
        return found | self._certainty()

    def sheet(self) -> dict[str, Any]:
        """The metrics by name."""
        return {line.name: line.metric for line in self.lines}

    def protocol(self) -> dict[str, Any]:
        """What a reader must know to compare these figures with others."""
        known = {
            "skeleton": self.data.skeleton.name,
            "motions": self.motions,
            "sequences": len(np.unique(self.data.cache.sequence[self.data.cache.rows(self.split)])),
            "samples": self.evaluation.samples,
            "resamples": self.evaluation.resamples,
            "collision_shape": self.evaluation.collision_shape,
        }
        if "non_collision" in self.sheet():
            judged = self.sheet()["non_collision"].sample()
            known |= {"collision_frames": judged.tested, "cloud_points": judged.density}
        return known

    def _certainty(self) -> dict[str, Tensor]:
        """The interval around Motion FID by resampling recordings, and its extrapolation to infinite N."""
        if self.motions < FEWEST or not self.kept:
            return {}
        generated, real = joined([part[0] for part in self.kept]), joined([part[1] for part in self.kept])
        sequence = torch.cat([part[2] for part in self.kept])
        several = sequence if len(sequence.unique()) > 1 else None
        resamples, seed = self.evaluation.resamples, self.evaluation.seed
        found = named("motion_fid_infinity", motion_fid_infinity(generated, real, several, seed=seed))
        if several is not None:
            interval = motion_fid_interval(generated, real, several, resamples=resamples, seed=seed)["average"]
            found |= named("motion_fid_interval", {"low": interval.low, "high": interval.high})
        return found


def joined(parts: list[ClipFeatures]) -> ClipFeatures:
    """Features of several batches as one set."""
    return {key: torch.cat([part[key] for part in parts]) for key in parts[0]}
