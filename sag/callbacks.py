"""What a run leaves in its folder besides checkpoints: metrics.json, progress.json, predictions.npz."""

from __future__ import annotations

import dataclasses
import os
import platform
import subprocess
import time
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import torch

import sag
from sag.components import parameter_count
from sag.data.motion_file import MotionFile, write_motions
from sag.files import write_json
from sag.methods.base import Method
from sag.processes import everyones

PROGRESS_EVERY = 1.0
"""Seconds between two writings of progress.json."""


class MetricsFile(pl.Callback):
    """Writes `metrics.json`: the figures of a test with all that is needed to compare them."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.started = time.monotonic()
        self.before = 0.0

    def state_dict(self) -> dict[str, float]:
        """How long training has taken, in all of its parts if it was interrupted."""
        return {"fit": self.before + time.monotonic() - self.started}

    def load_state_dict(self, state_dict: dict[str, float]) -> None:
        """Takes the parts of before."""
        self.before = state_dict["fit"]

    def on_fit_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Starts the clock."""
        self.started = time.monotonic()

    def on_fit_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Notes how long training took."""
        self.seconds["fit"] = round(self.state_dict()["fit"], 1)

    def on_test_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Starts the clock."""
        self.started = time.monotonic()

    def on_test_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Writes the file, unless the run was only a trial of its wiring."""
        if not isinstance(pl_module, Method) or trainer.fast_dev_run:  # type: ignore[attr-defined]
            return
        self.seconds["test"] = round(time.monotonic() - self.started, 1)
        folder = Path(trainer.default_root_dir)
        content = self._content(trainer, pl_module, folder.name)  # of all processes, so each has to ask
        if trainer.is_global_zero:
            write_json(folder / "metrics.json", content)
            print(f"the figures are in {folder / 'metrics.json'}", flush=True)

    def _content(self, trainer: pl.Trainer, method: Method, row: str) -> dict[str, Any]:
        figures = {k.removeprefix("test/"): float(v) for k, v in trainer.callback_metrics.items() if "test/" in k}
        components = getattr(method, "components", None)
        return {
            "row": row,
            "method": type(method).__name__,
            "components": dataclasses.asdict(components) if components else None,
            "pretrained": None if method.pretrained is None else str(method.pretrained),
            "seed": int(os.environ.get("PL_GLOBAL_SEED", -1)),
            "data": method.data.describe(),
            "protocol": method.protocol(),
            "metrics": figures,
            "motion_fid_distances": method.scores.distances(),
            "steps": int(getattr(method, "generator_steps", 0)),
            "seconds": self.seconds,
            "parameters": parameter_count(method),
            "versions": {"sag": sag.__version__, "torch": torch.__version__, "python": platform.python_version()},
            "commit": _commit(),
        }


def _commit() -> str | None:
    """The commit of the working tree this package runs from, if it runs from one."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=10, check=True).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return None


class ProgressFile(pl.Callback):
    """Writes `progress.json`, from which a sweep shows how far a row is."""

    def __init__(self) -> None:
        self.written = 0.0

    def on_train_batch_end(self, trainer: pl.Trainer, *args: Any, **kwargs: Any) -> None:
        """Steps of training done, of all."""
        epochs = trainer.max_epochs or 1
        steps = int(trainer.num_training_batches)
        self._write(trainer, "fit", trainer.fit_loop.epoch_loop.total_batch_idx + 1, steps * epochs)

    def on_test_batch_end(
        self, trainer: pl.Trainer, pl_module: pl.LightningModule, outputs: Any, batch: Any, batch_idx: int, *args: Any
    ) -> None:
        """Batches of the test done, of all."""
        self._write(trainer, "test", batch_idx + 1, int(sum(trainer.num_test_batches)))

    def _write(self, trainer: pl.Trainer, stage: str, step: int, steps: int) -> None:
        due = step == steps or time.monotonic() - self.written > PROGRESS_EVERY
        if due and trainer.is_global_zero and not trainer.fast_dev_run:  # type: ignore[attr-defined]
            self.written = time.monotonic()
            path = Path(trainer.default_root_dir) / "progress.json"
            write_json(path, {"stage": stage, "step": step, "steps": steps})


class PredictionFile(pl.Callback):
    """Writes what `predict` sampled to `predictions.npz`, see `sag.data.motion_file`, and says where it is."""

    def __init__(self) -> None:
        self.parts: list[dict[str, torch.Tensor]] = []

    def on_predict_batch_end(
        self, trainer: pl.Trainer, pl_module: pl.LightningModule, outputs: Any, *args: Any, **kwargs: Any
    ) -> None:
        """Keeps the batch, where there is one."""
        if outputs is not None:
            self.parts.append({name: value.cpu() for name, value in outputs.items()})

    def on_predict_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Writes the file, with what other processes have sampled."""
        parts = sorted((part for own in everyones(self.parts) for part in own), key=lambda part: int(part["index"][0]))
        if not isinstance(pl_module, Method) or not trainer.is_global_zero or not parts:
            return
        joints, index = (torch.cat([part[name] for part in parts]).numpy() for name in ("joints", "index"))
        path = Path(trainer.default_root_dir) / "predictions.npz"
        write_motions(path, MotionFile(path, joints, index, pl_module.data.fps, pl_module.skeleton.name))
        print(f"motions {joints.shape} are in {path}", flush=True)
