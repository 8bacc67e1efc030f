"""One recording of a folder of one's own as it lies on disk."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from sag.data.folder.files import MOTION, Head, read_cameras, read_head, read_joints
from sag.data.folder.pictures import Pictures
from sag.data.paths import contained
from sag.errors import SagError
from sag.skeleton import Skeleton


@dataclass(frozen=True)
class Recording:
    """A recording: joints and cameras of all frames, pictures of some.

    Attributes:
        folder: its files.
        skeleton: of the joints.
        head: frames a second and room.
        joints: metres, world frame (z up).
        world2cam: column vectors, metres, to the camera frame (x right, y down, z forward).
        intrinsics: camera matrix in pixels of the pictures.
        pictures: of some of the frames.
    """

    folder: Path
    skeleton: Skeleton
    head: Head
    joints: Float[np.ndarray, "t j 3"]
    world2cam: Float[np.ndarray, "t 4 4"]
    intrinsics: Float[np.ndarray, "t 3 3"]
    pictures: Pictures

    @classmethod
    def read(cls, folder: Path, skeleton: Skeleton) -> Recording:
        """Reads everything but the pictures, of which it looks at the names and one size.

        Args:
            folder: of the recording.
            skeleton: of the joints in the file.

        Raises:
            SagError: the motion is missing, damaged or cannot be, or the pictures are missing, of other frames or of
                another camera.
        """
        contained(folder, folder.parent)
        path, pictures = folder / MOTION, Pictures(folder)
        joints = read_joints(path, len(skeleton.joints))
        world2cam, intrinsics = read_cameras(path, len(joints))
        pictures.check(len(joints))
        beside = (intrinsics[:, :2, 2] <= 0) | (intrinsics[:, :2, 2] >= pictures.size[::-1])
        if beside.any():
            frame = int(beside.any(axis=1).argmax())
            raise SagError(
                f"{path} has intrinsics of other pictures than these of {pictures.size} pixels: in frame {frame} the "
                "camera looks beside them"
            )
        return cls(folder, skeleton, read_head(path), joints, world2cam, intrinsics, pictures)

    def __len__(self) -> int:
        return len(self.joints)

    @property
    def room(self) -> str:
        """Name of its room."""
        return self.head.room

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns of its pictures."""
        return self.pictures.size

    def seen_from(self, frame: int, frames: slice) -> Float[np.ndarray, "t j 3"]:
        """Joints of some frames in the camera frame of one frame, metres."""
        camera = self.world2cam[frame]
        return self.joints[frames] @ camera[:3, :3].T + camera[:3, 3]


def recordings_in(root: Path) -> Iterator[Path]:
    """Folders of recordings, in order of their names: those that hold a file of motion."""
    for path in sorted(root.iterdir()) if root.is_dir() else ():
        if (path / MOTION).exists():
            yield path
