"""All surfaces of a room as triangles with materials and ids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from jaxtyping import Float, Int, UInt8

from sag.data.rooms.floors import patch_triangles
from sag.data.rooms.materials import Colour, Material, Palette, shade
from sag.data.rooms.room import CEILING_ID, FIRST_PIECE_ID, FLOOR_ID, WALL_ID, Room

THICKNESS = 0.1
"""Of walls and ceiling, metres."""

WALLS: tuple[Colour, ...] = (
    (0.9, 0.88, 0.82), (0.78, 0.84, 0.86), (0.86, 0.8, 0.72), (0.74, 0.8, 0.72), (0.88, 0.78, 0.74), (0.66, 0.72, 0.8),
)  # fmt: skip

FLOORS: tuple[Material, ...] = (
    Material((0.62, 0.44, 0.28), (0.4, 0.26, 0.15), "planks", 0.14),
    Material((0.45, 0.31, 0.2), (0.26, 0.17, 0.1), "planks", 0.12),
    Material((0.74, 0.62, 0.46), (0.54, 0.43, 0.3), "planks", 0.16),
    Material((0.72, 0.71, 0.68), (0.42, 0.42, 0.42), "tiles", 0.45),
    Material((0.56, 0.5, 0.45), (0.34, 0.3, 0.28), "tiles", 0.33),
    Material((0.55, 0.52, 0.5), (0.45, 0.42, 0.4), "fabric", 0.03),
)


@dataclass
class Surfaces:
    """Triangles in the world frame (metres) with what they are made of.

    Attributes:
        triangles: corners.
        part: number of the surface that each triangle belongs to.
        ids: id in the pictures, by surface.
        origin: origin of the frame that its pattern is fixed to, by surface.
        yaw: turn of that frame, by surface.
        palette: materials, by surface.
    """

    triangles: Float[np.ndarray, "n 3 3"]
    part: Int[np.ndarray, " n"]
    ids: UInt8[np.ndarray, " m"]
    origin: Float[np.ndarray, "m 3"]
    yaw: Float[np.ndarray, " m"]
    palette: Palette

    def id_of(self, triangle: Int[np.ndarray, " k"]) -> UInt8[np.ndarray, " k"]:
        """Id in the pictures of triangles of these numbers."""
        return self.ids[self.part[triangle]]

    def colours(self, triangle: Int[np.ndarray, " k"], points: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "k 3"]:
        """Colour of triangles of these numbers at these places (metres, world frame)."""
        part = self.part[triangle]
        c, s = np.cos(self.yaw, dtype=np.float32)[part], np.sin(self.yaw, dtype=np.float32)[part]
        offset = points - self.origin[part]
        x, y = offset[:, 0] * c + offset[:, 1] * s, offset[:, 1] * c - offset[:, 0] * s
        return self.palette(part, np.stack([x, y, offset[:, 2]], axis=1))


class SurfaceList:
    """Gathers surfaces one by one."""

    def __init__(self) -> None:
        self._triangles: list[np.ndarray] = []
        self._rows: list[tuple[int, tuple[float, float, float], float]] = []
        self._materials: list[Material] = []

    def add(
        self,
        triangles: Float[np.ndarray, "n 3 3"],
        number: int,
        material: Material,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        yaw: float = 0.0,
    ) -> None:
        """Adds a surface whose pattern is fixed to the frame at `origin`, turned by `yaw`."""
        self._triangles.append(triangles)
        self._rows.append((number, origin, yaw))
        self._materials.append(material)

    def gathered(self) -> Surfaces:
        """All surfaces that were added."""
        ids, origin, yaw = zip(*self._rows)
        return Surfaces(
            np.concatenate(self._triangles),
            np.repeat(np.arange(len(self._triangles)), [len(t) for t in self._triangles]),
            np.array(ids, np.uint8),
            np.array(origin, np.float32),
            np.array(yaw, np.float32),
            Palette(self._materials),
        )


def room_surfaces(room: Room, rng: np.random.Generator) -> Surfaces:
    """The room's floor, walls, ceiling, decoration and furniture."""
    surfaces = SurfaceList()
    floor = FLOORS[rng.integers(len(FLOORS))]
    for number, patch in enumerate(room.floor):
        # Every other level is darker, so that steps can be told apart.
        tone = 1.0 - 0.2 * (number % 2)
        material = Material(shade(floor.colour, tone), shade(floor.second, tone), floor.pattern, floor.scale)
        surfaces.add(patch_triangles(patch), FLOOR_ID, material)
    _add_shell(surfaces, room, rng)
    for number, placed in enumerate(room.pieces):
        for part in placed.piece.parts:
            triangles = placed.to_world(part.triangles)
            surfaces.add(triangles, FIRST_PIECE_ID + number, part.material, placed.place, placed.yaw)
    return surfaces.gathered()


def _box(centre: tuple[float, ...], size: tuple[float, ...]) -> Float[np.ndarray, "12 3 3"]:
    return np.asarray(trimesh.creation.box(extents=size).triangles) + np.array(centre)


def _add_shell(surfaces: SurfaceList, room: Room, rng: np.random.Generator) -> None:
    """Walls with skirting, a door, windows and pictures, and the ceiling."""
    half = np.array(room.size[:2]) / 2
    height = room.size[2]
    accent = int(rng.integers(4))
    plain, other = (WALLS[i] for i in rng.choice(len(WALLS), 2, replace=False))
    for wall in range(4):
        axis, sign = wall // 2, 1 - 2 * (wall % 2)
        colour = other if wall == accent else plain
        centre, size = [0.0, 0.0, height / 2], [2 * half[0] + 0.2, 2 * half[1] + 0.2, height]
        centre[axis], size[axis] = sign * (half[axis] + THICKNESS / 2), THICKNESS
        surfaces.add(_box(tuple(centre), tuple(size)), WALL_ID, Material(colour))
        _decorate(surfaces, room, axis, sign, rng)
    ceiling = _box((0.0, 0.0, height + THICKNESS / 2), (2 * half[0] + 0.2, 2 * half[1] + 0.2, THICKNESS))
    surfaces.add(ceiling, CEILING_ID, Material((0.95, 0.95, 0.93)))


def _decorate(surfaces: SurfaceList, room: Room, axis: int, sign: int, rng: np.random.Generator) -> None:
    """Something flat on a wall: a door, a window or a picture."""
    kind = rng.choice(["door", "window", "picture", "picture"])
    half = np.array(room.size[:2]) / 2
    wide, tall, frame = {
        "door": (0.95, 2.05, Material((0.5, 0.34, 0.2))),
        "window": (rng.uniform(1.0, 1.8), 1.2, Material((0.95, 0.95, 0.95))),
        "picture": (rng.uniform(0.5, 1.1), rng.uniform(0.4, 0.7), Material((0.15, 0.12, 0.1))),
    }[kind]
    along = rng.uniform(-1, 1) * (half[1 - axis] - wide / 2 - 0.15)
    ground = [0.0, 0.0]
    ground[axis], ground[1 - axis] = sign * (half[axis] - 0.05), along
    base = float(room.geometry.floor_height(np.array(ground)))
    middle = base + tall / 2 if kind == "door" else max(base + 0.9 + tall / 2, 1.55)
    colours = rng.uniform(0.15, 0.9, (2, 3))
    fill = {
        "door": Material((0.72, 0.55, 0.36), (0.64, 0.48, 0.31), "wood", 0.12),
        "window": Material((0.75, 0.88, 0.97), (0.9, 0.96, 1.0), "stripes", 0.5),
        "picture": Material(tuple(colours[0].tolist()), tuple(colours[1].tolist()), "leaves", rng.uniform(0.2, 0.5)),
    }[kind]
    for depth, rim, material in ((0.02, 0.12, frame), (0.03, 0.0, fill)):
        centre, size = [0.0, 0.0, middle], [0.0, 0.0, tall - 0.12 + rim]
        centre[axis], centre[1 - axis] = sign * (half[axis] - depth / 2), along
        size[axis], size[1 - axis] = depth, wide - 0.12 + rim
        surfaces.add(_box(tuple(centre), tuple(size)), WALL_ID, material)
