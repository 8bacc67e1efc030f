"""A piece of furniture as primitives with materials.

A piece stands on the origin of its own frame: x to the front, y to the left, z up, metres.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import trimesh
from jaxtyping import Float

from sag.data.rooms.materials import Material

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Part:
    """A primitive of a piece.

    Attributes:
        triangles: metres, the piece's own frame.
        centre: of its bounding box.
        half: half the sides of its bounding box.
        material: its look.
    """

    triangles: Float[np.ndarray, "n 3 3"]
    centre: Triple
    half: Triple
    material: Material


@dataclass
class Piece:
    """A piece of furniture in its own frame.

    Attributes:
        name: what it is.
        parts: what it is made of.
        seats: centres of its seats in use, people facing the front.
        against_wall: whether it stands with its back to a wall.
        top: height of a surface that a hand may reach for, metres; None without one.
    """

    name: str
    parts: list[Part] = field(default_factory=list)
    seats: list[Triple] = field(default_factory=list)
    against_wall: bool = False
    top: float | None = None

    def box(self, centre: Triple, size: Triple, material: Material) -> None:
        """Adds a box."""
        self._add(trimesh.creation.box(extents=size), centre, material)

    def cylinder(self, centre: Triple, radius: float, height: float, material: Material) -> None:
        """Adds an upright cylinder."""
        self._add(trimesh.creation.cylinder(radius=radius, height=height, sections=14), centre, material)

    def ball(self, centre: Triple, size: Triple, material: Material) -> None:
        """Adds an ellipsoid of these diameters."""
        mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
        mesh.apply_scale(size)
        self._add(mesh, centre, material)

    def legs(self, half: tuple[float, float], height: float, thickness: float, material: Material) -> None:
        """Adds four legs at the corners of a rectangle."""
        for x in (-half[0], half[0]):
            for y in (-half[1], half[1]):
                self.box((x, y, height / 2), (thickness, thickness, height), material)

    def _add(self, mesh: trimesh.Trimesh, centre: Triple, material: Material) -> None:
        triangles = np.asarray(mesh.triangles) + np.array(centre)
        corners = triangles.reshape(-1, 3)
        half = np.ptp(corners, axis=0) / 2
        middle = corners.min(axis=0) + half
        self.parts.append(Part(triangles, tuple(middle.tolist()), tuple(half.tolist()), material))

    @property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Least and greatest corner of the bounding box."""
        centre, half = (np.array([getattr(p, name) for p in self.parts]) for name in ("centre", "half"))
        return np.stack([(centre - half).min(axis=0), (centre + half).max(axis=0)])
