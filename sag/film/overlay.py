"""Motions running in the picture that was given."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from sag.errors import SagError
from sag.film.canvas import Canvas
from sag.film.eye import Eye
from sag.film.place import PlaceView
from sag.film.stage import Stage

WAY_RADIUS = 0.012
"""Of the root's way over the floor, metres."""

SHADOW_RADIUS = 0.5
"""Of the shadow of a limb, in its own radius: a film on the floor."""


def overlay_frames(stage: Stage, columns: int = 960, every: int = 1) -> Iterator[UInt8[np.ndarray, "h w 3"]]:
    """The picture with all samples running in it, their shadows and the ways of their roots on the floor.

    What is behind the surfaces that the picture's depth shows is faint, where that depth was measured.

    Args:
        stage: with a picture.
        columns: of what is drawn, at most; its rows and columns are even, as films want them.
        every: so many frames of the motion make one of the film.

    Raises:
        SagError: the picture is not known.
    """
    eye, picture = picture_eye(stage, columns)
    hiding = measured_depth(stage, eye)
    for frame in range(0, stage.frames, every):
        yield as_bytes(with_bodies(stage, eye, picture, frame, hiding))


def picture_eye(stage: Stage, columns: int) -> tuple[Eye, Float[np.ndarray, "h w 3"]]:
    """The camera of the picture and the picture itself, colours in [0, 1], in so many columns at most.

    Raises:
        SagError: the picture is not known.
    """
    if stage.picture is None or stage.intrinsics is None:
        raise SagError("the picture of these motions is not known; name their data set by --reference, or give --orbit")
    rows, wide = stage.picture.shape[:2]
    share = min(1.0, columns / wide)
    size = (max(2, round(rows * share / 2) * 2), max(2, round(wide * share / 2) * 2))
    scale = np.array([[size[1] / wide], [size[0] / rows], [1.0]])
    resized = Image.fromarray(stage.picture).resize(size[::-1], Image.Resampling.LANCZOS)
    return Eye.of_picture(stage.intrinsics * scale, size), np.asarray(resized) / 255


def measured_depth(stage: Stage, eye: Eye) -> Float[np.ndarray, "h w"] | None:
    """Planar z of what stands in the place, metres, infinite where nothing is known; None where it would be a guess."""
    return PlaceView(stage).depth(eye) if stage.measured else None


def with_bodies(
    stage: Stage,
    eye: Eye,
    picture: Float[np.ndarray, "h w 3"],
    frame: int,
    hiding: Float[np.ndarray, "h w"] | None = None,
) -> Float[np.ndarray, "h w 3"]:
    """A picture with the bodies of one frame in it.

    Args:
        stage: the motions.
        eye: what sees them.
        picture: what it sees besides, colours in [0, 1].
        frame: of the motions.
        hiding: planar depth of what stands there, metres.
    """
    ground, bodies = Canvas(eye, stage.up), Canvas(eye, stage.up)
    for number, motion in enumerate(stage.motions):
        add_shadow(ground, stage, motion[frame])
        _add_way(bodies, stage, number, frame)
        bodies.add(*stage.capsules(motion[frame]), stage.colour(number))
    return bodies.laid_over(ground.shadowed(picture, blur=eye.size[1] / 240, hiding=hiding), hiding)


def add_shadow(canvas: Canvas, stage: Stage, joints: Float[np.ndarray, "j 3"]) -> None:
    """Lays a body flat on the floor."""
    starts, ends, radii = stage.capsules(joints)
    canvas.add(stage.on_floor(starts), stage.on_floor(ends), SHADOW_RADIUS * radii, np.zeros(3))


def _add_way(canvas: Canvas, stage: Stage, number: int, frame: int) -> None:
    """The root's way over the floor until a frame."""
    way = stage.on_floor(stage.roots[number, : frame + 1])
    if len(way) > 1:
        canvas.add(way[:-1], way[1:], np.full((len(way) - 1, 2), WAY_RADIUS), stage.colour(number))


def as_bytes(colours: Float[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "h w 3"]:
    """Colours in [0, 1] as films and files hold them."""
    return np.rint(colours.clip(0, 1) * 255).astype(np.uint8)
