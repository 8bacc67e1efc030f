"""Where people can walk in a room, cell by cell."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from sag.data.rooms.geometry import RoomGeometry
from sag.data.rooms.placed import Placed

CELL = 0.1
"""Side of a cell of the walking grid, metres."""

CLEARANCE = 0.36
"""How far the middle of a walking person stays away from what stands on the floor, metres."""

HIGHEST_STEP = 0.2
"""The greatest difference in height that a person steps over, metres."""


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
        return np.asarray(values[cells[..., 0], cells[..., 1]])


def _distance(marked: Bool[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows columns"]:
    return CELL * distance_transform_edt(~marked) if marked.any() else np.full(marked.shape, 99.0)
