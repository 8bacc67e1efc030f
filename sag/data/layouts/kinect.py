"""The Kinect that films rooms for PROX's layout: its two cameras, their calibration files and its skeletons."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from sag.data.rooms.cameras import Camera
from sag.geometry.kinematics import unit
from sag.skeleton import GTA_IM_19

COLOUR = np.array([[1060.53, 0, 951.30], [0, 1060.38, 536.77], [0, 0, 1]])
"""Camera matrix of PROX's colour camera in its 1080 x 1920 pictures; the first pixel's centre is at (0, 0)."""

COLOUR_ROWS = 1080

FIELD = float(2 * np.arctan(COLOUR_ROWS / 2 / COLOUR[1, 1]))
"""Vertical field of view of the colour camera, radians."""

INFRARED = np.array([[366.0, 0, 257.0], [0, 366.0, 207.0], [0, 0, 1]])
"""Camera matrix of the depth camera in its pictures of `INFRARED_SIZE`."""

INFRARED_SIZE = (424, 512)

TURN = np.array([0.002, -0.006, 0.001])
"""Rotation from the depth camera's frame to the colour camera's: an axis as long as its angle in radians."""

SHIFT = np.array([0.052, -0.0005, 0.001])
"""Translation that follows it, metres."""

HAND, HAND_TIP, FOOT = 0.08, 0.16, 0.13
"""How far the Kinect's hand and tip of the hand are from the wrist, and its foot from the ankle, metres."""

_SPINE = {"SpineBase": "root", "SpineMid": "spine0", "Neck": "neck", "Head": "head"}

_LIMBS = {
    f"{joint}{side}": f"{side.lower()}_{joint.lower()}"
    for side in ("Left", "Right")
    for joint in ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")
}

JOINT_TYPES = (
    *_SPINE, *(f"{joint}{side}" for side in ("Left", "Right") for joint in ("Shoulder", "Elbow", "Wrist", "Hand")),
    *(f"{joint}{side}" for side in ("Left", "Right") for joint in ("Hip", "Knee", "Ankle", "Foot")),
    "SpineShoulder", "HandTipLeft", "ThumbLeft", "HandTipRight", "ThumbRight",
)  # fmt: skip
"""The 25 joints in the order of the Kinect's SDK."""


def colour_matrix(size: tuple[int, int]) -> Float[np.ndarray, "3 3"]:
    """Camera matrix of colour pictures of so many rows and columns, the first pixel's centre at (0.5, 0.5)."""
    matrix = COLOUR.copy()
    matrix[:2, 2] += 0.5
    matrix[:2] *= size[0] / COLOUR_ROWS
    return matrix


def depth_camera(colour: Camera) -> Camera:
    """The depth camera that belongs to a colour camera."""
    turn = Rotation.from_rotvec(TURN).as_matrix()
    return replace(colour, place=colour.place + colour.turn.T @ SHIFT, turn=turn.T @ colour.turn)


def depth_matrix() -> Float[np.ndarray, "3 3"]:
    """Camera matrix of the depth pictures, the first pixel's centre at (0.5, 0.5)."""
    return INFRARED + [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]]


def calibration(size: tuple[int, int]) -> dict[str, dict[str, Any]]:
    """Content of the two calibration files by name; their frame is the depth camera's.

    Args:
        size: rows and columns of the colour pictures.
    """
    colour = colour_matrix(size) - [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]]
    return {"Color": _told(colour, TURN, SHIFT), "IR": _told(INFRARED, np.zeros(3), np.zeros(3))}


def _told(matrix: Float[np.ndarray, "3 3"], turn: np.ndarray, shift: np.ndarray) -> dict[str, Any]:
    view = np.column_stack([Rotation.from_rotvec(turn).as_matrix(), shift])
    return {
        "c": matrix[:2, 2].tolist(),
        "f": [matrix[0, 0], matrix[1, 1]],
        "k": [0.0] * 5,
        "camera_mtx": matrix.tolist(),
        "view_mtx": view.tolist(),
        "R": turn.tolist(),
        "T": shift.tolist(),
    }


def skeleton(joints: Float[np.ndarray, "19 3"], camera: Camera) -> dict[str, Any]:
    """Content of a skeleton's file: the joints of `GTA_IM_19`, and what the Kinect has beyond them as inferred.

    Args:
        joints: metres, world frame.
        camera: the depth camera.
    """
    known = dict(zip(GTA_IM_19.joints, joints))
    tracked = {name: known[joint] for name, joint in {**_SPINE, **_LIMBS}.items()}
    places = {**tracked, **_inferred(tracked)}
    # The SDK's camera space is the depth camera seen in a mirror: x to its left, y up, z forward.
    mirrored = {name: camera.to_camera(place) * [-1, -1, 1] for name, place in places.items()}
    told = {
        name: {
            "JointType": number,
            "Position": dict(zip("XYZ", mirrored[name].tolist())),
            "TrackingState": 2 if name in tracked else 1,
        }
        for number, name in enumerate(JOINT_TYPES)
    }
    return {"Bodies": [{"IsTracked": True, "TrackingId": 1, "Joints": told}]}


def _inferred(tracked: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Shoulder centre, hands and feet of a body (metres, world frame)."""
    ahead = unit(np.cross(tracked["HipLeft"] - tracked["HipRight"], [0.0, 0.0, 1.0]))
    found = {"SpineShoulder": (tracked["ShoulderLeft"] + tracked["ShoulderRight"]) / 2}
    for side in ("Left", "Right"):
        wrist = tracked[f"Wrist{side}"]
        along = unit(wrist - tracked[f"Elbow{side}"])
        found[f"Hand{side}"] = wrist + HAND * along
        found[f"HandTip{side}"] = wrist + HAND_TIP * along
        found[f"Thumb{side}"] = wrist + HAND * unit(along + ahead)
        found[f"Foot{side}"] = tracked[f"Ankle{side}"] + FOOT * ahead
    return found
