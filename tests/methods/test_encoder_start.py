"""What a scene encoder starts from."""

from pathlib import Path

import pytest
import torch

from sag.components import Network, build_encoder
from sag.errors import SagError
from sag.methods import SAG
from sag.methods.encoder_start import start_encoder

SMALL = {"width": 0.05, "feature_grid": (1, 2), "feature_norm": "batch"}


def checkpoint(folder: Path, average: float, **changes) -> tuple[Path, SAG]:
    """A checkpoint of a run whose averaged encoder, where it has one, is not the one that it trains."""
    method = SAG(network=Network(**{**SMALL, **changes}), image_size=(36, 64), average=average)
    for parameter in method.averaged.parameters():
        parameter.data.add_(1)
    path = folder / "last.ckpt"
    torch.save({"state_dict": method.state_dict()}, path)
    return path, method


@pytest.mark.parametrize("average", [0.0, 0.9])
def test_training_starts_in_the_encoder_that_another_run_samples_with(tmp_path: Path, average: float) -> None:
    path, method = checkpoint(tmp_path, average)
    encoder = build_encoder(Network(**SMALL, scene_encoder=path))
    said = start_encoder(encoder)
    found, wanted = encoder.state_dict(), method.drawing.encoder.state_dict()
    assert str(path) in said and all(torch.equal(found[name], wanted[name]) for name in wanted)


def test_without_a_file_it_starts_at_random_and_says_so() -> None:
    encoder = build_encoder(Network(**SMALL))
    before = {name: value.clone() for name, value in encoder.state_dict().items()}
    assert start_encoder(encoder) == "random weights, not from ImageNet"
    assert all(torch.equal(before[name], value) for name, value in encoder.state_dict().items())


@pytest.mark.parametrize("option", ["scene_encoder", "imagenet"])
def test_a_trained_method_is_built_without_the_file_that_it_began_in(option: str) -> None:
    encoder = build_encoder(Network(**SMALL, **{option: Path("moved.file")}))
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
        start_encoder(build_encoder(Network(**SMALL, scene_encoder=path)))


def test_one_start_only(tmp_path: Path) -> None:
    with pytest.raises(SagError, match="both set"):
        build_encoder(Network(**SMALL, scene_encoder=tmp_path, imagenet=tmp_path))
