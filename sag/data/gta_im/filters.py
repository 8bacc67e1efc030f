"""Which windows of a GTA-IM recording can be used, and why the others cannot."""

from __future__ import annotations

from collections import Counter

import numpy as np

from sag.data.gta_im.cameras import camera_cuts, camera_zooms
from sag.data.gta_im.recording import Recording
from sag.data.recordings.filters import (
    NO_CLIPS,
    NO_PICTURE,
    ROOT_JUMPS,
    faultless_starts,
    jumps_in,
    motion_fault,
    root_jumps,
)
from sag.data.recordings.views import WindowFormat
from sag.types import FRAMES


def events(recording: Recording, form: WindowFormat) -> Counter[str]:
    """What happens in a recording that windows must cope with: how often its root jumps, its camera cuts and zooms.

    A cut or zoom drops no window: all of it is seen through the camera of its first frame.
    """
    cuts = camera_cuts(recording.world2cam, recording.intrinsics)
    zooms = camera_zooms(recording.intrinsics, cuts)
    jumps = root_jumps(recording.joints[:, form.root_place], form.limits)
    return Counter({"root jumps": len(jumps), "camera cuts": len(cuts), "camera zooms": len(zooms)})


def usable_starts(recording: Recording, stride: int, form: WindowFormat) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what.

    Args:
        recording: a recording.
        stride: frames from one window to the next.
        form: how windows are stored, and what they must keep to.
    """
    jumps = root_jumps(recording.joints[:, form.root_place], form.limits)
    return faultless_starts(len(recording), stride, lambda start: _fault(recording, start, jumps, form))


def _fault(recording: Recording, start: int, jumps: list[int], form: WindowFormat) -> str | None:
    """The first reason against the window that starts at a frame."""
    if start not in recording.pictured:
        return NO_PICTURE
    if not np.isfinite(recording.clips[start]).all():
        return NO_CLIPS
    if jumps_in(jumps, start):
        return ROOT_JUMPS
    joints = recording.seen_from(start, slice(start, start + FRAMES))[:, form.joints]
    return motion_fault(joints, form.root, recording.intrinsics[start], recording.size, form.limits)
