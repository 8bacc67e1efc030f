"""Runs that go wrong: the term and the step are named within a step, and good checkpoints stay."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import pytest
import torch
from toy_data import ToyDataModule

import sag.methods.cao
import sag.methods.erd
import sag.methods.wgan
from sag.checkpoints import FOLDER, LAST, WholeCheckpoints
from sag.components import Network
from sag.errors import Diverged, SagError
from sag.methods import HPGAN, SAG, Cao, ERDTraining
from sag.methods.cao import CaoRecipe
from sag.saving import LastCheckpoint
from sag.trainer import Trainer

TINY = Network(width=0.05, critic_norm="layer")
AT = 3

SAG_TERMS = (
    *(f"critic/{name}" for name in ("pose", "trajectory", "projection", "context")),
    *(f"penalty/{name}" for name in ("pose", "trajectory", "projection", "context")),
    *(f"generator/{name}" for name in ("pose", "trajectory", "projection", "context", "depth")),
)


def trainer(folder: Path, *callbacks: pl.Callback, **options: Any) -> Trainer:
    quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False, "num_sanity_val_steps": 0}
    often = {"max_epochs": 4, "check_val_every_n_epoch": 99, "save_every_n_batches": 1, **options}
    return Trainer(
        default_root_dir=folder, accelerator="cpu", callbacks=[LastCheckpoint(), *callbacks], **quiet, **often
    )


class Poison(pl.Callback):
    """Writes NaN into one number of a batch's motion or picture."""

    def __init__(self, part: str) -> None:
        self.part = part

    def on_train_batch_start(self, trainer: pl.Trainer, module: pl.LightningModule, batch: Any, index: int) -> None:
        if trainer.fit_loop.epoch_loop.total_batch_idx == AT:
            target = batch.motion.pose if self.part == "motion" else batch.scene.image
            target[0, ..., 0] = float("nan")


def stopped(
    method: pl.LightningModule, data: ToyDataModule, folder: Path, *callbacks: pl.Callback, **options: Any
) -> str:
    """What a fit says that must stop at the poisoned step, leaving the good checkpoint of before."""
    run = trainer(folder, *callbacks, **options)
    with pytest.raises(Diverged) as refused:
        run.fit(method, datamodule=data)
    assert refused.value.status not in (0, 1, 2)
    checkpoint = WholeCheckpoints().load_checkpoint(folder / FOLDER / LAST)
    assert all(value.isfinite().all() for value in checkpoint["state_dict"].values())
    assert checkpoint["loops"]["fit_loop"]["epoch_loop.batch_progress"]["total"]["ready"] == AT
    assert all(parameter.isfinite().all() for parameter in method.parameters()), "no step was taken with it"
    return str(refused.value)


def inject(monkeypatch: pytest.MonkeyPatch, module: Any, term: str, value: float) -> None:
    """Lets one term of a method's losses have this value at the step."""
    real = module.record

    def recorded(method: pl.LightningModule, terms: dict[str, torch.Tensor]) -> None:
        due = method.trainer.fit_loop.epoch_loop.total_batch_idx == AT
        real(method, {n: t * 0 + value if due and n == f"train/{term}" else t for n, t in terms.items()})

    monkeypatch.setattr(module, "record", recorded)


@pytest.mark.parametrize("term", SAG_TERMS)
def test_a_term_that_is_no_number_is_named(term: str, toy: ToyDataModule, tmp_path: Path, monkeypatch, tally) -> None:
    inject(monkeypatch, sag.methods.wgan, term, float("nan"))
    said = stopped(SAG(network=TINY, image_size=toy.image_size), toy, tmp_path)
    assert said.startswith(f"train/{term} is nan at step 3 (batch 1 of epoch 1)")
    assert len(said.splitlines()) == 1
    tally["terms and batches that are no number, all named, the last good weights kept"] += 1


def test_every_term_of_sag_is_watched(toy: ToyDataModule, tmp_path: Path, monkeypatch) -> None:
    seen: set[str] = set()
    real = sag.methods.wgan.record
    monkeypatch.setattr(sag.methods.wgan, "record", lambda method, terms: (seen.update(terms), real(method, terms))[1])
    trainer(tmp_path, max_epochs=1).fit(SAG(network=TINY, image_size=toy.image_size), datamodule=toy)
    assert seen == {f"train/{term}" for term in SAG_TERMS}


@pytest.mark.parametrize("loss", ["critic_loss", "gradient_penalty", "generator_loss"])
def test_a_loss_that_is_computed_wrong_is_named(
    loss: str, toy: ToyDataModule, tmp_path: Path, monkeypatch, tally
) -> None:
    method = SAG(network=TINY, image_size=toy.image_size)
    real = getattr(sag.methods.wgan, loss)

    def wrong(*arguments: Any) -> torch.Tensor:
        due = method.trainer.fit_loop.epoch_loop.total_batch_idx == AT
        return real(*arguments) * (float("nan") if due else 1)

    monkeypatch.setattr(sag.methods.wgan, loss, wrong)
    name = {"critic_loss": "critic", "gradient_penalty": "penalty", "generator_loss": "generator"}[loss]
    assert f"train/{name}/" in stopped(method, toy, tmp_path)
    tally["terms and batches that are no number, all named, the last good weights kept"] += 1


@pytest.mark.parametrize(
    ("module", "term", "made"),
    [
        (sag.methods.wgan, "critic/sequence", lambda: HPGAN(TINY)),
        (sag.methods.wgan, "generator/bones", lambda: HPGAN(TINY)),
        (sag.methods.cao, "divergence", lambda: Cao(TINY)),
        (sag.methods.cao, "path", lambda: Cao(TINY, recipe=CaoRecipe(stages=(2.0, 4.0, 2.0)))),
        (sag.methods.erd, "erd/32", lambda: ERDTraining(width=0.04)),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_other_methods_name_theirs(
    module, term: str, made, toy: ToyDataModule, tmp_path: Path, monkeypatch, tally
) -> None:
    inject(monkeypatch, module, term, float("inf"))
    assert stopped(made(), toy, tmp_path).startswith(f"train/{term} is inf at step 3")
    tally["terms and batches that are no number, all named, the last good weights kept"] += 1


@pytest.mark.parametrize("part", ["motion", "picture"])
def test_a_batch_with_a_number_that_is_none_stops_the_run(part: str, toy: ToyDataModule, tmp_path: Path, tally) -> None:
    said = stopped(SAG(network=TINY, image_size=toy.image_size), toy, tmp_path, Poison(part))
    assert said.startswith("train/") and "is nan at step 3 (batch 1 of epoch 1)" in said
    tally["terms and batches that are no number, all named, the last good weights kept"] += 1


def test_a_critic_explodes_beyond_the_limit(toy: ToyDataModule, tmp_path: Path, monkeypatch) -> None:
    inject(monkeypatch, sag.methods.wgan, "critic/projection", -2000.0)
    made = SAG(network=TINY, image_size=toy.image_size)
    said = stopped(made, toy, tmp_path, loss_limit=1000.0)
    assert said.startswith("train/critic/projection is -2000, beyond trainer.loss_limit 1000, at step 3")
    trainer(tmp_path / "other", loss_limit=3000.0).fit(SAG(network=TINY, image_size=toy.image_size), datamodule=toy)


def test_a_limit_is_above_zero() -> None:
    with pytest.raises(SagError, match=r"trainer\.loss_limit is -1\.0"):
        Trainer(loss_limit=-1.0)
