"""GTA-IM (Cao et al., ECCV 2020): people in rooms of a game, from the files its authors send on request."""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from sag.data.base import MotionDataModule
from sag.data.cache import DEPTH_UNIT, WindowCache, open_or_build, write_cache
from sag.data.gta_im.convert import convert, counted
from sag.data.gta_im.filters import Limits
from sag.data.gta_im.plan import Plan, planned
from sag.data.gta_im.reader import GTA_IM
from sag.data.gta_im.recording import joint_places, recordings_in
from sag.data.gta_im.splits import RoomSplit
from sag.data.gta_im.views import WindowFormat
from sag.data.scratch import scratch_folder
from sag.errors import SagError

DEFAULT_LIMITS = Limits()
"""What a window must keep to when a config says nothing."""

VERSION = 2
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
        skip_broken: leaves recordings out that cannot be read, with a note that names each; otherwise they are errors.
        cache_dir: folder that holds the window caches.
        skeleton: name of the skeleton, see `sag.skeleton.SKELETONS`.
        image_size: rows and columns of the picture; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name = "gta_im"
    reader = GTA_IM

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
        skip_broken: bool = False,
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
        self.skip_broken = skip_broken
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
            windows = counted(self._opened.split, Counter(index["dropped"]), Counter(index["events"]))
            for note in (*index["notes"], windows):
                print(f"{self.name}: {note}", flush=True)
        return self._opened

    def folder(self) -> Path:
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
        folder = self.folder()
        return {
            "version": VERSION,
            "rate": [self.rate, folder.name],
            "files": _digest(folder),
            "stride": self.stride,
            "rooms": asdict(self.rooms),
            "form": asdict(self.form),
            "skeleton": self.skeleton.name,
            "skip_broken": self.skip_broken,
        }

    def _convert(self, folder: Path, recipe: dict[str, Any]) -> WindowCache:
        """Converts the recordings to a cache in a folder."""
        folders, limits = list(recordings_in(self.folder())), self.form.limits
        plan = planned(folders, self.stride, limits, self.rooms, skip_broken=self.skip_broken)
        if not plan.windows:
            names = ", ".join(path.name for path in plan.folders[:3])
            expected = "65 frames with .jpg, .png and _id.png at the first"
            raise SagError(f"{self.folder()} has no usable window ({expected}) in {names}: {dict(plan.dropped)}")
        with scratch_folder(folder) as scratch:
            with contextlib.suppress(SagError):  # another process may have made it in the meantime
                return WindowCache.open(folder)
            converted = convert(plan, self.form, scratch)
            dropped = plan.dropped + converted.dropped
            notes = [*self._rate_notes(), *plan.notes, *converted.notes]
            return write_cache(folder, converted.arrays, self._index(recipe, plan, dropped, notes))

    def _index(self, recipe: dict[str, Any], plan: Plan, dropped: Counter[str], notes: list[str]) -> dict[str, Any]:
        return {
            "name": self.name,
            "recipe": recipe,
            "fps": RATES[self.folder().name],
            "skeleton": self.skeleton.name,
            "dropped": dict(dropped),
            "notes": notes,
            "events": dict(plan.events),
            "sequences": [path.name for path in plan.folders],
        }

    def _rate_notes(self) -> list[str]:
        """What to know of the frames a second."""
        used = self.folder().name
        nominal = f"{RATES[used]:g} frames a second is the nominal rate of {used}; some recordings are faster or slower"
        return [nominal] if used == self.rate else [f"{used} USED: {self.root} has no {self.rate}", nominal]


def _digest(folder: Path) -> str:
    """Checksum of the names, sizes and times of all files of the recordings."""
    digest = hashlib.sha256()
    for recording in recordings_in(folder):
        with os.scandir(recording) as entries:
            files = sorted(_stamp(entry) for entry in entries)
        digest.update(repr((recording.name, files)).encode())
    return digest.hexdigest()


def _stamp(entry: os.DirEntry[str]) -> tuple[str, int, int]:
    """Name, size and time of a file; a link that leads nowhere has none."""
    try:
        found = entry.stat()
    except OSError:
        return entry.name, -1, -1
    return entry.name, found.st_size, found.st_mtime_ns
