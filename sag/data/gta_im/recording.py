"""One recording of GTA-IM as it lies on disk."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from sag.data.gta_im.bones import cameras_of, joints_of
from sag.data.gta_im.cameras import check_cameras, check_places
from sag.data.gta_im.files import ARCHIVE, PICKLE, REALTIME, clips_of, read_arrays, read_frames, read_room
from sag.data.paths import contained
from sag.data.pictures import picture_size, read_24_bit, read_colour, refuse_cut_off
from sag.data.recordings.views import Picture
from sag.errors import SagError
from sag.skeleton import Skeleton

JOINTS = (
    "head", "neck",
    "right_clavicle", "right_shoulder", "right_elbow", "right_wrist",
    "left_clavicle", "left_shoulder", "left_elbow", "left_wrist",
    "spine0", "spine1", "spine2", "spine3", "root",
    "right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle",
)  # fmt: skip
"""The 21 joints in the order of the files, by the names that `sag.skeleton` gives them."""

ROOT = JOINTS.index("root")

CHEST = "spine0"
"""The top of the spine, which other skeletons call the chest."""

NATIVE = (1080, 1920)
"""Rows and columns of the original pictures."""

SUFFIXES = (".jpg", ".png", "_id.png")
"""How the names of a frame's pictures end: colour, depth and ids."""


def joint_places(skeleton: Skeleton) -> list[int]:
    """Places of a skeleton's joints among the 21 of the files.

    Raises:
        SagError: GTA-IM lacks one of the joints.
    """
    names = [CHEST if joint == "chest" else joint for joint in skeleton.joints]
    if missing := sorted(set(names) - set(JOINTS)):
        raise SagError(f"skeleton {skeleton.name} has joints that GTA-IM lacks: {', '.join(missing)}")
    return [JOINTS.index(name) for name in names]


@dataclass(frozen=True)
class Recording:
    """A recording: joints and cameras of all frames, pictures of some.

    Attributes:
        folder: its files.
        room: number of the scene.
        joints: metres, world frame (z up); not a number where one is missing.
        world2cam: row vectors, `[x, 1] @ world2cam` is in the camera frame (x right, y down, z forward).
        intrinsics: camera matrix in pixels of the native picture.
        clips: distances of the near and the far clip plane, metres; not a number where unknown.
    """

    folder: Path
    room: int
    joints: Float[np.ndarray, "t 21 3"]
    world2cam: Float[np.ndarray, "t 4 4"]
    intrinsics: Float[np.ndarray, "t 3 3"]
    clips: Float[np.ndarray, "t 2"]

    @classmethod
    def read(cls, folder: Path) -> Recording:
        """Reads everything but the pictures; without `info_frames.npz` from the pickle alone.

        Raises:
            SagError: a file is missing, damaged or of another layout, or tells what cannot be, or the folder is a link
                that leads elsewhere.
        """
        contained(folder, folder.parent)
        frames, told = read_frames(folder / PICKLE), folder / PICKLE
        if (folder / ARCHIVE).exists():
            told = folder / ARCHIVE
            joints, world2cam, intrinsics = read_arrays(told).values()
        else:
            joints = joints_of(frames, told)
            world2cam, intrinsics = cameras_of(frames, _picture_size(folder), told)
        check_places(joints, told)
        check_cameras(world2cam, intrinsics, told)
        clips = np.full((len(joints), 2), np.nan)
        known = clips_of(frames, folder / PICKLE)[: len(clips)]
        clips[: len(known)] = known
        return cls(folder, read_room(folder / REALTIME), joints, world2cam, intrinsics, clips)

    def __len__(self) -> int:
        return len(self.joints)

    @cached_property
    def pictured(self) -> frozenset[int]:
        """Frames that have colour, depth and ids."""
        names = {path.name for path in self.folder.iterdir()}
        frames = (int(n[:5]) for n in names if n[5:] == ".jpg" and n[:5].isdecimal() and n.isascii())
        return frozenset(f for f in frames if all(self._file(f, s).name in names for s in SUFFIXES))

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns of the native pictures: the cameras look through their centre."""
        columns, rows = np.rint(2 * self.intrinsics[0, :2, 2]).astype(int).tolist()
        return rows, columns

    def seen_from(self, frame: int, frames: slice) -> Float[np.ndarray, "t 21 3"]:
        """Joints of some frames in the camera frame of one frame, metres."""
        camera = self.world2cam[frame]
        # In float64: the world's coordinates are in the hundreds of metres.
        return self.joints[frames] @ camera[:3, :3] + camera[3, :3]

    def picture(self, frame: int) -> Picture:
        """Colour, depth and ids of a frame.

        Raises:
            SagError: a picture is damaged, cut off or of another size than the camera.
        """
        colour = read_colour(self._file(frame, ".jpg"))
        refuse_cut_off(colour, self._file(frame, ".jpg"))
        codes, ids = (read_24_bit(self._file(frame, s)) for s in (".png", "_id.png"))
        if not colour.shape[:2] == codes.shape == ids.shape == self.size:
            raise SagError(f"{self._file(frame, '.jpg')}, its depth and its ids are not all of {self.size} pixels")
        return Picture(colour, planar_depth(codes, *self.clips[frame]), ids, self.intrinsics[frame])

    def _file(self, frame: int, suffix: str) -> Path:
        return self.folder / f"{frame:05d}{suffix}"


def planar_depth(codes: Int[np.ndarray, "h w"], near: float, far: float) -> Float[np.ndarray, "h w"]:
    """Planar z (metres) of stored depth; 0 where nothing is stored or it is nearer than the near clip plane.

    Args:
        codes: 24-bit numbers of the depth picture, an inverse depth.
        near: near clip plane, metres.
        far: far clip plane, metres.
    """
    inverse = 50.0 / np.maximum(codes, 1)
    depth = near * far / (near + inverse * (far - near))
    return np.where((codes > 0) & (inverse <= 1), depth, 0.0)


def recordings_in(folder: Path) -> Iterator[Path]:
    """Folders of recordings, in order of their names: those that hold any of their three files."""
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if any((path / name).exists() for name in (ARCHIVE, PICKLE, REALTIME)):
            yield path


def _picture_size(folder: Path) -> tuple[int, int]:
    """Rows and columns of a recording's pictures, by the first."""
    first = min(folder.glob("[0-9][0-9][0-9][0-9][0-9].jpg"), default=None)
    return NATIVE if first is None else picture_size(first)
