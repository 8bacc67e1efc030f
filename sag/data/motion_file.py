"""Motions on disk: what `sag predict` writes and `sag score` reads, from here or from anywhere else.

A file is a `.npz` with `joints` (n, k, 65, j, 3) or (n, 65, j, 3), metres in the camera frame of frame 0 (x right, y
down, z forward), the given frame first. `index` (n,) names the window of the data set that each continues; without
it there is one for each test window, in order. `fps` and `skeleton` are checked where they are there. `sag extend`
writes longer motions in the same form; figures are of 65 frames, so these are read only where any number is allowed.
"""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.files import write_whole
from sag.types import FRAMES

FARTHEST_START = 0.5
"""Metres by which the joints of the given frame may miss the window's own, on the median, before axes, frame or index
must be others."""


@dataclass(frozen=True)
class MotionFile:
    """Motions read from a file.

    Attributes:
        path: the file.
        joints: metres, camera frame of frame 0, the given frame first.
        index: place of each window in the data set; None where the file does not say.
        fps: frames a second; None where the file does not say.
        skeleton: its name; None where the file does not say.
    """

    path: Path
    joints: Float[np.ndarray, "n k t j 3"]
    index: Int[np.ndarray, " n"] | None = None
    fps: float | None = None
    skeleton: str | None = None

    def by_window(self, data: MotionDataModule) -> dict[int, int]:
        """Row of the file for each window of the data set that it continues.

        Raises:
            SagError: frames a second, joints, windows or the given frame are not those of the data set.
        """
        rows = data.cache.rows("test")
        joints = len(data.skeleton.joints)
        if self.fps is not None and abs(self.fps - data.fps) > 1e-3:
            raise SagError(f"{self.path} has {self.fps:g} frames a second, {data.name} has {data.fps:g}; resample it")
        if self.joints.shape[3] != joints or (self.skeleton or data.skeleton.name) != data.skeleton.name:
            found = f"{self.joints.shape[3]} joints" + (f" of skeleton {self.skeleton}" if self.skeleton else "")
            raise SagError(f"{self.path} has {found}, not the {joints} of {data.skeleton.name} as {data.name} has")
        if self.index is None and len(self.joints) != len(rows):
            raise SagError(
                f"{self.path} has {len(self.joints)} motions and no index, but {data.name} has {len(rows)} test "
                "windows; add an array `index` with the window of each motion"
            )
        index = rows if self.index is None else self.index
        known = np.isin(index, rows)
        if not known.all() or len(np.unique(index)) < len(index):
            wrong = (
                f"{int(index[~known][0])}, which is no test window ({rows[0]} to {rows[-1]})"
                if not known.all()
                else "a window twice"
            )
            raise SagError(
                f"{self.path}: its index names {wrong}, in {data.name} of fingerprint {data.cache.fingerprint}"
            )
        self._check_start(data, index)
        return {int(window): row for row, window in enumerate(index)}

    def _check_start(self, data: MotionDataModule, index: np.ndarray) -> None:
        """Refuses motions in other units or another frame: their given frame is not where the window's is."""
        given, true = self.joints[:, 0, 0], data.cache.joints[index][:, 0]
        sizes = [float(np.median(np.ptp(x, axis=1).max(axis=-1))) for x in (given, true)]
        if not 0.2 < sizes[0] / sizes[1] < 5:
            raise SagError(
                f"{self.path}: people measure {sizes[0]:,.2f} at frame 0, those of {data.name} {sizes[1]:,.2f} m; "
                "convert the joints to metres"
            )
        off = float(np.median(np.linalg.norm(given - true, axis=-1).mean(axis=-1)))
        if off > FARTHEST_START:
            raise SagError(
                f"{self.path}: joints at frame 0 are {off:.1f} m from the window's own; they must be in the camera "
                "frame of frame 0 (x right, y down, z forward), the given frame first, and the index must be right"
            )


def read_motions(path: Path, frames: int | None = FRAMES) -> MotionFile:
    """Motions from a `.npz`; nothing in it is executed.

    Args:
        path: of the file.
        frames: that its motions must have; None where any number will do.

    Raises:
        SagError: it is missing, damaged, or holds other shapes than the sentence names.
    """
    if not path.is_file():
        raise SagError(f"{path} does not exist; sag predict writes such files")
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in ("joints", "index", "fps", "skeleton") if name in file}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, TypeError) as error:
        raise SagError(f"{path} cannot be read as a .npz of plain arrays ({error})") from error
    joints = arrays.get("joints")
    if joints is None or not np.issubdtype(joints.dtype, np.floating):
        raise SagError(f"{path} has no array `joints` of floating-point numbers, (n, 65, j, 3) or (n, k, 65, j, 3)")
    joints = joints[:, None] if joints.ndim == 4 else joints
    if joints.ndim != 5 or joints.shape[2] != (frames or joints.shape[2]) or joints.shape[4] != 3 or not joints.size:
        some = frames or "t"
        raise SagError(
            f"{path}: joints are {arrays['joints'].shape}, they must be (n, {some}, j, 3) or (n, k, {some}, j, 3): "
            f"the given frame and {'those' if frames is None else f'the {frames - 1}'} that follow"
        )
    broken = ~np.isfinite(joints).all(axis=(1, 2, 3, 4))
    if broken.any():
        raise SagError(f"{path}: motion {int(np.argmax(broken))} has coordinates that are not finite; leave it out")
    return MotionFile(path, joints, *_labels(path, arrays, len(joints)))


def _labels(path: Path, arrays: dict[str, np.ndarray], count: int) -> tuple[Any, float | None, str | None]:
    """Index, frames a second and skeleton of a file, checked."""
    index = arrays.get("index")
    if index is not None and (index.shape != (count,) or not np.issubdtype(index.dtype, np.integer)):
        raise SagError(f"{path}: index is {index.dtype} {index.shape}, it must be a whole number for each motion")
    fps, skeleton = arrays.get("fps"), arrays.get("skeleton")
    if fps is not None and (fps.size != 1 or not np.issubdtype(fps.dtype, np.number)):
        raise SagError(f"{path}: fps must be one number")
    return index, None if fps is None else float(fps), None if skeleton is None else str(skeleton)


def write_motions(path: Path, motions: MotionFile) -> None:
    """Writes motions whole or not at all."""
    arrays: dict[str, Any] = {"joints": motions.joints}
    for name in ("index", "fps", "skeleton"):
        if getattr(motions, name) is not None:
            arrays[name] = np.asarray(getattr(motions, name))
    write_whole(path, lambda file: np.savez_compressed(file, **arrays))
