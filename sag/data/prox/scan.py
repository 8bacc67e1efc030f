"""A scene's scan seen by its fixed colour camera: depth of the whole picture, without the person."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float

from sag.data.paths import read_file
from sag.data.prox.numbers import FARTHEST
from sag.data.rays import cast, pixel_rays
from sag.errors import SagError

LARGEST = 1 << 30
"""Bytes of the largest scan that is read."""


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
        SagError: the file is missing, damaged or larger than `LARGEST`, or holds no triangles.
    """
    content = read_file(path, LARGEST)
    try:
        # From memory: of a file trimesh would open the pictures beside it that it names.
        mesh: Any = trimesh.load_mesh(io.BytesIO(content), file_type="ply", process=False)
        faces = np.asarray(mesh.faces)
        triangles = np.asarray(mesh.vertices, np.float64)[faces]
    except Exception as error:  # a damaged mesh can raise anything
        raise SagError(f"{path} cannot be read as a mesh ({error!r}); restore the original file") from error
    if not len(triangles) or faces.min() < 0 or not (np.abs(triangles) <= FARTHEST).all():
        raise SagError(f"{path} has no triangles, or corners beyond {FARTHEST:g} m; restore the original file")
    return triangles
