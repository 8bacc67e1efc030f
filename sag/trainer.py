"""Lightning's trainer that goes on where it stopped, with one more verb: `run`, which trains and tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import lightning.pytorch as pl

from sag.checkpoints import WholeCheckpoints, newest_good
from sag.errors import SagError
from sag.methods.base import Method
from sag.methods.terms import LOSS_LIMIT
from sag.randomness import RandomStates
from sag.showing import ShownSamples

NEWEST = "last"
"""What `--ckpt_path` says for the newest good checkpoint of the run's own folder, if there is one."""


class Trainer(pl.Trainer):
    """Lightning's trainer, with checkpoints that are whole, execute nothing and hold all that a run goes on from.

    Args:
        args: Lightning's.
        plugins: Lightning's.
        callbacks: Lightning's.
        save_every_seconds: time between two checkpoints in the midst of an epoch.
        save_every_n_batches: batches between two checkpoints, besides the time.
        loss_limit: magnitude at which a term of the loss has exploded and ends the training.
        show_every_n_epochs: epochs from one page, film and sheet of samples to the next; none when left out.
        kwargs: Lightning's.
    """

    def __init__(
        self,
        *args: Any,
        plugins: Any = None,
        callbacks: Any = None,
        save_every_seconds: float = 60.0,
        save_every_n_batches: int | None = None,
        loss_limit: float = LOSS_LIMIT,
        show_every_n_epochs: int | None = None,
        **kwargs: Any,
    ) -> None:
        _check_positive(
            save_every_seconds=save_every_seconds, save_every_n_batches=save_every_n_batches, loss_limit=loss_limit
        )
        self.save_every_seconds, self.save_every_n_batches = save_every_seconds, save_every_n_batches
        self.loss_limit = loss_limit
        plugins = [*_listed(plugins), WholeCheckpoints()]
        callbacks = [*_listed(callbacks), ShownSamples(show_every_n_epochs), RandomStates()]
        super().__init__(*args, plugins=plugins, callbacks=callbacks, **kwargs)

    def fit(
        self,
        model: pl.LightningModule,
        train_dataloaders: Any = None,
        val_dataloaders: Any = None,
        datamodule: Any = None,
        ckpt_path: Any = None,
        weights_only: bool | None = None,
    ) -> None:
        """Trains a method, from a checkpoint if one is named.

        Args:
            model: the method.
            train_dataloaders: Lightning's.
            val_dataloaders: Lightning's.
            datamodule: the data.
            ckpt_path: where an interrupted training goes on; `last` is the newest good checkpoint in the run's folder.
            weights_only: Lightning's; nothing is executed either way.
        """
        start = self._newest() if ckpt_path == NEWEST else ckpt_path
        super().fit(model, train_dataloaders, val_dataloaders, datamodule, start, weights_only)

    def run(self, model: pl.LightningModule, datamodule: Any = None, ckpt_path: str | None = None) -> None:
        """Trains a method, from a checkpoint if one is named, and tests it.

        Args:
            model: the method.
            datamodule: the data.
            ckpt_path: where an interrupted training goes on; `last` is the newest good checkpoint in the run's folder.

        Raises:
            SagError: the test would lack the encoders of Motion FID; said before training and not after it.
        """
        if isinstance(model, Method) and not self.fast_dev_run:  # type: ignore[attr-defined]
            model.load_encoders(datamodule)
        self.fit(model, datamodule=datamodule, ckpt_path=ckpt_path)
        self.test(model, datamodule=datamodule)

    def _newest(self) -> Path | None:
        folder = Path(self.default_root_dir)
        found = newest_good(folder)
        if self.is_global_zero:
            print(f"training goes on from {found}" if found else f"no checkpoint in {folder}: training starts anew")
        return found


def _listed(given: Any) -> list[Any]:
    return given if isinstance(given, list) else [] if given is None else [given]


def _check_positive(**options: float | None) -> None:
    for name, value in options.items():
        if value is not None and not value > 0:
            raise SagError(f"trainer.{name} is {value}; it must be above 0")
