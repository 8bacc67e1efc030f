"""A furnished room."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sag.data.rooms.geometry import FloorPatch, RoomGeometry
from sag.data.rooms.grid import WalkingGrid
from sag.data.rooms.placed import Placed

FLOOR_ID, WALL_ID, CEILING_ID, FIRST_PIECE_ID = 1, 2, 3, 4
"""Ids in the pictures; each piece has its own from the last one on."""


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
