"""Scores: every measure over all batches of a test, and what it says of its own certainty."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.metrics import DepthError, DepthProbe, motion_fid_infinity, motion_fid_interval
from sag.metrics.fid.clips import ClipEncoders, ClipFeatures, joined
from sag.scoring.evaluation import Evaluation
from sag.scoring.groups import Groups
from sag.scoring.judged import Judged
from sag.scoring.measures import measures_of
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
        groups: the windows that are judged, and what of them is independent; all of the split when left out.
        drawn: whether motions are drawn, so that they can differ from each other and from the truth.
        device: where the metrics live.
    """

    def __init__(
        self,
        data: MotionDataModule,
        split: str,
        encoders: ClipEncoders | None,
        evaluation: Evaluation,
        groups: Groups | None = None,
        drawn: bool = True,
        device: torch.device | str = "cpu",
    ) -> None:
        self.data, self.split, self.encoders, self.evaluation = data, split, encoders, evaluation
        self.groups = groups or Groups.of(data.cache, data.cache.rows(split))
        self.measures = measures_of(split, data, encoders, evaluation, drawn)
        for measure in self.measures:
            measure.metric.to(device)
        self.depth_error = DepthError().to(device)
        self.depth_probe: DepthProbe | None = None
        self.motions = 0
        self.kept: list[tuple[ClipFeatures, ClipFeatures, Tensor]] = []

    def update(
        self,
        batch: Batch,
        samples: Float[Tensor, "b k t j 3"],
        depth: Float[Tensor, "b h w"] | None = None,
        feature: Float[Tensor, "b f"] | None = None,
    ) -> Judged:
        """Judges motions of these windows.

        Args:
            batch: the windows.
            samples: metres, camera frame of frame 0.
            depth: what a method takes the depth of the picture to be (metres), if it has an opinion.
            feature: what a method sums the picture up in, if it does.

        Returns:
            What was worked out on the way.
        """
        if depth is not None:
            self.depth_error.update(depth, batch.scene.depth)
        if feature is not None and self.groups.count > 1:
            self._probe(feature, batch)
        judged = Judged(batch, samples, self.data, self.encoders)
        for measure in self.measures:
            measure.feed(measure.metric, judged)
        self.motions += len(batch)
        if self.encoders is not None and self.evaluation.resamples and self.split == "test":
            sides = ({k: x.cpu() for k, x in side.items()} for side in (judged.features, judged.true_features))
            self.kept.append((*sides, self.groups.of_batch(batch).cpu()))  # type: ignore[arg-type]
        return judged

    def _probe(self, feature: Float[Tensor, "b f"], batch: Batch) -> None:
        """Adds pictures to the depth probe, which is fitted on every other group and tried on those between."""
        if self.depth_probe is None:
            self.depth_probe = DepthProbe(feature.shape[1]).to(feature.device)
        fold = torch.from_numpy(np.unique(self.groups.of_rows)).to(batch.index.device)
        self.depth_probe.update(feature, batch.scene.depth, torch.searchsorted(fold, self.groups.of_batch(batch)) % 2)

    def compute(self) -> dict[str, Tensor]:
        """Every figure by its name, such as `motion_fid/average`."""
        found: dict[str, Tensor] = {}
        for measure in self.measures:
            found |= named(measure.name, measure.metric.compute())
        if self.depth_error.update_called:
            found |= named("depth_error", self.depth_error.compute())
        if self.depth_probe is not None and self.depth_probe.can_tell:
            found |= named("depth_probe", self.depth_probe.compute())
        return found | self._certainty()

    def sheet(self) -> dict[str, Any]:
        """The metrics by name."""
        return {measure.name: measure.metric for measure in self.measures}

    def distances(self) -> list[dict[str, Any]]:
        """All 18 distances of Motion FID, with the size of a feature and the clips on each side."""
        if self.encoders is None:
            return []
        found = self.sheet()["motion_fid"].distances()
        return [{"encoder": e, "frames": frames, **each._asdict()} for (e, frames), each in found.items()]

    def protocol(self) -> dict[str, Any]:
        """What a reader must know to compare these figures with others."""
        resampled = bool(self.kept) and self.groups.count > 1
        known = {
            "skeleton": self.data.skeleton.name,
            "motions": self.motions,
            "samples": self.evaluation.samples,
            "groups": f"{self.groups.count} {self.groups.kind}",
            "resamples": self.evaluation.resamples if resampled else 0,
        }
        if "non_collision" in self.sheet():
            judged = self.sheet()["non_collision"].sample()
            rooms = self.data.cache.scene[self.groups.rows[:1]]
            known |= {
                "collision_frames": judged.tested,
                "collision_shape": self.evaluation.collision_shape,
                "cloud_points": judged.density,
                "floor": "estimated from depth" if self.data.geometry(int(rooms[0])) is None else "known",
            }
        return known

    def _certainty(self) -> dict[str, Tensor]:
        """The interval around Motion FID by resampling groups, and its extrapolation to infinite N."""
        if self.motions < FEWEST or not self.kept:
            return {}
        generated, real = joined([part[0] for part in self.kept]), joined([part[1] for part in self.kept])
        group = torch.cat([part[2] for part in self.kept]) if self.groups.count > 1 else None
        resamples, seed = self.evaluation.resamples, self.evaluation.seed
        found = named("motion_fid_infinity", motion_fid_infinity(generated, real, group, seed=seed))
        if group is not None:
            interval = motion_fid_interval(generated, real, group, resamples=resamples, seed=seed)["average"]
            found |= named("motion_fid_interval", {"low": interval.low, "high": interval.high})
        return found
