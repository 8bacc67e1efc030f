"""A canvas for bodies: what is nearest in every pixel, and how it is laid over a picture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter

from sag.data.rays import pixel_rays
from sag.film.colours import lit
from sag.film.eye import Eye
from sag.film.solids import rounded_cone
from sag.geometry.capsule import footprints
from sag.geometry.kinematics import unit

SHARPER = 2
"""Rows and columns that are drawn for each of the picture, so that edges are smooth."""

NEAREST = 0.1
"""Nothing is drawn nearer to the eye than this, metres."""

BEHIND = 0.35
"""How much is seen of what stands behind something."""

SLACK = 0.06
"""Metres by which a body must be behind a surface to count as hidden: surfaces are no better than their depth."""

DARK = 0.42
"""How much light a shadow takes away."""

SUN = np.array([-0.55, 0, -0.75])
"""Whence the light comes besides from above: from the left behind the eye, in the eye's frame."""


class Solid(NamedTuple):
    """A capsule whose ends may differ in size: places in the eye's frame and radii, metres, and its colour."""

    start: Float[np.ndarray, " 3"]
    end: Float[np.ndarray, " 3"]
    start_radius: float
    end_radius: float
    colour: Float[np.ndarray, " 3"]


class Drawn(NamedTuple):
    """The part of a picture in which there are solids, in fine pixels.

    Attributes:
        part: rows and columns of the picture.
        depth: planar z, metres, infinite where there is nothing.
        normal: outward, of any length, in the eye's frame.
        albedo: own colours in [0, 1].
        rays: directions from the eye, of length 1.
    """

    part: tuple[slice, slice]
    depth: Float[np.ndarray, "r c"]
    normal: Float[np.ndarray, "r c 3"]
    albedo: Float[np.ndarray, "r c 3"]
    rays: Float[np.ndarray, "r c 3"]


class Canvas:
    """Solids as one eye sees them; the nearest are seen.

    Args:
        eye: where they are seen from.
        up: against gravity, camera frame of frame 0.
    """

    def __init__(self, eye: Eye, up: Float[np.ndarray, " 3"]) -> None:
        self.eye, self.up, self.fine = eye, up, eye.scaled(SHARPER)
        self.solids: list[Solid] = []

    def add(
        self,
        starts: Float[np.ndarray, "m 3"],
        ends: Float[np.ndarray, "m 3"],
        radii: Float[np.ndarray, "m 2"],
        colour: Float[np.ndarray, " 3"],
    ) -> None:
        """Adds capsules whose ends may differ in size; what comes too near to the eye is left out.

        Args:
            starts: metres, camera frame of frame 0.
            ends: metres, camera frame of frame 0.
            radii: of their starts and ends, metres.
            colour: red, green, blue in [0, 1].
        """
        for start, end, (first, last) in zip(self.eye.seen(starts), self.eye.seen(ends), radii.tolist()):
            if min(start[2] - first, end[2] - last) > NEAREST:
                self.solids.append(Solid(start, end, first, last, colour))

    def laid_over(
        self,
        picture: Float[np.ndarray, "h w 3"],
        hiding: Float[np.ndarray, "h w"] | None = None,
    ) -> Float[np.ndarray, "h w 3"]:
        """The picture with the solids in it, lit; colours in [0, 1].

        Args:
            picture: colours in [0, 1].
            hiding: planar depth of what stands in the picture, metres; solids behind it are faint.
        """
        drawn = self._drawn()
        if drawn is None:
            return picture
        there = np.isfinite(drawn.depth)
        up = self.eye.turn @ self.up
        colour = np.zeros_like(drawn.albedo)
        colour[there] = lit(drawn.albedo[there], unit(drawn.normal[there]), drawn.rays[there], up, unit(up + unit(SUN)))
        cover = np.where(_hidden(drawn, hiding), BEHIND, 1.0) * there
        covered = _coarse(cover[..., None])
        made = picture.copy()
        made[drawn.part] = picture[drawn.part] * (1 - covered) + _coarse(colour * cover[..., None])
        return made

    def shadowed(
        self, picture: Float[np.ndarray, "h w 3"], blur: float, hiding: Float[np.ndarray, "h w"] | None = None
    ) -> Float[np.ndarray, "h w 3"]:
        """The picture darker where there are solids, with soft edges.

        Args:
            picture: colours in [0, 1].
            blur: of the edges, pixels.
            hiding: planar depth of what stands in the picture, metres; nothing is dark behind it.
        """
        margin = int(4 * blur) + 1
        drawn = self._drawn(margin)
        if drawn is None:
            return picture
        there = np.isfinite(drawn.depth) & ~_hidden(drawn, hiding)
        dark = gaussian_filter(_coarse(there[..., None].astype(float))[..., 0], blur)
        made = picture.copy()
        made[drawn.part] *= 1 - DARK * dark[..., None]
        return made

    def _drawn(self, margin: int = 0) -> Drawn | None:
        """What is nearest in every pixel of the part that has solids, and some more around it."""
        boxes = self._boxes()
        inside = boxes[(boxes[:, 1] > boxes[:, 0]) & (boxes[:, 3] > boxes[:, 2])]
        if not len(inside):
            return None
        low, high = inside[:, [0, 2]].min(axis=0), inside[:, [1, 3]].max(axis=0)
        top, left = (low // SHARPER - margin).clip(0).tolist()
        bottom, right = (-(-high // SHARPER) + margin).clip(0, self.eye.size).tolist()
        part = slice(top, bottom), slice(left, right)
        shape = SHARPER * (bottom - top), SHARPER * (right - left)
        ways = pixel_rays(self.fine.intrinsics, (SHARPER * top, SHARPER * bottom), (SHARPER * left, SHARPER * right))
        drawn = Drawn(
            part, np.full(shape, np.inf), np.zeros((*shape, 3)), np.zeros((*shape, 3)), unit(ways).reshape(*shape, 3)
        )
        for solid, box in zip(self.solids, boxes - SHARPER * np.array([top, top, left, left])):
            _draw(drawn, solid, box.clip(0).tolist())
        return drawn

    def _boxes(self) -> np.ndarray:
        """(m, 4) fine rows, then columns, outside which no pixel can see a solid."""
        boxes = np.zeros((len(self.solids), 4), int)
        radii = np.array([max(solid.start_radius, solid.end_radius) for solid in self.solids])
        classes = 2.0 ** np.ceil(np.log2(radii))  # one radius bounds many, so that few calls do
        for radius in np.unique(classes).tolist():
            members = np.flatnonzero(classes == radius)
            starts, ends = (torch.from_numpy(np.stack([self.solids[one][end] for one in members])) for end in (0, 1))
            matrix = torch.from_numpy(self.fine.intrinsics)
            boxes[members] = footprints(starts, ends, radius, matrix, self.fine.size).numpy()
        return boxes


def _draw(drawn: Drawn, solid: Solid, box: list[int]) -> None:
    """Draws a solid where it is nearer than what is there."""
    top, bottom, left, right = box
    part = slice(top, bottom), slice(left, right)
    rays = drawn.rays[part]
    if not rays.size:
        return
    met = rounded_cone(rays.reshape(-1, 3), *solid[:4])
    depth = met.distance.reshape(rays.shape[:2]) * rays[..., 2]
    nearer = depth < drawn.depth[part]
    drawn.depth[part][nearer] = depth[nearer]
    drawn.normal[part][nearer] = met.normal.reshape(rays.shape)[nearer]
    drawn.albedo[part][nearer] = solid.colour


def _hidden(drawn: Drawn, hiding: Float[np.ndarray, "h w"] | None) -> Bool[np.ndarray, "r c"]:
    """Where what is drawn stands behind what the picture shows."""
    if hiding is None:
        return np.zeros(drawn.depth.shape, bool)
    return drawn.depth > hiding[drawn.part].repeat(SHARPER, 0).repeat(SHARPER, 1) + SLACK


def _coarse(values: Float[np.ndarray, "r c k"]) -> Float[np.ndarray, "h w k"]:
    """Mean over the fine pixels of each of the picture."""
    rows, columns, count = values.shape
    return values.reshape(rows // SHARPER, SHARPER, columns // SHARPER, SHARPER, count).mean(axis=(1, 3))
