"""What a motion must be to be written for other programs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from sag.errors import SagError
from sag.skeleton import Skeleton

FARTHEST = 1000.0
"""Metres from the origin beyond which a joint is no joint."""


def check_motion(joints: np.ndarray, skeleton: Skeleton, fps: float) -> None:
    """Refuses what no program could play.

    Args:
        joints: (t, j, 3), metres.
        skeleton: whose joints they are.
        fps: frames a second.

    Raises:
        SagError: a joint is lacking or too many, a coordinate is not finite or far away, or there is no frame or no
            rate.
    """
    if joints.ndim != 3 or joints.shape[2] != 3:
        raise SagError(f"joints are {joints.shape}, they must be (frames, joints, 3)")
    if joints.shape[1] != len(skeleton.joints):
        raise SagError(
            f"joints are {joints.shape[1]}, and skeleton {skeleton.name} has {len(skeleton.joints)}; name the skeleton "
            "that they are of"
        )
    if not len(joints):
        raise SagError("the motion has no frames, at least one is needed")
    broken = ~np.isfinite(joints).all(axis=-1)
    if broken.any():
        frame, joint = (int(place) for place in np.argwhere(broken)[0])
        raise SagError(f"{skeleton.joints[joint]} in frame {frame} is at no finite place; leave the motion out")
    if np.abs(joints).max() > FARTHEST:
        raise SagError(f"the motion goes over {FARTHEST:g} m from the origin; joints are to be in metres")
    if not (math.isfinite(fps) and fps > 0):
        raise SagError(f"fps is {fps}, it must be more than 0 frames a second")


def check_suffix(path: Path, suffix: str) -> None:
    """Refuses a path that other programs would take for something else.

    Raises:
        SagError: it does not end in the suffix, or is a folder.
    """
    if path.suffix.lower() != suffix or path.is_dir():
        raise SagError(f"{path} must be a file that ends in {suffix}")
