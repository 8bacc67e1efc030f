"""A tiny recording in GTA-IM's own layout: a person before a slanted wall, seen by a moving camera."""

from __future__ import annotations

import pickle
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from PIL import Image

from sag.data.gta_im import GtaImDataModule
from sag.data.gta_im.recording import JOINTS, joint_places
from sag.data.recordings.filters import Limits
from sag.data.recordings.views import WindowFormat
from sag.skeleton import GTA_IM_19, Skeleton

ROWS, COLUMNS = 108, 192
SIZE = (54, 96)
"""Rows and columns of the windows' pictures."""

NEAR, FAR = 0.1, 800.0
PERSON, CLOSE_ID, WALL = 0x011703, 0x011704, 0x000300
"""Ids; the second differs from the first in the lowest byte alone."""

SKIN = 0.05
"""How far the drawn skin lies before the joints, metres."""

CLOSE_BOX = (slice(0, 20), slice(0, 20))
"""Native rows and columns of an object with the id `CLOSE_ID`."""

BODY = {
    "head": (0.0, 0.0, 0.75), "neck": (0.0, 0.0, 0.6),
    "clavicle": (0.05, 0.0, 0.58), "shoulder": (0.2, 0.0, 0.55), "elbow": (0.22, 0.0, 0.3), "wrist": (0.22, 0.0, 0.1),
    "spine0": (0.0, 0.0, 0.4), "spine1": (0.0, 0.0, 0.3), "spine2": (0.0, 0.0, 0.2), "spine3": (0.0, 0.0, 0.1),
    "root": (0.0, 0.0, 0.0), "hip": (0.1, 0.0, 0.0), "knee": (0.1, 0.0, -0.4), "ankle": (0.1, 0.0, -0.8),
}  # fmt: skip
"""Joints before the root, metres, z up; the left side mirrors the right in x."""


def body() -> np.ndarray:
    """(21, 3) joints before the root."""
    side = {"left": np.array([-1.0, 1, 1]), "right": np.ones(3)}
    split = [name.partition("_") for name in JOINTS]
    return np.array([side[a] * BODY[b] if b else BODY[a] for a, _, b in split])


def intrinsics(field_of_view: float = 50.0) -> np.ndarray:
    focal = ROWS / (2 * np.tan(np.radians(field_of_view) / 2))
    return np.array([[focal, 0, COLUMNS / 2], [0, focal, ROWS / 2], [0, 0, 1]])


def camera(frame: int) -> tuple[np.ndarray, np.ndarray]:
    """World axes of the camera (rows: right, down, forward) and its place, metres."""
    heading = 0.002 * frame
    forward = np.array([np.sin(heading), np.cos(heading), -0.1])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward]), np.array([-300 + 0.003 * frame, 500.0, 40.2])


class Sequence:
    """What a recording holds, before it is written; tests change its arrays.

    Attributes:
        roots: (t, 3) metres, world.
        clips: a dict of clip planes for each frame.
    """

    def __init__(self, frames: int = 70) -> None:
        self.frames = frames
        self.roots = np.array([-300, 503.5, 40.0]) + 0.01 * np.arange(frames)[:, None] * [1, 0.5, 0]
        self.offsets = np.tile(body(), (frames, 1, 1))
        self.clips = [{"cam_near_clip": NEAR, "cam_far_clip": FAR} for _ in range(frames)]

    @property
    def joints(self) -> np.ndarray:
        return self.roots[:, None] + self.offsets

    def in_camera(self, frame: int, frames: slice) -> np.ndarray:
        """Joints of some frames in the camera of one, by column vectors."""
        axes, place = camera(frame)
        return np.einsum("ij,tkj->tki", axes, self.joints[frames] - place)

    def in_picture(self, frame: int) -> np.ndarray:
        """(1, 21, 2) joints of a frame in pixels of its picture."""
        pixels = self.in_camera(frame, slice(frame, frame + 1)) @ intrinsics().T
        return pixels[..., :2] / pixels[..., 2:]

    def write(self, folder: Path, room: int = 1, pictured: Iterable[int] = range(6)) -> Path:
        folder.mkdir(parents=True)
        cameras = [camera(frame) for frame in range(self.frames)]
        world2cam = np.tile(np.eye(4), (self.frames, 1, 1))
        world2cam[:, :3, :3] = [axes.T for axes, _ in cameras]
        world2cam[:, 3, :3] = [-axes @ place for axes, place in cameras]
        np.savez(
            folder / "info_frames.npz",
            joints_3d_world=self.joints,
            world2cam_trans=world2cam,
            intrinsics=np.tile(intrinsics(), (self.frames, 1, 1)),
            joints_2d=np.concatenate([self.in_picture(frame) for frame in range(self.frames)]),
        )
        (folder / "info_frames.pickle").write_bytes(pickle.dumps(self.clips))
        (folder / "realtimeinfo.gz").write_bytes(pickle.dumps({"frames": [], "setting": {"room": room}}))
        for frame in pictured:
            self._write_pictures(folder, frame)
        return folder

    def _write_pictures(self, folder: Path, frame: int) -> None:
        depth, ids = self.drawn(frame)
        columns, rows = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
        colour = np.stack([rows, columns, np.where(ids == PERSON, 255, 0)], -1).astype(np.uint8)
        Image.fromarray(colour).save(folder / f"{frame:05d}.jpg", quality=95)
        Image.fromarray(packed(stored(depth))).save(folder / f"{frame:05d}.png")
        Image.fromarray(packed(ids)).save(folder / f"{frame:05d}_id.png")

    def drawn(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Depth (metres) and ids of a frame: a wall from 6 m to 25 m, and a blob for each joint."""
        depth = np.tile(np.linspace(6, 25, COLUMNS), (ROWS, 1))
        ids = np.full((ROWS, COLUMNS), WALL)
        ids[CLOSE_BOX] = CLOSE_ID
        rows, columns = np.mgrid[:ROWS, :COLUMNS] + 0.5
        for x, y, z in self.in_camera(frame, slice(frame, frame + 1))[0]:
            u, v = (intrinsics() @ [x / z, y / z, 1])[:2]
            blob = (columns - u) ** 2 + (rows - v) ** 2 < 16
            depth[blob], ids[blob] = np.minimum(depth, z - SKIN)[blob], PERSON
        return depth, ids


def stored(depth: np.ndarray) -> np.ndarray:
    """The 24-bit numbers that the depth pictures hold."""
    return np.rint(50 / ((NEAR * FAR / depth - NEAR) / (FAR - NEAR))).astype(int)


def packed(values: np.ndarray) -> np.ndarray:
    """24-bit numbers as colours."""
    return np.stack([values >> 16, values >> 8 & 255, values & 255], -1).astype(np.uint8)


def form(skeleton: Skeleton = GTA_IM_19, **limits: float) -> WindowFormat:
    """How windows are stored, with small pictures."""
    return WindowFormat(joint_places(skeleton), skeleton.root_index, SIZE, 1, Limits(**limits))


def module(root: Path, cache_dir: Path, **options: object) -> GtaImDataModule:
    """The data module with small pictures."""
    return GtaImDataModule(root, cache_dir=cache_dir, **{"image_size": SIZE, **options})
