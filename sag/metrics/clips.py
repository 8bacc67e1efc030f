"""Clips: how Motion FID cuts a motion, and what it needs of the encoders that look at the pieces (paper, 4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor

from sag.types import GENERATED

LENGTHS = (2, 4, 8, 16, 32, 64)
"""Frames of the clips that a motion is cut into."""

GROUPS = {"short": (2, 4), "mid": (8, 16), "long": (32, 64)}
"""Clip lengths whose distances are averaged under one name."""


@runtime_checkable
class ClipEncoders(Protocol):
    """What Motion FID needs of its encoders; `sag.models.erd.MotionEncoders` has it.

    Attributes:
        frames: training length that names each encoder, (16, 32, 64) in the paper.
        joints: joints that a frame must have.
        dimension: size of a feature.
    """

    frames: tuple[int, ...]
    joints: int
    dimension: int

    def features(self, clips: Tensor, lengths: Sequence[int]) -> dict[tuple[int, int], Tensor]:
        """Features (n, dimension) of the first `length` frames of clips, by (encoder, length).

        Args:
            clips: (n, frames, joints, 3), metres, relative to the root of the clip's first frame.
            lengths: where to read.
        """
        ...

    def to(self, device: torch.device) -> Any:
        """Moves the encoders."""
        ...


def clips_by_longest(joints: Float[Tensor, "b t j 3"], root: int) -> dict[int, Float[Tensor, "n l j 3"]]:
    """The disjoint clips of motions: each start once, as long as the longest clip that starts there.

    Shorter clips from the same start are prefixes, so one pass over these 224 frames a motion reads the
    features of all clips, which are 384 frames long together.

    Args:
        joints: the 64 generated frames, metres.
        root: place of the root joint; a clip is relative to the root of its first frame.
    """
    found = {}
    for length in LENGTHS:
        whole = length == GENERATED
        starts = range(0, 1) if whole else range(length, GENERATED, 2 * length)
        clips = torch.stack([joints[:, start : start + length] for start in starts], dim=1).flatten(0, 1)
        found[length] = clips - clips[:, :1, root : root + 1]
    return found
