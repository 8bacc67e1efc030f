"""Furniture in its place."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from sag.data.rooms.geometry import Seat, Solid
from sag.data.rooms.pieces import Piece


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
