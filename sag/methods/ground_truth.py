"""Ground truth as a method: the row that every other is read against, and the floors of the distances."""

from __future__ import annotations

from torch import Generator

from sag.methods.base import Method
from sag.scoring import Evaluation, Floors
from sag.types import Batch, Motion


class GroundTruth(Method):
    """Repeats the true motion. Its non-collision ratio is the best that can be asked for.

    Its Motion FID is 0 by definition, so it also measures the floors: random halves of the rooms, or of the
    recordings, against each other.

    Args:
        skeleton: name of the skeleton.
        evaluation: the protocol of testing.
    """

    drawn = False

    def __init__(
        self,
        skeleton: str = "gta_im_19",
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
    ) -> None:
        super().__init__(skeleton, evaluation)

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """The window's own motion."""
        return batch.motion

    def draw(self, count: int, generator: Generator) -> None:
        """Nothing: true motions are what they are."""

    def on_test_start(self) -> None:
        """Lays out the metrics and the floors."""
        super().on_test_start()
        self.floors = Floors(self.data, self.scores.groups, self.evaluation.seed, self.device)

    def test_step(self, batch: Batch, batch_idx: int) -> None:
        """Scores the true motion, once for the figures and once for the floors."""
        judged = self._score(batch, batch_idx)
        if judged is not None:
            self.floors.update(judged)

    def on_test_epoch_end(self) -> None:
        """Logs the floors as `test/motion_fid_floor/...` and the like, where there are two groups to compare."""
        super().on_test_epoch_end()
        self._log("test", self.floors.compute())
