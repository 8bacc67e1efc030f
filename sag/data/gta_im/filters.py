"""Which windows of a GTA-IM recording can be used, and why the others cannot."""

from __future__ import annotations

from collections import Counter

import numpy as np

from sag.data.gta_im.cameras import camera_cuts, camera_zooms
from sag.data.gta_im.recording import Recording
from sag.data.recordings.filters import NO_CLIPS, NO_PICTURE, root_jumps
from sag.data.recordings.starts import starts_in
from sag.data.recordings.views import WindowFormat


def events(recording: Recording, form: WindowFormat) -> Counter[str]:
    """What happens in a recording that windows must cope with: how often its root jumps, its camera cuts and zooms.

    A cut or zoom drops no window: all of it is seen through the camera of its first frame.
    """
    cuts = camera_cuts(recording.world2cam, recording.intrinsics)
    zooms = camera_zooms(recording.intrinsics, cuts)
    jumps = root_jumps(recording.joints[:, form.root_place], form.limits)
    return Counter({"root jumps": len(jumps), "camera cuts": len(cuts), "camera zooms": len(zooms)})


def usable_starts(recording: Recording, stride: int, form: WindowFormat) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what; see `starts_in`."""
    return starts_in(recording, stride, form, _picture_fault)


def _picture_fault(recording: Recording, start: int) -> str | None:
    """The first reason against the pictures of a frame."""
    if start not in recording.pictured:
        return NO_PICTURE
    return None if np.isfinite(recording.clips[start]).all() else NO_CLIPS
