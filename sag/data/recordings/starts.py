"""Windows of recordings that tell the world and a camera for each frame: which can be used, and why others cannot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Protocol, TypeVar, runtime_checkable

import numpy as np
from jaxtyping import Float

from sag.data.recordings.filters import ROOT_JUMPS, faultless_starts, motion_fault, root_jumps
from sag.data.recordings.views import WindowFormat
from sag.types import FRAMES


@runtime_checkable
class Filmed(Protocol):
    """A recording whose camera may move."""

    @property
    def joints(self) -> Float[np.ndarray, "t j 3"]:
        """Metres, world frame."""

    @property
    def intrinsics(self) -> Float[np.ndarray, "t 3 3"]:
        """Camera matrices, pixels."""

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns of its pictures."""

    def __len__(self) -> int: ...

    def seen_from(self, frame: int, frames: slice) -> Float[np.ndarray, "t j 3"]:
        """Joints of some frames in the camera frame of one frame, metres."""


Recorded = TypeVar("Recorded", bound=Filmed)


def starts_in(
    recording: Recorded, stride: int, form: WindowFormat, picture_fault: Callable[[Recorded, int], str | None]
) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what.

    Args:
        recording: a recording.
        stride: frames from one window to the next.
        form: how windows are stored, and what they must keep to.
        picture_fault: the first reason against the pictures of a frame; nothing where there is none.
    """
    jumps = root_jumps(recording.joints[:, form.root_place], form.limits)

    def fault(start: int) -> str | None:
        if (reason := picture_fault(recording, start)) is not None:
            return reason
        if any(start <= jump < start + FRAMES - 1 for jump in jumps):
            return ROOT_JUMPS
        joints = recording.seen_from(start, slice(start, start + FRAMES))[:, form.joints]
        return motion_fault(joints, form.root, recording.intrinsics[start], recording.size, form.limits)

    return faultless_starts(len(recording), stride, fault)
