"""GTA-IM (Cao et al., ECCV 2020): people in rooms of a game, from the files its authors send on request."""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from sag.data.base import MotionDataModule
from sag.data.cache import DEPTH_UNIT, SPLITS, WindowCache, open_or_build, write_cache
from sag.data.gta_im.convert import convert, scratch_folder
from sag.data.gta_im.filters import Limits
from sag.data.gta_im.plan import Plan, planned
from sag.data.gta_im.recording import joint_places, recordings_in
from sag.data.gta_im.splits import RoomSplit
from sag.data.gta_im.views import WindowFormat
from sag.errors import SagError

DEFAULT_LIMITS = Limits()
"""What a window must keep to when a config says nothing."""

VERSION = 1
"""Raised when the same recordings give other bytes, so that old caches are not used."""

FARTHEST = np.iinfo(np.uint16).max * DEPTH_UNIT
"""Largest depth that a cache can hold, metres."""

RATES = {"FPS-30": 30.0, "FPS-5": 5.0}
"""Folders of GTA-IM and their nominal frames a second."""

HOW_TO_GET = (
    "GTA-IM (CC BY-NC) is sent by its authors on request by e-mail, see https://github.com/ZheC/GTA-IM-Dataset; "
    "set its folder by --data.init_args.root"
)


class GtaImDataModule(MotionDataModule):
    """GTA-IM: windows of its recordings, converted once to a window cache.

    Args:
        root: folder that holds `FPS-30`, `FPS-5` or both.
        rate: the one of them that is used; where it is missing the other is, and a note says so.
        stride: frames from one window to the next (paper, 4.1).
        train_rooms: rooms to train on; the paper does not tell its own.
        test_rooms: rooms to test on; rooms in both are divided by recording.
        shared_test_share: share of a shared room's recordings that test.
        val_share: share of the training recordings that are held out.
        limits: what a window must keep to.
        cloud_step: of the native depth every so many rows and columns go to the test windows' clouds; 1 is the
            sensor's own resolution, 4 MB a window.
        cache_dir: folder that holds the window caches.
        skeleton: name of the skeleton, see `sag.skeleton.SKELETONS`.
        image_size: rows and columns of the picture; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name = "gta_im"

    def __init__(
        self,
        root: Path,
        rate: str = "FPS-30",
        stride: int = 5,
        train_rooms: tuple[int, ...] = (1, 2, 3, 6, 10, 11),
        test_rooms: tuple[int, ...] = (10, 11, 13),
        shared_test_share: float = 0.5,
        val_share: float = 0.05,
        limits: Limits = DEFAULT_LIMITS,
        cloud_step: int = 1,
        cache_dir: Path = Path("data"),
        skeleton: str = "gta_im_19",
        image_size: tuple[int, int] = (288, 512),
        batch_size: int = 16,
        eval_batch_size: int = 64,
    ) -> None:
        super().__init__(cache_dir, skeleton, image_size, batch_size, eval_batch_size)
        if stride < 1 or cloud_step < 1:
            raise SagError(f"data.init_args.stride and cloud_step must be at least 1, found {stride} and {cloud_step}")
        if rate not in RATES:
            raise SagError(f"data.init_args.rate must be one of {', '.join(RATES)}, found {rate!r}")
        if not 0 < limits.farthest_depth <= FARTHEST:
            raise SagError(
                f"data.init_args.limits.farthest_depth must be up to {FARTHEST:.1f} metres, the stored limit"
            )
        self.root = Path(root)
        self.rate = rate
        self.stride = stride
        self.rooms = RoomSplit(tuple(train_rooms), tuple(test_rooms), shared_test_share, val_share)
        self.form = WindowFormat(joint_places(self.skeleton), self.image_size, cloud_step, limits)
        self._opened: WindowCache | None = None

    def build(self) -> WindowCache:
        """Opens the cache, converting the recordings first when it is missing, and prints its notes and counts.

        Raises:
            SagError: the data set is not where the config says, or has no usable window.
        """
        if self._opened is None:
            recipe = self._recipe()
            self._opened = open_or_build(self.cache_dir, self.name, recipe, lambda f: self._convert(f, recipe))
            index = self._opened.index
            for note in (*index["notes"], _counted(self._opened.split, Counter(index["dropped"]))):
                print(f"{self.name}: {note}", flush=True)
        return self._opened

    def _folder(self) -> Path:
        """Folder of the recordings.

        Raises:
            SagError: there is none.
        """
        for rate in (self.rate, *RATES):
            if any(recordings_in(self.root / rate)):
                return self.root / rate
        raise SagError(
            f"{self.root} is no GTA-IM folder: expected {self.root / self.rate} with a folder for each recording, "
            f"info_frames.npz and pictures inside; {HOW_TO_GET}"
        )

    def _recipe(self) -> dict[str, Any]:
        """Everything that decides the bytes of the cache."""
        folder = self._folder()
        return {
            "version": VERSION,
            "rate": [self.rate, folder.name],
            "files": _digest(folder),
            "stride": self.stride,
            "rooms": asdict(self.rooms),
            "form": asdict(self.form),
            "skeleton": self.skeleton.name,
        }

    def _convert(self, folder: Path, recipe: dict[str, Any]) -> WindowCache:
        """Converts the recordings to a cache in a folder."""
        plan = planned(list(recordings_in(self._folder())), self.stride, self.form.limits, self.rooms)
        if not plan.windows:
            expected = "65 frames with .jpg, .png and _id.png at the first"
            raise SagError(f"{self._folder()} has no usable window ({expected}): {dict(plan.dropped)}")
        with scratch_folder(self.cache_dir) as scratch:
            converted = convert(plan, self.form, Path(scratch))
            dropped = plan.dropped + converted.dropped
            notes = [*self._rate_notes(), *plan.notes, *converted.notes]
            return write_cache(folder, converted.arrays, self._index(recipe, plan, dropped, notes))

    def _index(self, recipe: dict[str, Any], plan: Plan, dropped: Counter[str], notes: list[str]) -> dict[str, Any]:
        return {
            "name": self.name,
            "recipe": recipe,
            "fps": RATES[self._folder().name],
            "skeleton": self.skeleton.name,
            "dropped": dict(dropped),
            "notes": notes,
            "sequences": [path.name for path in plan.folders],
        }

    def _rate_notes(self) -> list[str]:
        """What to know of the frames a second."""
        used = self._folder().name
        nominal = f"{RATES[used]:g} frames a second is the nominal rate of {used}; some recordings are faster or slower"
        return [nominal] if used == self.rate else [f"{used} USED: {self.root} has no {self.rate}", nominal]


def _counted(splits: np.ndarray, dropped: Counter[str]) -> str:
    """How many windows were kept, and why the others were not."""
    reasons = "; ".join(f"{reason}: {count}" for reason, count in dropped.most_common())
    kept = ", ".join(f"{count} {name}" for name, count in zip(SPLITS, np.bincount(splits, minlength=len(SPLITS))))
    return f"{kept} windows; {sum(dropped.values())} dropped{f' ({reasons})' if reasons else ''}"


def _digest(folder: Path) -> str:
    """Checksum of the names, sizes and times of all files of the recordings."""
    digest = hashlib.sha256()
    for recording in recordings_in(folder):
        with os.scandir(recording) as entries:
            files = sorted((entry.name, entry.stat().st_size, entry.stat().st_mtime_ns) for entry in entries)
        digest.update(repr((recording.name, files)).encode())
    return digest.hexdigest()
