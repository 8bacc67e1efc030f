"""Clips: how Motion FID cuts a motion, and what it needs of the encoders that look at the pieces (paper, 4.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeAlias, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.types import GENERATED

LENGTHS = (2, 4, 8, 16, 32, 64)
"""Frames of the clips that a motion is cut into."""

GROUPS = {"short": (2, 4), "mid": (8, 16), "long": (32, 64)}
"""Clip lengths whose distances are averaged under one name."""

ClipFeatures: TypeAlias = dict[tuple[int, int], Float[Tensor, "_motions _clips _d"]]
"""Features by (frames the encoder was trained on, frames of the clips): motions, their clips in order of time, d."""

_AT_ONCE = 256
"""Motions that are run through the encoders together."""


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
            clips: (n, frames, joints, 3), metres, relative to the root of the clip's first frame; float32 or float64.
            lengths: where to read.
        """
        ...

    def to(self, device: torch.device) -> Any:
        """Moves the encoders."""
        ...


def clip_starts(longest: int) -> list[int]:
    """Where the clips start that are this long and no longer, frames after the given one."""
    return [0] if longest == GENERATED else list(range(longest, GENERATED, 2 * longest))


def clips_by_longest(joints: Float[Tensor, "b t j 3"], root: int) -> dict[int, Float[Tensor, "b _n _l j 3"]]:
    """The disjoint clips of motions: each start once, as long as the longest clip that starts there.

    Shorter clips from the same start are prefixes, so one pass over these 224 frames a motion reads the
    features of all clips, which are 384 frames long together.

    Args:
        joints: the 64 generated frames, metres.
        root: place of the root joint; a clip is relative to the root of its first frame.
    """
    found = {}
    for length in LENGTHS:
        clips = torch.stack([joints[:, start : start + length] for start in clip_starts(length)], dim=1)
        found[length] = clips - clips[:, :, :1, root : root + 1]
    return found


@torch.no_grad()
def clip_features(encoders: ClipEncoders, joints: Float[Tensor, "b t j 3"], root: int) -> ClipFeatures:
    """Features of all clips of motions, each start run once through the recurrent encoders and read at 2, ..., 64.

    A motion has 32, 16, 8, 4, 2 and 1 disjoint clips of 2, 4, 8, 16, 32 and 64 frames. They are prefixes of the
    longest clips from the same starts, so one pass over these gives the very features of clip by clip.

    Args:
        encoders: see `ClipEncoders`; moved to where the joints are.
        joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
        root: place of the root joint.

    Raises:
        SagError: another number of frames or joints, or a coordinate that is not finite.

    Example:
        >>> import torch
        >>> from sag.models.erd import MotionEncoders
        >>> features = clip_features(MotionEncoders("gta_im_19", width=0.01), torch.randn(5, 65, 19, 3), root=12)
        >>> len(features), features[16, 8].shape
        (18, torch.Size([5, 8, 32]))
    """
    check_joints("Motion FID", joints, encoders.joints, exact=True)
    encoders.to(joints.device)
    wide = joints.to(torch.promote_types(joints.dtype, torch.float32))
    with torch.autocast(joints.device.type, enabled=False):  # a figure must not hang on the run's precision
        parts = [_features(encoders, part[:, 1:], root) for part in wide.split(_AT_ONCE)]
    return {key: torch.cat([part[key] for part in parts]) for key in parts[0]}


def check_same_encoders(name: str, generated: ClipFeatures, real: ClipFeatures) -> None:
    """Refuses features of two sets of motions that different encoders made, or of fewer than two motions.

    Raises:
        SagError: an encoder, a clip length or the dimension differs, or there are too few motions.
    """
    if _sizes(generated) != _sizes(real):
        raise SagError(
            f"{name} was given features of different encoders; make both sides by clip_features with the same"
        )
    fewest = min(motions_of(generated), motions_of(real))
    if fewest < 2:
        raise SagError(f"{name} needs at least 2 motions of each side, it was given {fewest}")


def check_paired(name: str, generated: ClipFeatures, real: ClipFeatures) -> None:
    """Refuses features of two sets of motions that different encoders made, or that are not equally many.

    Raises:
        SagError: see `check_same_encoders`, or the number of motions differs.
    """
    check_same_encoders(name, generated, real)
    if motions_of(generated) != motions_of(real):
        raise SagError(
            f"{name} was given {motions_of(generated)} generated and {motions_of(real)} real motions, and it depends "
            "on how many they are; give equally many of both"
        )


def motions_of(features: ClipFeatures) -> int:
    """How many motions these are the features of."""
    return len(next(iter(features.values())))


def joined(parts: Sequence[ClipFeatures]) -> ClipFeatures:
    """Features of several sets of motions as one set."""
    return {key: torch.cat([part[key] for part in parts]) for key in parts[0]}


def picked(features: ClipFeatures, chosen: Tensor | slice) -> ClipFeatures:
    """The features of some of the motions, given by a mask, places or a slice."""
    return {key: found[chosen] for key, found in features.items()}


def grouped(distances: Mapping[tuple[int, int], Tensor]) -> dict[str, Tensor]:
    """Short, mid and long over encoders and two clip lengths each, and the mean of the three.

    Args:
        distances: by (frames the encoder was trained on, frames of the clips), of any one shape.
    """
    found = {
        name: torch.stack([distance for (_, length), distance in distances.items() if length in lengths]).mean(0)
        for name, lengths in GROUPS.items()
    }
    return {**found, "average": torch.stack(list(found.values())).mean(0)}


def _sizes(features: ClipFeatures) -> dict[tuple[int, int], tuple[int, ...]]:
    return {key: found.shape[1:] for key, found in features.items()}


def _features(encoders: ClipEncoders, generated: Tensor, root: int) -> ClipFeatures:
    """Features of motions that are few enough to be run together."""
    keys = [(frames, length) for frames in encoders.frames for length in LENGTHS]
    found: dict[tuple[int, int], list[Tensor]] = {key: [] for key in keys}
    starts: dict[int, list[int]] = {length: [] for length in LENGTHS}
    for longest, clips in clips_by_longest(generated, root).items():
        lengths = [length for length in LENGTHS if length <= longest]
        for key, features in encoders.features(clips.flatten(0, 1), lengths).items():
            found[key].append(features.unflatten(0, clips.shape[:2]))
        for length in lengths:
            starts[length] += clip_starts(longest)
    in_time = {length: torch.tensor(each).argsort() for length, each in starts.items()}
    return {key: torch.cat(found[key], dim=1)[:, in_time[key[1]]] for key in keys}
