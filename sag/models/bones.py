"""Bones that keep their lengths, whatever a generator draws (ours; the paper leaves joints free)."""

from __future__ import annotations

from typing import Literal

import numpy as np
import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn

from sag.models.generators import MotionGenerator
from sag.skeleton import Skeleton
from sag.types import Condition, Motion

Bones = Literal["free", "kept"]

SHORTEST = 1e-4
"""Metres; a drawn bone that is shorter keeps its direction but not its length, so that gradients stay finite."""


class KeptBones(nn.Module):
    """Poses whose bones point where they did and are as long as in frame 0.

    From the root outwards each joint moves along its own bone, and what hangs on it moves along.

    Args:
        skeleton: joints and bones.
    """

    starts: Tensor
    ends: Tensor
    ways: Tensor

    def __init__(self, skeleton: Skeleton) -> None:
        super().__init__()
        starts, ends = torch.as_tensor(skeleton.bone_index).T
        self.register_buffer("starts", starts, persistent=False)
        self.register_buffer("ends", ends, persistent=False)
        self.register_buffer("ways", torch.tensor(_ways(skeleton), dtype=torch.float32), persistent=False)

    def forward(self, pose: Float[Tensor, "b t j 3"], first: Float[Tensor, "b j 3"]) -> Float[Tensor, "b t j 3"]:
        """The poses (metres, root at zero) with the bone lengths of `first` (metres)."""
        drawn = self._bones(pose)
        lengths = self._bones(first).norm(dim=-1)[:, None, :, None]
        bones = lengths * drawn / drawn.norm(dim=-1, keepdim=True).clamp_min(SHORTEST)
        return torch.matmul(self.ways.to(pose.dtype), bones)

    def _bones(self, joints: Float[Tensor, "*frames j 3"]) -> Float[Tensor, "*frames bones 3"]:
        return joints[..., self.ends, :] - joints[..., self.starts, :]


class KeptBonesGenerator(MotionGenerator):
    """Another generator's motions with the bone lengths of frame 0.

    Args:
        generator: draws the motions.
        skeleton: joints and bones.
    """

    def __init__(self, generator: MotionGenerator, skeleton: Skeleton) -> None:
        super().__init__()
        self.generator = generator
        self.bones = KeptBones(skeleton)

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """Noise of the generator within."""
        return self.generator.noise(count, generator)

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """R as drawn, P at the lengths of frame 0."""
        drawn = self.generator(condition, given, noise)
        return given.first.continued(drawn.trajectory[:, 1:], self.bones(drawn.pose[:, 1:], given.pose[:, 0]))


def _ways(skeleton: Skeleton) -> Float[np.ndarray, "j bones"]:
    """Which bones lie on the way from the root to each joint."""
    ways = np.zeros((len(skeleton.joints), len(skeleton.bones)))
    for place, (parent, child) in enumerate(skeleton.bone_index):
        ways[child] = ways[parent]
        ways[child, place] = 1
    return ways
