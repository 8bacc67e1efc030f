"""Motions longer than a window: any method, window after window (paper, 6.2)."""

from __future__ import annotations

from dataclasses import replace

import torch
from jaxtyping import Float
from torch import Generator, Tensor

from sag.errors import SagError
from sag.geometry.crossfade import crossfaded
from sag.geometry.panning import in_picture, offset_to, panned
from sag.methods.base import Method
from sag.types import FRAMES, Batch, Motion

LONGEST_OVERLAP = 32
"""Frames that two windows may share; more than half a window, and three would meet."""


def window_starts(frames: int, overlap: int) -> list[int]:
    """The frame at which each window of a long motion begins, its given one; after the first, those are the seams.

    Args:
        frames: of the whole motion.
        overlap: frames that two neighbours share, the given one included.

    Raises:
        SagError: less than one window, or an overlap that is not within 1 .. 32.
    """
    if frames < FRAMES:
        raise SagError(f"a long motion was asked for with {frames} frames; one window alone has {FRAMES}")
    if not 1 <= overlap <= LONGEST_OVERLAP:
        raise SagError(f"windows were asked to share {overlap} frames; choose an overlap of 1 to {LONGEST_OVERLAP}")
    return list(range(0, frames - overlap, FRAMES - overlap))


def sample_long(
    method: Method, batch: Batch, frames: int, overlap: int = 8, generator: Generator | None = None
) -> Float[Tensor, "b t j 3"]:
    """Motions of any length, drawn window after window by a method that knows 65 frames (paper, 6.2).

    The paper names a sliding window and no more; what follows is ours. The first window is what the method draws. Each
    further one begins `overlap` frames before the end of what is there: the pose of that frame is given, and the scene
    is the picture of frame 0, moved by whole pixels until the root of that frame is at its centre, as the method has
    it in training. No other picture is known: what the move uncovers is black and has depth 0, and the person is
    seen where frame 0 had them. Where the root leaves the picture or comes behind the camera, the picture follows no
    further and the last cut stays.

    Over the frames that two windows share, the one passes into the other (`sag.geometry.crossfade`): place and
    velocity of root and limbs are continuous there, and bones turn rather than shrink. Beyond them a window is as it
    was drawn, moved by as much as its root was at first held to the velocity of the one before; since the next window
    begins where the root then truly is, and looks there, such moves do not add up unseen. With an overlap of 1 nothing
    is mixed, and the next window begins at the last frame: the plain way, whose seams can be seen.

    Args:
        method: what draws; only `sample` is used, which sees frame 0 and nothing after it.
        batch: windows whose frame 0 is continued; clouds and cameras stay those of frame 0.
        frames: of the whole motion, frame 0 included.
        overlap: frames that two windows share.
        generator: of the noise of all windows, in their order.

    Returns:
        Joints, metres, camera frame of frame 0.

    Raises:
        SagError: less than one window, an overlap that is not within 1 .. 32, or a method that does not continue the
            frame it is given.
    """
    starts = window_starts(frames, overlap)
    skeleton = method.skeleton
    joints = _window(method, batch, generator)
    offset = torch.zeros(len(batch), 2, dtype=torch.long, device=joints.device)
    for start in starts[1:]:
        given = Motion.from_joints(joints[:, start : start + 1], skeleton.root_index)
        followed = in_picture(batch.scene, given.start)
        offset = torch.where(followed[:, None], offset_to(batch.scene, given.start), offset)
        drawn = _window(method, replace(batch, motion=given, scene=panned(batch.scene, offset)), generator)
        further = crossfaded(joints[:, start:], drawn, skeleton.bone_index, skeleton.root_index)
        joints = torch.cat([joints[:, :start], further], dim=1)
    return joints[:, :frames]


def _window(method: Method, batch: Batch, generator: Generator | None) -> Float[Tensor, "b 65 j 3"]:
    """One window of a method that draws from frame 0, as it must."""
    joints = method.sample(batch, generator).joints
    given = batch.motion.joints[:, 0]
    if joints.shape[1] != FRAMES or not torch.allclose(joints[:, 0], given, atol=1e-3):
        raise SagError(f"{type(method).__name__} cannot go on beyond its window: it does not draw from a given frame")
    return joints
