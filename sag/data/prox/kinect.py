"""Skeletons of the Kinect's own software: what moves where PROX's fits cannot be used.

PROX's tools do not read its `Skeleton` files, so their layout is taken from the Kinect SDK that wrote them: `Bodies`,
each with `Joints` by name or in the SDK's order, each with a `Position` in the SDK's camera space, which is the depth
camera seen in a mirror: metres, x to the camera's left, y up, z forward.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from sag.data.prox.numbers import array_of, read_json
from sag.errors import SagError
from sag.skeleton import PROX_16

SDK_JOINTS = (
    "SpineBase", "SpineMid", "Neck", "Head",
    "ShoulderLeft", "ElbowLeft", "WristLeft", "HandLeft",
    "ShoulderRight", "ElbowRight", "WristRight", "HandRight",
    "HipLeft", "KneeLeft", "AnkleLeft", "FootLeft",
    "HipRight", "KneeRight", "AnkleRight", "FootRight",
    "SpineShoulder", "HandTipLeft", "ThumbLeft", "HandTipRight", "ThumbRight",
)  # fmt: skip
"""The Kinect's 25 joints in the order of its SDK; left and right are the person's own."""

_MIDDLE = {"head": "Head", "neck": "Neck", "chest": "SpineMid", "root": "SpineBase"}

JOINTS = tuple(
    _MIDDLE.get(name) or "".join(part.capitalize() for part in reversed(name.split("_"))) for name in PROX_16.joints
)
"""The Kinect's joint for each of `prox_16`; its spine has no joint in the chest, and the middle one is the nearest."""

TO_DEPTH_CAMERA = np.array([-1.0, -1.0, 1.0])
"""From the SDK's camera space to x right, y down, z forward."""


def read_skeleton(path: Path) -> Float[np.ndarray, "16 3"]:
    """Joints of `prox_16`: metres, depth camera (x right, y down, z forward); not numbers where nobody is tracked.

    Of several people the first that is tracked is taken.

    Raises:
        SagError: the file is missing, damaged or of another layout.
    """
    content = read_json(path)
    bodies = content.get("Bodies") if isinstance(content, dict) else None
    if not isinstance(bodies, list) or not all(isinstance(body, dict) for body in bodies):
        raise SagError(f"{path} has no list Bodies, as the Kinect SDK writes it; restore the original file")
    for body in bodies:
        if body.get("Joints") and body.get("IsTracked", True):
            return _positions(body["Joints"], path) * TO_DEPTH_CAMERA
    return np.full((len(JOINTS), 3), np.nan)


def _positions(joints: Any, path: Path) -> Float[np.ndarray, "16 3"]:
    """Places of a body's joints in the SDK's camera space."""
    if isinstance(joints, list) and len(joints) == len(SDK_JOINTS):
        joints = dict(zip(SDK_JOINTS, joints))
    if not isinstance(joints, dict):
        raise SagError(f"{path} has Joints that are neither named nor {len(SDK_JOINTS)}; restore the original file")
    places = []
    for name in JOINTS:
        joint = joints.get(name)
        place = joint.get("Position") if isinstance(joint, dict) else None
        if isinstance(place, dict):
            place = [place.get(axis) for axis in "XYZ"]
        places.append(array_of(place, (3,), f"{path}: Position of {name}"))
    return np.stack(places)
