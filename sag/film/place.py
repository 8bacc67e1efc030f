"""The place around people as an eye sees it: its surface by rays, and a grid on the floor where nothing is known."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from sag.data.rays import RayScene
from sag.film.eye import Eye
from sag.film.stage import Stage

SKY, GROUND = np.array([0.93, 0.94, 0.96]), np.array([0.76, 0.79, 0.83])
"""Colours of nothing, above and below."""

LEAST_RISE = -1e-3
"""A direction that falls less than this (sine) never meets the floor."""

PATCH = 0.02
"""Half the width of the widest holes of the surface that are filled, as a share of the picture's."""

LINE, LINE_WIDTH = np.array([0.60, 0.64, 0.70]), 0.012
"""Colour of the grid on the floor, and half the width of its lines in metres; they are a metre apart."""

REACH = 7.0
"""Metres from the start at which the grid has faded away."""


class Seen(NamedTuple):
    """A place as an eye sees it.

    Attributes:
        colour: in [0, 1].
        depth: planar z, metres, infinite where nothing is known.
    """

    colour: Float[np.ndarray, "h w 3"]
    depth: Float[np.ndarray, "h w"]


class PlaceView:
    """The place of a stage, to be looked at from anywhere.

    Surfaces are seen from the side from which the camera saw them and not from behind, so that no wall hides a room.

    Args:
        stage: with its surface, if it has one.
    """

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.triangles = None if stage.surface is None else stage.surface.points[stage.surface.triangles]
        if self.triangles is not None:
            corner, one, other = np.moveaxis(self.triangles, 1, 0)
            self.normals = np.cross(one - corner, other - corner)
            toward = -np.sign((self.normals * corner).sum(axis=1, keepdims=True))
            self.normals *= np.where(toward == 0, 1, toward)

    def depth(self, eye: Eye) -> Float[np.ndarray, "h w"]:
        """Planar z of the surface, metres, infinite where there is none."""
        if self.triangles is None:
            return np.full(eye.size, np.inf)
        directions = (eye.rays @ eye.turn).reshape(-1, 3)
        return self._facing(eye).distance(eye.place, directions).reshape(eye.size).astype(float)

    def seen_by(self, eye: Eye) -> Seen:
        """Colours and depth, a grid on the floor and the sky where the surface is not."""
        directions = (eye.rays @ eye.turn).reshape(-1, 3)
        if self.triangles is None:
            return Seen(self._empty(eye, directions).reshape(*eye.size, 3), np.full(eye.size, np.inf))
        depth = self._facing(eye).distance(eye.place, directions).astype(float)
        met, colour = np.isfinite(depth), np.zeros(directions.shape)
        colour[~met] = self._empty(eye, directions[~met])
        colour[met] = self._painted(eye.place + directions[met] * depth[met, None])
        return Seen(_patched(colour.reshape(*eye.size, 3), met.reshape(eye.size)), depth.reshape(eye.size))

    def _facing(self, eye: Eye) -> RayScene:
        """The triangles that an eye sees from the front."""
        assert self.triangles is not None
        front = ((eye.place - self.triangles[:, 0]) * self.normals).sum(axis=1) > 0
        return RayScene(self.triangles[front])

    def _painted(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Colours of points of the surface, which are those of the picture where the camera saw them."""
        stage = self.stage
        assert stage.surface is not None and stage.intrinsics is not None
        picture = stage.surface.picture
        seen = points @ stage.intrinsics.T
        across = (seen[:, :2] / seen[:, 2:]).astype(int).clip(0, np.array(picture.shape[1::-1]) - 1)
        return picture[across[:, 1], across[:, 0]] / 255

    def _empty(self, eye: Eye, directions: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Sky and floor."""
        stage, up = self.stage, self.stage.up
        rise = directions @ up / np.sqrt(np.einsum("nd,nd->n", directions, directions))
        share = np.clip(0.5 + 1.5 * rise, 0, 1)[:, None]
        colour = GROUND * (1 - share) + SKY * share
        below = np.flatnonzero(rise < LEAST_RISE)
        ways = directions[below]
        far = -float((eye.place - stage.upright.origin) @ up) / (ways @ up)
        place = (eye.place + ways * far[:, None] - stage.upright.origin) @ stage.upright.rotation[[0, 2]].T
        off = np.abs(place - np.round(place)).min(axis=1)
        width = LINE_WIDTH + 0.6 * np.abs(far) / eye.intrinsics[0, 0]  # never thinner than a pixel
        near = np.clip(1 - np.hypot(*place.T) / REACH, 0, 1)
        line = np.clip(1.5 - off / width, 0, 1) * near * np.minimum(1, 3 * LINE_WIDTH / width) * (far > 0)
        colour[below] += (LINE - colour[below]) * line[:, None]
        return colour


def _patched(colour: Float[np.ndarray, "h w 3"], met: Bool[np.ndarray, "h w"]) -> Float[np.ndarray, "h w 3"]:
    """Holes of the surface filled with what is next to them: where widening it and narrowing it again leaves some."""
    if met.all() or not met.any():
        return colour
    reach = PATCH * met.shape[1]
    away, (row, column) = distance_transform_edt(~met, return_indices=True)
    hole = ~met & (distance_transform_edt(np.pad(away <= reach, 1, mode="edge"))[1:-1, 1:-1] > reach)
    return np.where(hole[..., None], colour[row, column], colour)
