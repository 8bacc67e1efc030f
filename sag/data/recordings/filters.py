"""What windows of any data set of recordings must keep to, and the reasons against them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float

from sag.geometry.camera import project
from sag.types import FRAMES

TOO_SHORT = f"recording of fewer than {FRAMES} frames"
NO_PICTURE = "no picture at the start frame"
NO_CLIPS = "no clip planes of the camera at the start frame"
ROOT_JUMPS = "root jumps"
JOINT_BEHIND = "joint behind the start camera"
ROOT_OUTSIDE = "root leaves the start picture"
OTHER_SIZE = "picture of another size than most recordings'"
OTHER_ROOM = "room in neither train_rooms nor test_rooms"
UNREADABLE = "unreadable picture"
CUT_OFF = "cut-off picture"
BROKEN = "broken recording"
NO_BONE = "joint that the recording lacks"
HIDDEN = "person hidden at the start frame"


@dataclass(frozen=True)
class Limits:
    """What a window must keep to.

    Attributes:
        root_step: farthest that the root moves in one frame, metres; the recordings have teleports.
        nearest_joint: smallest planar z of any joint in the start camera, metres.
        farthest_depth: depth beyond this is not known, metres.
    """

    root_step: float = 0.3
    nearest_joint: float = 0.1
    farthest_depth: float = 20.0


def root_jumps(roots: Float[np.ndarray, "t 3"], limits: Limits) -> list[int]:
    """Frames after which the root (metres, a frame that does not move) is farther away than a person moves in one."""
    steps = np.linalg.norm(np.diff(roots, axis=0), axis=1)
    return np.flatnonzero(steps > limits.root_step).tolist()


def pixels_of(points: Float[np.ndarray, "n 3"], intrinsics: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "n 2"]:
    """Picture coordinates (pixels) of points in the camera frame (metres)."""
    return project(torch.from_numpy(points)[None], torch.from_numpy(intrinsics)[None])[0].numpy()


def inside_picture(pixels: Float[np.ndarray, "n 2"], rows: int, columns: int) -> Bool[np.ndarray, " n"]:
    """Whether picture coordinates lie in the picture."""
    return np.all((pixels >= 0) & (pixels < (columns, rows)), axis=-1)


def faultless_starts(frames: int, stride: int, fault: Callable[[int], str | None]) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what.

    Args:
        frames: of the recording.
        stride: frames from one window to the next.
        fault: the first reason against the window that starts at a frame; nothing where there is none.
    """
    if frames < FRAMES:
        return [], Counter({TOO_SHORT: 1})
    faults = {start: fault(start) for start in range(0, frames - FRAMES + 1, stride)}
    return [start for start, found in faults.items() if found is None], Counter(f for f in faults.values() if f)


def motion_fault(
    joints: Float[np.ndarray, "t j 3"],
    root: int,
    intrinsics: Float[np.ndarray, "3 3"],
    size: tuple[int, int],
    limits: Limits,
) -> str | None:
    """The first reason against the motion of a window, if there is one.

    Args:
        joints: those of the skeleton, metres, camera frame of the window's start; not numbers where one is missing.
        root: its place among the joints.
        intrinsics: camera matrix in pixels of the start picture.
        size: rows and columns of the start picture.
        limits: what a window must keep to.
    """
    if np.isnan(joints).any():
        return NO_BONE
    if (joints[..., 2] < limits.nearest_joint).any():
        return JOINT_BEHIND
    return None if inside_picture(pixels_of(joints[:, root], intrinsics), *size).all() else ROOT_OUTSIDE
