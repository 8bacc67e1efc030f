"""Claim: training spends its time in the step, not around it."""

from __future__ import annotations

import logging
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import numpy as np
import torch
import yaml

from benchmarks.claim import Claim, Say, duration
from benchmarks.training_step import windows
from sag.callbacks import ProgressFile
from sag.components import Network
from sag.data.base import MotionDataModule
from sag.data.cache import ARRAYS, WindowCache, open_or_build, write_cache
from sag.logger import WandbOffline
from sag.methods import SAG
from sag.saving import LastCheckpoint
from sag.trainer import Trainer
from sag.types import Batch

MOST = 0.05
"""The most of the fit's process time that may pass outside the step."""

PRESET = Path("configs/presets/quick.yaml")
"""The preset that is trained, from the root of the repository."""

LOG_EVERY = 25
"""Steps between two lines of the log, as in `configs/base.yaml`."""


class TimedSAG(SAG):
    """SAG that adds up the process time of its steps."""

    spent = 0.0

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """The step, timed."""
        begun = time.process_time()
        super().training_step(batch, batch_idx)
        self.spent += time.process_time() - begun


class Loop(pl.Callback):
    """Process time from the first batch's reading to the end of the last epoch, its checkpoint included."""

    spent = 0.0

    def on_train_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Starts the clock."""
        self.spent = -time.process_time()

    def on_train_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Stops it."""
        self.spent += time.process_time()


class RoomWindows(MotionDataModule):
    """Windows of a few furnished rooms, again and again.

    Args:
        cache_dir: folder of the cache.
        image_size: rows and columns.
        count: windows of the training split.
    """

    name = "bench"

    def __init__(self, cache_dir: Path, image_size: tuple[int, int], count: int) -> None:
        super().__init__(cache_dir, "gta_im_19", image_size)
        self.count = count

    def build(self) -> WindowCache:
        """Writes the cache."""
        return open_or_build(self.cache_dir, self.name, {"count": self.count}, self._write)

    def _write(self, folder: Path) -> WindowCache:
        batch = windows(self.batch_size, self.image_size)
        split = np.append(np.zeros(self.count), [1, 2])  # the protocol wants one window of each split
        again = np.arange(len(split)) % len(batch)
        zeros = np.zeros((len(split), *self.image_size), np.uint8)
        known = {
            "joints": batch.motion.joints.numpy()[again],
            "image": (255 * batch.scene.image).byte().permute(0, 2, 3, 1).numpy()[again],
            "depth": (1000 * batch.scene.depth).numpy().astype(np.uint16)[again],
            "ids": zeros,
            "intrinsics": batch.scene.intrinsics.numpy()[again],
            "world2cam": batch.world2cam.double().numpy()[again],
            "split": split,
            "cloud_row": np.full(len(split), -1),
            "cloud_depth": zeros[:0],
            "cloud_intrinsics": np.zeros((0, 3, 3)),
        }
        arrays = {n: np.asarray(known.get(n, np.zeros(len(split)))).astype(kind) for n, (kind, _) in ARRAYS.items()}
        return write_cache(folder, arrays, {"name": self.name, "fps": 30, "dropped": {}, "notes": []})


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """One epoch by Lightning's trainer with the checkpoint, the progress file and the log of a usual run."""
    torch.set_flush_denormal(True)
    size, steps = ((36, 64), 2) if quick else ((72, 128), 100)
    say(f"training {steps} steps of the quick preset")
    with tempfile.TemporaryDirectory() as folder:
        method, loop = _fit(Path(folder), size, steps)
    outside = 1 - method.spent / loop.spent
    yield Claim(
        f"training's time outside the step: data, log, callbacks, Lightning; quick preset, {size[0]}x{size[1]}",
        "the whole fit",
        found=outside,
        asked=MOST,
        ours=f"{duration((loop.spent - method.spent) / steps)} a step",
        theirs=f"{duration(loop.spent / steps)} a step",
        at_least=False,
        unit=" of it",
        note=f"one fit of {steps} batches of 16 with a checkpoint at its end and W&B offline",
    )


def _fit(folder: Path, size: tuple[int, int], steps: int) -> tuple[TimedSAG, Loop]:
    logging.getLogger("lightning.pytorch").setLevel(logging.WARNING)
    chosen: dict[str, Any] = yaml.safe_load(PRESET.read_text(encoding="utf-8"))["model"]["init_args"]
    network = chosen.pop("network")
    network["feature_grid"] = tuple(network["feature_grid"])
    method, loop = TimedSAG(network=Network(**network), image_size=size, **chosen), Loop()
    data = RoomWindows(folder / "data", size, steps * 16)
    trainer = Trainer(
        max_epochs=1,
        default_root_dir=folder,
        accelerator="cpu",
        logger=WandbOffline(save_dir=folder, offline=True),
        callbacks=[LastCheckpoint(), ProgressFile(), loop],
        log_every_n_steps=LOG_EVERY,
        num_sanity_val_steps=0,
        check_val_every_n_epoch=99,
        enable_model_summary=False,
        enable_progress_bar=False,
    )
    trainer.fit(method, datamodule=data)
    return method, loop
