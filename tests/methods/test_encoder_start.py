"""What a scene encoder starts from, and training that starts in another run's."""

from pathlib import Path

import pytest
import torch
from test_sag import SMALL, trained, trainer
from toy_data import ToyDataModule

from sag.components import Network, build_encoder
from sag.errors import SagError
from sag.methods import CSGN, SAG, Cao
from sag.methods.encoder_start import start_encoder

SIZES = {"width": 0.05, "feature_grid": (1, 2), "feature_norm": "batch"}


def checkpoint(folder: Path, average: float, **changes) -> tuple[Path, SAG]:
    """A checkpoint of a run whose averaged encoder, where it has one, is not the one that it trains."""
    method = SAG(network=Network(**{**SIZES, **changes}), image_size=(36, 64), average=average)
    for parameter in method.averaged.parameters():
        parameter.data.add_(1)
    path = folder / "last.ckpt"
    torch.save({"state_dict": method.state_dict()}, path)
    return path, method


@pytest.mark.parametrize("average", [0.0, 0.9])
def test_training_starts_in_the_encoder_that_another_run_samples_with(tmp_path: Path, average: float) -> None:
    path, method = checkpoint(tmp_path, average)
    encoder = build_encoder(Network(**SIZES, scene_encoder=path))
    said = start_encoder(encoder)
    found, wanted = encoder.state_dict(), method.drawing.encoder.state_dict()
    assert str(path) in said and all(torch.equal(found[name], wanted[name]) for name in wanted)


def test_without_a_file_it_starts_at_random_and_says_so() -> None:
    encoder = build_encoder(Network(**SIZES))
    before = {name: value.clone() for name, value in encoder.state_dict().items()}
    assert start_encoder(encoder) == "random weights, not from ImageNet"
    assert all(torch.equal(before[name], value) for name, value in encoder.state_dict().items())


@pytest.mark.parametrize("option", ["scene_encoder", "imagenet"])
def test_a_trained_method_is_built_without_the_file_that_it_began_in(option: str) -> None:
    encoder = build_encoder(Network(**SIZES, **{option: Path("moved.file")}))
    with pytest.raises(SagError, match=r"moved\.file"):
        start_encoder(encoder)


@pytest.mark.parametrize("content", [None, b"no checkpoint", "other width"])
def test_a_wrong_file_is_named(tmp_path: Path, content: bytes | str | None) -> None:
    path = tmp_path / "last.ckpt"
    if content == "other width":
        checkpoint(tmp_path, 0.0, width=0.3)
    elif isinstance(content, bytes):
        path.write_bytes(content)
    with pytest.raises(SagError, match=r"network\.scene_encoder .*last\.ckpt"):
        start_encoder(build_encoder(Network(**SIZES, scene_encoder=path)))


def test_one_start_only(tmp_path: Path) -> None:
    with pytest.raises(SagError, match="both set"):
        build_encoder(Network(**SIZES, scene_encoder=tmp_path, imagenet=tmp_path))


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
