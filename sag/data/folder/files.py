"""The file of a recording that is not a picture: its joints, cameras, frames a second and room."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from sag.data.archives import Shape, read_array
from sag.data.recordings.cameras import WORLD, improper
from sag.errors import SagError

SKELETON, MOTION = "skeleton.yaml", "motion.npz"
"""Names of the files: the joints of all recordings, and the motion of one."""

GUIDE = "docs/own-data.md shows how it is written"
"""Way out of most mistakes."""

FOCAL = (8.0, 1e6)
"""Focal lengths, pixels; a shorter one is told in other units."""

FASTEST = 1000.0
"""Most frames a second."""

LONGEST_NAME = 200
"""Letters that the name of a room may have."""


@dataclass(frozen=True)
class Head:
    """What all frames of a recording have in common.

    Attributes:
        fps: frames a second.
        room: its name.
    """

    fps: float
    room: str


def read_head(path: Path) -> Head:
    """Frames a second and room of a recording.

    Raises:
        SagError: the file is missing or damaged, or does not tell them.
    """
    fps = float(read_array(path, "fps", [()], "fiu", GUIDE))
    if not 0 < fps <= FASTEST:
        raise SagError(f"{path} tells fps {fps:g}, not the frames of one second; {GUIDE}")
    told = read_array(path, "room", [()], "iuU", GUIDE)
    room = str(told) if told.dtype.kind == "U" else str(int(told))
    if not room.strip() or len(room) > LONGEST_NAME:
        raise SagError(f"{path} tells a room whose name has {len(room)} letters; {GUIDE}")
    return Head(fps, room)


def read_joints(path: Path, count: int) -> Float[np.ndarray, "t j 3"]:
    """Joints of all frames, metres, world frame (z up).

    Args:
        path: of the file.
        count: joints of the skeleton.

    Raises:
        SagError: the file is missing or damaged, or its joints are others or cannot be.
    """
    joints = read_array(path, "joints", [(None, count, 3)], way_out=f"{SKELETON} names {count} joints, and {GUIDE}")
    outside = np.argwhere(np.abs(joints) > WORLD)
    if len(outside):
        raise SagError(
            f"{path} has a joint more than {WORLD:g} metres from the origin in frame {outside[0, 0]}; {GUIDE}"
        )
    return joints


def read_cameras(path: Path, frames: int) -> tuple[Float[np.ndarray, "t 4 4"], Float[np.ndarray, "t 3 3"]]:
    """`world2cam` and `intrinsics` of all frames; a camera that does not move may be told once.

    Args:
        path: of the file.
        frames: of the recording.

    Raises:
        SagError: the file is missing or damaged, or its cameras cannot be.
    """
    world2cam, intrinsics = (_each(path, name, size, frames) for name, size in (("world2cam", 4), ("intrinsics", 3)))
    for fault, found in _faults(world2cam, intrinsics).items():
        if found.any():
            raise SagError(f"{path} has {fault}, first in frame {int(found.argmax())}; {GUIDE}")
    return world2cam, intrinsics


def _each(path: Path, name: str, size: int, frames: int) -> np.ndarray:
    """A square matrix for each frame."""
    shapes: list[Shape] = [(size, size), (None, size, size)]
    found = read_array(path, name, shapes, way_out=GUIDE)
    if found.ndim == 3 and len(found) != frames:
        raise SagError(f"{path} holds {name} of {len(found)} frames, but {frames} frames of joints; {GUIDE}")
    return np.broadcast_to(found, (frames, size, size)).copy()


def _faults(world2cam: np.ndarray, intrinsics: np.ndarray) -> dict[str, np.ndarray]:
    """For each thing that cannot be, the frames in which it is."""
    focal = intrinsics[:, [0, 1], [0, 1]]
    return {
        f"intrinsics whose focal length is not in pixels, {FOCAL[0]:g} or more": (
            (focal < FOCAL[0]) | (focal > FOCAL[1])
        ).any(axis=1),
        "intrinsics that are not fx 0 cx, 0 fy cy, 0 0 1": (
            (intrinsics[:, 2] != (0, 0, 1)).any(axis=1) | (intrinsics[:, [0, 1], [1, 0]] != 0).any(axis=1)
        ),
        "world2cam for row vectors, or none: its last row is not 0 0 0 1": (
            (np.abs(world2cam[:, 3] - (0, 0, 0, 1)) > 1e-6).any(axis=1)
        ),
        "world2cam whose rotation is none": improper(world2cam[:, :3, :3]),
        f"a camera more than {WORLD:g} metres from the origin": (np.abs(world2cam[:, :3, 3]) > WORLD).any(axis=1),
    }
