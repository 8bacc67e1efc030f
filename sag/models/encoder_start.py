"""What a scene encoder starts from: random weights, ImageNet's, or those of another run's encoder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn

from sag.errors import SagError
from sag.models.resnet import ResNet18
from sag.seal import read_sealed

AVERAGED, TRAINED = "averaged.0.module.encoder.", "sampler.encoder."
"""Where a checkpoint has the encoder that its run samples with, if it keeps an average, and the one it trains."""


@dataclass(frozen=True)
class EncoderStart:
    """A file to start from, or none.

    Attributes:
        imagenet: torchvision's ImageNet weights of ResNet-18, as in the paper.
        checkpoint: of a run of this program, whose scene encoder is taken.

    Raises:
        SagError: both are given.
    """

    imagenet: Path | None = None
    checkpoint: Path | None = None

    def __post_init__(self) -> None:
        if self.imagenet is not None and self.checkpoint is not None:
            raise SagError("network.imagenet and network.scene_encoder are both set; the scene encoder starts from one")

    def load(self, encoder: nn.Module, resnet: ResNet18) -> str:
        """Loads the file, if there is one; returns what the encoder starts from, in words.

        Args:
            encoder: all of it.
            resnet: the part of it that ImageNet's weights are for.

        Raises:
            SagError: the file is missing, damaged or for an encoder of other sizes.
        """
        if self.imagenet is not None:
            resnet.load_imagenet(self.imagenet)
            return str(self.imagenet)
        if self.checkpoint is not None:
            _load(encoder, self.checkpoint)
            return f"the scene encoder in {self.checkpoint}"
        return "random weights, not from ImageNet"


def _load(encoder: nn.Module, path: Path) -> None:
    if not path.is_file():
        raise SagError(f"network.scene_encoder {path} is no file")
    try:
        state = torch.load(read_sealed(path)[0], map_location="cpu", weights_only=True)["state_dict"]
        found = _part(state, AVERAGED) or _part(state, TRAINED)
        encoder.load_state_dict(found)
    except Exception as error:  # a damaged checkpoint can raise anything
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SagError(
            f"network.scene_encoder {path} holds no scene encoder of this width, feature_grid and feature_norm: "
            f"{reason:.200}"
        ) from error


def _part(state: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): value for name, value in state.items() if name.startswith(prefix)}
