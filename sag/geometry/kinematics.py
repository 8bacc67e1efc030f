"""Rotations of a body's parts and the two-bone limb; every array may carry leading axes, such as frames.

A person's own frame has x forward, y to the left and z up.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

STRAIGHT = 0.995
"""The largest share of its length that a limb is stretched to: knees and elbows keep a slight bend."""

FOLDED = 0.15
"""The smallest share of its length that a limb is folded to."""


def rotation(
    yaw: Float[np.ndarray, "*frames"],
    pitch: Float[np.ndarray, "*frames"] | float = 0.0,
    roll: Float[np.ndarray, "*frames"] | float = 0.0,
) -> Float[np.ndarray, "*frames 3 3"]:
    """Rotation from a body part's own frame to the frame that it stands in.

    Args:
        yaw: turn to the left, radians, applied last.
        pitch: lean forward, radians.
        roll: lean to the right, radians, applied first.
    """
    cy, sy, cp, sp, cr, sr = (f(a) for a in np.broadcast_arrays(yaw, pitch, roll) for f in (np.cos, np.sin))
    rows = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def turned(rotations: Float[np.ndarray, "... 3 3"], vectors: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "... 3"]:
    """The vectors after the rotations."""
    return (rotations @ vectors[..., None])[..., 0]


def unit(vectors: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "... 3"]:
    """The vectors at length 1; a zero vector stays zero."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)


def two_bone(
    start: Float[np.ndarray, "... 3"],
    end: Float[np.ndarray, "... 3"],
    upper: float,
    lower: float,
    pole: Float[np.ndarray, "... 3"],
) -> tuple[Float[np.ndarray, "... 3"], Float[np.ndarray, "... 3"]]:
    """The middle joint and the end of a limb that reaches from `start` for `end` (metres).

    An end out of reach is brought to the nearest reachable point on the line from the start, so both
    bones always keep their lengths.

    Args:
        start: hip or shoulder.
        end: where the ankle or wrist should be.
        upper: length of the bone at the start, metres.
        lower: length of the bone at the end, metres.
        pole: the direction that the middle joint points to, of any length; not along the limb.
    """
    way = end - start
    asked = np.linalg.norm(way, axis=-1, keepdims=True)
    along = way / np.maximum(asked, 1e-9)
    span = np.clip(asked, max(FOLDED * (upper + lower), abs(upper - lower)), STRAIGHT * (upper + lower))
    foot = (upper**2 - lower**2 + span**2) / (2 * span)
    height = np.sqrt(np.maximum(upper**2 - foot**2, 0.0))
    aside = unit(pole - (pole * along).sum(axis=-1, keepdims=True) * along)
    return start + along * foot + aside * height, start + along * span


def reachable_height(
    start: Float[np.ndarray, "... 3"], end: Float[np.ndarray, "... 3"], length: float
) -> Float[np.ndarray, "*frames"]:
    """Largest height (metres, z up) at which `start` may be so that a limb of this length still reaches `end`.

    Where no height will do, because the two are farther apart than the limb is long when seen from
    above, it is the height of the end.
    """
    aside = ((start - end)[..., :2] ** 2).sum(axis=-1)
    return end[..., 2] + np.sqrt(np.maximum((STRAIGHT * length) ** 2 - aside, 0.0))
