"""What the cache stores of one window of GTA-IM."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from sag.data.gta_im.recording import Recording
from sag.data.recordings.filters import inside_picture, pixels_of
from sag.data.recordings.views import Picture, WindowFormat, window_arrays
from sag.types import FRAMES

BEFORE_JOINT = 0.3
"""How far the visible skin may lie in front of its joint, metres."""

BEHIND_JOINT = 0.1
"""How far the visible skin may lie behind its joint, metres."""


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
    picture = recording.picture(start)
    joints = recording.seen_from(start, slice(start, start + FRAMES))
    person = person_id(picture, joints[0])
    if person is None:
        return None
    return window_arrays(picture, person, joints, recording.world2cam[start].T, form, picture if with_cloud else None)


def person_id(picture: Picture, joints: Float[np.ndarray, "j 3"]) -> int | None:
    """The id that most of the visible joints lie on; nothing when none is visible.

    Args:
        picture: a frame.
        joints: joints of the same frame, metres, its camera's frame.
    """
    pixels = pixels_of(joints, picture.intrinsics)
    inside = inside_picture(pixels, *picture.depth.shape)
    columns, rows = pixels[inside].astype(int).T
    before = joints[inside, 2] - picture.depth[rows, columns]
    ids = picture.ids[rows, columns][(before < BEFORE_JOINT) & (before > -BEHIND_JOINT)]
    values, counts = np.unique(ids[ids > 0], return_counts=True)
    return int(values[counts.argmax()]) if len(values) else None
