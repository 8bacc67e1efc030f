"""How rooms are furnished: pieces against walls and free in the room, with free ways between them."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import label

from sag.data.rooms.floors import random_floor
from sag.data.rooms.furniture import chair, random_piece
from sag.data.rooms.geometry import RoomGeometry
from sag.data.rooms.grid import WalkingGrid
from sag.data.rooms.pieces import Piece
from sag.data.rooms.placed import Placed
from sag.data.rooms.room import Room

LEAST = 9
"""A room with fewer pieces is drawn anew."""

MOST = {"plant": 2, "lamp": 2, "bed": 1, "shelf": 3}
"""Of some pieces a room has no more than this many."""


def random_room(rng: np.random.Generator) -> Room:
    """Some room: 4 to 6 m a side, 9 to 20 pieces, all the free ground in one connected part."""
    while True:
        size = (rng.uniform(4.0, 6.0), rng.uniform(4.0, 5.6), rng.uniform(2.7, 3.2))
        floor = random_floor(size[:2], rng)
        empty = RoomGeometry(size, floor)
        grid = WalkingGrid(size[:2], empty)
        wanted = int(np.clip(rng.normal(0.66, 0.07) * size[0] * size[1], LEAST, 20))
        pieces = _furnish(empty, grid, wanted, rng)
        if len(pieces) >= LEAST:
            return Room(size, floor, tuple(pieces), grid)


def _furnish(empty: RoomGeometry, grid: WalkingGrid, wanted: int, rng: np.random.Generator) -> list[Placed]:
    """Up to this many pieces; the grid loses the ground that they cover."""
    pieces: list[Placed] = []
    for _ in range(300):
        if len(pieces) == wanted:
            break
        placed = _placed(random_piece(rng), empty, rng)
        if not _fits(placed, pieces, empty, grid):
            continue
        group = [placed, *_chairs_around(placed, rng)] if placed.piece.name == "table" else [placed]
        for member in group:
            if len(pieces) < wanted and _fits(member, pieces, empty, grid):
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
    """Whether a piece stands level, inside, touches nothing, leaves the free ground in one part, and is no excess."""
    if sum(other.piece.name == placed.piece.name for other in others) >= MOST.get(placed.piece.name, 20):
        return False
    ground = placed.ground(0.02)
    if empty.signed_distance_to_walls(placed.ground()).min() < 0 or np.ptp(empty.floor_height(ground)) > 1e-6:
        return False
    if any(other.footprint.signed_distance(ground).min() < 0.02 for other in others):
        return False
    free = grid.free_with(placed)
    parts, _ = label(free)
    counts = np.bincount(parts[free]) if free.any() else np.zeros(1)
    return bool(free.mean() > 0.2 and counts.max() > 0.97 * counts.sum())
