"""A callback that ends a training in its midst."""

from __future__ import annotations

from typing import Any

import lightning.pytorch as pl


class Killed(Exception):
    """What ends a run in these tests, without a word to anyone."""


class Kill(pl.Callback):
    """Ends a run when a batch begins, counted over all epochs."""

    def __init__(self, at: int | None) -> None:
        self.at = at

    def on_train_batch_start(self, trainer: pl.Trainer, *args: Any) -> None:
        if trainer.fit_loop.epoch_loop.total_batch_idx == self.at:
            raise Killed
