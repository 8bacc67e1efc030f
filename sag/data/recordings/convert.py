"""Conversion of planned windows to the arrays of the cache."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from sag.data.cache import SPLITS
from sag.data.pictures import CutOffError
from sag.data.recordings.filters import CUT_OFF, HIDDEN, UNREADABLE
from sag.data.recordings.plan import Plan, Window
from sag.data.recordings.reader import Reader
from sag.data.recordings.scratch import Scratch
from sag.data.recordings.views import WindowFormat
from sag.errors import SagError
from sag.types import FRAMES

TOGETHER = 32
"""Windows that are converted at once; their native pictures fill the memory."""


COMMITTED = 8
"""Windows after which what was converted is made to last."""


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


def convert(plan: Plan, form: WindowFormat, scratch: Path, reader: Reader) -> Converted:
    """Reads every planned window and puts it into arrays on disk, going on where an earlier try was interrupted.

    Args:
        plan: the windows.
        form: how they are stored.
        scratch: folder for the arrays, of this plan and form alone.
        reader: how the data set is read.

    Raises:
        SagError: the disk has too little room, a recording has changed since the plan, or no window is left.
    """
    rows = Scratch(scratch, _shapes(plan, form))
    finished = len(rows.outcomes)
    if finished:
        print(f"{reader.name}: going on after {finished:,} of {len(plan.windows):,} windows", flush=True)
    windows = plan.windows[finished:]
    results = _converted(plan, windows, form, reader)
    try:
        say = Console(stderr=True)
        for window, result in track(results, f"{reader.name}: converting windows", total=len(windows), console=say):
            _store(rows, result, {**_place(window), "scene": reader.number(plan.rooms[window.recording])})
            if rows.uncommitted >= COMMITTED:
                rows.commit()
    finally:
        rows.commit()
    return _finished(rows, plan)


def _place(window: Window) -> dict[str, int]:
    return {"split": SPLITS.index(window.split), "sequence": window.recording, "start": window.start}


def _store(rows: Scratch, result: dict[str, np.ndarray] | SagError | None, place: dict[str, int]) -> None:
    """Keeps a window or drops it."""
    if isinstance(result, SagError):
        rows.drop(CUT_OFF if isinstance(result, CutOffError) else UNREADABLE, str(result))
    elif result is None:
        rows.drop(HIDDEN)
    else:
        rows.keep({**result, **place})


def _finished(rows: Scratch, plan: Plan) -> Converted:
    """Arrays, counts and notes of all windows."""
    dropped = rows.dropped
    firsts = {reason: rows.first(reason) for reason in (CUT_OFF, UNREADABLE) if dropped[reason]}
    arrays = rows.filled()
    if not len(arrays["split"]):
        said = "; ".join([*firsts.values(), f"the recordings are {', '.join(f.name for f in plan.folders[:3])}"])
        raise SagError(f"{plan.folders[0].parent} has no usable window: {dict(plan.dropped + dropped)}; {said}")
    notes = (f"{dropped[reason]} windows have an {reason}, the first: {said}" for reason, said in firsts.items())
    return Converted(arrays, dropped, tuple(notes))


def _converted(
    plan: Plan, windows: Sequence[Window], form: WindowFormat, reader: Reader
) -> Iterator[tuple[Window, dict[str, np.ndarray] | SagError | None]]:
    """Every window with its arrays, in order; a few at a time, on all cores (decoding frees the interpreter)."""
    with ThreadPoolExecutor(min(8, os.cpu_count() or 1)) as pool:
        for place, group in groupby(windows, key=lambda window: window.recording):
            recording, together = reader.read(plan.folders[place]), list(group)
            for first in range(0, len(together), TOGETHER):
                batch = together[first : first + TOGETHER]
                yield from zip(batch, pool.map(partial(_attempt, reader, recording, form), batch))


def _attempt(
    reader: Reader, recording: Any, form: WindowFormat, window: Window
) -> dict[str, np.ndarray] | SagError | None:
    try:
        return reader.window(recording, window.start, form, window.split == "test")
    except SagError as error:
        return error


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


def counted(splits: np.ndarray, dropped: Counter[str], events: Counter[str] | None = None) -> str:
    """How many windows were kept, why the others were not, and what happens in the recordings.

    Args:
        splits: place among `SPLITS` of each window.
        dropped: reason -> windows.
        events: what happens, and how often.
    """
    reasons = "; ".join(f"{reason}: {count}" for reason, count in dropped.most_common())
    kept = ", ".join(f"{count} {name}" for name, count in zip(SPLITS, np.bincount(splits, minlength=len(SPLITS))))
    happened = "".join(f"; {count} {name}" for name, count in (events or {}).items())
    return f"{kept} windows; {sum(dropped.values())} dropped{f' ({reasons})' if reasons else ''}{happened}"
