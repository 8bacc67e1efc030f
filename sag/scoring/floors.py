"""Floors: how far halves of the true motions are from each other, on the average over random splits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.metrics import SceneFrechet, VelocityFrechet
from sag.metrics.fid.clips import ClipFeatures, joined
from sag.metrics.fid.floor import motion_fid_floor_of_features
from sag.metrics.halves import random_halves
from sag.scoring.groups import Groups
from sag.scoring.in_order import in_order
from sag.scoring.judged import Judged
from sag.scoring.named import named

SPLITS = 8
"""Random splits that a floor is the mean of."""


class Features(NamedTuple):
    """Features of a batch.

    Attributes:
        first: place of its first window in the data set.
        features: of the true motions.
        group: of each window.
    """

    first: int
    features: ClipFeatures
    group: Int[Tensor, " b"]


class Floors:
    """The distances between random halves of the true motions, whole groups on a side, averaged over splits.

    Halves hold half as many motions as the set. What of a distance comes from N alone goes as 1/N, so a set that
    is not split has about half of that floor.

    Args:
        data: where the windows come from.
        groups: windows and what of them is independent.
        seed: of the splits.
        device: where the metrics live.
    """

    def __init__(self, data: MotionDataModule, groups: Groups, seed: int, device: torch.device | str) -> None:
        self.groups, self.seed = groups, seed
        splits = SPLITS if groups.count > 1 else 0
        none = torch.zeros(0, len(groups.rows), dtype=torch.long)
        self.sides = random_halves(torch.as_tensor(groups.of_rows).long(), splits, seed) if splits else none
        joints, root = len(data.skeleton.joints), data.skeleton.root_index
        self.velocity = [VelocityFrechet(data.fps, joints).to(device) for _ in range(splits)]
        self.scene = [SceneFrechet(root).to(device) for _ in range(splits)]
        self.features: list[Features] = []

    def update(self, judged: Judged) -> None:
        """Adds true motions, for each split to the side that their group is on."""
        places = np.searchsorted(self.groups.rows, judged.batch.index.cpu().numpy())
        for split, side in enumerate(self.sides):
            chosen = side[places].to(judged.truth.device)
            kept, real = chosen >= 0, chosen[chosen >= 0] == 0
            self.velocity[split].update(judged.truth[kept], real=real)
            self.scene[split].update(judged.truth[kept], judged.cloud[kept], real=real)
        if judged.encoders is not None:
            features = {key: found.cpu() for key, found in judged.true_features.items()}
            first = int(judged.batch.index[0])
            self.features.append(Features(first, features, self.groups.of_batch(judged.batch).cpu()))

    def compute(self) -> dict[str, Tensor]:
        """Every floor by the name of its distance; nothing where there is one group only."""
        if not len(self.sides):
            return {}
        found = {
            name: torch.stack([metric.compute() for metric in metrics]).mean()
            for name, metrics in (("velocity_frechet_floor", self.velocity), ("scene_frechet_floor", self.scene))
        }
        if parts := in_order(self.features):
            features, group = joined([part.features for part in parts]), torch.cat([part.group for part in parts])
            found |= named("motion_fid_floor", motion_fid_floor_of_features(features, group, SPLITS, self.seed))
        return found
