"""The person in a picture of PROX: where, and how far away.

The scan has no person in it, and of the body only the joints are known here: so the body is capsules around the bones,
and its outline is the mask that PROX keeps beside the picture.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from sag.data.pictures import read_grey
from sag.data.prox.scan import cast, pixel_rays
from sag.data.prox.sensor import Aligned
from sag.errors import SagError
from sag.skeleton import PROX_16

THICKNESS = {
    "head": 0.1, "neck": 0.07, "chest": 0.13, "root": 0.12, "shoulder": 0.08, "elbow": 0.05, "wrist": 0.045,
    "hip": 0.1, "knee": 0.065, "ankle": 0.05,
}  # fmt: skip
"""Radius of the body at a joint and along the bone that leads to it, metres."""

NOBODY = 255
"""Value of the masks where no person is."""

NEAREST = 0.1
"""Bodies that come nearer than this to the camera (metres) are sought in the whole picture."""


def body_depth(
    joints: Float[np.ndarray, "16 3"], intrinsics: Float[np.ndarray, "3 3"], size: tuple[int, int]
) -> Float[np.ndarray, "h w"]:
    """Planar z of the body's capsules, metres; infinite beside them.

    Args:
        joints: of `prox_16`, metres, camera frame.
        intrinsics: camera matrix in pixels of the picture.
        size: rows and columns of the picture.
    """
    triangles = _capsules(joints)
    rows, columns = _box(triangles.reshape(-1, 3), intrinsics, size)
    depth = np.full(size, np.inf)
    if rows[0] < rows[1] and columns[0] < columns[1]:
        found = cast(triangles, pixel_rays(intrinsics, rows, columns))
        depth[slice(*rows), slice(*columns)] = found.reshape(rows[1] - rows[0], columns[1] - columns[0])
    return depth


def _capsules(joints: Float[np.ndarray, "16 3"]) -> Float[np.ndarray, "n 3 3"]:
    """Triangles of a ball at each joint and a cylinder along each bone."""
    radius = [THICKNESS[name.split("_")[-1]] for name in PROX_16.joints]
    ball = trimesh.creation.icosphere(2).triangles
    parts = [joint + r * ball for joint, r in zip(joints, radius)]
    for parent, child in PROX_16.bone_index:
        if np.linalg.norm(joints[child] - joints[parent]) > 0:
            bone = trimesh.creation.cylinder(radius[child], segment=joints[[parent, child]], sections=16)
            parts.append(bone.triangles)
    return np.concatenate(parts)


def _box(
    points: Float[np.ndarray, "n 3"], intrinsics: Float[np.ndarray, "3 3"], size: tuple[int, int]
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Rows and columns, first and last + 1, that hold the points; the whole picture where they come near its plane."""
    if points[:, 2].min() < NEAREST:
        return (0, size[0]), (0, size[1])
    pixels = (points @ intrinsics.T)[:, :2] / points[:, 2:]
    low = np.floor(pixels.min(axis=0)).clip(0, size[::-1]).astype(int)
    high = np.ceil(pixels.max(axis=0)).clip(0, size[::-1]).astype(int)
    return (int(low[1]), int(high[1])), (int(low[0]), int(high[0]))


def read_mask(path: Path) -> Bool[np.ndarray, "h w"]:
    """Where a person is, unmirrored; of `BodyIndexColor` in the colour camera's pixels, of `BodyIndex` in the depth's.

    Raises:
        SagError: the file is damaged.
    """
    return read_grey(path)[:, ::-1] != NOBODY


def mask_of(folder: Path, stem: str, size: tuple[int, int], measured: Aligned) -> Bool[np.ndarray, "h w"] | None:
    """Where the person is in a colour picture, unmirrored, as PROX's masks say; nothing where it has none.

    Args:
        folder: of the recording.
        stem: name of the frame.
        size: rows and columns of the colour picture.
        measured: the frame's aligned depth, by which the depth camera's mask can be moved.

    Raises:
        SagError: a mask is damaged or of another size than its picture.
    """
    own = folder / "BodyIndexColor" / f"{stem}.png"
    if own.is_file():
        mask = read_mask(own)
        if mask.shape != size:
            raise SagError(f"{own} has {mask.shape} pixels, and its colour picture {size}; restore the original file")
        return mask
    moved = folder / "BodyIndex" / f"{stem}.png"
    if not moved.is_file() or (measured.source < 0).all():
        return None
    flat = read_mask(moved).ravel()
    if len(flat) <= measured.source.max():
        raise SagError(f"{moved} is smaller than the frame's Depth picture; restore the original file")
    return np.where(measured.source >= 0, flat[measured.source], False)


def with_person(
    scene: Float[np.ndarray, "h w"], body: Float[np.ndarray, "h w"], mask: Bool[np.ndarray, "h w"]
) -> Float[np.ndarray, "h w"]:
    """Depth of the scene with the person before it, metres.

    Inside the mask but beside the capsules the body is as far away as where it is nearest in the picture; it is never
    behind the scene, since it is seen.

    Args:
        scene: without the person, 0 where it is not known.
        body: of the capsules, infinite beside them.
        mask: where the person is seen; it touches the capsules.
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    box = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    inside, seen = mask[box], mask[box] & np.isfinite(body[box])
    nearest = distance_transform_edt(~seen, return_distances=False, return_indices=True)
    behind = np.where(scene[box] > 0, scene[box], np.inf)
    depth = scene.copy()
    depth[box][inside] = np.minimum(body[box][tuple(nearest)], behind)[inside]
    return depth
