"""What a generator's motion goes through before anybody sees it (ours; the paper leaves joints and frames free)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import comb
from typing import Literal

import numpy as np
import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn

from sag.errors import SagError
from sag.models.generators import MotionGenerator
from sag.skeleton import Skeleton
from sag.types import FRAMES, Condition, Motion

Bones = Literal["free", "kept"]

SHORTEST = 1e-4
"""Metres; a drawn bone that is shorter keeps its direction but not its length, so that gradients stay finite."""


class FinishedGenerator(MotionGenerator):
    """Another generator's motions after some finishing, through which it is trained.

    Args:
        generator: draws the motions.
        finishes: modules from `Motion` to `Motion`, in their order; frame 0 passes them as it is.
    """

    def __init__(self, generator: MotionGenerator, finishes: Iterable[nn.Module]) -> None:
        super().__init__()
        self.generator = generator
        self.finishes = nn.Sequential(*finishes)

    def noise(self, count: int, generator: Generator | None = None) -> tuple[Tensor, ...]:
        """Noise of the generator within."""
        return self.generator.noise(count, generator)

    def forward(self, condition: Condition, given: Motion, noise: tuple[Tensor, ...]) -> Motion:
        """The finished motions."""
        return self.finishes(self.generator(condition, given, noise))


class Smooth(nn.Module):
    """Motions as means over neighbouring frames, weighted by a binomial window.

    Towards both ends the window grows narrow, so the first and the last frame stay and no frame is drawn to one side:
    whoever walks evenly still does. A window of 4 frames to either side lets three quarters of a swing of 2.5 Hz
    pass at 30 frames a second, a tenth of one of 7 Hz.

    Args:
        reach: frames to either side.

    Raises:
        SagError: there are fewer than none, or as many as a motion has.
    """

    weights: Tensor

    def __init__(self, reach: int) -> None:
        super().__init__()
        if not 0 <= reach < FRAMES:
            raise SagError(f"model.init_args.network.smooth is {reach}; it must be 0, for none, to {FRAMES - 1} frames")
        self.register_buffer("weights", torch.tensor(_windows(reach), dtype=torch.float32), persistent=False)

    def forward(self, motion: Motion) -> Motion:
        """R and P over their 65 frames."""
        weights = self.weights.to(motion.pose.dtype)
        trajectory = torch.matmul(weights, motion.trajectory)
        pose = torch.matmul(weights, motion.pose.flatten(2)).view_as(motion.pose)
        return replace(motion, trajectory=trajectory, pose=pose)


class KeptBones(nn.Module):
    """Motions whose bones point where they did and are as long as in frame 0.

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

    def forward(self, motion: Motion) -> Motion:
        """P at the lengths of frame 0."""
        drawn = motion.pose[:, :, self.ends] - motion.pose[:, :, self.starts]
        spans = drawn.norm(dim=-1, keepdim=True)
        bones = spans[:, :1] * drawn / spans.clamp_min(SHORTEST)
        pose = torch.matmul(self.ways.to(drawn.dtype), bones[:, 1:])
        return motion.first.continued(motion.trajectory[:, 1:], pose)


def _ways(skeleton: Skeleton) -> Float[np.ndarray, "j bones"]:
    """Which bones lie on the way from the root to each joint."""
    ways = np.zeros((len(skeleton.joints), len(skeleton.bones)))
    for place, (start, end) in enumerate(skeleton.bone_index):
        ways[end] = ways[start]
        ways[end, place] = 1
    return ways


def _windows(reach: int) -> Float[np.ndarray, "t t"]:
    """The share of each frame (column) in each smoothed one (row)."""
    windows = np.zeros((FRAMES, FRAMES))
    for frame in range(FRAMES):
        near = min(reach, frame, FRAMES - 1 - frame)
        for step in range(-near, near + 1):
            windows[frame, frame + step] = comb(2 * near, near + step) / 4**near
    return windows
