"""Which windows of a PROX recording can be used, and why the others cannot."""

from __future__ import annotations

from collections import Counter

import numpy as np
from jaxtyping import Bool

from sag.data.prox.recording import Recording
from sag.data.recordings.filters import (
    JOINT_BEHIND,
    NO_PICTURE,
    ROOT_JUMPS,
    ROOT_OUTSIDE,
    faultless_starts,
    inside_picture,
    pixels_of,
    root_jumps,
)
from sag.data.recordings.views import WindowFormat
from sag.types import FRAMES

NO_BODY = "no fit or skeleton in one of the frames"
PAUSE = "pauses between frames"

LONGEST_PAUSE = 0.1
"""From one frame to the next, seconds: two or more frames of the nominal 30 a second are missing."""


def usable_starts(recording: Recording, stride: int, form: WindowFormat) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what.

    Args:
        recording: a recording.
        stride: frames from one window to the next.
        form: how windows are stored, and what they must keep to.
    """
    frames, steps = _faulty_frames(recording, form), _faulty_steps(recording, form)
    pictured = recording.measured if recording.scan is None else np.ones(len(recording), bool)

    def fault(start: int) -> str | None:
        if not pictured[start]:
            return NO_PICTURE
        found = [reason for reason, faulty in frames.items() if faulty[start : start + FRAMES].any()]
        found += [reason for reason, faulty in steps.items() if faulty[start : start + FRAMES - 1].any()]
        return found[0] if found else None

    return faultless_starts(len(recording), stride, fault)


def events(recording: Recording, form: WindowFormat) -> Counter[str]:
    """What happens in a recording that windows must cope with, and how often."""
    return Counter({reason: int(faulty.sum()) for reason, faulty in _faulty_steps(recording, form).items()})


def _faulty_frames(recording: Recording, form: WindowFormat) -> dict[str, Bool[np.ndarray, " t"]]:
    """For each reason the frames that a window must not hold; the camera does not move, so they have no start."""
    joints = recording.joints[:, form.joints]
    bodies = np.isfinite(joints).all(axis=(1, 2))
    roots = np.where(bodies[:, None], joints[:, form.root], 1.0)
    return {
        NO_BODY: ~bodies,
        JOINT_BEHIND: (joints[..., 2] < form.limits.nearest_joint).any(axis=1),
        ROOT_OUTSIDE: ~inside_picture(pixels_of(roots, recording.intrinsics), *recording.size),
    }


def _faulty_steps(recording: Recording, form: WindowFormat) -> dict[str, Bool[np.ndarray, " n"]]:
    """For each reason the frames after which a window must not go on."""
    pauses = np.diff(recording.seconds) > LONGEST_PAUSE
    jumps = np.zeros_like(pauses)
    jumps[root_jumps(recording.joints[:, form.root_place], form.limits)] = True
    return {PAUSE: pauses, ROOT_JUMPS: jumps}
