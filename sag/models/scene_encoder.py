"""The scene encoder and the depth decoder that supervises it (paper, 3.1)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.errors import SagError
from sag.models.batch_norm import BatchNorm1d, BatchNorm2d
from sag.models.resnet import ResNet18

FeatureNorm = Literal["none", "batch"]
"""How f is brought to scale: left as the linear layer makes it, or every number to deviation 1 over a batch."""


@dataclass(frozen=True)
class EncoderStart:
    """The file in which training starts, or none; nothing else needs it.

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


class SceneEncoder(nn.Module):
    """ResNet-18 and one linear layer: a picture becomes the scene feature f, 256 numbers in the paper.

    Args:
        feature_channels: length of f.
        width: channels of the first stage; 64 is ResNet-18.
        grid: cells (rows, columns) into which the last map is pooled before the linear layer; (1, 1) is
            ResNet's global average, finer ones keep where things are.
        norm: of f. Left alone, f grows in training until noise and initial pose beside it count for little.
        start: what it holds when training begins.
    """

    mean: Tensor
    std: Tensor

    def __init__(
        self,
        feature_channels: int,
        width: int = 64,
        grid: tuple[int, int] = (1, 1),
        norm: FeatureNorm = "none",
        start: EncoderStart = EncoderStart(),
    ) -> None:
        super().__init__()
        self.resnet = ResNet18(width)
        self.grid, self.start = grid, start
        self.fc = nn.Linear(self.resnet.out_channels * grid[0] * grid[1], feature_channels)
        self.norm = BatchNorm1d(feature_channels, affine=False) if norm == "batch" else nn.Identity()
        self.register_buffer("mean", torch.tensor([0.485, 0.456, 0.406]).view(3, 1, 1), persistent=False)
        self.register_buffer("std", torch.tensor([0.229, 0.224, 0.225]).view(3, 1, 1), persistent=False)

    def forward(self, image: Float[Tensor, "b 3 h w"]) -> Float[Tensor, "b f"]:
        """f of pictures with colours in [0, 1], in their precision, whatever the maps between had."""
        pixels = ((image - self.mean) / self.std).contiguous(memory_format=torch.channels_last)
        pooled = F.adaptive_avg_pool2d(self.resnet(pixels), self.grid).flatten(1)
        return self.norm(self.fc(pooled)).to(image.dtype)


class BlindEncoder(nn.Module):
    """An encoder that does not look: f is zero whatever the picture shows, and there is nothing to train.

    Ours: what a generator does with it, it does without knowing its scene.

    Args:
        feature_channels: length of f.
    """

    def __init__(self, feature_channels: int) -> None:
        super().__init__()
        self.feature_channels = feature_channels

    def forward(self, image: Float[Tensor, "b 3 h w"]) -> Float[Tensor, "b f"]:
        """f of any pictures: zeros."""
        return image.new_zeros(len(image), self.feature_channels)


class DepthDecoder(nn.Module):
    """Depth from f alone, as the text says: a small map, doubled up to half the picture's size.

    Args:
        feature_channels: length of f.
        image_size: rows and columns of the depth map to make.
        channels: channels of the small map; halved at every doubling.
    """

    def __init__(self, feature_channels: int, image_size: tuple[int, int], channels: int = 128) -> None:
        super().__init__()
        self.image_size = image_size
        self.sizes = _doublings((image_size[0] // 2, image_size[1] // 2))
        self.channels = channels
        rows, columns = self.sizes[0]
        self.fc = nn.Linear(feature_channels, channels * rows * columns)
        blocks = []
        for _ in self.sizes[1:]:
            narrower = max(channels // 2, 8)
            conv = nn.Conv2d(channels, narrower, 3, 1, 1, bias=False)
            blocks.append(nn.Sequential(conv, BatchNorm2d(narrower), nn.ReLU()))
            channels = narrower
        self.blocks = nn.ModuleList(blocks)
        self.out = nn.Conv2d(channels, 1, 3, 1, 1)

    def forward(self, feature: Float[Tensor, "b f"]) -> Float[Tensor, "b h w"]:
        """Depth in metres, positive."""
        x = F.relu(self.fc(feature)).view(-1, self.channels, *self.sizes[0])
        x = x.contiguous(memory_format=torch.channels_last)
        for block, size in zip(self.blocks, self.sizes[1:]):
            x = block(F.interpolate(x, size, mode="nearest"))
        metres = 4 * F.softplus(self.out(x))  # about 3 m at the start, so that crops see a room at once
        return F.interpolate(metres, self.image_size, mode="bilinear", align_corners=False)[:, 0]


def _doublings(size: tuple[int, int], smallest: int = 9) -> list[tuple[int, int]]:
    """Sizes from a small map up to `size`, each about twice the one before."""
    sizes = [size]
    while sizes[0][0] > smallest:
        rows, columns = sizes[0]
        sizes.insert(0, (-(-rows // 2), -(-columns // 2)))
    return sizes
