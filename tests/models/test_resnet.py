from pathlib import Path

import pytest
import torch

from sag.errors import SagError
from sag.models.resnet import ResNet18

TORCHVISION = {
    "conv1.weight": (64, 3, 7, 7),
    "bn1.running_mean": (64,),
    "layer1.0.conv1.weight": (64, 64, 3, 3),
    "layer1.1.bn2.bias": (64,),
    "layer2.0.downsample.0.weight": (128, 64, 1, 1),
    "layer2.0.downsample.1.weight": (128,),
    "layer3.1.conv2.weight": (256, 256, 3, 3),
    "layer4.0.conv1.weight": (512, 256, 3, 3),
    "layer4.1.bn2.running_var": (512,),
}
"""Some parameters of torchvision's resnet18 and their shapes."""

TORCHVISION_PARAMETERS = 11_689_512 - (512 * 1000 + 1000)
"""torchvision documents 11,689,512 parameters for resnet18, its classifier included."""


def test_names_and_shapes_are_torchvisions() -> None:
    state = ResNet18().state_dict()
    assert {name: tuple(state[name].shape) for name in TORCHVISION} == TORCHVISION
    assert len(state) == 120
    assert sum(p.numel() for p in ResNet18().parameters()) == TORCHVISION_PARAMETERS


def test_feature_map_is_a_thirty_second(tmp_path: Path) -> None:
    assert ResNet18(8)(torch.randn(1, 3, 96, 160)).shape == (1, 64, 3, 5)


def test_a_local_file_loads_without_its_classifier(tmp_path: Path) -> None:
    there = ResNet18(8)
    file = tmp_path / "resnet18.pth"
    torch.save({**there.state_dict(), "fc.weight": torch.zeros(1000, 64), "fc.bias": torch.zeros(1000)}, file)
    here = ResNet18(8)
    here.load_imagenet(file)
    assert torch.equal(here.layer4[1].conv2.weight, there.layer4[1].conv2.weight)


@pytest.mark.parametrize("content", [b"no weights", None])
def test_a_wrong_file_is_named(tmp_path: Path, content: bytes | None) -> None:
    file = tmp_path / "weights.pth"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(SagError, match=r"weights\.pth"):
        ResNet18(8).load_imagenet(file)


def test_a_pickle_is_not_executed(tmp_path: Path) -> None:
    canary = tmp_path / "canary"

    class Gadget:
        def __reduce__(self):
            return (Path.touch, (canary,))

    file = tmp_path / "weights.pth"
    torch.save({"conv1.weight": Gadget()}, file)
    with pytest.raises(SagError):
        ResNet18(8).load_imagenet(file)
    assert not canary.exists()
