"""A data module over recordings on disk, which are converted once to a window cache."""

from __future__ import annotations

import contextlib
from abc import abstractmethod
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from sag.data.base import MotionDataModule
from sag.data.cache import DEPTH_UNIT, WindowCache, open_or_build, write_cache
from sag.data.recordings.convert import convert, counted
from sag.data.recordings.filters import Limits
from sag.data.recordings.plan import Plan, planned
from sag.data.recordings.reader import Reader
from sag.data.recordings.scratch import scratch_folder
from sag.data.recordings.splits import RoomSplit
from sag.data.recordings.views import WindowFormat
from sag.errors import SagError
from sag.text import plain

FARTHEST = np.iinfo(np.uint16).max * DEPTH_UNIT
"""Largest depth that a cache can hold, metres."""


class RecordedDataModule(MotionDataModule):
    """A data set of recordings with pictures; what it is says its reader.

    Attributes:
        version: raised when the same recordings give other bytes, so that old caches are not used.
        needs: what a usable window has, for the error when there is none.

    Args:
        root: folder of the data set.
        stride: frames from one window to the next.
        rooms: which recordings train, validate and test.
        limits: what a window must keep to.
        cloud_step: of the native depth every so many rows and columns go to the test windows' clouds.
        skip_broken: leaves recordings out that cannot be read, with a note that names each.
        cache_dir: folder that holds the window caches.
        skeleton: name of the skeleton, see `sag.skeleton.skeleton_named`.
        image_size: rows and columns of the picture.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    version: int
    needs: str

    def __init__(
        self,
        root: Path,
        stride: int,
        rooms: RoomSplit,
        limits: Limits,
        cloud_step: int,
        skip_broken: bool,
        cache_dir: Path,
        skeleton: str,
        image_size: tuple[int, int],
        batch_size: int,
        eval_batch_size: int,
    ) -> None:
        super().__init__(cache_dir, skeleton, image_size, batch_size, eval_batch_size)
        if stride < 1 or cloud_step < 1:
            raise SagError(f"data.init_args.stride and cloud_step must be at least 1, found {stride} and {cloud_step}")
        if not 0 < limits.farthest_depth <= FARTHEST:
            raise SagError(
                f"data.init_args.limits.farthest_depth must be up to {FARTHEST:.1f} metres, the stored limit"
            )
        self.root = Path(root)
        self.stride = stride
        self.rooms = rooms
        self.skip_broken = skip_broken
        self.form = WindowFormat(self.joint_places(), self.skeleton.root_index, self.image_size, cloud_step, limits)

    @property
    @abstractmethod
    def reader(self) -> Reader:
        """How its recordings are read."""

    @abstractmethod
    def joint_places(self) -> list[int]:
        """Places of the skeleton's joints among those of the files.

        Raises:
            SagError: the files lack one of the joints.
        """

    @abstractmethod
    def recordings(self) -> Sequence[Path]:
        """Folders of the recordings, in order of their names.

        Raises:
            SagError: there are none; the sentence says how to get the data set.
        """

    @abstractmethod
    def sources(self) -> dict[str, Any]:
        """What decides the bytes of the cache beside the options that all such data sets have: files, above all."""

    @abstractmethod
    def remarks(self) -> list[str]:
        """What a reader of figures must know of the recordings."""

    @abstractmethod
    def native_fps(self) -> float:
        """Frames a second of the recordings."""

    def build(self) -> WindowCache:
        """Opens the cache, converting the recordings first when it is missing, and prints its notes and counts.

        Raises:
            SagError: the data set is not where the config says, or has no usable window.
        """
        recipe = self._recipe()
        cache = open_or_build(self.cache_dir, self.name, recipe, lambda folder: self._convert(folder, recipe))
        windows = counted(cache.split, Counter(cache.index["dropped"]), Counter(cache.index["events"]))
        for note in (*cache.index["notes"], windows):
            print(f"{self.name}: {plain(note)}", flush=True)
        return cache

    def plan(self, folders: Sequence[Path] | None = None) -> Plan:
        """The windows that training gets, found without decoding a picture.

        Args:
            folders: of the recordings; all of them where nothing is given.

        Raises:
            SagError: a recording cannot be read and is not left out, or none can be read.
        """
        found = self.recordings() if folders is None else folders
        return planned(found, self.stride, self.form, self.rooms, self.reader, self.skip_broken)

    def _recipe(self) -> dict[str, Any]:
        """Everything that decides the bytes of the cache."""
        return {
            "version": self.version,
            **self.sources(),
            "stride": self.stride,
            "rooms": asdict(self.rooms),
            "form": asdict(self.form),
            "skeleton": self.skeleton.description,
            "skip_broken": self.skip_broken,
        }

    def _convert(self, folder: Path, recipe: dict[str, Any]) -> WindowCache:
        """Converts the recordings to a cache in a folder."""
        plan = self.plan()
        if not plan.windows:
            names = ", ".join(path.name for path in plan.folders[:3])
            raise SagError(f"{self.root} has no usable window ({self.needs}) in {names}: {dict(plan.dropped)}")
        with scratch_folder(folder) as scratch:
            with contextlib.suppress(SagError):  # another process may have made it in the meantime
                return WindowCache.open(folder)
            converted = convert(plan, self.form, scratch, self.reader)
            index = {
                "name": self.name,
                "recipe": recipe,
                "fps": self.native_fps(),
                "skeleton": self.skeleton.name,
                "dropped": dict(plan.dropped + converted.dropped),
                "notes": [*self.remarks(), *plan.notes, *converted.notes],
                "events": dict(plan.events),
                "rooms": self.reader.rooms,
                "sequences": [path.name for path in plan.folders],
            }
            return write_cache(folder, converted.arrays, index)
