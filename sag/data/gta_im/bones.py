"""Joints and cameras from `info_frames.pickle` alone, for recordings without `info_frames.npz`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from sag.data.gta_im.files import Frame
from sag.errors import SagError

BONES = (
    "SKEL_Head", "SKEL_Neck_1",
    "SKEL_R_Clavicle", "SKEL_R_UpperArm", "SKEL_R_Forearm", "SKEL_R_Hand",
    "SKEL_L_Clavicle", "SKEL_L_UpperArm", "SKEL_L_Forearm", "SKEL_L_Hand",
    "SKEL_Spine3", "SKEL_Spine2", "SKEL_Spine1", "SKEL_Spine0", "SKEL_Spine_Root",
    "SKEL_R_Thigh", "SKEL_R_Calf", "SKEL_R_Foot", "SKEL_L_Thigh", "SKEL_L_Calf", "SKEL_L_Foot",
)  # fmt: skip
"""The bones behind the 21 joints of `info_frames.npz`, in its order; the pickle names 98."""

CAMERA = {"cam_pos": 3, "cam_rot": 3, "cam_field_of_view": 1}
"""What a frame tells of its camera, and how many numbers each is."""

FORWARD = Rotation.from_euler("x", -90, degrees=True)
"""From the camera frame (x right, y down, z forward) to the game's (x right, y forward, z up)."""


def joints_of(frames: Sequence[Frame], path: Path) -> Float[np.ndarray, "t 21 3"]:
    """Joints in the world, metres; not a number where a frame lacks the bone or has it at the world's origin.

    Bones are found by name in each frame: their order may change from one to the next.

    Args:
        frames: of a recording.
        path: of their file, for the error.

    Raises:
        SagError: a frame does not name its bones.
    """
    joints = np.full((len(frames), len(BONES), 3), np.nan)
    for place, frame in enumerate(frames):
        try:
            names = {str(name): number for number, name in enumerate(frame["kpname"])}
            values = np.asarray(frame["kpvalue"], float).reshape(len(frame["kpname"]), 3)
        except (KeyError, TypeError, ValueError) as error:
            raise SagError(f"{path} has no kpname with a kpvalue for each in frame {place} ({error!r})") from error
        known = [joint for joint, bone in enumerate(BONES) if bone in names]
        found = values[[names[BONES[joint]] for joint in known]]
        joints[place, known] = np.where(found.any(axis=1, keepdims=True), found, np.nan)
    return joints


def cameras_of(
    frames: Sequence[Frame], size: tuple[int, int], path: Path
) -> tuple[Float[np.ndarray, "t 4 4"], Float[np.ndarray, "t 3 3"]]:
    """World-to-camera matrices for row vectors (metres) and camera matrices (pixels), as in `info_frames.npz`.

    `cam_rot` are degrees about the fixed axes x, y and z, in this order; `cam_field_of_view` is the vertical angle in
    degrees. Rebuilt like this, the cameras of an original recording agree with its archive to 2e-11.

    Args:
        frames: of a recording.
        size: rows and columns of its pictures.
        path: of their file, for the error.

    Raises:
        SagError: a frame does not tell its camera.
    """
    told = np.array([_camera(frame, place, path) for place, frame in enumerate(frames)]).reshape(-1, 7)
    axes = (Rotation.from_euler("xyz", told[:, 3:6], degrees=True) * FORWARD).as_matrix()
    world2cam = np.tile(np.eye(4), (len(told), 1, 1))
    world2cam[:, :3, :3] = axes
    world2cam[:, 3, :3] = -np.einsum("ti,tij->tj", told[:, :3], axes)
    rows, columns = size
    intrinsics = np.tile(np.array([[0, 0, columns / 2], [0, 0, rows / 2], [0, 0, 1]]), (len(told), 1, 1))
    intrinsics[:, 0, 0] = intrinsics[:, 1, 1] = rows / (2 * np.tan(np.radians(told[:, 6]) / 2))
    return world2cam, intrinsics


def _camera(frame: Frame, place: int, path: Path) -> np.ndarray:
    """Place, rotation and field of view of one camera."""
    try:
        numbers = np.concatenate([np.ravel(np.asarray(frame[name], float)) for name in CAMERA])
    except (KeyError, TypeError, ValueError) as error:
        told = f"{path} does not tell {', '.join(CAMERA)} in frame {place} ({error!r})"
        raise SagError(f"{told}: info_frames.npz is needed beside it") from error
    if numbers.shape != (7,) or not np.isfinite(numbers).all() or not 1 <= numbers[6] <= 170:
        raise SagError(f"{path} tells no possible camera in frame {place}: {', '.join(CAMERA)} are {numbers.tolist()}")
    return numbers
