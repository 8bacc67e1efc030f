"""Recorded motions as a method: whatever made them, they are tested like every other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from torch import Generator, Tensor

from sag.data.motion_file import read_motions
from sag.methods.base import Method
from sag.scoring import Evaluation
from sag.types import Batch, Motion


class Recorded(Method):
    """Repeats the motions of a file, see `sag.data.motion_file`.

    Args:
        file: `.npz` of motions; windows that it does not continue are left out of the test.
        skeleton: name of the skeleton.
        evaluation: the protocol of testing; no more samples of a window are looked at than the file has.
    """

    needs_encoders = False

    def __init__(
        self,
        file: Path,
        skeleton: str = "gta_im_19",
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
    ) -> None:
        self.motions = read_motions(Path(file))
        super().__init__(skeleton, replace(evaluation, samples=min(evaluation.samples, self.motions.joints.shape[1])))

    def setup(self, stage: str) -> None:
        """Finds the windows that the motions continue."""
        super().setup(stage)
        self.rows = self.motions.by_window(self.data)
        self.windows = np.array(list(self.rows))

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """The first motion of each window."""
        return Motion.from_joints(self._samples(batch, 1)[:, 0], self.skeleton.root_index)

    def draw(self, count: int, generator: Generator) -> None:
        """Nothing: the motions are there."""

    def _samples(self, batch: Batch, count: int) -> Tensor:
        rows = [self.rows[window] for window in batch.index.tolist()]
        return torch.from_numpy(self.motions.joints[rows, :count]).to(batch.motion.joints)
