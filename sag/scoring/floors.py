"""Floors: how far one half of the true motions is from the other, below which nothing can be told apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.metrics import MotionFID, SceneFrechet, VelocityFrechet
from sag.metrics.fid.clips import ClipEncoders
from sag.scoring.judged import Judged
from sag.scoring.named import named


class Floors:
    """The distances between every other recording and the rest, of the true motions of the test split.

    Halves are made of whole recordings, since the windows of one overlap. Each holds about half as many motions as
    the set, so the floor of the whole set lies a little lower.

    Args:
        data: where the windows come from.
        encoders: of Motion FID; without them it has no floor.
        device: where the metrics live.
    """

    def __init__(self, data: MotionDataModule, encoders: ClipEncoders | None, device: torch.device | str) -> None:
        root = data.skeleton.root_index
        self.recordings = np.unique(data.cache.sequence[data.cache.rows("test")])
        self.motion_fid = MotionFID(encoders, root, unequal="ignore").to(device) if encoders is not None else None
        self.velocity = VelocityFrechet(data.fps, len(data.skeleton.joints)).to(device)
        self.scene = SceneFrechet(root).to(device)

    def update(self, judged: Judged) -> None:
        """Adds true motions, each to the half of its recording."""
        if len(self.recordings) < 2:
            return
        first = torch.as_tensor(np.searchsorted(self.recordings, judged.batch.sequence.cpu().numpy()) % 2 == 0)
        first = first.to(judged.truth.device)
        self.velocity.update(judged.truth, real=first)
        self.scene.update(judged.truth, judged.cloud, real=first)
        if self.motion_fid is not None:
            for half, real in ((first, True), (~first, False)):
                self.motion_fid.update_features({k: x[half] for k, x in judged.true_features.items()}, real=real)

    def compute(self) -> dict[str, Tensor]:
        """Every floor by the name of its distance; nothing where there is one recording only."""
        if len(self.recordings) < 2:
            return {}
        sheet: dict[str, Any] = {"velocity_frechet_floor": self.velocity, "scene_frechet_floor": self.scene}
        if self.motion_fid is not None:
            sheet["motion_fid_floor"] = self.motion_fid
        found: dict[str, Tensor] = {}
        for name, metric in sheet.items():
            found |= named(name, metric.compute())
        return found
