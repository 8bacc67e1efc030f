"""Trains the encoders of Motion FID on a data set's motions (paper, 4.2)."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import torch
from jaxtyping import Float
from torch import Tensor, nn

from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.methods.terms import record
from sag.models.erd import MotionEncoders
from sag.processes import drawn
from sag.skeleton import skeleton_named
from sag.types import Batch


class ERDTraining(pl.LightningModule):
    """Three ERDs that learn at once to foresee the next frame of random clips of 16, 32 and 64 frames.

    The noise on the frames they see grows in a curriculum, so that they learn to come back to real motion; without
    it their features hardly notice jitter. Fragkiadaki et al. (ICCV 2015) go up to 0.65, which asks for far longer
    training than the next frame without noise does. When the fit ends, the encoders are written to the data
    module's `encoder_path`.

    Args:
        skeleton: name of the skeleton, see `sag.skeleton.SKELETONS`.
        width: factor on the hidden sizes, see `sag.models.erd.ERD`.
        learning_rate: of Adam.
        first_noise: deviation of the noise at the first step, in z-scores.
        last_noise: deviation at the last step.
        clip_norm: greatest norm of each encoder's gradient.
        retrain: whether encoders that are already there are trained anew.
    """

    def __init__(
        self,
        skeleton: str = "gta_im_19",
        width: float = 1.0,
        learning_rate: float = 1e-3,
        first_noise: float = 0.01,
        last_noise: float = 0.15,
        clip_norm: float = 25.0,
        retrain: bool = True,
    ) -> None:
        super().__init__()
        chosen = skeleton_named(skeleton)
        self.encoders = MotionEncoders(chosen.name, width, len(chosen.joints))
        self.learning_rate = learning_rate
        self.first_noise = first_noise
        self.last_noise = last_noise
        self.clip_norm = clip_norm
        self.retrain = retrain

    @property
    def data(self) -> MotionDataModule:
        """The data module of this run."""
        return self.trainer.datamodule  # type: ignore[attr-defined]

    def setup(self, stage: str) -> None:
        """Takes the statistics of the training split, or ends the fit where encoders are there and are kept.

        To validate or test, the encoders of this data are read.

        Raises:
            SagError: the data set has another skeleton, or encoders to keep are damaged or of another width.
        """
        name, path = self.data.skeleton.name, self.data.encoder_path
        if name != self.encoders.skeleton:
            raise SagError(f"model.skeleton is {self.encoders.skeleton!r} but the data set's is {name!r}; use one")
        if stage == "fit" and not self.retrain and path.is_file():
            self._keep(path)
        elif stage == "fit":
            self.encoders.set_statistics(self._from_first_root(self.data.training_motion.joints[:, 1:]))
        elif not self.trainer.fast_dev_run:  # type: ignore[attr-defined]
            self.encoders = MotionEncoders.load(path, name, self.data.cache.fingerprint)

    def forward(self, batch: Batch) -> dict[tuple[int, int], Tensor]:
        """Features of the true motions after all 64 frames, by (encoder, length)."""
        motions = self._from_first_root(batch.motion.joints[:, 1:])
        return self.encoders.features(motions, [motions.shape[1]])

    def training_step(self, batch: Batch, batch_idx: int) -> Tensor:
        """Mean squared error of the next frame on noisy clips, summed over the three encoders."""
        losses = self._losses(batch, self.noise)
        record(self, {f"train/erd/{frames}": loss for frames, loss in losses.items()})
        return torch.stack(list(losses.values())).sum()

    def validation_step(self, batch: Batch, batch_idx: int) -> None:
        """The same error without noise."""
        self._log_errors("val", batch)

    def test_step(self, batch: Batch, batch_idx: int) -> None:
        """The same error without noise."""
        self._log_errors("test", batch)

    def configure_optimizers(self) -> torch.optim.Optimizer:
        """Adam over all three encoders."""
        return torch.optim.Adam(self.encoders.parameters(), lr=self.learning_rate)

    def configure_gradient_clipping(self, optimizer: Any, *args: Any, **kwargs: Any) -> None:
        """Clips the norm of the gradient of each encoder, as if it were trained alone."""
        for network in self.encoders.networks.values():
            nn.utils.clip_grad_norm_(network.parameters(), self.clip_norm)

    def on_fit_end(self) -> None:
        """Writes the encoders beside the data's cache; a fit of fewer batches than there are leaves no trace.

        That a fit goes on which was interrupted after its last batch is no reason not to.
        """
        trainer: Any = self.trainer
        if not trainer.is_global_zero or trainer.fast_dev_run or not self.global_step:
            return
        path = self.data.encoder_path
        limit = trainer.limit_train_batches  # a share of the batches when a float, their number when not
        if not isinstance(limit, float) or limit < 1:
            self.print(f"{path} is left as it is: encoders of a limited fit are not kept")
            return
        self.encoders.save(path, self.data.cache.fingerprint)
        self.print(f"the encoders, after {self.global_step} steps, are in {path}")

    def _keep(self, path: Path) -> None:
        """Ends the fit before its first step, as whole encoders of this size are there."""
        kept = MotionEncoders.load(path, self.data.skeleton.name, self.data.cache.fingerprint)
        if kept.width != self.encoders.width:
            raise SagError(
                f"{path} holds encoders of width {kept.width:g}, not {self.encoders.width:g}: figures of the two do "
                "not compare; delete it, or set model.retrain to true"
            )
        self.print(f"{path} holds the encoders of these windows; nothing to train")
        self.trainer.limit_train_batches = 0

    @property
    def noise(self) -> float:
        """Deviation of the noise on the frames at this step, in z-scores."""
        steps = self.trainer.estimated_stepping_batches
        return self.first_noise + (self.last_noise - self.first_noise) * min(1.0, self.global_step / steps)

    def _log_errors(self, stage: str, batch: Batch) -> None:
        nothing = dict.fromkeys(self.encoders.frames, torch.zeros((), device=self.device))
        errors = self._losses(batch, noise=0.0) if len(batch) else nothing
        named = {f"{stage}/erd/{frames}": error for frames, error in errors.items()}
        self.log_dict(named, batch_size=len(batch), sync_dist=True)

    def _losses(self, batch: Batch, noise: float) -> dict[int, Tensor]:
        """Error of the next frame for each encoder, in squared z-scores."""
        motions, losses = batch.motion.joints[:, 1:], {}
        for frames in self.encoders.frames:
            network = self.encoders.of(frames)
            clips = network.normalised(self._from_first_root(random_clips(motions, frames)))
            seen = clips[:, :-1] + noise * drawn(partial(_normal, clips[0, :-1]), len(clips))
            losses[frames] = nn.functional.mse_loss(network(seen), clips[:, 1:])
        return losses

    def _from_first_root(self, joints: Tensor) -> Tensor:
        root = self.data.skeleton.root_index
        return joints - joints[:, :1, root : root + 1]


def random_clips(motions: Float[Tensor, "b t j 3"], frames: int) -> Float[Tensor, "b n j 3"]:
    """One clip of that many consecutive frames from each motion, each from a start of its own."""

    def starts(count: int) -> Tensor:
        return torch.randint(motions.shape[1] - frames + 1, (count, 1), device=motions.device)

    start = drawn(starts, len(motions))
    places = start + torch.arange(frames, device=motions.device)
    return motions[torch.arange(len(motions), device=motions.device)[:, None], places]


def _normal(like: Tensor, count: int) -> Tensor:
    """Normal noise for so many clips of that shape."""
    return torch.randn(count, *like.shape, dtype=like.dtype, device=like.device)
