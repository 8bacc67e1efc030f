"""Resume means resume: interrupted at any batch and continued, a run ends bitwise where the undisturbed one ends."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import pytest
import torch
from killing import Kill, Killed
from lightning.pytorch.callbacks import ModelCheckpoint
from torch.utils.data import DataLoader, RandomSampler
from toy_data import ToyDataModule

from sag.components import Network
from sag.data.base import Windows
from sag.methods import HPGAN, SAG, Cao, ERDTraining, TwoStage
from sag.methods.hp_gan import HPGANRecipe
from sag.methods.two_stage import TwoStageRecipe
from sag.randomness import random_state, set_random_state
from sag.saving import LastCheckpoint
from sag.trainer import Trainer

TINY = Network(width=0.05)
LAYER = Network(width=0.05, critic_norm="layer")
KEPT = Network(width=0.05, critic_norm="layer", bones="kept")
EPOCHS, BATCHES = 2, 3

METHODS: dict[str, Callable[[], pl.LightningModule]] = {
    "sag": lambda: SAG(network=LAYER, image_size=(36, 64), average=0.9, critic_steps=2),
    "sag, rate that falls": lambda: SAG(network=KEPT, image_size=(36, 64), critic_steps=2, falling_from=0.2),
    "sag, batch norm": lambda: SAG(network=TINY, image_size=(36, 64)),
    "hp_gan": lambda: HPGAN(TINY, recipe=HPGANRecipe(critic_steps=2)),
    "two_stage": lambda: TwoStage(TINY, recipe=TwoStageRecipe(critic_steps=1)),
    "cao": lambda: Cao(TINY),
    "erd": lambda: ERDTraining(width=0.04),
}


class Validating(ToyDataModule):
    """Toy data that validates, which draws from PyTorch's generator as well."""

    def val_dataloader(self) -> DataLoader:
        return self._fixed("test", with_cloud=False)


def trainer(folder: Path, *callbacks: pl.Callback, **options: Any) -> Trainer:
    quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False, "num_sanity_val_steps": 0}
    usual = {"max_epochs": EPOCHS, "check_val_every_n_epoch": 99, "save_every_n_batches": 1, **options}
    return Trainer(
        default_root_dir=folder, accelerator="cpu", callbacks=[LastCheckpoint(), *callbacks], **quiet, **usual
    )


def part(name: str, data: ToyDataModule, folder: Path, kill_at: int | None, seed: int = 5, **options: Any) -> Any:
    """A process's share of a run: it starts from a seed, or goes on from what is in the folder."""
    pl.seed_everything(seed, verbose=False)
    method = METHODS[name]()
    run = trainer(folder, Kill(kill_at), **options)
    try:
        run.fit(method, datamodule=data, ckpt_path="last")
    except Killed:
        return None
    return ending(run, method)


def ending(run: pl.Trainer, method: pl.LightningModule) -> dict[str, Any]:
    """All that a run ends with: weights, averages, counters, optimisers, generators, places of the loops."""
    loop = run.fit_loop.epoch_loop
    places = [run.current_epoch, run.global_step, loop.total_batch_idx, loop._batches_that_stepped]
    return {
        "method": method.state_dict(),
        "optimisers": [optimizer.state_dict() for optimizer in run.optimizers],
        # The checks of shapes, in tests alone, draw from Python's own generator, which nothing here trains with.
        "random": {name: state for name, state in random_state().items() if name != "python"},
        "places": places,
        "metrics": {name: float(value) for name, value in run.callback_metrics.items()},
    }


def differences(one: Any, other: Any, where: str = "") -> list[str]:
    """Places at which two endings are not the same, to the last bit."""
    if isinstance(one, dict):
        keys = [] if one.keys() == other.keys() else [f"{where}: {one.keys() ^ other.keys()}"]
        return keys + [
            d for key in one.keys() & other.keys() for d in differences(one[key], other[key], f"{where}/{key}")
        ]
    if isinstance(one, (list, tuple)):
        return [d for i, pair in enumerate(zip(one, other, strict=True)) for d in differences(*pair, f"{where}/{i}")]
    same = torch.equal(one, other) if torch.is_tensor(one) else one == other
    return [] if same else [where]


@pytest.fixture
def data(toy_cache: Path) -> ToyDataModule:
    """Six training windows in three batches."""
    return ToyDataModule(toy_cache, batch_size=2, windows=6)


@pytest.fixture(scope="session")
def undisturbed(toy_cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], dict[str, Any]]:
    """The ending of a method's run that nothing interrupts, trained once."""
    known: dict[str, dict[str, Any]] = {}

    def of(name: str) -> dict[str, Any]:
        if name not in known:
            known[name] = part(
                name, ToyDataModule(toy_cache, batch_size=2, windows=6), tmp_path_factory.mktemp("whole"), None
            )
        return known[name]

    return of


POSITIONS = {
    "sag": range(EPOCHS * BATCHES),
    "sag, rate that falls": (1, 4),
    "sag, batch norm": (2,),
    "hp_gan": (2, 3),
    "two_stage": (1, 3, 4),  # its stages end in the third and the fourth batch
    "cao": (2, 3, 5),  # its stages end with the third and in the fifth batch
    "erd": range(EPOCHS * BATCHES),
}


@pytest.mark.parametrize(("name", "place"), [(name, place) for name, places in POSITIONS.items() for place in places])
def test_a_run_killed_at_any_batch_ends_where_the_undisturbed_one_ends(
    name: str, place: int, data: ToyDataModule, undisturbed, tmp_path: Path, tally
) -> None:
    assert part(name, data, tmp_path, kill_at=place) is None
    continued, whole = part(name, data, tmp_path, kill_at=None, seed=6 if place else 5), undisturbed(name)
    logged = {term: value for term, value in whole["metrics"].items() if term in continued["metrics"]}
    assert logged and differences(continued, {**whole, "metrics": logged}) == []
    tally["places to go on from, all bitwise"] += 1


def test_batches_after_the_last_checkpoint_are_done_again(data: ToyDataModule, undisturbed, tmp_path: Path) -> None:
    for place in (1, 2, 3, 5, 5):  # checkpoints are after batches 1, 2 (the epoch's end), 3 and 5
        assert part("sag", data, tmp_path, kill_at=place, save_every_n_batches=2) is None
    continued = part("sag", data, tmp_path, kill_at=None, save_every_n_batches=2)
    assert differences(continued, undisturbed("sag")) == []


def test_a_finished_fit_does_not_train_again(data: ToyDataModule, undisturbed, tmp_path: Path) -> None:
    whole = part("erd", data, tmp_path, kill_at=None)
    data.encoder_path.unlink()
    again = part("erd", data, tmp_path, kill_at=0)
    assert differences(again["method"], whole["method"]) == []
    assert data.encoder_path.is_file(), "encoders are written even if training ended just before the interruption"


def test_a_run_that_validates_goes_on_too(toy_cache: Path, tmp_path: Path) -> None:
    data = Validating(toy_cache, batch_size=2, windows=6)
    options = {"check_val_every_n_epoch": 1, "val_check_interval": 2, "limit_val_batches": 1}
    whole = part("erd", data, tmp_path / "whole", None, **options)
    for place in (1, 2, 3, 5):
        assert part("erd", data, tmp_path / str(place), kill_at=place, **options) is None
        assert differences(part("erd", data, tmp_path / str(place), None, **options), whole) == []


def test_plain_lightning_does_not_end_there(data: ToyDataModule, tmp_path: Path, monkeypatch) -> None:
    """The control: without the order and the generators of the checkpoint the same check finds a difference."""

    def plainly(self: ToyDataModule) -> DataLoader:
        windows = Windows(self.cache, "train", self.skeleton)
        return DataLoader(windows, batch_size=2, shuffle=True, drop_last=True, collate_fn=lambda batch: batch)

    monkeypatch.setattr(ToyDataModule, "train_dataloader", plainly)

    def run(folder: Path, kill_at: int | None, start: Path | None = None) -> Any:
        pl.seed_everything(5, verbose=False)
        method = METHODS["sag"]()
        saving = ModelCheckpoint(
            folder, filename="x", every_n_train_steps=1, save_top_k=1, enable_version_counter=False
        )
        quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False}
        never = {"check_val_every_n_epoch": 99, "num_sanity_val_steps": 0}
        made = pl.Trainer(max_epochs=EPOCHS, accelerator="cpu", callbacks=[saving, Kill(kill_at)], **quiet, **never)
        try:
            made.fit(method, datamodule=data, ckpt_path=start)
        except Killed:
            return None
        return ending(made, method)

    whole = run(tmp_path / "whole", None)
    for place in (2, 3):
        run(tmp_path / str(place), place)
        continued = run(tmp_path / str(place), None, tmp_path / str(place) / "x.ckpt")
        assert any(found.startswith("/method") for found in differences(continued, whole))


def test_the_order_is_what_it_always_was(data: ToyDataModule) -> None:
    """Figures depend on seeds: windows come as torch's own shuffling has them, and as much chance is drawn."""
    data.setup()
    windows = Windows(data.cache, "train", data.skeleton)
    usual = DataLoader(windows, batch_size=2, sampler=RandomSampler(windows), drop_last=True, collate_fn=lambda b: b)
    for loader in (usual, data.train_dataloader()):
        torch.manual_seed(3)
        found = [[batch.index.tolist() for batch in loader] for _ in range(3)]
        drawn = torch.rand(3)
        if loader is usual:
            wanted = found, drawn
    assert found == wanted[0] and torch.equal(drawn, wanted[1])
    assert found[0] != found[1]


def test_a_loader_goes_on_after_what_it_has_given(data: ToyDataModule) -> None:
    data.setup()
    torch.manual_seed(3)
    first = data.train_dataloader()
    order = [batch.index.tolist() for batch in first]
    assert first.state_dict()["given"] == BATCHES
    for given in range(BATCHES):
        again = data.train_dataloader()
        again.load_state_dict({"seed": first.state_dict()["seed"], "given": given})
        assert [batch.index.tolist() for batch in again] == order[given:]
        assert len([batch.index for batch in again]) == BATCHES, "the next epoch is whole"


def test_every_generator_goes_on_where_it_was() -> None:
    import random

    import numpy as np

    state = random_state()
    drawn = [random.gauss(0, 1), np.random.normal(), torch.rand(2).tolist()]
    random.gauss(0, 1)
    set_random_state(state)
    assert [random.gauss(0, 1), np.random.normal(), torch.rand(2).tolist()] == drawn
