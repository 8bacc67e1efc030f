"""Floors at more than one level: platforms, steps and ramps that people walk up and down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from jaxtyping import Float

from sag.data.rooms.geometry import FloorPatch, Pair

THICKNESS = 0.1
"""How far the floor's solids go below the ground, metres."""


@dataclass(frozen=True)
class _Frame:
    """The room seen from the side that a platform rises towards: u goes to that wall, v along it, both from 0."""

    size: Pair
    axis: int
    flipped: bool

    @property
    def depth(self) -> float:
        return self.size[self.axis]

    @property
    def breadth(self) -> float:
        return self.size[1 - self.axis]

    def patch(self, u: Pair, v: Pair, heights: Pair) -> FloorPatch:
        """A patch over these ranges that rises along u between the heights."""
        if self.flipped:
            u, heights = (self.depth - u[1], self.depth - u[0]), (heights[1], heights[0])
        ranges = [(low - length / 2, high - length / 2) for (low, high), length in ((u, self.depth), (v, self.breadth))]
        x, y = ranges if self.axis == 0 else ranges[::-1]
        return FloorPatch((x[0], y[0]), (x[1], y[1]), heights, self.axis)


def random_floor(size: Pair, rng: np.random.Generator) -> tuple[FloorPatch, ...]:
    """Some floor for a room of this length along x and y (metres): level in one of six, else with a platform.

    A platform takes a corner or the whole breadth at one wall; one to three steps lead up to it, or a ramp, or both.
    """
    axis = int(rng.integers(2))
    frame = _Frame(size, axis, bool(rng.integers(2)))
    ground = frame.patch((0.0, frame.depth), (0.0, frame.breadth), (0.0, 0.0))
    if rng.random() < 1 / 6:
        return (ground,)
    steps, riser, tread = int(rng.integers(1, 4)), rng.uniform(0.12, 0.165), rng.uniform(0.36, 0.48)
    height = steps * riser
    edge = frame.depth * rng.uniform(0.5, 0.62)
    corner = frame.breadth > 4.5 and rng.random() < 0.4
    side = frame.breadth * rng.uniform(0.3, 0.45) if corner else 0.0
    patches = [ground]
    for level in range(1, steps + 1):
        out = (steps - level) * tread
        v = (max(side - out, 0.0), frame.breadth)
        patches.append(frame.patch((edge - out, frame.depth), v, (level * riser, level * riser)))
    if rng.random() < 0.5:
        patches.append(_ramp(frame, edge, side, height, rng))
    return tuple(patches)


def _ramp(frame: _Frame, edge: float, side: float, height: float, rng: np.random.Generator) -> FloorPatch:
    """A ramp of 7 to 11 degrees up to the edge of a platform that begins at `side`."""
    length = min(height / np.tan(np.deg2rad(rng.uniform(7, 11))), edge - 0.6)
    room = frame.breadth - side
    width = min(rng.uniform(1.3, 2.2), room)
    low = side + (room - width) * rng.choice([0.0, rng.random(), 1.0])
    return frame.patch((edge - length, edge), (low, low + width), (0.0, height))


def patch_triangles(patch: FloorPatch) -> Float[np.ndarray, "n 3 3"]:
    """The solid under a patch, metres, world frame."""
    corners = [
        (x, y, z)
        for x, at_x in ((patch.low[0], 0), (patch.high[0], 1))
        for y, at_y in ((patch.low[1], 0), (patch.high[1], 1))
        for z in (-THICKNESS, patch.heights[(at_x, at_y)[patch.axis]])
    ]
    return np.asarray(trimesh.convex.convex_hull(np.array(corners)).triangles)
