"""Windows of a folder of one's own: which can be used, and what the cache stores of them."""

from __future__ import annotations

from collections import Counter

import numpy as np
from jaxtyping import Bool, Float

from sag.data.folder.recording import Recording
from sag.data.recordings.body import BEHIND_SKIN, NOTHING, PERSON, body_depth, unhidden
from sag.data.recordings.filters import NO_PICTURE, ROOT_JUMPS, root_jumps
from sag.data.recordings.starts import starts_in
from sag.data.recordings.views import Picture, WindowFormat, window_arrays
from sag.types import FRAMES


def events(recording: Recording, form: WindowFormat) -> Counter[str]:
    """How often the root of a recording jumps."""
    return Counter({ROOT_JUMPS: len(root_jumps(recording.joints[:, form.root_place], form.limits))})


def usable_starts(recording: Recording, stride: int, form: WindowFormat) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what; see `starts_in`."""
    return starts_in(recording, stride, form, _picture_fault)


def _picture_fault(recording: Recording, start: int) -> str | None:
    """The reason against the pictures of a frame, if there is one."""
    return None if start in recording.pictures.complete else NO_PICTURE


def stored_window(
    recording: Recording, start: int, form: WindowFormat, with_cloud: bool
) -> dict[str, np.ndarray] | None:
    """The cache's arrays of one window by name; nothing when the person is hidden at its start.

    Args:
        recording: the recording.
        start: frame where the window starts.
        form: how windows are stored.
        with_cloud: whether the cloud is wanted as well.

    Raises:
        SagError: a picture of the start frame cannot be read.
    """
    joints = recording.seen_from(start, slice(start, start + FRAMES))
    colour, depth = recording.pictures.colour(start), recording.pictures.depth(start)
    person = person_in(recording, start, joints[0], depth)
    if person is None:
        return None
    picture = Picture(colour, depth, np.where(person, PERSON, NOTHING), recording.intrinsics[start])
    return window_arrays(picture, PERSON, joints, recording.world2cam[start], form, picture if with_cloud else None)


def person_in(
    recording: Recording, frame: int, joints: Float[np.ndarray, "j 3"], depth: Float[np.ndarray, "h w"]
) -> Bool[np.ndarray, "h w"] | None:
    """Where the person is in a frame: as its picture tells, or else where capsules around the bones are not hidden.

    Args:
        recording: the recording.
        frame: one that has pictures.
        joints: of this frame, metres, its camera's frame.
        depth: planar z of this frame, metres.

    Returns:
        Nothing where no pixel of the capsules is the person's.

    Raises:
        SagError: the picture of the person cannot be read.
    """
    body = body_depth(joints, recording.skeleton, recording.intrinsics[frame], recording.size)
    told = recording.pictures.person(frame)
    person = unhidden(body, depth, BEHIND_SKIN) if told is None else told
    return person if (person & np.isfinite(body)).any() else None
