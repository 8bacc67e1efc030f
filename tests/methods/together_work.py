"""What one process does alone, or two do together, for the tests that hold the two side by side."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import torch
from killing import Kill, Killed
from lightning.pytorch.strategies import FSDPStrategy
from torch import Tensor
from toy_data import ToyDataModule

from sag.callbacks import MetricsFile, PredictionFile
from sag.components import Network
from sag.errors import SagError
from sag.losses import berhu
from sag.methods import CSGN, HPGAN, SAG, Cao, ERDTraining, GroundTruth, TwoStage
from sag.methods.hp_gan import HPGANRecipe
from sag.methods.two_stage import TwoStageRecipe
from sag.methods.wgan import Recipe
from sag.parallel import share_out
from sag.processes import everyones, own_rows, processes, rank
from sag.saving import LastCheckpoint
from sag.scoring import Evaluation
from sag.trainer import Trainer
from sag.types import Batch

TINY = Network(width=0.05)
LAYER = replace(TINY, critic_norm="layer", context_depth="given")
SHORT = Evaluation(samples=2, resamples=20)

METHODS: dict[str, Callable[[], pl.LightningModule]] = {
    "sag, batch norm in critics": lambda: SAG(network=TINY, image_size=(36, 64), average=0.9),
    "sag, every other batch": lambda: SAG(network=LAYER, image_size=(36, 64), critic_steps=2),
    "csgn": lambda: CSGN(TINY, recipe=Recipe(2e-4, (0.5, 0.999), critic_steps=2)),
    "hp_gan": lambda: HPGAN(TINY, recipe=HPGANRecipe(critic_steps=2)),
    "two_stage": lambda: TwoStage(TINY, recipe=TwoStageRecipe(critic_steps=1)),
    "cao": lambda: Cao(TINY),
    "erd": lambda: ERDTraining(width=0.04),
}
SAG_WITH_ALL = "sag, batch norm in critics"

TESTED: dict[str, Callable[[], pl.LightningModule]] = {
    "sag": lambda: SAG(network=TINY, image_size=(36, 64), average=0.9, evaluation=SHORT),
    "cao": lambda: Cao(TINY, evaluation=SHORT),
    "ground_truth": lambda: GroundTruth(evaluation=SHORT),
}
CASES = [("sag", 2), ("sag", 6), ("cao", 2), ("ground_truth", 2)]
"""Methods and windows of a test batch: the six test windows make three batches, or one and the second process none."""


class Gradients(pl.Callback):
    """Keeps the gradient of every step of every optimiser."""

    def __init__(self) -> None:
        self.steps: list[dict[str, Tensor]] = []

    def on_before_optimizer_step(self, trainer: pl.Trainer, pl_module: pl.LightningModule, optimizer: Any) -> None:
        own = {id(p) for group in optimizer.param_groups for p in group["params"]}
        named = {name: p for name, p in pl_module.named_parameters() if id(p) in own and p.grad is not None}
        self.steps.append({name: p.grad.clone() for name, p in named.items()})


class Figures(pl.Callback):
    """Keeps every figure of a test as it was computed, in float64."""

    found: dict[str, float]

    def on_test_end(self, trainer: pl.Trainer, pl_module: Any) -> None:
        self.found = {name: float(value) for name, value in pl_module.scores.compute().items()}
        for name, (metric, _) in pl_module.further.items():
            self.found |= {f"{name}/{key}": float(value) for key, value in metric.compute().items()}
        if isinstance(pl_module, GroundTruth):
            self.found |= {name: float(value) for name, value in pl_module.floors.compute().items()}


class NotANumber(pl.Callback):
    """Makes the motions of a batch no numbers, in the second process alone where there are two."""

    def on_train_batch_start(self, trainer: pl.Trainer, pl_module: Any, batch: Batch, batch_idx: int) -> None:
        if rank() == processes() - 1 and batch_idx == 1:
            batch.motion.pose.fill_(torch.nan)


@dataclass(frozen=True)
class Work:
    """Everything that is done, by so many devices.

    Attributes:
        cache: folder of the data.
        runs: folder of what it leaves.
        devices: one or two.
    """

    cache: Path
    runs: Path
    devices: int

    def all(self) -> dict[str, Any]:
        """All of it."""
        return {
            "trained": {name: self.trained(name) for name in METHODS},
            "processes": processes(),
            "depth": depth_loss(),
            "apart": self.trained(SAG_WITH_ALL, sync_batchnorm=False),
            "tested": {case: self.tested(*case) for case in CASES},
            "whole": self.part("whole", None),
            "left": self.part("left", 4),
            "resumed": self.part(self.copied("left", "resumed"), None),
            "refused": {
                "uneven": refusal(lambda: self.trained("erd", batch_size=3)),
                "diverged": refusal(lambda: self.trained("sag, every other batch", more=[NotANumber()])),
            },
        }

    def trainer(self, folder: str, *callbacks: pl.Callback, **options: Any) -> Trainer:
        quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False}
        usual = {"max_epochs": 1, "check_val_every_n_epoch": 99, "num_sanity_val_steps": 0, "limit_train_batches": 3}
        where = {"default_root_dir": self.runs / folder, "accelerator": "cpu", "devices": self.devices}
        return Trainer(**where, callbacks=list(callbacks), **quiet, **{**usual, **options})

    def data(self, batch_size: int = 4, eval_batch_size: int = 2) -> ToyDataModule:
        return ToyDataModule(self.cache, batch_size=batch_size, eval_batch_size=eval_batch_size, windows=12)

    def trained(self, name: str, batch_size: int = 4, more: list[Any] = [], **options: Any) -> dict[str, Any]:
        """Gradients of all steps of an epoch of three batches, and the ending."""
        pl.seed_everything(3, verbose=False)
        method, gradients = METHODS[name](), Gradients()
        run = self.trainer(name, gradients, *more, precision="64-true", **options)
        run.fit(method, datamodule=self.data(batch_size))
        logged = {term: float(value) for term, value in run.callback_metrics.items()}
        return {"steps": gradients.steps, "weights": dict(method.state_dict()), "logged": logged}

    def tested(self, name: str, size: int) -> dict[str, float]:
        """Every figure of a test; beside it the run leaves `metrics.json` and `predictions.npz`."""
        torch.manual_seed(0)
        method, folder, figures = TESTED[name](), f"{name}-{size}", Figures()
        data = self.data(eval_batch_size=size)
        make_ready(method, data)
        self.trainer(folder, figures, MetricsFile()).test(method, datamodule=data, verbose=False)
        self.trainer(folder, PredictionFile()).predict(method, datamodule=data)
        return figures.found

    def copied(self, folder: str, name: str) -> str:
        """The name of a copy of a run's folder, which is there when all processes go on."""
        if rank() == 0:
            shutil.copytree(self.runs / folder, self.runs / name)
        everyones(None)
        return name

    def part(self, folder: str, killed_at: int | None) -> dict[str, Any] | None:
        """A share of a run of six batches, which goes on from what is in the folder; how it ends, if it does."""
        pl.seed_everything(3, verbose=False)
        method = METHODS[SAG_WITH_ALL]()
        options = {"max_epochs": 2, "save_every_n_batches": 1}
        run = self.trainer(folder, LastCheckpoint(), Kill(killed_at), **options)
        try:
            run.fit(method, datamodule=self.data(), ckpt_path="last")
        except Killed:
            return None
        logged = {key: float(value) for key, value in run.callback_metrics.items()}
        return {"weights": dict(method.state_dict()), "logged": logged}


def make_ready(method: Any, data: ToyDataModule) -> None:
    """Gives a method units and, as if it were trained, steps; its average is not quite what it is itself."""
    scale = method.sampler.scale if isinstance(method, SAG) else getattr(method, "scale", None)
    if scale is not None:
        scale.fit(data.training_motion)
    for steps in [buffer for name, buffer in method.named_buffers() if name.endswith("_steps")]:
        steps += 1
    for averaged in getattr(method, "averaged", ()):
        averaged.module.load_state_dict(method.sampler.state_dict())
        with torch.no_grad():
            method.sampler.generator.pose.out.weight.mul_(1.5)


def depth_loss() -> dict[str, Tensor]:
    """Inverse Huber loss of four pictures: the second process's two are unknown for the most part, one of them all."""
    true = torch.linspace(1, 5, 240, dtype=torch.float64).view(4, 6, 10).clone()
    true[2, :, 1:], true[3] = 0, 0
    weight = torch.tensor(1.2, dtype=torch.float64, requires_grad=True)
    own = own_rows(4 // processes())
    loss = berhu(weight * true[own].sqrt() + 1, true[own])
    (gradient,) = torch.autograd.grad(loss, weight)
    return {"loss": loss.detach(), "gradient": gradient}


def refusal(work: Callable[[], Any]) -> str:
    """The sentence that something is refused with."""
    try:
        work()
    except SagError as error:
        return f"{type(error).__name__}: {error}"
    return "nothing was refused"


def work_of_two(cache: Path, runs: Path) -> dict[str, Any]:
    """The work of one of two processes."""
    return Work(cache, runs, 2).all()


def refused_strategy() -> str:
    """What is said of a strategy that shares out the weights."""
    return refusal(lambda: share_out(FSDPStrategy(), 2))
