"""Pictures of a room and a person: Lambert light with hard shadows, planar depth and instance ids."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8, UInt16

from sag.data.cache import DEPTH_UNIT, PERSON
from sag.data.rays import SKIN, RayScene, dot
from sag.data.rooms.cameras import Camera
from sag.data.rooms.surfaces import Surfaces

AMBIENT, DIFFUSE = 0.46, 0.72
"""Light from everywhere and light from the lamp."""

SMALL = 144
"""Pictures of fewer rows are drawn with four rays for each pixel's colour."""


@dataclass(frozen=True)
class Solids:
    """Surfaces and the rays that meet them."""

    surfaces: Surfaces
    rays: RayScene

    @classmethod
    def of(cls, surfaces: Surfaces) -> Solids:
        """Surfaces made ready for rays."""
        return cls(surfaces, RayScene(surfaces.triangles))


@dataclass(frozen=True)
class Stand:
    """What is in front of the camera at the moment of the picture.

    Attributes:
        room: everything that does not move.
        person: the body.
        light: place of the lamp, metres, world frame.
    """

    room: Solids
    person: Solids
    light: Float[np.ndarray, " 3"]


class Picture(NamedTuple):
    """A rendered view.

    Attributes:
        image: colours.
        depth: planar z in steps of `DEPTH_UNIT`.
        ids: of the pieces; PERSON where the person stands.
    """

    image: UInt8[np.ndarray, "h w 3"]
    depth: UInt16[np.ndarray, "h w"]
    ids: UInt8[np.ndarray, "h w"]


class View:
    """The rays through a picture's pixels.

    Args:
        camera: gives place and frame.
        intrinsics: of the picture.
        size: its rows and columns.
        fine: rays for each pixel along either side.

    Attributes:
        eye: where the rays begin, metres, world frame.
        directions: world frame, of length 1 along the camera's axis, so that they are scaled by planar depth.
    """

    def __init__(self, camera: Camera, intrinsics: np.ndarray, size: tuple[int, int], fine: int = 1) -> None:
        self.eye = camera.place.astype(np.float32)
        self._camera = camera
        rows, columns = ((np.arange(n * fine) + 0.5) / fine for n in size)
        self._x = ((columns - intrinsics[0, 2]) / intrinsics[0, 0]).astype(np.float32)
        self._y = ((rows - intrinsics[1, 2]) / intrinsics[1, 1]).astype(np.float32)
        right, down, ahead = camera.turn.astype(np.float32)
        grid = self._x[None, :, None] * right + (self._y[:, None, None] * down + ahead)
        self.directions: Float[np.ndarray, "n 3"] = grid.reshape(-1, 3)

    def around(self, points: Float[np.ndarray, "*any 3"]) -> Int[np.ndarray, " k"]:
        """Numbers of the rays inside the upright rectangle around points (metres, world frame)."""
        local = self._camera.to_camera(points.reshape(-1, 3))
        if local[:, 2].min() < 0.1:
            return np.arange(len(self.directions))
        low, high = ((local[:, :2] / local[:, 2:]).min(axis=0), (local[:, :2] / local[:, 2:]).max(axis=0))
        columns, rows = (
            np.flatnonzero((axis >= low[i]) & (axis <= high[i])) for i, axis in enumerate((self._x, self._y))
        )
        return (rows[:, None] * len(self._x) + columns).ravel()


def render(stand: Stand, camera: Camera, intrinsics: Float[np.ndarray, "3 3"], size: tuple[int, int]) -> Picture:
    """A picture of the person in the room, of `size` rows and columns."""
    fine = 2 if size[0] < SMALL else 1
    colours, depth, ids = _traced(stand, View(camera, intrinsics, size, fine))
    if fine > 1:
        colours = colours.reshape(size[0], fine, size[1], fine, 3).mean(axis=(1, 3))
        depth, ids = _sampled(stand, View(camera, intrinsics, size))
    image = np.rint(255 * colours.clip(0, 1)).astype(np.uint8)
    return Picture(image.reshape(*size, 3), to_steps(depth).reshape(size), ids.reshape(size))


def to_steps(depth: Float[np.ndarray, "*any"]) -> UInt16[np.ndarray, "*any"]:
    """Depth (metres) as it is stored; what is too far away is unknown."""
    steps = np.rint(np.where(np.isfinite(depth), depth, 0) / DEPTH_UNIT)
    return np.where(steps < 65536, steps, 0).astype(np.uint16)


def _sampled(stand: Stand, view: View) -> tuple[np.ndarray, np.ndarray]:
    """Depth (metres) and ids along rays."""
    behind = stand.room.rays.cast(view.eye, view.directions)
    depth, ids = behind.distance, stand.room.surfaces.id_of(behind.triangle)
    near = view.around(stand.person.surfaces.triangles)
    before = stand.person.rays.distance(view.eye, view.directions[near])
    nearer = before < depth[near]
    depth[near[nearer]] = before[nearer]
    ids[near[nearer]] = PERSON
    return depth, ids


def _traced(stand: Stand, view: View) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours, depth (metres) and ids along rays."""
    behind = stand.room.rays.cast(view.eye, view.directions)
    near = view.around(stand.person.surfaces.triangles)
    before = stand.person.rays.cast(view.eye, view.directions[near])
    covers = np.flatnonzero(before.distance < behind.distance[near])
    body = near[covers]
    depth, normal, ids = behind.distance, behind.normal, stand.room.surfaces.id_of(behind.triangle)
    depth[body], normal[body], ids[body] = before.distance[covers], before.normal[covers], PERSON
    points = view.eye + view.directions * depth[:, None]
    colours = stand.room.surfaces.colours(behind.triangle, points)
    colours[body] = stand.person.surfaces.colours(before.triangle[covers], points[body])
    colours *= brightness(points, normal, stand)[:, None]
    return colours, depth, ids


def brightness(points: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "n 3"], stand: Stand) -> np.ndarray:
    """How bright surfaces are: even light and a lamp that casts shadows."""
    light = stand.light.astype(np.float32)
    way = light - points
    far = np.sqrt(dot(way, way))
    facing = dot(normal, way) / far
    lit = np.flatnonzero(facing > 0)
    start = points[lit] + SKIN * normal[lit]
    hidden = stand.room.rays.hidden(start, light) | stand.person.rays.hidden(start, light)
    lamp = np.zeros(len(points), np.float32)
    seen = lit[~hidden]
    lamp[seen] = facing[seen] / (1 + 0.04 * far[seen] ** 2)
    # Light that floor and walls throw back brightens the ceiling, which the lamp leaves dark.
    even = AMBIENT + normal @ np.array([0.05, 0.025, 0.07], np.float32) + 0.32 * (normal[:, 2] < -0.95)
    return even + DIFFUSE * lamp


def cloud_depth(
    stand: Stand, camera: Camera, intrinsics: np.ndarray, size: tuple[int, int]
) -> UInt16[np.ndarray, "h w"]:
    """Depth of the room as a sensor sees it past the person, whose pixels and their neighbours are unknown."""
    view = View(camera, intrinsics, size)
    depth = stand.room.rays.distance(view.eye, view.directions)
    near = view.around(stand.person.surfaces.triangles)
    before = stand.person.rays.distance(view.eye, view.directions[near])
    covered = np.zeros(len(depth), bool)
    covered[near] = before < depth[near]
    return np.where(_widened(covered.reshape(size)), 0, to_steps(depth).reshape(size)).astype(np.uint16)


def _widened(mask: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """The mask and all pixels that touch it, corners included."""
    tall = mask.copy()
    tall[1:] |= mask[:-1]
    tall[:-1] |= mask[1:]
    wide = tall.copy()
    wide[:, 1:] |= tall[:, :-1]
    wide[:, :-1] |= tall[:, 1:]
    return wide
