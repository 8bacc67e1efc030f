"""A small data set with a skeleton of its own: 17 joints as Human3.6M's, people who walk before a slanted wall."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from PIL import Image

from sag.data.folder import FolderDataModule

ROWS, COLUMNS = 72, 128
SIZE = (36, 64)
"""Rows and columns of the windows' pictures."""

SKIN = 0.05
"""How far the drawn skin lies before the joints, metres."""

BODY = {
    "pelvis": (0.0, 0.0, 0.0),
    "right_hip": (0.12, 0.0, 0.0), "right_knee": (0.12, 0.0, -0.42), "right_ankle": (0.12, 0.0, -0.84),
    "left_hip": (-0.12, 0.0, 0.0), "left_knee": (-0.12, 0.0, -0.42), "left_ankle": (-0.12, 0.0, -0.84),
    "spine": (0.0, 0.0, 0.22), "thorax": (0.0, 0.0, 0.46), "nose": (0.0, 0.1, 0.56), "head": (0.0, 0.0, 0.66),
    "left_shoulder": (-0.18, 0.0, 0.42), "left_elbow": (-0.2, 0.0, 0.16), "left_wrist": (-0.2, 0.0, -0.06),
    "right_shoulder": (0.18, 0.0, 0.42), "right_elbow": (0.2, 0.0, 0.16), "right_wrist": (0.2, 0.0, -0.06),
}  # fmt: skip
"""Joints from the pelvis, metres, z up, the face to y."""

GUIDE = Path(__file__).parents[2] / "docs/own-data.md"

SKELETON: dict[str, Any] = yaml.safe_load(re.findall(r"```yaml\n(.*?)```", GUIDE.read_text(), re.DOTALL)[0])
"""The skeleton of the documentation, as its file tells it."""

INTRINSICS = np.array([[90.0, 0, 60], [0, 90, 38], [0, 0, 1]])
"""The camera does not look through the middle of its pictures."""

WORLD2CAM = np.array([[1.0, 0, 0, 7], [0, 0, -1, 1.1], [0, 1, 0, -20], [0, 0, 0, 1]])
"""Column vectors: the camera stands at (-7, 20, 1.1) and looks along y."""


class Take:
    """A recording before it is written; tests change its arrays.

    Attributes:
        arrays: what `motion.npz` holds.
        moving: whether the camera of each frame is told, and not one for all.
    """

    def __init__(self, frames: int = 70, room: str | int = "kitchen", seed: int = 0) -> None:
        generator = np.random.default_rng(seed)
        time = np.arange(frames)[:, None] / 30
        roots = np.array([-7, 23.5, 0.925]) + time * (*generator.uniform([-0.2, 0], [0.2, 0.4]), 0)
        swing = 0.06 * np.sin(6 * time + generator.uniform(0, 6, 17))[..., None] * [0, 1, 0]
        far = np.abs(list(BODY.values())).sum(axis=1) > 0.5
        joints = roots[:, None] + list(BODY.values()) + swing * far[:, None]
        self.arrays: dict[str, Any] = {
            "joints": joints.astype(np.float32),
            "world2cam": WORLD2CAM,
            "intrinsics": INTRINSICS,
            "fps": 30,
            "room": room,
        }

    def with_moving_camera(self) -> Take:
        """The same, with a camera that comes nearer, told for each frame."""
        frames = len(self.arrays["joints"])
        self.arrays["world2cam"] = np.tile(WORLD2CAM, (frames, 1, 1))
        self.arrays["world2cam"][:, 2, 3] -= 0.002 * np.arange(frames)
        self.arrays["intrinsics"] = np.tile(INTRINSICS, (frames, 1, 1))
        return self

    def in_camera(self, frame: int) -> np.ndarray:
        """(17, 3) joints of a frame in its camera, metres."""
        told = self.arrays["world2cam"]
        camera = told if told.ndim == 2 else told[frame]
        return self.arrays["joints"][frame] @ camera[:3, :3].T + camera[:3, 3]

    def drawn(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Depth (metres) and the person of a frame: a wall from 5 m to 9 m, and balls along the bones."""
        joints, names = self.in_camera(frame), list(BODY)
        ends = np.array([[joints[names.index(a)], joints[names.index(b)]] for a, b in SKELETON["bones"]])
        balls = (ends[:, 0] + np.linspace(0, 1, 6)[:, None, None] * (ends[:, 1] - ends[:, 0])).reshape(-1, 3)
        depth, person = np.tile(np.linspace(5, 9, COLUMNS), (ROWS, 1)), np.zeros((ROWS, COLUMNS), bool)
        rows, columns = np.mgrid[:ROWS, :COLUMNS] + 0.5
        for ball in balls:
            u, v = (INTRINSICS @ (ball / ball[2]))[:2]
            inside = (columns - u) ** 2 + (rows - v) ** 2 < (0.08 * 90 / ball[2]) ** 2
            depth[inside], person[inside] = np.minimum(depth, ball[2] - SKIN)[inside], True
        return depth, person

    def write(
        self, folder: Path, pictured: Iterable[int] = range(6), person: bool = True, suffix: str = ".jpg"
    ) -> Path:
        """Writes it to a folder of its own."""
        folder.mkdir(parents=True)
        np.savez(folder / "motion.npz", **self.arrays)
        for frame in pictured:
            depth, mask = self.drawn(frame)
            rows, columns = np.mgrid[:ROWS, :COLUMNS]
            colour = np.stack([2 * rows, columns, np.where(mask, 255, 0)], -1).astype(np.uint8)
            Image.fromarray(colour).save(folder / f"{frame:05d}{suffix}")
            Image.fromarray(np.rint(1000 * depth).astype(np.uint16)).save(folder / f"{frame:05d}_depth.png")
            if person:
                Image.fromarray(mask.astype(np.uint8)).save(folder / f"{frame:05d}_person.png")
        return folder


def write_skeleton(root: Path, /, **changes: object) -> Path:
    """Writes `skeleton.yaml`, with changes."""
    root.mkdir(parents=True, exist_ok=True)
    (root / "skeleton.yaml").write_text(yaml.safe_dump({**SKELETON, **changes}, sort_keys=False))
    return root


def write_root(root: Path, rooms: Iterable[str | int] = ("attic", "kitchen", "study")) -> Path:
    """A data set of one recording in each room, of windows that start in frames 0 to 5."""
    write_skeleton(root)
    for place, room in enumerate(rooms):
        Take(room=room, seed=place).write(root / f"take{place}")
    return root


def module(root: Path, cache_dir: Path, **options: Any) -> FolderDataModule:
    """The data module with small pictures."""
    return FolderDataModule(root, **{"cache_dir": cache_dir, "image_size": SIZE, "stride": 1, **options})
