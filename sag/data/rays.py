"""Rays against triangles, by embree."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from jaxtyping import Bool, Float, Int

SKIN = 2e-3
"""Rays towards the light start this far off the surface, metres."""


class Hits(NamedTuple):
    """What rays meet first.

    Attributes:
        distance: in lengths of the ray's direction; infinite where nothing is met.
        triangle: its number, -1 where nothing is met.
        normal: of the triangle, of length 1, on the side that the ray comes from.
    """

    distance: Float[np.ndarray, " n"]
    triangle: Int[np.ndarray, " n"]
    normal: Float[np.ndarray, "n 3"]


def dot(a: Float[np.ndarray, "n d"], b: Float[np.ndarray, "n d"]) -> Float[np.ndarray, " n"]:
    """Row by row scalar product."""
    return np.einsum("nd,nd->n", a, b)


class RayScene:
    """Triangles (metres, world frame) that rays can be sent against."""

    def __init__(self, triangles: Float[np.ndarray, "n 3 3"]) -> None:
        self._scene = EmbreeScene()
        TriangleMesh(self._scene, np.ascontiguousarray(triangles, np.float32))

    def cast(self, origin: Float[np.ndarray, " 3"], directions: Float[np.ndarray, "n 3"]) -> Hits:
        """The first triangle that each ray from one place meets."""
        directions = np.ascontiguousarray(directions, np.float32)
        origins = np.broadcast_to(origin.astype(np.float32), directions.shape).copy()
        found = self._scene.run(origins, directions, output=True)
        normal = found["Ng"]
        length = np.sqrt(dot(normal, normal))
        normal *= (np.sign(-dot(normal, directions)) / np.maximum(length, 1e-12))[:, None]
        distance = found["tfar"]
        distance[found["primID"] < 0] = np.inf
        return Hits(distance, found["primID"], normal)

    def distance(
        self, origin: Float[np.ndarray, " 3"], directions: Float[np.ndarray, "n 3"]
    ) -> Float[np.ndarray, " n"]:
        """How far rays from one place go, in lengths of their directions; infinite where nothing is met."""
        directions = np.ascontiguousarray(directions, np.float32)
        origins = np.broadcast_to(origin.astype(np.float32), directions.shape).copy()
        distance = self._scene.run(origins, directions, query="DISTANCE")
        distance[distance > 1e6] = np.inf
        return distance

    def hidden(self, points: Float[np.ndarray, "n 3"], target: Float[np.ndarray, " 3"]) -> Bool[np.ndarray, " n"]:
        """Whether a triangle lies between points and one place (metres)."""
        points = np.ascontiguousarray(points, np.float32)
        towards = (target - points).astype(np.float32)
        limit = np.full(len(points), 0.999, np.float32)
        return np.asarray(self._scene.run(points, towards, limit, query="OCCLUDED") >= 0)


def pixel_rays(
    intrinsics: Float[np.ndarray, "3 3"], rows: tuple[int, int], columns: tuple[int, int]
) -> Float[np.ndarray, "n 3"]:
    """Directions through the centres of pixels, row by row; 1 along the camera's axis, so scaled by planar depth.

    Args:
        intrinsics: camera matrix in continuous pixels.
        rows: first and last + 1.
        columns: first and last + 1.
    """
    x = (np.arange(*columns) + 0.5 - intrinsics[0, 2]) / intrinsics[0, 0]
    y = (np.arange(*rows) + 0.5 - intrinsics[1, 2]) / intrinsics[1, 1]
    grid = np.stack(np.broadcast_arrays(x, y[:, None], 1.0), axis=-1)
    return grid.reshape(-1, 3)


def cast(triangles: Float[np.ndarray, "m 3 3"], rays: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
    """Planar z at which rays from the camera meet triangles (metres, camera frame); infinite where they meet none."""
    return RayScene(triangles).distance(np.zeros(3), rays)
