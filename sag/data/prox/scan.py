"""A scene's scan seen by its fixed colour camera: depth of the whole picture, without the person."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float

from sag.data.paths import regular
from sag.data.rays import RayScene
from sag.errors import SagError


def scan_depth(
    path: Path, world2cam: Float[np.ndarray, "4 4"], intrinsics: Float[np.ndarray, "3 3"], size: tuple[int, int]
) -> Float[np.ndarray, "h w"]:
    """Planar z of a scan, metres, 0 where the camera sees past it.

    Args:
        path: `scenes/<Scene>.ply`: metres, z up.
        world2cam: from the scan to the colour camera, column vectors, metres.
        intrinsics: camera matrix in pixels of the colour pictures.
        size: their rows and columns.

    Raises:
        SagError: the mesh is missing or damaged.
    """
    triangles = read_triangles(path) @ world2cam[:3, :3].T + world2cam[:3, 3]
    depth = cast(triangles, pixel_rays(intrinsics, (0, size[0]), (0, size[1])))
    return np.where(np.isfinite(depth), depth, 0).reshape(size)


def read_triangles(path: Path) -> Float[np.ndarray, "n 3 3"]:
    """Corners of every triangle of a mesh, in the file's own frame.

    Raises:
        SagError: the file is missing or damaged, or holds no triangles.
    """
    try:
        with regular(path).open("rb") as file:
            mesh: Any = trimesh.load_mesh(file, file_type="ply", process=False)
        triangles = np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.faces)]
    except Exception as error:  # a damaged mesh can raise anything
        raise SagError(f"{path} cannot be read as a mesh ({error!r}); restore the original file") from error
    if not len(triangles) or not np.isfinite(triangles).all():
        raise SagError(f"{path} has no triangles, or corners that are not finite; restore the original file")
    return triangles


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
