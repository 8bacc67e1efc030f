"""Training that starts in the scene encoder of another run."""

from pathlib import Path

import pytest
import torch
from test_sag import SMALL, trained, trainer
from toy_data import ToyDataModule

from sag.components import Network
from sag.errors import SagError
from sag.methods import CSGN, SAG, Cao


@pytest.fixture
def before(toy: ToyDataModule, tmp_path: Path) -> Path:
    """A checkpoint of a short training with an average."""
    path = tmp_path / "before.ckpt"
    trained(toy, tmp_path, average=0.5).trainer.save_checkpoint(path)
    return path


def started(kind: type, toy: ToyDataModule, scene_encoder: Path, **options):
    """A method at the start of its training."""
    network = Network(width=SMALL.width, scene_encoder=scene_encoder)
    made = kind(network=network, **options)
    made.trainer = trainer(toy.cache_dir)
    made.trainer.datamodule = toy
    made.setup("fit")
    return made


@pytest.mark.parametrize(
    ("kind", "find"),
    [(SAG, lambda made: made.sampler.encoder), (CSGN, lambda made: made.sampler.encoder), (Cao, lambda m: m.encoder)],
)
def test_every_method_can_start_in_it(kind, find, toy, before, capsys) -> None:
    made = started(kind, toy, before, **({"image_size": toy.image_size} if kind is SAG else {}))
    wanted = torch.load(before, weights_only=True)["state_dict"]
    state = find(made).state_dict()
    assert state and all(torch.equal(state[n], wanted[f"averaged.0.module.encoder.{n}"]) for n in state)
    assert f"starts from the scene encoder in {before}" in capsys.readouterr().out


def test_the_average_starts_in_it_too(toy, before) -> None:
    network = Network(width=SMALL.width, scene_encoder=before)
    made = SAG(network=network, image_size=toy.image_size, average=0.999, learning_rate=0.0)
    trainer(toy.cache_dir).fit(made, toy)
    weight = torch.load(before, weights_only=True)["state_dict"]["averaged.0.module.encoder.resnet.conv1.weight"]
    assert torch.equal(made.sampler.encoder.resnet.conv1.weight, weight)
    assert torch.equal(made.averaged[0].module.encoder.resnet.conv1.weight, weight)


def test_a_missing_one_ends_training_before_it_begins(toy, tmp_path: Path) -> None:
    with pytest.raises(SagError, match=r"network\.scene_encoder .*none\.ckpt is no file"):
        started(SAG, toy, tmp_path / "none.ckpt", image_size=toy.image_size)
