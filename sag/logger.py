"""Weights & Biases, offline unless asked."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import wandb
from lightning.pytorch.loggers import WandbLogger
from lightning.pytorch.loggers.logger import rank_zero_experiment


class WandbOffline(WandbLogger):
    """The W&B logger, offline unless `WANDB_MODE` or `offline` says otherwise; no account is needed.

    Args:
        project: the W&B project.
        save_dir: folder that gets the `wandb` folder.
        name: the run; `WANDB_NAME`, then the folder's name when left out.
        group: runs that belong together; `WANDB_RUN_GROUP` when left out.
        offline: whether nothing is sent; `WANDB_MODE` decides when left out.
    """

    def __init__(
        self,
        project: str = "sag",
        save_dir: Path = Path("runs"),
        name: str | None = None,
        group: str | None = None,
        offline: bool | None = None,
    ) -> None:
        if offline is None:
            offline = os.environ.get("WANDB_MODE", "offline") != "online"
        save_dir.mkdir(parents=True, exist_ok=True)
        super().__init__(
            project=project,
            save_dir=save_dir,
            name=name or os.environ.get("WANDB_NAME") or save_dir.name,
            group=group or os.environ.get("WANDB_RUN_GROUP"),
            offline=offline,
            settings=wandb.Settings(silent=True, x_disable_stats=True),
        )
        self._wandb_init.pop("anonymous", None)  # W&B warns of it, whatever its value

    @property
    @rank_zero_experiment
    def experiment(self) -> Any:
        """W&B's run, with the generator's own steps as the axis of training; Lightning counts every optimizer's."""
        first = self._experiment is None
        run = super().experiment
        if first:
            run.define_metric("train/*", step_metric="train/generator_step")
        return run

    @property
    def log_dir(self) -> str | None:
        """The run's own folder, so that configs are saved beside its metrics."""
        return str(self.save_dir)
