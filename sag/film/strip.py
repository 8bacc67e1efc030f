"""Several poses of a motion in one picture, coloured by time: the paper's way to show motion (Figures 1, 4, 8)."""

from __future__ import annotations

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from sag.film.canvas import Canvas
from sag.film.colours import time_colour
from sag.film.overlay import add_shadow, as_bytes, measured_depth, picture_eye
from sag.film.stage import Stage

POSES = 6
"""Of a motion in a picture, the first and the last among them."""


def strip(stage: Stage, columns: int, poses: int = POSES) -> UInt8[np.ndarray, "h w 3"]:
    """The picture with poses of all samples at equal times, from dark to bright.

    What is behind the surface of the stage is faint, where it has one and its depth was measured.

    Args:
        stage: with a picture.
        columns: of what is drawn, at most.
        poses: of each sample.

    Raises:
        SagError: the picture is not known.
    """
    eye, picture = picture_eye(stage, columns)
    hiding = measured_depth(stage, eye)
    ground, bodies = Canvas(eye, stage.up), Canvas(eye, stage.up)
    for frame in np.linspace(0, stage.frames - 1, poses).round().astype(int).tolist():
        for motion in stage.motions:
            add_shadow(ground, stage, motion[frame])
            bodies.add(*stage.capsules(motion[frame]), time_colour(frame / max(1, stage.frames - 1)))
    return as_bytes(bodies.laid_over(ground.shadowed(picture, blur=eye.size[1] / 240, hiding=hiding), hiding))


def side_by_side(pictures: list[UInt8[np.ndarray, "h w 3"]], columns: int, gap: int = 4) -> Image.Image:
    """Pictures in a row with white between them, each cut to 16:9 about its middle and of so many columns."""
    rows = round(columns * 9 / 16)
    whole = Image.new("RGB", (len(pictures) * (columns + gap) - gap, rows), "white")
    for place, picture in enumerate(pictures):
        high, wide = picture.shape[:2]
        scale = min(wide / 16, high / 9)
        left, top = (wide - 16 * scale) / 2, (high - 9 * scale) / 2
        box = (left, top, left + 16 * scale, top + 9 * scale)
        cut = Image.fromarray(picture).resize((columns, rows), Image.Resampling.LANCZOS, box)
        whole.paste(cut, (place * (columns + gap), 0))
    return whole
