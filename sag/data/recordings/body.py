"""A person as capsules around the bones: where in a picture, and how far away."""

from __future__ import annotations

import numpy as np
import trimesh
from jaxtyping import Bool, Float

from sag.data.rays import cast, pixel_rays
from sag.skeleton import Skeleton

THICKNESS = {
    "head": 0.1, "neck": 0.07, "chest": 0.13, "thorax": 0.13, "spine": 0.13, "root": 0.12, "shoulder": 0.08,
    "elbow": 0.05, "wrist": 0.045, "hip": 0.1, "knee": 0.065, "ankle": 0.05,
}  # fmt: skip
"""Radius of the body at a joint, by the last word of its name, and along the bone that leads to it, metres."""

OTHERWISE = 0.06
"""Radius at joints of other names, metres."""

BEHIND_SKIN = 0.1
"""How far a capsule may lie behind the skin that a sensor measured, metres."""

NOTHING, PERSON = 0, 1
"""Ids in a native picture of which only the person is known."""

NEAREST = 0.1
"""Bodies that come nearer than this to the camera (metres) are sought in the whole picture."""


def body_depth(
    joints: Float[np.ndarray, "j 3"], skeleton: Skeleton, intrinsics: Float[np.ndarray, "3 3"], size: tuple[int, int]
) -> Float[np.ndarray, "h w"]:
    """Planar z of the body's capsules, metres; infinite beside them.

    Args:
        joints: metres, camera frame.
        skeleton: of the joints.
        intrinsics: camera matrix in pixels of the picture.
        size: rows and columns of the picture.
    """
    triangles = _capsules(joints, skeleton)
    rows, columns = _box(triangles.reshape(-1, 3), intrinsics, size)
    depth = np.full(size, np.inf)
    if rows[0] < rows[1] and columns[0] < columns[1]:
        found = cast(triangles, pixel_rays(intrinsics, rows, columns))
        depth[slice(*rows), slice(*columns)] = found.reshape(rows[1] - rows[0], columns[1] - columns[0])
    return depth


def unhidden(body: Float[np.ndarray, "h w"], depth: Float[np.ndarray, "h w"], slack: float) -> Bool[np.ndarray, "h w"]:
    """Where capsules are not hidden by what a picture's depth shows.

    Args:
        body: see `body_depth`.
        depth: planar z, metres, 0 where it is not known.
        slack: how far a capsule may lie behind that, metres.
    """
    return np.isfinite(body) & ((depth == 0) | (body < depth + slack))


def _capsules(joints: Float[np.ndarray, "j 3"], skeleton: Skeleton) -> Float[np.ndarray, "n 3 3"]:
    """Triangles of a ball at each joint and a cylinder along each bone."""
    words = ("root" if name == skeleton.root else name.split("_")[-1] for name in skeleton.joints)
    radius = [THICKNESS.get(word, OTHERWISE) for word in words]
    ball = trimesh.creation.icosphere(2).triangles
    parts = [joint + r * ball for joint, r in zip(joints, radius)]
    for parent, child in skeleton.bone_index:
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
