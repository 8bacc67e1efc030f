"""Whether bodies, pictures and scans of PROX agree: the usual mistakes are of mirrored pictures and of cameras."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sag.data.check.report import Line, graded
from sag.data.check.sights import Sight, sight_lines
from sag.data.prox.person import mask_of
from sag.data.prox.recording import Recording
from sag.data.prox.views import measured_depth, read_unmirrored
from sag.data.recordings.filters import inside_picture, pixels_of
from sag.skeleton import PROX_16

BEFORE_SCAN = (0.9, 0.5)
"""Shares of the joints before the scan that are usual, and below which the camera is not where the scan has it."""

SLACK = 0.2
"""How far behind the scan a joint may lie (metres): people sink into sofas, and scans and fits are not exact."""


@dataclass(frozen=True)
class Look:
    """What a frame shows.

    Attributes:
        sight: of the person; nothing where there is no body.
        before: share of the joints in the picture that lie before the scan; not a number without a scan.
    """

    sight: Sight | None
    before: float


def look_at(recording: Recording, frame: int) -> Look:
    """Decodes the pictures of a frame that training would read.

    Raises:
        SagError: one of them is damaged or of another size.
    """
    read_unmirrored(recording, frame)  # for what is broken in it alone
    measured = measured_depth(recording, frame)
    person = mask_of(recording.folder, recording.frames[frame].stem, recording.size, measured)
    joints = recording.joints[frame]
    if not np.isfinite(joints).all():
        return Look(None, np.nan)
    pixels = pixels_of(joints, recording.intrinsics)
    inside = inside_picture(pixels, *recording.size) & (joints[:, 2] > 0)
    columns, rows = pixels[inside].astype(int).T
    seen, depth = measured.depth[rows, columns], joints[inside, 2]
    on_person = np.nan if person is None or not len(rows) else float(person[rows, columns].mean())
    sight = Sight(float(inside.mean()), (depth - seen)[seen > 0], on_person, _height(recording, frame))
    if recording.scan is None or not len(rows):
        return Look(sight, np.nan)
    scan = recording.scan[rows, columns]
    return Look(sight, float(((scan == 0) | (depth < scan + SLACK)).mean()))


def _height(recording: Recording, frame: int) -> float:
    """Of the root over the lower ankle, metres, along the scan's z."""
    cam2world = np.linalg.inv(recording.world2cam)
    heights = recording.joints[frame] @ cam2world[2, :3]
    return float(heights[PROX_16.root_index] - heights[PROX_16.index("left_ankle", "right_ankle")].min())


def look_lines(looks: Sequence[Look]) -> list[Line]:
    """Lines on the world's axes, cameras, the person and the scan.

    Args:
        looks: at all decoded frames.
    """
    lines = sight_lines([look.sight for look in looks if look.sight is not None])
    shares = [look.before for look in looks if np.isfinite(look.before)]
    if shares:
        share = float(np.mean(shares))
        said = f"{share:.0%} of the joints in the picture are before the scan"
        lines.append(Line("scan", said, graded(-share, -BEFORE_SCAN[0], -BEFORE_SCAN[1])))
    return lines
