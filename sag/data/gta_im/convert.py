"""Conversion of planned windows to the arrays of the cache."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np
from rich.progress import track

from sag.data.cache import ARRAYS, SPLITS
from sag.data.gta_im.filters import HIDDEN, UNREADABLE
from sag.data.gta_im.plan import Plan, Window
from sag.data.gta_im.recording import Recording
from sag.data.gta_im.views import WindowFormat, stored_window
from sag.errors import SagError
from sag.types import FRAMES

TOGETHER = 32
"""Windows that are converted at once; their native pictures fill the memory."""


@dataclass(frozen=True)
class Converted:
    """What became of the planned windows.

    Attributes:
        arrays: the cache's arrays by name.
        dropped: reason -> windows.
        notes: what a reader of figures must know.
    """

    arrays: dict[str, np.ndarray]
    dropped: Counter[str]
    notes: tuple[str, ...]


def convert(plan: Plan, form: WindowFormat, scratch: Path) -> Converted:
    """Reads every planned window and puts it into arrays on disk.

    Args:
        plan: the windows.
        form: how they are stored.
        scratch: empty folder for the arrays.

    Raises:
        SagError: the disk has too little room, or a recording has changed since the plan.
    """
    rows = _Rows(plan, form, scratch)
    dropped: Counter[str] = Counter()
    unread: list[str] = []
    results = _converted(plan, form)
    for window, result in track(results, "gta_im: converting windows", total=len(plan.windows)):
        if isinstance(result, SagError):
            dropped[UNREADABLE] += 1
            unread.append(str(result))
        elif result is None:
            dropped[HIDDEN] += 1
        else:
            rows.add(window, plan.rooms[window.recording], result)
    notes = (f"{len(unread)} windows have an unreadable picture, the first: {unread[0]}",) if unread else ()
    return Converted(rows.filled(), dropped, notes)


def _converted(plan: Plan, form: WindowFormat) -> Iterator[tuple[Window, dict[str, np.ndarray] | SagError | None]]:
    """Every window with its arrays, in order; a few at a time, on all cores (decoding frees the interpreter)."""
    with ThreadPoolExecutor(min(8, os.cpu_count() or 1)) as pool:
        for place, group in groupby(plan.windows, key=lambda window: window.recording):
            recording, windows = Recording.read(plan.folders[place]), list(group)
            for first in range(0, len(windows), TOGETHER):
                batch = windows[first : first + TOGETHER]
                yield from zip(batch, pool.map(partial(_attempt, recording, form), batch))


def _attempt(recording: Recording, form: WindowFormat, window: Window) -> dict[str, np.ndarray] | SagError | None:
    try:
        return stored_window(recording, window.start, form, with_cloud=window.split == "test")
    except SagError as error:
        return error


class _Rows:
    """Arrays on disk that are filled row by row."""

    def __init__(self, plan: Plan, form: WindowFormat, scratch: Path) -> None:
        shapes = _shapes(plan, form)
        needed = sum(np.dtype(ARRAYS[name][0]).itemsize * int(np.prod(shape)) for name, shape in shapes.items())
        # Twice: the cache is a checked copy of the arrays that are filled here.
        if 2 * needed > shutil.disk_usage(scratch).free:
            raise SagError(
                f"{len(plan.windows)} windows need {2 * needed / 1e9:.1f} GB in {scratch.parent}, which has less free; "
                "raise --data.init_args.stride or cloud_step, or set another --data.init_args.cache_dir"
            )
        self._arrays = {
            name: np.lib.format.open_memmap(scratch / f"{name}.npy", "w+", ARRAYS[name][0], shape)
            for name, shape in shapes.items()
        }
        self._windows = self._clouds = 0

    def add(self, window: Window, room: int, stored: dict[str, np.ndarray]) -> None:
        """Fills the next row, and the next row of the cloud where the window has one."""
        with_cloud = "cloud_depth" in stored
        row: dict[str, object] = {
            **stored,
            "split": SPLITS.index(window.split),
            "scene": room,
            "sequence": window.recording,
            "start": window.start,
            "cloud_row": self._clouds if with_cloud else -1,
        }
        for name, value in row.items():
            self._arrays[name][self._clouds if _of_cloud(name) else self._windows] = value
        self._windows += 1
        self._clouds += with_cloud

    def filled(self) -> dict[str, np.ndarray]:
        """The rows that were filled."""
        return {n: a[: self._clouds if _of_cloud(n) else self._windows] for n, a in self._arrays.items()}


def _of_cloud(name: str) -> bool:
    """Whether an array has a row for each cloud, not for each window."""
    return name in ("cloud_depth", "cloud_intrinsics")


def _shapes(plan: Plan, form: WindowFormat) -> dict[str, tuple[int, ...]]:
    """Shape of every array of the cache."""
    windows = len(plan.windows)
    clouds = max(1, sum(window.split == "test" for window in plan.windows))
    return {
        "joints": (windows, FRAMES, len(form.joints), 3),
        "image": (windows, *form.image_size, 3),
        "depth": (windows, *form.image_size),
        "ids": (windows, *form.image_size),
        "intrinsics": (windows, 3, 3),
        "world2cam": (windows, 4, 4),
        **{name: (windows,) for name in ("split", "scene", "sequence", "start", "cloud_row")},
        "cloud_depth": (clouds, *form.cloud_size(*plan.size)),
        "cloud_intrinsics": (clouds, 3, 3),
    }


def scratch_folder(parent: Path) -> tempfile.TemporaryDirectory[str]:
    """A folder beside the caches for arrays that are being filled; removed when it is left."""
    parent.mkdir(parents=True, exist_ok=True)
    return tempfile.TemporaryDirectory(prefix="gta_im.converting-", dir=parent)
