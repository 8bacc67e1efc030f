"""What the networks of Cao et al. are made of, and what they are told."""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.batch_norm import BatchNorm2d
from sag.types import Condition, Tensors


@dataclass
class Seen(Tensors):
    """What is known at frame 0.

    Attributes:
        image: colours in [0, 1].
        joints: a heat map for each joint of the person.
        condition: scene feature and initial pose.
    """

    image: Float[Tensor, "b 3 rows columns"]
    joints: Float[Tensor, "b j h w"]
    condition: Condition

    @property
    def told(self) -> Float[Tensor, "b c"]:
        """Scene feature and initial pose in one."""
        return torch.cat([self.condition.feature, self.condition.initial_pose], dim=1)


class ConvBlock(nn.Sequential):
    """Two 3 x 3 convolutions with batch norm and ReLU.

    Args:
        in_channels: of the map that comes in.
        out_channels: of the map that goes out.
        stride: of the first convolution.
    """

    def __init__(self, in_channels: int, out_channels: int, stride: int = 1) -> None:
        super().__init__(
            nn.Conv2d(in_channels, out_channels, 3, stride, 1, bias=False), BatchNorm2d(out_channels), nn.ReLU(),
            nn.Conv2d(out_channels, out_channels, 3, 1, 1, bias=False), BatchNorm2d(out_channels), nn.ReLU(),
        )  # fmt: skip


class View(nn.Module):
    """A picture and heat maps side by side, both at a quarter of the picture's size.

    Args:
        maps: how many heat maps there are.
        channels: of each half; 64 in a public GoalNet.
    """

    def __init__(self, maps: int, channels: int) -> None:
        super().__init__()
        self.picture = nn.Sequential(
            nn.Conv2d(3, channels, 7, 2, 3), nn.MaxPool2d(3, 2, 1), ConvBlock(channels, channels)
        )
        self.maps = ConvBlock(maps, channels)

    def forward(self, image: Float[Tensor, "b 3 rows columns"], maps: Float[Tensor, "b n h w"]) -> Tensor:
        """Features (b, 2 channels, h, w)."""
        return torch.cat([self.picture(2 * image - 1), self.maps(maps)], dim=1)


class Residual(nn.Module):
    """The bottleneck of an hourglass: 1 x 1, 3 x 3 and 1 x 1 convolutions around a shortcut (Newell et al., 2016).

    Args:
        in_channels: of the map that comes in.
        out_channels: of the map that goes out.
    """

    def __init__(self, in_channels: int, out_channels: int) -> None:
        super().__init__()
        narrow = max(out_channels // 2, 1)
        self.convolutions = nn.Sequential(
            BatchNorm2d(in_channels), nn.ReLU(), nn.Conv2d(in_channels, narrow, 1, bias=False),
            BatchNorm2d(narrow), nn.ReLU(), nn.Conv2d(narrow, narrow, 3, 1, 1, bias=False),
            BatchNorm2d(narrow), nn.ReLU(), nn.Conv2d(narrow, out_channels, 1),
        )  # fmt: skip
        same = in_channels == out_channels
        self.shortcut = nn.Identity() if same else nn.Conv2d(in_channels, out_channels, 1)

    def forward(self, x: Float[Tensor, "b c h w"]) -> Float[Tensor, "b d h w"]:
        """Residual block."""
        return self.convolutions(x) + self.shortcut(x)


class Hourglass(nn.Module):
    """A map made small and large again, with a way around at every size (Newell et al., ECCV 2016).

    Args:
        channels: of all maps.
        levels: how many times the map is halved.
    """

    def __init__(self, channels: int, levels: int) -> None:
        super().__init__()
        self.around = Residual(channels, channels)
        inner = Hourglass(channels, levels - 1) if levels > 1 else Residual(channels, channels)
        self.through = nn.Sequential(Residual(channels, channels), inner, Residual(channels, channels))

    def forward(self, x: Float[Tensor, "b c h w"]) -> Float[Tensor, "b c h w"]:
        """Features that know of the whole map; any size, odd ones too."""
        small = self.through(F.max_pool2d(x, 2, ceil_mode=True))
        return self.around(x) + F.interpolate(small, x.shape[-2:], mode="nearest")
