"""What windows of any data set of recordings must keep to, and the reasons against them."""

from __future__ import annotations

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
OTHER_SIZE = "picture of another size than the first recording's"
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
