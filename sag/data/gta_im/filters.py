"""Which windows of a recording can be used, and why the others cannot."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float

from sag.data.gta_im.cameras import camera_cuts, camera_zooms
from sag.data.gta_im.recording import JOINTS, Recording
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

ROOT = JOINTS.index("root")


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


def root_jumps(recording: Recording, limits: Limits) -> list[int]:
    """Frames after which the root is farther away than a person moves in one frame."""
    return root_jumps_of(recording.joints[:, ROOT], limits)


def root_jumps_of(roots: Float[np.ndarray, "t 3"], limits: Limits) -> list[int]:
    """The same for any root (metres, a frame that does not move)."""
    steps = np.linalg.norm(np.diff(roots, axis=0), axis=1)
    return np.flatnonzero(steps > limits.root_step).tolist()


def events(recording: Recording, limits: Limits) -> Counter[str]:
    """What happens in a recording that windows must cope with: how often its root jumps, its camera cuts and zooms.

    A cut or zoom drops no window: all of it is seen through the camera of its first frame.
    """
    cuts = camera_cuts(recording.world2cam, recording.intrinsics)
    zooms = camera_zooms(recording.intrinsics, cuts)
    jumps = root_jumps(recording, limits)
    return Counter({"root jumps": len(jumps), "camera cuts": len(cuts), "camera zooms": len(zooms)})


def usable_starts(
    recording: Recording, stride: int, limits: Limits, size: tuple[int, int]
) -> tuple[list[int], Counter[str]]:
    """Frames where a usable window starts, and how many windows were dropped for what.

    Args:
        recording: a recording.
        stride: frames from one window to the next.
        limits: what a window must keep to.
        size: rows and columns that the pictures must have.
    """
    if len(recording) < FRAMES:
        return [], Counter({TOO_SHORT: 1})
    jumps = np.array(root_jumps(recording, limits), int)
    faults = {s: _fault(recording, s, jumps, limits, size) for s in range(0, len(recording) - FRAMES + 1, stride)}
    return [s for s, fault in faults.items() if fault is None], Counter(f for f in faults.values() if f)


def _fault(recording: Recording, start: int, jumps: np.ndarray, limits: Limits, size: tuple[int, int]) -> str | None:
    """The first reason against the window that starts at a frame."""
    if start not in recording.pictured:
        return NO_PICTURE
    if recording.size != size:
        return OTHER_SIZE
    if not np.isfinite(recording.clips[start]).all():
        return NO_CLIPS
    if ((jumps >= start) & (jumps < start + FRAMES - 1)).any():
        return ROOT_JUMPS
    joints = recording.seen_from(start, slice(start, start + FRAMES))
    if np.isnan(joints).any():
        return NO_BONE
    if (joints[..., 2] < limits.nearest_joint).any():
        return JOINT_BEHIND
    rows, columns = recording.size
    inside = inside_picture(pixels_of(joints[:, ROOT], recording.intrinsics[start]), rows, columns)
    return None if inside.all() else ROOT_OUTSIDE


def pixels_of(points: Float[np.ndarray, "n 3"], intrinsics: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "n 2"]:
    """Picture coordinates (pixels) of points in the camera frame (metres)."""
    return project(torch.from_numpy(points)[None], torch.from_numpy(intrinsics)[None])[0].numpy()


def inside_picture(pixels: Float[np.ndarray, "n 2"], rows: int, columns: int) -> Bool[np.ndarray, " n"]:
    """Whether picture coordinates lie in the picture."""
    return np.all((pixels >= 0) & (pixels < (columns, rows)), axis=-1)
