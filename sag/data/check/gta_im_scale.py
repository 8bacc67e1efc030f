"""Whether the numbers of GTA-IM's recordings agree: joints, cameras, ids and depth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sag.data.check.bodies import bones_line
from sag.data.check.gta_im_recording import GtaImFindings, Look
from sag.data.check.report import Line, graded

PROJECTION = (1e-3, 0.5)
"""Pixels between projected and published joints that are rounding, and beyond which one of them is wrong."""

ON_PERSON = (0.8, 0.5)
"""Shares of the visible joints on the person's ids that are usual, and below which ids and joints do not agree."""

SKIN = (0.0, 0.2)
"""Usual way from the skin to the joint behind it, metres."""


def scale_lines(readable: Sequence[GtaImFindings]) -> tuple[Line, ...]:
    """Lines on projection, ids, bones and depth.

    Args:
        readable: recordings that could be read.
    """
    looks = [look for found in readable for look in found.looks]
    bones = bones_line([(found.folder.name, found.bones) for found in readable if found.bones is not None])
    return _projection(readable), _ids(looks), bones, *_depth(looks)


def _projection(readable: Sequence[GtaImFindings]) -> Line:
    told = [(found.projection, found) for found in readable if found.projection is not None]
    if not told:
        return Line("projection", "no recording has joints_2d to compare with", "look")
    error, worst = max(told, key=lambda pair: pair[0])
    frames = sum(len(found.recording or ()) for _, found in told)
    value = f"world joints, seen by their frame's camera, land within {error:.1e} px of joints_2d in {frames:,} frames"
    where = (f"the worst: {worst.folder.name}",) * (error > PROJECTION[0])
    return Line("projection", value, graded(error, *PROJECTION), where)


def _ids(looks: Sequence[Look]) -> Line:
    visible, on_person = sum(look.visible for look in looks), sum(look.on_person for look in looks)
    if not visible:
        return Line("ids", "no decoded picture shows a joint", "look")
    share = on_person / visible
    value = f"{share:.1%} of {visible:,} visible joints lie on the person's ids"
    return Line("ids", value, graded(-share, -ON_PERSON[0], -ON_PERSON[1]))


def _depth(looks: Sequence[Look]) -> list[Line]:
    near, far = np.array([look.depth for look in looks]).reshape(-1, 2).T
    if not np.isfinite(near).any():
        return [Line("depth", "no decoded picture has any", "look")]
    plausible = 0.2 < np.nanmedian(near) < np.nanmedian(far) < 300
    value = f"{np.nanmin(near):.2f} to {np.nanmax(far):.1f} m, the nearest and the farthest hundredth left out"
    lines = [Line("depth", value, "ok" if plausible else "look")]
    gaps = [look.gap for look in looks if np.isfinite(look.gap)]
    if gaps:
        gap = float(np.median(gaps))
        said = f"visible joints lie {100 * gap:.1f} cm behind the skin"
        lines.append(Line("skin", said, "ok" if SKIN[0] <= gap <= SKIN[1] else "look"))
    return lines
