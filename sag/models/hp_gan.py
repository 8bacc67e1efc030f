"""HP-GAN's networks: a recurrent generator from sequence to sequence and a fully connected critic.

Barsoum, Kender and Liu, "HP-GAN: Probabilistic 3D human motion prediction via GAN", CVPR workshops 2018; sizes
are those of its public code.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn

from sag.models.generators import MotionGenerator
from sag.models.scale import MotionScale
from sag.types import FRAMES, GENERATED, Condition, Motion

NOISE_LIMIT = 0.1
"""Noise is uniform between minus this and this."""

DEVIATION = 1e-3
"""Of the truncated normal that the generator's matrices start from."""


@dataclass(frozen=True)
class HPGANSizes:
    """Widths; the defaults are the published ones.

    Attributes:
        embedding: of a frame on its way into a recurrent layer, and into the critic.
        noise: numbers of noise for a motion.
        memory: of each of the two recurrent layers of encoder and decoder.
        critic: of the critic's three hidden layers.
    """

    embedding: int = 128
    noise: int = 128
    memory: int = 1024
    critic: int = 512


class HPGANGenerator(MotionGenerator):
    """Frame 0 and the scene feature become a memory, noise is added to it, and 64 frames are read off it.

    Each step of the decoder is fed with what it made in the step before; frames are z-scored joints
    relative to the start of the motion, the root included.

    Args:
        joints: joints of the skeleton.
        feature: length of f.
        sizes: widths.
        scale: units.
    """

    def __init__(self, joints: int, feature: int, sizes: HPGANSizes, scale: MotionScale) -> None:
        super().__init__()
        self.scale = scale
        self.sizes = sizes
        self.embed = nn.Linear(3 * joints + feature, sizes.embedding)
        self.encoder = nn.GRU(sizes.embedding, sizes.memory, num_layers=2, batch_first=True)
        self.mix = nn.ModuleList(nn.Linear(sizes.noise, sizes.memory, bias=False) for _ in range(2))
        self.feed = nn.Linear(sizes.memory, sizes.embedding, bias=False)
        self.decoder = nn.GRU(sizes.embedding, sizes.memory, num_layers=2, batch_first=True)
        self.out = nn.Linear(sizes.memory, 3 * joints)
        for layer in (self.embed, *self.mix, self.feed, self.out):
            nn.init.trunc_normal_(layer.weight, std=DEVIATION, a=-2 * DEVIATION, b=2 * DEVIATION)
        nn.init.zeros_(self.embed.bias)
        nn.init.zeros_(self.out.bias)

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """Uniform noise, one vector for each motion."""
        unit = torch.rand(count, self.sizes.noise, generator=generator, device=self.out.weight.device)
        return (NOISE_LIMIT * (2 * unit - 1),)

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """Encodes the one frame that is given, then decodes 64."""
        seen = self.embed(torch.cat([condition.initial_pose, condition.feature], dim=1))
        output, memory = self.encoder(seen[:, None])
        memory = memory + torch.stack([mix(noise[0]) for mix in self.mix])
        outputs = []
        for _ in range(GENERATED):
            output, memory = self.decoder(self.feed(output), memory)
            outputs.append(output)
        return self.scale.continued(given, self.out(torch.cat(outputs, dim=1)))


class HPGANCriticNetwork(nn.Module):
    """Frames are embedded one by one and judged together.

    Args:
        joints: joints of the skeleton.
        feature: length of f.
        sizes: widths.
    """

    def __init__(self, joints: int, feature: int, sizes: HPGANSizes) -> None:
        super().__init__()
        self.embed = nn.Linear(3 * joints, sizes.embedding, bias=False)
        widths = (FRAMES * sizes.embedding + feature, *[sizes.critic] * 3)
        hidden = [layer for a, b in itertools.pairwise(widths) for layer in (nn.Linear(a, b), nn.ReLU())]
        self.judge = nn.Sequential(*hidden, nn.Linear(sizes.critic, 1))

    def forward(self, x: Float[Tensor, "b 65 c"], condition: Float[Tensor, "b f"]) -> Float[Tensor, " b"]:
        """Scores, higher for what looks real; the condition stands beside the embedded frames."""
        return self.judge(torch.cat([self.embed(x).flatten(1), condition], dim=1))[:, 0]
