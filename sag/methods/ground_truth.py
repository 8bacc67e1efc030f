"""Ground truth as a method: the row that every other is read against, and Motion FID's floor."""

from __future__ import annotations

import torch
from torch import Generator

from sag.methods.base import Evaluation, Method
from sag.metrics import motion_fid_floor
from sag.types import Batch, Motion


class GroundTruth(Method):
    """Repeats the true motion. Its non-collision ratio is the best that can be asked for.

    Its Motion FID is 0 by definition, so it also measures the floor: one half of the recordings against the
    other half.

    Args:
        skeleton: name of the skeleton.
        evaluation: the protocol of testing.
    """

    def __init__(
        self,
        skeleton: str = "gta_im_19",
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
    ) -> None:
        super().__init__(skeleton, evaluation)
        self.seen: list[tuple[torch.Tensor, torch.Tensor]] = []

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """The window's own motion."""
        return batch.motion

    def test_step(self, batch: Batch, batch_idx: int) -> None:
        """Scores the true motion, and keeps it for the floor."""
        super().test_step(batch, batch_idx)
        self.seen.append((batch.motion.joints, batch.sequence))

    def on_test_epoch_end(self) -> None:
        """Logs the floor as `test/motion_fid_floor/...`, where there are two recordings to compare."""
        super().on_test_epoch_end()
        sequence = torch.cat([sequence for _, sequence in self.seen])
        if self.motion_fid and len(sequence.unique()) > 1:
            joints = torch.cat([joints for joints, _ in self.seen])
            encoders = self.motion_fid[""].encoders
            self._log("test/motion_fid_floor", motion_fid_floor(encoders, joints, sequence, self.skeleton.root_index))
        self.seen = []
