"""What a run shows of its samples: files in its folder and in W&B, and a training that nothing of it changes."""

from pathlib import Path

import pytest
import torch
from PIL import Image
from toy_data import ToyDataModule

from sag.components import Components, Network
from sag.errors import SagError
from sag.logger import WandbOffline
from sag.methods import SAG
from sag.showing import ShownSamples, as_evaluated
from sag.trainer import Trainer


def method() -> SAG:
    network = Network(width=0.05, critic_norm="layer")
    return SAG(Components(projection=False, context=False), network, image_size=(36, 64), average=0.9)


def fitted(folder: Path, toy_cache: Path, every: int | None, logger: object = False) -> SAG:
    """A method after two epochs."""
    torch.manual_seed(0)
    made = method()
    trainer = Trainer(
        default_root_dir=folder, max_epochs=2, accelerator="cpu", logger=logger, enable_progress_bar=False,
        enable_model_summary=False, num_sanity_val_steps=0, check_val_every_n_epoch=100, enable_checkpointing=False,
        show_every_n_epochs=every,
    )  # fmt: skip
    trainer.fit(made, datamodule=ToyDataModule(toy_cache))
    return made


def test_nothing_is_shown_where_nothing_is_asked_for(tmp_path, toy_cache):
    fitted(tmp_path, toy_cache, None)
    assert not (tmp_path / "samples").exists()


def test_pages_films_and_sheets_do_not_change_the_training(tmp_path, toy_cache):
    plain, shown = fitted(tmp_path / "plain", toy_cache, None), fitted(tmp_path / "shown", toy_cache, 1)
    names = {path.name for path in (tmp_path / "shown/samples").iterdir()}
    assert names == {f"epoch-00{epoch}.{form}" for epoch in (1, 2) for form in ("html", "gif", "png")}
    pairs = zip(plain.state_dict().items(), shown.state_dict().values())
    assert all(torch.equal(value, other) for (_, value), other in pairs)
    assert "shown, epoch 002" in (tmp_path / "shown/samples/epoch-002.html").read_text()
    with Image.open(tmp_path / "shown/samples/epoch-002.gif") as film:
        assert film.n_frames == 33


def test_the_last_epoch_is_shown_in_any_case(tmp_path, toy_cache):
    fitted(tmp_path, toy_cache, 5)
    assert (tmp_path / "samples/epoch-002.html").is_file() and not (tmp_path / "samples/epoch-001.html").exists()


def test_wandb_gets_them_offline(tmp_path, toy_cache):
    fitted(tmp_path, toy_cache, 2, WandbOffline(save_dir=tmp_path, offline=True))
    media = {path.suffix for path in tmp_path.glob("wandb/offline-run-*/files/media/**/*") if path.is_file()}
    assert {".html", ".gif", ".png"} <= media


def test_a_test_leaves_a_contact_sheet(tmp_path, toy_cache):
    made, data = method(), ToyDataModule(toy_cache)
    made.sampler.scale.fit(data.training_motion)
    callback = ShownSamples()
    trainer = Trainer(default_root_dir=tmp_path, accelerator="cpu", logger=False)
    trainer.datamodule = data
    made.trainer = trainer
    callback.on_test_end(trainer, made)
    assert Image.open(tmp_path / "samples.png").size == (4 * 244 - 4, 135)


def test_modes_come_back_as_they_were():
    part = torch.nn.Sequential(torch.nn.Linear(2, 2), torch.nn.BatchNorm1d(2))
    part[1].eval()
    with as_evaluated(part):
        assert not part.training and not part[0].training
    assert part.training and part[0].training and not part[1].training


def test_refuses_what_cannot_be_shown():
    with pytest.raises(SagError, match="show_every_n_epochs is 0"):
        ShownSamples(0)
    with pytest.raises(SagError, match="0 windows with 3 samples"):
        ShownSamples(1, windows=0)
