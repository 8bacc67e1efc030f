"""The pose in which a person begins where no recording tells it."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from jaxtyping import Float

from sag.errors import SagError
from sag.skeleton import Skeleton

SIDE = {
    "shoulder": (-0.009, 0.201, 0.483), "elbow": (-0.024, 0.251, 0.216), "wrist": (0.057, 0.259, -0.027),
    "hip": (-0.002, 0.096, -0.073), "knee": (0.022, 0.100, -0.475), "ankle": (-0.031, 0.095, -0.882),
}  # fmt: skip
"""Joints of the left side of a person who stands, from the root: metres, x forward, y to the left, z up."""

MIDDLE = {
    "head": (0.050, 0.0, 0.647), "neck": (0.014, 0.0, 0.542), "chest": (-0.010, 0.0, 0.260),
    "spine0": (-0.008, 0.0, 0.297), "spine1": (-0.015, 0.0, 0.186), "spine2": (-0.017, 0.0, 0.101),
    "spine3": (-0.012, 0.0, 0.017), "root": (0.0, 0.0, 0.0),
}  # fmt: skip
"""Those of the middle. All are the mean of the people of the synthetic rooms who stand, both sides made alike."""

TALLEST, SMALLEST = 3.0, 0.3
"""Largest and smallest extent of a person's joints, metres."""


def standing_pose(skeleton: Skeleton) -> Float[np.ndarray, "j 3"]:
    """A person of usual size who stands: joints from the root, metres, x forward, y to the left, z up.

    Raises:
        SagError: the skeleton has joints whose place is not known.
    """
    known = {name: np.array(place) for name, place in MIDDLE.items()}
    for name, place in SIDE.items():
        known[f"left_{name}"], known[f"right_{name}"] = np.array(place), np.array(place) * [1, -1, 1]
    unknown = [name for name in skeleton.joints if name not in known]
    if unknown:
        raise SagError(
            f"how {skeleton.name} stands is not known ({unknown[0]}); give the first pose by --pose FILE.npz"
        )
    return np.stack([known[name] for name in skeleton.joints])


def read_pose(path: Path, skeleton: Skeleton) -> Float[np.ndarray, "j 3"]:
    """The first pose of a file: joints from the root, metres, axes of the camera (x right, y down, z forward).

    Args:
        path: a .npz with `joints`, (j, 3) or a file of motions, of which the first frame of the first is taken.
        skeleton: whose joints they must be.

    Raises:
        SagError: it is missing or damaged, or holds something else.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            joints = np.asarray(file["joints"], dtype=np.float64)
    except (OSError, ValueError, KeyError, EOFError, TypeError, zipfile.BadZipFile) as error:
        raise SagError(f"--pose {path} cannot be read as a .npz with an array `joints` ({error})") from error
    count = len(skeleton.joints)
    if joints.ndim < 2 or joints.shape[-2:] != (count, 3) or not joints.size:
        raise SagError(f"--pose {path}: joints are {joints.shape}, their last two sizes must be {count} and 3")
    pose = joints.reshape(-1, count, 3)[0]
    if not np.isfinite(pose).all() or not SMALLEST < np.ptp(pose, axis=0).max() < TALLEST:
        raise SagError(f"--pose {path}: the first pose is not finite, or no person's size; joints must be in metres")
    return pose - pose[skeleton.root_index]
