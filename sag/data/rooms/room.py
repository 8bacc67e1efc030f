"""A furnished room: floor levels, walls and pieces that leave free ways between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt, label

from sag.data.rooms.floors import random_floor
from sag.data.rooms.furniture import Piece, chair, random_piece
from sag.data.rooms.geometry import FloorPatch, RoomGeometry, Seat, Solid

CELL = 0.1
"""Side of a cell of the walking grid, metres."""

CLEARANCE = 0.36
"""How far the middle of a walking person stays away from what stands on the floor, metres."""

HIGHEST_STEP = 0.2
"""The greatest difference in height that a person steps over, metres."""

FLOOR_ID, WALL_ID, CEILING_ID, FIRST_PIECE_ID = 1, 2, 3, 4


@dataclass(frozen=True)
class Placed:
    """A piece in its place.

    Attributes:
        piece: in its own frame.
        place: where the origin of its frame is, metres, world frame.
        yaw: direction of its front, radians.
    """

    piece: Piece
    place: tuple[float, float, float]
    yaw: float

    def to_world(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the piece's own frame in the world frame (metres)."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + np.array(self.place)

    @cached_property
    def footprint(self) -> Solid:
        """The upright box around the piece."""
        low, high = self.piece.bounds
        centre = self.to_world((low + high) / 2)
        return Solid(self.piece.name, tuple(centre.tolist()), tuple(((high - low) / 2).tolist()), self.yaw)

    def ground(self, margin: float = 0.0) -> Float[np.ndarray, "n 2"]:
        """Points over the ground, close together, that cover the footprint and a margin around it."""
        low, high = self.piece.bounds[:, :2] + np.array([[-margin], [margin]])
        x, y = (np.linspace(a, b, int(np.ceil((b - a) / 0.12)) + 1) for a, b in zip(low, high))
        grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        return self.to_world(np.pad(grid, ((0, 0), (0, 1))))[:, :2]

    def solids(self) -> list[Solid]:
        """The boxes of its parts, world frame."""
        name, yaw = self.piece.name, self.yaw
        return [
            Solid(name, tuple(self.to_world(np.array(part.centre)).tolist()), part.half, yaw)
            for part in self.piece.parts
        ]

    def seats(self) -> list[Seat]:
        """Its seats, world frame."""
        places = (self.to_world(np.array(seat)) for seat in self.piece.seats)
        return [Seat(self.piece.name, tuple(place.tolist()), self.yaw) for place in places]


class WalkingGrid:
    """Where a person can be in a room, in cells of `CELL`.

    Attributes:
        points: (rows, columns, 2) middle of each cell, metres, world frame.
        height: of the floor.
        clearance: distance to walls, furniture and drops that are too high to step over, metres.
        edge: distance to the nearest change of level, metres.
    """

    def __init__(self, size: tuple[float, float], floor: RoomGeometry) -> None:
        x, y = (np.arange(CELL / 2, length, CELL) - length / 2 for length in size)
        self.points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        self.height = floor.floor_height(self.points)
        rise = np.zeros_like(self.height)
        for axis in (0, 1):
            change = np.abs(np.diff(self.height, axis=axis))
            for cells in (np.s_[1:], np.s_[:-1]):
                part = (cells,) if axis == 0 else (np.s_[:], cells)
                rise[part] = np.maximum(rise[part], change)
        self.edge = _distance(rise > 0.05)
        self.clearance = np.minimum(
            _distance(rise > HIGHEST_STEP) + CELL / 2, floor.signed_distance_to_walls(self.points)
        )

    def add(self, piece: Placed) -> None:
        """Takes away the ground that a piece covers."""
        self.clearance = np.minimum(self.clearance, piece.footprint.signed_distance(self.points))

    def free_with(self, piece: Placed) -> Bool[np.ndarray, "rows columns"]:
        """Where people could walk if the piece were there too."""
        return np.minimum(self.clearance, piece.footprint.signed_distance(self.points)) > CLEARANCE

    @property
    def free(self) -> Bool[np.ndarray, "rows columns"]:
        """Where people can walk."""
        return self.clearance > CLEARANCE

    def at(self, values: Float[np.ndarray, "rows columns"], points: Float[np.ndarray, "*any 2"]) -> np.ndarray:
        """Values of the cells that points over the ground fall in."""
        size = np.array(self.height.shape)
        cells = np.floor((points - self.points[0, 0]) / CELL + 0.5).astype(int).clip(0, size - 1)
        return values[cells[..., 0], cells[..., 1]]


def _distance(marked: Bool[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows columns"]:
    return CELL * distance_transform_edt(~marked) if marked.any() else np.full(marked.shape, 99.0)


@dataclass(frozen=True)
class Room:
    """A room with everything in it.

    Attributes:
        size: length along x, along y and height, metres; the origin is on the ground in the middle.
        floor: patches of floor.
        pieces: furniture.
        grid: where people can walk.
    """

    size: tuple[float, float, float]
    floor: tuple[FloorPatch, ...]
    pieces: tuple[Placed, ...]
    grid: WalkingGrid

    @cached_property
    def geometry(self) -> RoomGeometry:
        """What is solid, exactly."""
        instances = [(FLOOR_ID, "floor"), (WALL_ID, "wall"), (CEILING_ID, "ceiling")]
        instances += [(FIRST_PIECE_ID + i, placed.piece.name) for i, placed in enumerate(self.pieces)]
        solids = tuple(solid for placed in self.pieces for solid in placed.solids())
        seats = tuple(seat for placed in self.pieces for seat in placed.seats())
        return RoomGeometry(self.size, self.floor, solids, seats, tuple(instances))


def random_room(rng: np.random.Generator) -> Room:
    """Some room: 4 to 8 m a side, 8 to 20 pieces, all the free ground in one connected part."""
    while True:
        size = (rng.uniform(4.2, 8.0), rng.uniform(4.2, 7.5), rng.uniform(2.7, 3.2))
        floor = random_floor(size[:2], rng)
        empty = RoomGeometry(size, floor)
        grid = WalkingGrid(size[:2], empty)
        wanted = int(np.clip(rng.normal(0.42, 0.06) * size[0] * size[1], 8, 20))
        pieces = _furnish(empty, grid, wanted, rng)
        if len(pieces) >= 8:
            return Room(size, floor, tuple(pieces), grid)


def _furnish(empty: RoomGeometry, grid: WalkingGrid, wanted: int, rng: np.random.Generator) -> list[Placed]:
    pieces: list[Placed] = []
    for _ in range(400):
        if len(pieces) >= wanted:
            break
        placed = _placed(random_piece(rng), empty, rng)
        if _fits(placed, pieces, empty, grid):
            group = [placed, *_chairs_around(placed, rng)] if placed.piece.name == "table" else [placed]
            for member in group[: wanted - len(pieces)]:
                if _fits(member, pieces, empty, grid):
                    pieces.append(member)
                    grid.add(member)
    return pieces


def _placed(piece: Piece, empty: RoomGeometry, rng: np.random.Generator) -> Placed:
    """The piece at some place: with its back to a wall, or free in the room."""
    half = np.array(empty.size[:2]) / 2
    axis, sign = int(rng.integers(2)), int(rng.choice([-1, 1]))
    if piece.against_wall or rng.random() < 0.2:
        yaw = np.arctan2(*((0.0, -sign) if axis == 0 else (-sign, 0.0)))
        place = rng.uniform(-half, half)
        place[axis] = sign * (half[axis] + piece.bounds[0, 0] - rng.uniform(0.01, 0.05))
    else:
        yaw = rng.integers(4) * np.pi / 2 + (rng.uniform(-0.5, 0.5) if rng.random() < 0.4 else 0.0)
        place = rng.uniform(-0.8 * half, 0.8 * half)
    return Placed(piece, (float(place[0]), float(place[1]), float(empty.floor_height(place))), float(yaw))


def _chairs_around(table: Placed, rng: np.random.Generator) -> list[Placed]:
    """Chairs that face a dining table."""
    if (table.piece.top or 0) < 0.6:
        return []
    half = table.piece.bounds[1, :2]
    sides = rng.permutation(4)[: rng.integers(1, 4)]
    chairs = []
    for side in sides:
        angle = side * np.pi / 2
        seat = chair(rng)
        away = half[side % 2] + seat.bounds[1, 0] + rng.uniform(0.01, 0.1)
        place = table.to_world(np.array([away * np.cos(angle), away * np.sin(angle), 0.0]))
        yaw = float(table.yaw + angle + np.pi + rng.uniform(-0.15, 0.15))
        chairs.append(Placed(seat, tuple(place.tolist()), yaw))
    return chairs


def _fits(placed: Placed, others: list[Placed], empty: RoomGeometry, grid: WalkingGrid) -> bool:
    """Whether a piece stands level, inside, touches nothing and leaves the free ground in one part."""
    ground = placed.ground(0.02)
    if empty.signed_distance_to_walls(placed.ground()).min() < 0 or np.ptp(empty.floor_height(ground)) > 1e-6:
        return False
    if any(other.footprint.signed_distance(ground).min() < 0.02 for other in others):
        return False
    free = grid.free_with(placed)
    parts, _ = label(free)
    counts = np.bincount(parts[free]) if free.any() else np.zeros(1)
    return bool(free.mean() > 0.2 and counts.max() > 0.97 * counts.sum())
