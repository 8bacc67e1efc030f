"""The known geometry of a room: solids, seats and floor, exact where a depth map only has points."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Float

from sag.data.cache import WindowCache
from sag.errors import SagError

Pair = tuple[float, float]
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Solid:
    """A box that stands upright, world frame.

    Attributes:
        name: the piece that it is a part of.
        centre: metres.
        half: half its length along its own axes, metres.
        yaw: turn of its axes about the vertical, radians.
    """

    name: str
    centre: Triple
    half: Triple
    yaw: float

    def signed_distance(self, points: Float[np.ndarray, "*any d"]) -> Float[np.ndarray, "*any"]:
        """Distance to the surface, negative inside (metres); of points over the ground if they have two coordinates."""
        axes = points.shape[-1]
        offset = points - np.array(self.centre[:axes])
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        local = np.stack([offset[..., 0] * c + offset[..., 1] * s, offset[..., 1] * c - offset[..., 0] * s], axis=-1)
        outside = np.abs(np.concatenate([local, offset[..., 2:]], axis=-1)) - np.array(self.half[:axes])
        return np.asarray(np.linalg.norm(outside.clip(0), axis=-1) + outside.max(axis=-1).clip(max=0))


@dataclass(frozen=True)
class Seat:
    """A place to sit.

    Attributes:
        name: the piece that it is a part of.
        point: centre of the seat in use, metres, world frame.
        yaw: direction that a seated person faces, radians.
    """

    name: str
    point: Triple
    yaw: float


@dataclass(frozen=True)
class FloorPatch:
    """A rectangle of floor along the room's axes, level or sloping along one of them.

    Attributes:
        low: its least x and y, metres, world frame.
        high: its greatest x and y.
        heights: at the low and the high end of the sloping axis, metres.
        axis: 0 where it slopes along x, 1 along y.
    """

    low: Pair
    high: Pair
    heights: Pair
    axis: int = 0

    def height(self, points: Float[np.ndarray, "*any 2"]) -> Float[np.ndarray, "*any"]:
        """Height under points over the ground, metres; minus infinity beside the patch."""
        low, high = np.array(self.low), np.array(self.high)
        share = (points[..., self.axis] - low[self.axis]) / (high[self.axis] - low[self.axis])
        inside = ((points >= low) & (points <= high)).all(axis=-1)
        return np.where(inside, self.heights[0] + share * (self.heights[1] - self.heights[0]), -np.inf)


@dataclass(frozen=True)
class RoomGeometry:
    """Everything solid in a room, world frame, z up, origin on the ground in the middle.

    Attributes:
        size: length along x, along y and height, metres.
        floor: patches; where they overlap the highest counts.
        solids: boxes of the furniture.
        seats: places to sit.
        instances: name of the piece for each id in the pictures.
    """

    size: Triple
    floor: tuple[FloorPatch, ...]
    solids: tuple[Solid, ...] = ()
    seats: tuple[Seat, ...] = ()
    instances: tuple[tuple[int, str], ...] = ()

    def floor_height(self, points: Float[np.ndarray, "*any 2"]) -> Float[np.ndarray, "*any"]:
        """Height of the floor under points over the ground, metres; 0 outside the room."""
        heights = [np.zeros(points.shape[:-1]), *(patch.height(points) for patch in self.floor)]
        return np.asarray(np.max(heights, axis=0))

    def signed_distance_to_walls(self, points: Float[np.ndarray, "*any d"]) -> Float[np.ndarray, "*any"]:
        """Distance to the nearest wall, negative outside the room (metres)."""
        return np.asarray((np.array(self.size[:2]) / 2 - np.abs(points[..., :2])).min(axis=-1))

    def signed_distance(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any"]:
        """Distance to the nearest furniture or wall, negative inside (metres)."""
        distances = [self.signed_distance_to_walls(points), *(s.signed_distance(points) for s in self.solids)]
        return np.asarray(np.min(distances, axis=0))

    def to_json(self) -> bytes:
        """The file that `from_json` reads."""
        return json.dumps(asdict(self), indent=1, sort_keys=True).encode()

    @classmethod
    def from_json(cls, content: bytes) -> RoomGeometry:
        """The geometry that was written."""
        read = json.loads(content)
        return cls(
            size=tuple(read["size"]),
            floor=tuple(
                FloorPatch(tuple(p["low"]), tuple(p["high"]), tuple(p["heights"]), p["axis"]) for p in read["floor"]
            ),
            solids=tuple(Solid(s["name"], tuple(s["centre"]), tuple(s["half"]), s["yaw"]) for s in read["solids"]),
            seats=tuple(Seat(s["name"], tuple(s["point"]), s["yaw"]) for s in read["seats"]),
            instances=tuple((number, name) for number, name in read["instances"]),
        )


def geometry_file(room: int) -> str:
    """Where a cache keeps the geometry of a room (the cache's `scene`)."""
    return f"geometry/{room}.json"


def load_geometry(cache: WindowCache, room: int) -> RoomGeometry:
    """The known geometry of a room; a window's `world2cam` leads from its frame to the camera.

    Raises:
        SagError: the cache knows no such room.
    """
    path = cache.folder / geometry_file(room)
    if not path.is_file():
        raise SagError(f"{path} is not there: only caches of synthetic rooms know their geometry")
    return RoomGeometry.from_json(path.read_bytes())
