"""Lightning's trainer with one more verb: `run`, which trains and tests in one process."""

from __future__ import annotations

from typing import Any

import lightning.pytorch as pl

from sag.checkpoints import WholeCheckpoints
from sag.methods.base import Method


class Trainer(pl.Trainer):
    """Lightning's trainer, with checkpoints that are whole and execute nothing."""

    def __init__(self, *args: Any, plugins: Any = None, **kwargs: Any) -> None:
        given = plugins if isinstance(plugins, list) else [] if plugins is None else [plugins]
        super().__init__(*args, plugins=[*given, WholeCheckpoints()], **kwargs)

    def run(self, model: pl.LightningModule, datamodule: Any = None, ckpt_path: str | None = None) -> None:
        """Trains a method, from a checkpoint if one is named, and tests it.

        Args:
            model: the method.
            datamodule: the data.
            ckpt_path: where an interrupted training goes on.

        Raises:
            SagError: the test would lack the encoders of Motion FID; said before training and not after it.
        """
        if isinstance(model, Method) and not self.fast_dev_run:  # type: ignore[attr-defined]
            model.load_encoders(datamodule)
        self.fit(model, datamodule=datamodule, ckpt_path=ckpt_path)
        self.test(model, datamodule=datamodule)
