"""PoseNet: the pose along a path, a Transformer that refines a first guess."""

from __future__ import annotations

import math

import torch
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.cao.blocks import Seen
from sag.models.scale import MotionScale
from sag.types import FRAMES, Motion

HEADS = 8
"""Of the attention."""

CHANNELS = 512
"""Of a token, as in the Transformer's base model (Vaswani et al., 2017)."""

LAYERS = 6
"""Of the same model's encoder."""

FIRST_STEP = 1e-3
"""Deviation of the last layer's weights at the start, so that training begins at the guess."""


class PoseNet(nn.Module):
    """The given pose carried along a path, frame for frame a token, and what attention makes of it.

    Every frame may move away from the guess: its joints about the root, and the root about the path, which is smoother
    than people are.

    Args:
        scale: units.
        joints: joints of the skeleton.
        told: length of scene feature and initial pose.
        channels: see `CHANNELS`; rounded down to a multiple of the heads.
        layers: see `LAYERS`.
    """

    time: Tensor

    def __init__(
        self, scale: MotionScale, joints: int, told: int, channels: int = CHANNELS, layers: int = LAYERS
    ) -> None:
        super().__init__()
        self.scale = scale
        channels = HEADS * (channels // HEADS)
        self.into = nn.Linear(3 * joints + 6, channels)
        self.told = nn.Linear(told, channels)
        self.register_buffer("time", time_code(FRAMES - 1, channels), persistent=False)
        layer = nn.TransformerEncoderLayer(
            channels, HEADS, 4 * channels, dropout=0.0, activation="gelu", batch_first=True, norm_first=True
        )
        self.attention = nn.TransformerEncoder(layer, layers, nn.LayerNorm(channels), enable_nested_tensor=False)
        self.out = nn.Linear(channels, 3 * joints + 3)
        nn.init.normal_(self.out.weight, std=FIRST_STEP)
        nn.init.zeros_(self.out.bias)

    def forward(self, seen: Seen, given: Motion, path: Float[Tensor, "b 64 3"]) -> Motion:
        """Motions of 65 frames, the first as given.

        Args:
            seen: what is known at frame 0.
            given: frame 0; its later frames are not looked at.
            path: R at the 64 generated frames, metres.
        """
        guess = given.pose[:, :1].expand(-1, path.shape[1], -1, -1)
        tokens = self.into(self._normalised(guess, path)) + self.told(seen.told)[:, None] + self.time
        moved = self.out(self.attention(tokens))
        pose = guess + self.scale.pose_std * moved[..., 3:].unflatten(-1, guess.shape[2:])
        trajectory = path + self.scale.trajectory_std * moved[..., :3]
        return given.first.continued(trajectory, pose - pose[:, :, self.scale.root, None])

    def _normalised(self, guess: Tensor, path: Tensor) -> Tensor:
        """Pose, place and velocity of every frame in units of their deviations."""
        pose = ((guess - self.scale.pose_mean) / self.scale.pose_std).flatten(2)
        velocity = path.diff(dim=1, prepend=torch.zeros_like(path[:, :1])) / self.scale.speed_limit
        return torch.cat([path / self.scale.trajectory_std, velocity, pose], dim=-1)


def time_code(frames: int, channels: int) -> Float[Tensor, "t c"]:
    """Sines and cosines of each frame's number, at wavelengths from 6 frames up (Vaswani et al., 2017, 3.5)."""
    rates = torch.exp(-math.log(10_000.0) * torch.arange(0, channels, 2) / channels)
    angles = torch.arange(frames)[:, None] * rates
    return torch.stack([angles.sin(), angles.cos()], dim=-1).flatten(1)
