"""What every method shares: one protocol of testing and predicting, whatever is behind `sample`."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import lightning.pytorch as pl
import torch
from torch import Generator, Tensor

from sag.data.base import MotionDataModule
from sag.data.cache import sha256_of
from sag.errors import SagError
from sag.metrics import MotionFID, NonCollisionRatio
from sag.models.erd import MotionEncoders
from sag.skeleton import skeleton_named
from sag.types import GENERATED, Batch, Motion

Sample = Callable[[Batch, Generator], Motion]
"""Makes one motion of 65 frames for each window of a batch."""


@dataclass(frozen=True)
class Evaluation:
    """The protocol of testing.

    Attributes:
        seed: of the noise that test and predict draw.
        collision_frames: about how many frames the non-collision ratio looks at, the same number of every motion,
            at least 1 and at most all; the paper's 10,000.
        collision_unit: what is clear or not; a motion is not when one of its 64 frames is not.
        predictions: motions that predict draws for each window.
    """

    seed: int = 0
    collision_frames: int = 10_000
    collision_unit: Literal["frame", "motion"] = "frame"
    predictions: int = 1


class Method(pl.LightningModule):
    """A system that continues frame 0 of a window by 64 frames, tested like every other.

    Args:
        skeleton: name of the skeleton.
        evaluation: the protocol of testing.
    """

    def __init__(self, skeleton: str, evaluation: Evaluation) -> None:
        super().__init__()
        self.skeleton = skeleton_named(skeleton)
        self.evaluation = evaluation

    @abstractmethod
    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """One motion for each window; looks at the picture and frame 0, never at what comes after it."""

    @property
    def trained(self) -> bool:
        """Whether there is anything to sample from; methods that learn say when."""
        return True

    def prepare(self, motion: Motion) -> None:
        """Takes what it needs from the true motion of the training split, before training starts."""

    def variants(self) -> dict[str, Sample]:
        """What to test: a prefix of the metrics' names for each way to sample."""
        return {"": self.sample}

    @property
    def data(self) -> MotionDataModule:
        """The data module of this run."""
        return self.trainer.datamodule  # type: ignore[attr-defined]

    def setup(self, stage: str) -> None:
        """Takes statistics before training; refuses to test or predict what was never trained."""
        if stage == "fit":
            self.prepare(self.data.training_motion)

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Refuses weights of another method, other components or other sizes, in one sentence."""
        found, own = checkpoint["state_dict"], self.state_dict()
        differing = [k for k in sorted({*found, *own}) if _shape(found, k) != _shape(own, k)]
        if differing:
            key = differing[0]
            raise SagError(
                f"the checkpoint does not fit this {type(self).__name__}: {key} is {_shape(found, key)} there and "
                f"{_shape(own, key)} here ({len(differing)} such); use the configs that it was trained with, "
                "which lie in its run's folder"
            )

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
        encoders = None if self._only_wiring and not self.data.encoder_path.is_file() else self.load_encoders(self.data)
        root = self.skeleton.root_index
        self.motion_fid = (
            {name: MotionFID(encoders, root).to(self.device) for name in self.variants()} if encoders else {}
        )
        windows = max(1, len(self.data.cache.rows(split)))
        frames = max(1, min(GENERATED, round(self.evaluation.collision_frames / windows)))
        bones, unit = self.skeleton.bone_index, self.evaluation.collision_unit
        self.non_collision = NonCollisionRatio(bones, frames=frames, unit=unit).to(self.device)
        self.motions = 0
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
        """Scores held-out windows of the training rooms; they have no cloud, so Motion FID alone."""
        self._score(batch)

    def test_step(self, batch: Batch, batch_idx: int) -> None:
        """Scores one motion for each window and each variant; the first variant's is checked for collisions."""
        self._score(batch)

    def _score(self, batch: Batch) -> None:
        self.motions += len(batch)
        for place, (name, sample) in enumerate(self.variants().items()):
            motion = sample(batch, self.generator)
            if name in self.motion_fid:
                self.motion_fid[name].update(motion.joints, real=False)
            if place == 0 and self.motion_fid:
                self.motion_fid[name].update(batch.motion.joints, real=True)
            if place == 0 and batch.cloud is not None:
                self.non_collision.update(motion.joints, batch.cloud, batch.index)

    def on_validation_epoch_end(self) -> None:
        """Logs `val/motion_fid/...`."""
        self._finish("val")

    def on_test_epoch_end(self) -> None:
        """Logs `test/motion_fid/...` and `test/non_collision/...`; further variants as `test/<name>/...`."""
        self._finish("test")
        self._log("test/non_collision", self.non_collision.compute())

    def _finish(self, stage: str) -> None:
        first = next(iter(self.motion_fid.values()), None)
        for name, metric in self.motion_fid.items():
            if first is not None and metric is not first:
                metric.share_real(first)
            self._log("/".join(filter(None, (stage, name, "motion_fid"))), metric.compute())

    def _log(self, prefix: str, values: dict[str, Tensor]) -> None:
        self.log_dict({f"{prefix}/{name}": torch.as_tensor(v).float() for name, v in values.items()})

    def protocol(self) -> dict[str, Any]:
        """What a reader must know of the last test to compare its figures."""
        judged = self.non_collision.sample()
        return {
            "skeleton": self.skeleton.name,
            "motions": self.motions,
            "encoders": sha256_of(self.data.encoder_path)[:12] if self.motion_fid else None,
            "collision_frames": judged.tested,
            "cloud_points": judged.density,
        }

    def on_predict_start(self) -> None:
        """Refuses to sample from weights that were never trained."""
        self._require_trained()
        self.generator = self._noise()

    def predict_step(self, batch: Batch, batch_idx: int) -> dict[str, Tensor]:
        """Motions for each window: `joints` (b, k, 65, j, 3) in metres, camera frame of frame 0, and `index`."""
        motions = [self.sample(batch, self.generator).joints for _ in range(self.evaluation.predictions)]
        return {"joints": torch.stack(motions, dim=1), "index": batch.index}


def _shape(state: dict[str, Tensor], key: str) -> str:
    return str(list(state[key].shape)) if key in state else "missing"
