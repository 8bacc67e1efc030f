"""Two-Stage's networks: poses from latents, latents from a recurrent network, and a critic for each stage.

Cai, Bai, Tai and Tang, "Deep video generation, prediction and completion of human action sequences", ECCV 2018.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn

from sag.models.critics import Critic
from sag.models.generators import MotionGenerator
from sag.models.scale import MotionScale
from sag.types import GENERATED, Condition, DepthMap, Motion


@dataclass(frozen=True)
class TwoStageSizes:
    """Widths; ours, near those of the public code of Wang et al. (AAAI 2020), which generates in the same way.

    Attributes:
        latent: numbers that stand for a pose.
        noise: numbers of noise for a shift.
        pose: of the fully connected layers of the pose generator and of its critic.
        memory: of the recurrent layer of the shifts, and of each direction of their critic's.
    """

    latent: int = 12
    noise: int = 64
    pose: int = 512
    memory: int = 256


class Residual(nn.Module):
    """Two linear layers whose result is added to what they are given.

    Args:
        width: of both.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(nn.ReLU(), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, width))

    def forward(self, x: Float[Tensor, "*any c"]) -> Float[Tensor, "*any c"]:
        """The sum of both."""
        return x + self.layers(x)


def residual_network(in_channels: int, width: int, out_channels: int) -> nn.Sequential:
    """A linear layer, two residual blocks and a linear layer, without norms."""
    ends = nn.Linear(in_channels, width), nn.Linear(width, out_channels)
    return nn.Sequential(ends[0], Residual(width), Residual(width), nn.ReLU(), ends[1])


class Shifts(nn.Module):
    """From each latent and new noise to the next latent, by an LSTM that says by how much it shifts.

    Args:
        conditions: numbers of f and the initial pose together.
        sizes: widths.
    """

    def __init__(self, conditions: int, sizes: TwoStageSizes) -> None:
        super().__init__()
        self.memory = nn.LSTMCell(sizes.latent + sizes.noise + conditions, sizes.memory)
        self.out = nn.Linear(sizes.memory, sizes.latent)

    def forward(
        self, first: Float[Tensor, "b z"], noise: Float[Tensor, "b n s"], told: Float[Tensor, "b e"]
    ) -> Float[Tensor, "b n z"]:
        """Shifts in [-1, 1], each added to the latent before it; the first is added to `first`."""
        latent, state, shifts = first, None, []
        for step in noise.unbind(1):
            state = self.memory(torch.cat([latent, step, told], dim=1), state)
            shifts.append(torch.tanh(self.out(state[0])))
            latent = latent + shifts[-1]
        return torch.stack(shifts, dim=1)


class TwoStageGenerator(MotionGenerator):
    """A latent for each frame, and a generator that makes a pose of each by itself.

    A pose is the whole of X in one frame, z-scored joints relative to the start of the motion: the root is a
    joint like any other, so the trajectory too comes of latents that shift.

    Args:
        joints: joints of the skeleton.
        feature: length of f.
        sizes: widths.
        scale: units.
    """

    def __init__(self, joints: int, feature: int, sizes: TwoStageSizes, scale: MotionScale) -> None:
        super().__init__()
        self.scale = scale
        self.sizes = sizes
        conditions = feature + 3 * joints
        self.pose = residual_network(sizes.latent + conditions, sizes.pose, 3 * joints)
        self.shifts = Shifts(conditions, sizes)

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """The latent that a motion starts from, uniform in [-1, 1], and normal noise for each shift."""
        device = self.shifts.out.weight.device
        steps = torch.randn(count, GENERATED, self.sizes.noise, generator=generator, device=device)
        return self.latents(count, 1, generator)[:, 0], steps

    def latents(self, count: int, frames: int, generator: Generator | None = None) -> Float[Tensor, "count frames z"]:
        """Latents that know nothing of each other, uniform in [-1, 1]."""
        device = self.shifts.out.weight.device
        return 2 * torch.rand(count, frames, self.sizes.latent, generator=generator, device=device) - 1

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """Motions of latents that shift."""
        return self.shifted(condition, given, noise)[0]

    def shifted(
        self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]
    ) -> tuple[Motion, Float[Tensor, "b n z"]]:
        """Motions of latents that shift, and the shifts."""
        first, steps = noise
        shifts = self.shifts(first, steps, _told(condition))
        return self.posed(condition, given, first[:, None] + shifts.cumsum(dim=1)), shifts

    def posed(self, condition: Condition, given: Motion, latents: Float[Tensor, "b n z"]) -> Motion:
        """Motions of given latents, each frame by itself."""
        told = _told(condition)[:, None].expand(-1, latents.shape[1], -1)
        return self.scale.continued(given, self.pose(torch.cat([latents, told], dim=2)))


class SinglePoseCritic(Critic):
    """Two-Stage's first critic: each generated frame of X by itself, seen from the start of its motion."""

    def view(self, motion: Motion, scene: DepthMap) -> Float[Tensor, "n c"]:
        """Frames of all motions in one row, in units of their deviation."""
        return self.scale.vectors(motion)[:, 1:].flatten(0, 1)

    def forward(self, view: Float[Tensor, "n c"], condition: Condition) -> Float[Tensor, " n"]:
        """Scores of single poses, given f and the initial pose of their motions."""
        told = _told(condition)
        repeated = told.repeat_interleave(len(view) // len(told), dim=0)
        return self.network(torch.cat([view, repeated], dim=1))[:, 0]


class RecurrentCriticNetwork(nn.Module):
    """A bidirectional LSTM over all frames; what it remembers at both ends is judged.

    Args:
        joints: joints of the skeleton.
        feature: length of f.
        sizes: widths.
    """

    def __init__(self, joints: int, feature: int, sizes: TwoStageSizes) -> None:
        super().__init__()
        self.memory = nn.LSTM(3 * joints + feature, sizes.memory, batch_first=True, bidirectional=True)
        self.score = nn.Linear(2 * sizes.memory, 1)

    def forward(self, x: Float[Tensor, "b 65 c"], condition: Float[Tensor, "b f"]) -> Float[Tensor, " b"]:
        """Scores, higher for what looks real; the condition stands beside every frame."""
        seen = torch.cat([x, condition[:, None].expand(-1, x.shape[1], -1)], dim=2)
        with torch.backends.cudnn.flags(enabled=False):  # cuDNN's recurrent layers have no second derivative
            _, (last, _) = self.memory(seen)
        return self.score(last.transpose(0, 1).flatten(1))[:, 0]


def _told(condition: Condition) -> Float[Tensor, "b e"]:
    """f and the initial pose in a row."""
    return torch.cat([condition.feature, condition.initial_pose], dim=1)
