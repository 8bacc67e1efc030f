"""The last checkpoint of a run: written now and then, at each epoch's end, and when the run is asked to end."""

from __future__ import annotations

import signal
import threading
import time
from pathlib import Path
from types import FrameType
from typing import Any

import lightning.pytorch as pl
from lightning.pytorch.callbacks import Checkpoint

from sag.checkpoints import FOLDER, LAST
from sag.errors import Interrupted

SECONDS = 60.0
"""Time between two checkpoints in the midst of an epoch, where `trainer.save_every_seconds` does not tell."""

SIGNALS = (signal.SIGTERM, signal.SIGINT)
"""Requests to end: of a scheduler or a sweep, and of Ctrl-C."""


class LastCheckpoint(Checkpoint):
    """Keeps `checkpoints/last.ckpt` in the run's folder, and beside it `previous.ckpt`.

    It is written at the end of each epoch, `trainer.save_every_seconds` after the one before, after every
    `trainer.save_every_n_batches` where that is given, and when SIGTERM or SIGINT asks the run to end, which it does
    after the batch at hand. A second request is not waited for, nor is one when nothing is trained.
    """

    def __init__(self) -> None:
        self.path = Path(FOLDER) / LAST
        self.saved = time.monotonic()
        self.asked = 0
        self.training = False

    def setup(self, trainer: pl.Trainer, pl_module: pl.LightningModule, stage: str) -> None:
        """Finds the run's folder."""
        self.path = Path(trainer.default_root_dir) / FOLDER / LAST

    def on_train_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Starts the clock, and listens."""
        self.saved, self.training = time.monotonic(), True
        self._listen()

    def on_train_batch_end(self, trainer: pl.Trainer, *args: Any, **kwargs: Any) -> None:
        """Saves when it is time, but not before what Lightning does between epochs: its loops cannot go on there."""
        loop = trainer.fit_loop.epoch_loop
        decide = trainer.strategy.reduce_boolean_decision  # all processes save at the same batch
        asked, due = decide(bool(self.asked), all=False), decide(self._due(trainer), all=False)
        fetcher: Any = trainer.fit_loop._data_fetcher
        if not (asked or due) or loop.batch_progress.is_last_batch or loop._should_check_val_fx(fetcher):
            return
        self._save(trainer)
        if asked:
            self._leave(trainer)

    def on_validation_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """A validation can take longer than who asks to end waits."""
        if trainer.strategy.reduce_boolean_decision(bool(self.asked), all=False):
            self._leave(trainer)

    def on_train_epoch_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Saves between two epochs."""
        self._save(trainer)
        if trainer.strategy.reduce_boolean_decision(bool(self.asked), all=False):
            self._leave(trainer)

    def on_fit_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Says where the checkpoint is."""
        self.training = False
        if trainer.is_global_zero and self.path.is_file() and not trainer.fast_dev_run:  # type: ignore[attr-defined]
            print(f"the checkpoint is {self.path}", flush=True)

    def on_test_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Listens: Lightning would take SIGTERM and go on."""
        self._listen()

    def on_predict_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Listens: Lightning would take SIGTERM and go on."""
        self._listen()

    def on_exception(self, trainer: pl.Trainer, pl_module: pl.LightningModule, exception: BaseException) -> None:
        """What comes now is no batch that could be waited for."""
        self.training = False

    def _due(self, trainer: Any) -> bool:
        every = getattr(trainer, "save_every_n_batches", None)
        seconds = getattr(trainer, "save_every_seconds", SECONDS)
        counted = every is not None and (trainer.fit_loop.epoch_loop.total_batch_idx + 1) % every == 0
        return counted or time.monotonic() - self.saved >= seconds

    def _save(self, trainer: Any) -> None:
        if not trainer.fast_dev_run:
            trainer.save_checkpoint(self.path, weights_only=False)
        self.saved = time.monotonic()

    def _listen(self) -> None:
        """Takes the signals over from Lightning, which gives them back when the stage is over."""
        if threading.current_thread() is threading.main_thread():
            for number in SIGNALS:
                signal.signal(number, self._hear)

    def _hear(self, number: int, frame: FrameType | None) -> None:
        if self.asked or not self.training:
            self.asked = number
            raise Interrupted("ended in the midst of its work; the same command with --ckpt_path last goes on", number)
        self.asked = number

    def _leave(self, trainer: Any) -> None:
        place = f"epoch {trainer.current_epoch}, batch {trainer.fit_loop.epoch_loop.batch_idx}"
        raise Interrupted(
            f"ended after {place}; the same command with --ckpt_path last goes on", self.asked or signal.SIGTERM
        )
