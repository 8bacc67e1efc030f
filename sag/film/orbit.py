"""Motions in their place, seen by an eye that swings around them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, UInt8

from sag.film.eye import Eye
from sag.film.overlay import as_bytes, with_bodies
from sag.film.place import PlaceView
from sag.film.stage import Stage

SWING = np.radians(38)
"""How far the eye goes to either side of where the picture was taken from: beyond, there is nothing to be seen."""

RISE = np.radians(24)
"""How far it looks down."""

LENS = np.radians(42)
"""Angle from the lowest row to the highest."""

MARGIN = 1.25
"""What fits into the view, in sizes of all that moves."""

LEAST = 1.3
"""Half of the least height that fits, metres: a person who stands."""


def orbit_frames(
    stage: Stage, size: tuple[int, int] = (540, 960), every: int = 1
) -> Iterator[UInt8[np.ndarray, "h w 3"]]:
    """All samples in their place, from an eye that swings once to either side and comes back.

    Args:
        stage: the motions; a place whose surface is not known is a grid on the floor.
        size: rows and columns, even.
        every: so many frames of the motion make one of the film.
    """
    place = PlaceView(stage)
    for frame in range(0, stage.frames, every):
        eye = orbit_eye(stage, size, SWING * np.sin(2 * np.pi * frame / stage.frames))
        seen = place.seen_by(eye)
        yield as_bytes(with_bodies(stage, eye, seen.colour, frame, seen.depth if stage.measured else None))


def orbit_eye(stage: Stage, size: tuple[int, int], angle: float) -> Eye:
    """An eye to one side of the camera that sees all samples from their first frame to their last.

    Args:
        stage: the motions.
        size: rows and columns.
        angle: about the vertical, radians; 0 is the side from which the picture was taken.
    """
    joints = stage.motions.reshape(-1, 3)
    low, high = np.quantile(joints, 0.01, axis=0), np.quantile(joints, 0.99, axis=0)
    middle = (low + high) / 2
    reach = max(LEAST, float(np.quantile(np.linalg.norm(joints - middle, axis=1), 0.99)))
    away = MARGIN * reach / np.sin(LENS / 2)
    right, back = stage.upright.rotation[0], stage.upright.rotation[2]
    aside = np.sin(angle) * right + np.cos(angle) * back
    return Eye.looking_at(middle, middle + away * _raised(aside, stage.up), stage.up, size, LENS)


def _raised(aside: Float[np.ndarray, " 3"], up: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    return np.cos(RISE) * aside + np.sin(RISE) * up
