"""What decoded frames show of the person, and whether joints, cameras and depth agree in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.data.check.report import Line, graded

IN_PICTURE = (0.5, 0.1)
"""Shares of the joints in the picture that are usual, and below which the camera is not that of the motion."""

SKIN = (0.3, 1.0)
"""Ways between joints and what the depth sees there (metres) that are usual, and beyond which units differ."""

ON_PERSON = (0.7, 0.3)
"""Shares of the joints on the person's pixels that are usual, and below which they are not the person's."""

STANDING = (-0.4, 0.2)
"""Heights of the root over the lower ankle (metres) as of people upside down, and as of people upright."""


@dataclass(frozen=True)
class Sight:
    """What one frame shows.

    Attributes:
        inside: share of the joints in the picture.
        gaps: from what the depth sees to the joint behind it, for each joint in the picture, metres.
        on_person: share of them on the person's pixels; not a number where no picture tells them.
        height: of the root over the lower ankle, metres, along the world's z.
    """

    inside: float
    gaps: Float[np.ndarray, " n"]
    on_person: float
    height: float


def sight_lines(sights: Sequence[Sight]) -> list[Line]:
    """Lines on the world's axes, cameras, depth and person.

    Args:
        sights: of all decoded frames.
    """
    if not sights:
        return []
    height, inside = (float(np.median([getattr(sight, name) for sight in sights])) for name in ("height", "inside"))
    gaps = np.concatenate([sight.gaps for sight in sights])
    told = [sight.on_person for sight in sights if np.isfinite(sight.on_person)]
    upright, framed = graded(-height, -STANDING[1], -STANDING[0]), graded(-inside, -IN_PICTURE[0], -IN_PICTURE[1])
    lines = [
        Line("world", f"the root is {height:.2f} m over the lower ankle, along z", upright),
        Line("camera", f"{inside:.0%} of the joints are in the picture", framed),
    ]
    if gaps.size:
        gap = float(np.median(gaps))
        said = f"joints are {100 * gap:.0f} cm behind what is seen there"
        lines.append(Line("depth", said, graded(abs(gap), *SKIN)))
    if told:
        share = float(np.mean(told))
        said = f"{share:.0%} of the joints in the picture are on the person"
        lines.append(Line("on person", said, graded(-share, -ON_PERSON[0], -ON_PERSON[1])))
    return lines
