"""What GTA-IM's `info_frames.pickle` tells of a frame: its camera and 98 bones by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from sag.data.gta_im.bones import BONES
from sag.data.gta_im.recording import JOINTS
from sag.data.rooms.cameras import Camera
from sag.data.rooms.person import FRAME_RATE

NEAR, FAR = 0.1, 800.0
"""Clip planes of the game's camera, metres."""

FAR_UNTOLD = 7
"""Every so many frames one does not tell its far clip plane, as in some recordings."""

CLAVICLE = 0.0572 / (0.0572 + 0.1819)
"""Share of the way from neck to shoulder at which the clavicle begins: the lengths of GTA-IM's bones."""

_SIDES = ("R", "L")

_OTHERS = (
    "SKEL_ROOT", "SKEL_Pelvis", "IK_Head", "IK_Root", "RB_Neck_1", "FACIAL_facialRoot",
    *(f"FB_{name}_000" for name in (
        "Brow_Centre", "UpperLipRoot", "UpperLip", "Jaw", "LowerLipRoot", "LowerLip", "Tongue",
    )),
    *(pattern.format(side) for side in _SIDES for pattern in (
        "SKEL_{}_Toe0", "IK_{}_Hand", "IK_{}_Foot", "PH_{}_Hand", "PH_{}_Foot", "MH_{}_Elbow", "MH_{}_Knee",
        "RB_{}_ArmRoll", "RB_{}_ForeArmRoll", "RB_{}_ThighRoll",
        "FB_{}_Brow_Out_000", "FB_{}_Lid_Upper_000", "FB_{}_Eye_000", "FB_{}_CheekBone_000",
        "FB_{}_Lip_Corner_000", "FB_{}_Lip_Top_000", "FB_{}_Lip_Bot_000",
        *(f"SKEL_{{}}_Finger{finger}{part}" for finger in range(5) for part in range(3)),
    )),
)  # fmt: skip

ALL_BONES = (*BONES, *_OTHERS)
"""Names of the game's 98 bones; only those at a joint have a place here, the others are missing."""


def told_frames(
    joints: Float[np.ndarray, "t 21 3"], camera: Camera, origin: Float[np.ndarray, " 3"]
) -> list[dict[str, Any]]:
    """The content of `info_frames.pickle`: plain types alone; bones in another order in every frame.

    Args:
        joints: metres, the game's world frame.
        camera: of the room.
        origin: of the room in the world frame, metres.
    """
    told = {
        "cam_near_clip": NEAR,
        "cam_far_clip": FAR,
        "cam_field_of_view": float(np.rad2deg(camera.field)),
        "cam_pos": (camera.place + origin).tolist(),
        "cam_rot": game_angles(camera).tolist(),
    }
    frames = []
    for number, places in enumerate(joints):
        frame = {"time": round(1000 * number / FRAME_RATE), **told, **_named(places), **_bones(places, number)}
        if number % FAR_UNTOLD == FAR_UNTOLD - 1:
            del frame["cam_far_clip"]
        frames.append(frame)
    return frames


def game_angles(camera: Camera) -> Float[np.ndarray, " 3"]:
    """Degrees about x, then y, then z of the world by which the game turns a camera that looks north along y."""
    # The rows of `turn` are right, down and forward; the game's own axes are right, forward and up.
    right, down, forward = camera.turn
    return Rotation.from_matrix(np.stack([right, forward, -down], axis=1)).as_euler("xyz", degrees=True)


def _named(places: Float[np.ndarray, "21 3"]) -> dict[str, list[float]]:
    """Joints under the names that the game's plugin gives them, where the root is the lowest spine joint."""
    return {"spine4" if name == "root" else name: place.tolist() for name, place in zip(JOINTS, places)}


def _bones(places: Float[np.ndarray, "21 3"], number: int) -> dict[str, list[Any]]:
    """Names and places of all bones; those that are missing are at exactly 0, 0, 0."""
    known = dict(zip(BONES, places))
    names = np.random.default_rng(number).permutation(ALL_BONES).tolist()
    values = np.concatenate([known.get(name, np.zeros(3)) for name in names])
    return {"kpname": names, "kpvalue": values.tolist()}
