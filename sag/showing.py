"""What a run shows of its samples: pages, films and sheets while it trains, and a contact sheet when it is tested."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import numpy as np
import torch
import wandb
from lightning.pytorch.loggers import WandbLogger

from sag.data.selection import windows_at
from sag.errors import SagError
from sag.files import write_whole
from sag.film import overlay_frames, write_film
from sag.film.encoding import every_frame
from sag.film.samples import SHEET, SHEET_WINDOWS, sampled, spread_windows, stages_of, write_sheet
from sag.film.stage import Stage
from sag.methods.base import Method
from sag.viewer import page, shown_window

FOLDER = "samples"
"""Of what training shows, in the run's folder."""

COLUMNS = 480
"""Of the film."""


class ShownSamples(pl.Callback):
    """Shows samples of a method in the run's folder, and in W&B where that is the logger.

    While it trains, every so many epochs and after the last one: `samples/epoch-007.html`, a page of held-out windows
    of the training rooms; `.gif`, the first of them as a film; and `.png`, a sheet of all. When it is tested:
    `samples.png`, a sheet of test windows, which reports embed. Every time with the same windows and the same noise.
    Nothing of it changes the training: modes and the state of chance stay as they are.

    Args:
        every_n_epochs: epochs from one showing to the next; none during training where it is left out.
        windows: on a page.
        samples: motions of each.
        seed: of the noise.

    Raises:
        SagError: a number is below 1.
    """

    def __init__(self, every_n_epochs: int | None = None, windows: int = 3, samples: int = 3, seed: int = 0) -> None:
        if every_n_epochs is not None and every_n_epochs < 1:
            raise SagError(f"trainer.show_every_n_epochs is {every_n_epochs}; it must be at least 1")
        if min(windows, samples) < 1:
            raise SagError(f"{windows} windows with {samples} samples cannot be shown; at least 1 of each is needed")
        self.every, self.windows, self.samples, self.seed = every_n_epochs, windows, samples, seed

    def on_train_epoch_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Shows held-out windows when it is their turn."""
        epoch = trainer.current_epoch + 1
        due = self.every is not None and (epoch % self.every == 0 or epoch == trainer.max_epochs)
        if due and isinstance(pl_module, Method) and _shows(trainer, pl_module):
            self._show(trainer, pl_module, Path(trainer.default_root_dir) / FOLDER / f"epoch-{epoch:03d}")

    def on_test_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Writes the contact sheet."""
        if isinstance(pl_module, Method) and _shows(trainer, pl_module):
            data = pl_module.data
            batch = windows_at(data, "test", spread_windows(data, "test", SHEET_WINDOWS))
            with as_evaluated(pl_module):
                motions = sampled(pl_module, batch, 1, self.seed)
            write_sheet(Path(trainer.default_root_dir) / SHEET, stages_of(data, batch, motions))

    def _show(self, trainer: pl.Trainer, method: Method, path: Path) -> None:
        data = method.data
        split = "val" if len(data.cache.rows("val")) else "train"
        batch = windows_at(data, split, spread_windows(data, split, self.windows))
        with as_evaluated(method):
            motions = sampled(method, batch, self.samples, self.seed)
        row = Path(trainer.default_root_dir).resolve().name
        shown = [shown_window(data, batch[[n]], {row: motions[n]}) for n in range(len(batch))]
        text = page(shown, data.skeleton, data.fps, f"{row}, {path.name.replace('-', ' ')}")
        write_whole(path.with_suffix(".html"), lambda file: file.write(text.encode()))
        (first,) = stages_of(data, batch[[0]], motions[:1], with_surface=True)
        _film(path.with_suffix(".gif"), first)
        write_sheet(path.with_suffix(".png"), stages_of(data, batch, motions))
        _log(trainer, path)


def _shows(trainer: Any, method: Method) -> bool:
    """Whether there is something to show, in the one process that does."""
    return bool(method.drawn and trainer.is_global_zero and not trainer.fast_dev_run)


def _film(path: Path, stage: Stage) -> None:
    every = every_frame(path, stage.fps)
    vivid = np.stack([stage.colour(number) for number in range(len(stage.motions))])
    write_film(path, overlay_frames(stage, COLUMNS, every), stage.fps / every, vivid)


def _log(trainer: pl.Trainer, path: Path) -> None:
    """Gives the files to W&B, offline or not."""
    for logger in trainer.loggers:
        if isinstance(logger, WandbLogger):
            media = {
                "samples/page": wandb.Html(str(path.with_suffix(".html"))),
                "samples/film": wandb.Video(str(path.with_suffix(".gif")), format="gif"),
                "samples/sheet": wandb.Image(str(path.with_suffix(".png"))),
            }
            logger.experiment.log({**media, "trainer/global_step": trainer.global_step})


@contextmanager
def as_evaluated(method: torch.nn.Module) -> Iterator[None]:
    """Puts a method and all that is in it into the mode of testing, and back into what each part was in."""
    modes = [(module, module.training) for module in method.modules()]
    method.eval()
    try:
        yield
    finally:
        for module, training in modes:
            module.training = training
