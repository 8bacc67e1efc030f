"""What every method shares: one protocol of testing and predicting, whatever is behind `sample`."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import numpy as np
import torch
from torch import Generator, Tensor

from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.files import sha256_of
from sag.methods.pretrained import pretrained_state
from sag.methods.weights import check_shapes, check_skeleton
from sag.metrics import MotionFID
from sag.models.erd import MotionEncoders
from sag.processes import processes, rank
from sag.scoring import Evaluation, Groups, Scores
from sag.scoring.judged import Judged
from sag.skeleton import skeleton_named
from sag.types import Batch, Motion

Sample = Callable[[Batch, Generator], Motion]
"""Makes one motion of 65 frames for each window of a batch."""


class Method(pl.LightningModule):
    """A system that continues frame 0 of a window by 64 frames, tested like every other.

    Attributes:
        drawn: whether motions are drawn, so that they can differ from each other and from the truth.
        needs_encoders: whether a test without Motion FID's encoders is refused.
        windows: places in the data set of the test windows that are judged; all of them when None.
        pretrained: checkpoint in which training starts, of the same method and skeleton on other data.

    Args:
        skeleton: name of the skeleton.
        evaluation: the protocol of testing.
    """

    drawn = True
    needs_encoders = True
    pretrained: Path | None = None

    def __init__(self, skeleton: str, evaluation: Evaluation) -> None:
        super().__init__()
        self.skeleton = skeleton_named(skeleton)
        self.evaluation = evaluation
        self.windows: np.ndarray | None = None

    @abstractmethod
    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """One motion for each window; looks at the picture and frame 0, never at what comes after it."""

    def samples(self, batch: Batch, count: int, generator: Generator | None = None) -> list[Motion]:
        """So many motions for each window, as so many calls of `sample` make them; in one go where that is cheaper."""
        return [self.sample(batch, generator) for _ in range(count)]

    def draw(self, count: int, generator: Generator) -> None:
        """Draws what one `sample` of so many windows draws, and leaves it: another process tests those windows.

        Raises:
            SagError: the method does not say what it draws.
        """
        raise SagError(f"{type(self).__name__} has no `draw`, so only one device can test it: --trainer.devices 1")

    @property
    def trained(self) -> bool:
        """Whether there is anything to sample from; methods that learn say when."""
        return True

    def begin(self) -> None:
        """Loads what its networks start from, where that is a file, before training starts."""

    def prepare(self, motion: Motion) -> None:
        """Takes what it needs from the true motion of the training split, before training starts."""

    def variants(self) -> dict[str, Sample]:
        """Further ways to sample whose Motion FID is wanted too, by the prefix of its name."""
        return {}

    def predicted_depth(self, batch: Batch) -> Tensor | None:
        """What the method takes the depth of the pictures to be (b, h, w), metres, if it has an opinion."""
        return None

    def scene_feature(self, batch: Batch) -> Tensor | None:
        """What the method sums the pictures up in (b, f), if in anything."""
        return None

    @property
    def data(self) -> MotionDataModule:
        """The data module of this run."""
        return self.trainer.datamodule  # type: ignore[attr-defined]

    def setup(self, stage: str) -> None:
        """Before training, takes statistics of the data or everything of a checkpoint, its normalisation included."""
        if stage != "fit":
            return
        if self.pretrained is None:
            self.begin()
            self.prepare(self.data.training_motion)
        else:
            self.load_state_dict(pretrained_state(self.pretrained, self.state_dict(), self.skeleton))
            self.print(f"training starts from {self.pretrained}, normalisation included")

    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Notes which skeleton the weights are for."""
        checkpoint["skeleton"] = self.skeleton.description

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Refuses weights for another skeleton, of another method, other components or other sizes, in one sentence."""
        check_skeleton("the checkpoint", checkpoint, self.skeleton)
        check_shapes(
            f"the checkpoint does not fit this {type(self).__name__}",
            checkpoint["state_dict"],
            self.state_dict(),
            "use the configs that it was trained with, which lie in its run's folder",
        )

    def _step(self, which: int, loss: Any) -> None:
        """A step of one of the optimisers, for methods that step by hand."""
        optimizer: Any = self.optimizers()[which]  # type: ignore[index]
        optimizer.zero_grad(set_to_none=True)
        self.manual_backward(loss)
        optimizer.step()

    def _require_trained(self) -> None:
        if not self.trained and not self._only_wiring:
            raise SagError(f"this {type(self).__name__} was never trained: name a checkpoint with --ckpt_path")

    @property
    def _only_wiring(self) -> bool:
        """Whether the run only tries that everything fits together, so that figures mean nothing."""
        return bool(self.trainer.fast_dev_run or self.trainer.sanity_checking)  # type: ignore[attr-defined]

    def _noise(self) -> Generator:
        return torch.Generator(self.device).manual_seed(self.evaluation.seed)

    def on_validation_start(self) -> None:
        """Lays out the metrics."""
        self._lay_out("val")

    def on_test_start(self) -> None:
        """Lays out the metrics."""
        self._lay_out("test")

    def _lay_out(self, split: str) -> None:
        self._require_trained()
        may_lack = self._only_wiring or not self.needs_encoders
        encoders = None if may_lack and not self.data.encoder_path.is_file() else self.load_encoders(self.data)
        self.encoders = encoders and encoders.to(self.device)
        rows = self.data.cache.rows(split) if self.windows is None else np.sort(self.windows)
        groups = Groups.of(self.data.cache, rows)
        self.scores = Scores(self.data, split, self.encoders, self.evaluation, groups, self.drawn, self.device)
        self.further = {
            name: (MotionFID(encoders, self.skeleton.root_index).to(self.device), self._noise())
            for name in self.variants()
            if encoders
        }
        self.generator = self._noise()

    def load_encoders(self, data: MotionDataModule) -> MotionEncoders:
        """The encoders of Motion FID that were trained on this data.

        Raises:
            SagError: they are missing; the sentence says how to train them.
        """
        path = data.encoder_path
        if path.is_file():
            return MotionEncoders.load(path, self.skeleton.name, data.cache.fingerprint)
        raise SagError(
            f"Motion FID needs encoders trained on this data, and {path} is not there; train them once by sag fit with "
            "the same configs and --config configs/methods/erd.yaml as the last of them"
        )

    def validation_step(self, batch: Batch, batch_idx: int) -> None:
        """Scores held-out windows of the training rooms, which have no cloud: motion, floor and known geometry."""
        self._score(batch, batch_idx)

    def test_step(self, batch: Batch, batch_idx: int) -> None:
        """Scores motions for each window; further variants have their Motion FID alone."""
        self._score(batch, batch_idx)

    def _score(self, batch: Batch, batch_idx: int) -> Judged | None:
        """Judges motions for those windows of a batch that are asked for; None when there are none."""
        if not len(batch):
            return None
        self._pass_over(batch_idx, *(noise for _, noise in self.further.values()))
        if self.windows is not None:
            asked = torch.as_tensor(np.isin(batch.index.cpu().numpy(), self.windows), device=batch.index.device)
            if not asked.any():
                return None
            batch = batch[asked]
        samples = self._samples(batch, self.evaluation.samples)
        judged = self.scores.update(batch, samples, self.predicted_depth(batch), self.scene_feature(batch))
        for name, (metric, noise) in self.further.items():
            motion = self.variants()[name](batch, noise)
            metric.update(motion.joints, real=False)
        return judged

    def _pass_over(self, batch_idx: int, *further: Generator) -> None:
        """Draws what the batches before this one take that other processes have, so that chance is that of one."""
        for _ in range(rank() if batch_idx == 0 else processes() - 1):
            for generator in (*[self.generator] * self.evaluation.samples, *further):
                self.draw(self.data.eval_batch_size, generator)

    def _samples(self, batch: Batch, count: int) -> Tensor:
        """Motions for each window, (b, k, 65, j, 3), metres, camera frame of frame 0."""
        return torch.stack([motion.joints for motion in self.samples(batch, count, self.generator)], dim=1)

    def on_validation_epoch_end(self) -> None:
        """Logs `val/motion_fid/...` and the like."""
        self._finish("val")

    def on_test_epoch_end(self) -> None:
        """Logs `test/motion_fid/...` and all else that is on the sheet; further variants as `test/<name>/...`."""
        self._finish("test")

    def _finish(self, stage: str) -> None:
        self._log(stage, self.scores.compute())
        for name, (metric, _) in self.further.items():
            metric.share_real(self.scores.sheet()["motion_fid"])
            self._log(f"{stage}/{name}/motion_fid", metric.compute())

    def _log(self, prefix: str, values: dict[str, Tensor]) -> None:
        self.log_dict({f"{prefix}/{name}": torch.as_tensor(v).float() for name, v in values.items()})

    def protocol(self) -> dict[str, Any]:
        """What a reader must know of the last test to compare its figures."""
        encoders = sha256_of(self.data.encoder_path)[:12] if self.encoders else None
        return {**self.scores.protocol(), "encoders": encoders}

    def on_predict_start(self) -> None:
        """Refuses to sample from weights that were never trained."""
        self._require_trained()
        self.generator = self._noise()

    def predict_step(self, batch: Batch, batch_idx: int) -> dict[str, Tensor] | None:
        """Motions for each window: `joints` (b, k, 65, j, 3) in metres, camera frame of frame 0, and `index`."""
        if not len(batch):
            return None
        self._pass_over(batch_idx)
        return {"joints": self._samples(batch, self.evaluation.samples), "index": batch.index}
