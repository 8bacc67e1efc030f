"""The floor of Motion FID: one half of the real motions against the other; ours, not the paper's."""

from __future__ import annotations

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.metrics.fid.clips import ClipEncoders, ClipFeatures, picked
from sag.metrics.fid.motion_fid import MotionFID, motion_fid_of_features

_AT_ONCE = 256
"""Motions whose features are held at a time."""


def motion_fid_floor(
    encoders: ClipEncoders, joints: Float[Tensor, "b t j 3"], sequence: Int[Tensor, " b"], root: int
) -> dict[str, Tensor]:
    """Motion FID between two halves of the real motions: what a perfect generator could reach.

    Halves are made of whole sequences, every other one, since the windows of one sequence overlap; the larger half
    is thinned to the number of the smaller. They hold half as many motions as the set, so the floor of the whole set
    lies a little lower.

    Args:
        encoders: see `ClipEncoders`.
        joints: 65 frames, metres, camera frame of frame 0.
        sequence: the recording of each motion.
        root: place of the root joint.

    Raises:
        SagError: fewer than two sequences.

    Example:
        >>> import torch
        >>> from sag.metrics import motion_fid_floor
        >>> from sag.models.erd import MotionEncoders
        >>> motions = torch.randn(16, 65, 19, 3, generator=torch.manual_seed(0))
        >>> sequence = torch.arange(4).repeat_interleave(4)
        >>> floor = motion_fid_floor(MotionEncoders("gta_im_19", width=0.01), motions, sequence, root=12)
        >>> bool(floor["average"] > 0)
        True
    """
    metric = MotionFID(encoders, root)
    for half, real in zip(_halves(sequence), (True, False)):
        for chunk in joints[half].split(_AT_ONCE):
            metric.update(chunk, real=real)
    return metric.compute()


def motion_fid_floor_of_features(features: ClipFeatures, sequence: Int[Tensor, " b"]) -> dict[str, Tensor]:
    """The floor of Motion FID of features that `clip_features` made of real motions; see `motion_fid_floor`.

    Args:
        features: of real motions.
        sequence: the recording of each motion.

    Raises:
        SagError: fewer than two sequences.

    Example:
        >>> import torch
        >>> features = {(16, length): torch.randn(8, 64 // length, 4) for length in (2, 4, 8, 16, 32, 64)}
        >>> floor = motion_fid_floor_of_features(features, sequence=torch.arange(8) // 2)
        >>> sorted(floor)
        ['average', 'long', 'mid', 'short']
    """
    first, second = _halves(sequence)
    return motion_fid_of_features(picked(features, first), picked(features, second))


def _halves(sequence: Int[Tensor, " b"]) -> list[Int[Tensor, " n"]]:
    """Places of the motions of every other sequence and of the others, equally many."""
    rank = torch.unique(sequence, return_inverse=True)[1]
    if not len(rank) or rank.max() < 1:
        raise SagError("the floor of Motion FID needs real motions of at least 2 sequences to split them in halves")
    halves = [(rank % 2 == half).nonzero().flatten() for half in (0, 1)]
    size = min(len(half) for half in halves)
    return [half[torch.arange(size, device=half.device) * len(half) // size] for half in halves]
