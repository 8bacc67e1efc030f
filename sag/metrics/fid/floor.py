"""The floor of Motion FID: halves of the real motions against each other; ours, not the paper's."""

from __future__ import annotations

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.metrics.fid.clips import ClipEncoders, ClipFeatures, clip_features, motions_of, picked
from sag.metrics.fid.motion_fid import motion_fid_of_features
from sag.metrics.fid.resampling import places_of_groups
from sag.metrics.halves import random_halves


def motion_fid_floor(
    encoders: ClipEncoders,
    joints: Float[Tensor, "b t j 3"],
    group: Int[Tensor, " b"],
    root: int,
    splits: int = 8,
    seed: int = 0,
) -> dict[str, Tensor]:
    """Motion FID between two halves of the real motions, the mean over random splits. Ours.

    floor = mean over splits s of F(half 0 of s, half 1 of s)

    It says how far real motions of some groups are from those of others, and how much of a figure comes from there
    being so few. Halves are made of whole groups, see `random_halves`. They hold half as many motions as the set, and
    the part of a Fréchet distance that comes from the number N goes as 1/N: a comparison of all N motions has a floor
    of about half of this.

    Reacts to how few motions and groups there are, and to how groups differ. Blind to what all groups share.

    Memory: the features of all motions, 189 d numbers each. Time: 18 distances a split, see `motion_fid_interval`.

    Args:
        encoders: see `ClipEncoders`.
        joints: 65 frames, metres, camera frame of frame 0.
        group: of each motion its recording or, better, its room: whatever does not share people, places or cameras.
        root: place of the root joint.
        splits: random splits to average.
        seed: of the splits.

    Raises:
        SagError: fewer than two groups, no group for each motion, or motions that Motion FID refuses.

    Example:
        >>> import torch
        >>> from sag.metrics import motion_fid_floor
        >>> from sag.models.erd import MotionEncoders
        >>> motions = torch.randn(16, 65, 19, 3, generator=torch.manual_seed(0))
        >>> room = torch.arange(4).repeat_interleave(4)
        >>> floor = motion_fid_floor(MotionEncoders("gta_im_19", width=0.01), motions, room, root=12, splits=2)
        >>> bool(floor["average"] > 0)
        True
    """
    return motion_fid_floor_of_features(clip_features(encoders, joints, root), group, splits, seed)


def motion_fid_floor_of_features(
    features: ClipFeatures, group: Int[Tensor, " b"], splits: int = 8, seed: int = 0
) -> dict[str, Tensor]:
    """The floor of Motion FID of features that `clip_features` made of real motions; see `motion_fid_floor`.

    Args:
        features: of real motions.
        group: of each motion its recording or, better, its room: whatever does not share people, places or cameras.
        splits: random splits to average.
        seed: of the splits.

    Raises:
        SagError: fewer than two groups, no group for each motion, or fewer than two motions in a half.

    Example:
        >>> import torch
        >>> features = {(16, length): torch.randn(8, 64 // length, 4) for length in (2, 4, 8, 16, 32, 64)}
        >>> floor = motion_fid_floor_of_features(features, group=torch.arange(8) // 2)
        >>> sorted(floor)
        ['average', 'long', 'mid', 'short']
    """
    place = places_of_groups("the floor of Motion FID", group, motions_of(features))
    halves = random_halves(place, splits, seed).to(next(iter(features.values())).device)
    found = [motion_fid_of_features(picked(features, side == 0), picked(features, side == 1)) for side in halves]
    return {name: torch.stack([each[name] for each in found]).mean() for name in found[0]}
