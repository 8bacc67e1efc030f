"""The windows of a data set: found by their motion, before any picture is decoded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from rich.console import Console
from rich.progress import track

from sag.data.recordings.filters import BROKEN, OTHER_ROOM, OTHER_SIZE
from sag.data.recordings.reader import Reader
from sag.data.recordings.splits import Room, RoomSplit, Split
from sag.data.recordings.views import WindowFormat
from sag.errors import SagError

T = TypeVar("T")

VAL_FROM_TRAINING = 16
"""Most validation windows that are taken from training windows when no recording can be held out."""


@dataclass(frozen=True)
class Window:
    """A window to convert.

    Attributes:
        recording: place among the folders.
        start: frame where it starts.
        split: name of its split.
    """

    recording: int
    start: int
    split: str


@dataclass(frozen=True)
class Plan:
    """The windows to convert.

    Attributes:
        folders: all recordings.
        rooms: room of each recording.
        size: rows and columns of the native pictures.
        windows: in the order of the cache.
        dropped: reason -> windows.
        notes: what a reader of figures must know.
        events: what happens in the recordings, and how often.
    """

    folders: Sequence[Path]
    rooms: tuple[Room, ...]
    size: tuple[int, int]
    windows: tuple[Window, ...]
    dropped: Counter[str]
    notes: tuple[str, ...]
    events: Counter[str] = field(default_factory=Counter)


def planned(
    folders: Sequence[Path],
    stride: int,
    form: WindowFormat,
    rule: RoomSplit,
    reader: Reader,
    skip_broken: bool = False,
) -> Plan:
    """Finds the usable windows and gives each its split.

    With windows in fewer than two recordings the stride becomes 1, and a note says so.

    Args:
        folders: all recordings.
        stride: frames from one window to the next.
        form: how windows are stored, and what they must keep to.
        rule: how recordings are divided.
        reader: how the data set is read.
        skip_broken: leaves recordings out that cannot be read; a note names each.

    Raises:
        SagError: a recording cannot be read and is not left out, or none can be read.
    """
    found = _Found.of(folders, stride, form, reader, skip_broken)
    thin: tuple[str, ...] = ()
    if len(found.used) < 2 and stride > 1:
        thin = (f"stride 1 instead of {stride}: with that, fewer than two recordings have windows",)
        found = _Found.of(folders, 1, form, reader, skip_broken)
    notes = found.notes + thin
    plan = Plan(found.folders, found.rooms, found.size, (), found.dropped, notes, found.events)
    if not found.used:
        return plan
    split = rule.divided([found.rooms[i] for i in found.used])
    windows = _divided(found, split)
    left_out = sum(map(len, found.starts)) - len({(w.recording, w.start) for w in windows})
    dropped = found.dropped + Counter({OTHER_ROOM: left_out})
    return replace(plan, windows=windows, dropped=dropped, notes=notes + split.notes)


@dataclass(frozen=True)
class _Found:
    """Usable windows by recording."""

    folders: tuple[Path, ...]
    rooms: tuple[Room, ...]
    size: tuple[int, int]
    starts: tuple[list[int], ...]
    dropped: Counter[str]
    events: Counter[str]
    notes: tuple[str, ...]

    @classmethod
    def of(cls, folders: Sequence[Path], stride: int, form: WindowFormat, reader: Reader, skip_broken: bool) -> _Found:
        used, sizes, rooms, starts, broken = [], [], [], [], []
        dropped, events = Counter[str](), Counter[str]()
        for folder in track(
            folders, f"{reader.name}: looking for windows", transient=True, console=Console(stderr=True)
        ):
            try:
                recording = reader.read(folder)
            except SagError as error:
                if not skip_broken:
                    raise
                broken.append(f"{folder.name} LEFT OUT, it is broken: {error}")
                continue
            used.append(folder)
            sizes.append(recording.size)
            found, faults = reader.starts(recording, stride, form)
            rooms.append(recording.room)
            starts.append(found)
            dropped += faults
            events += reader.events(recording, form)
        if not used:
            raise SagError(f"all {len(broken)} recordings are broken, the first: {broken[0]}")
        dropped += Counter({BROKEN: len(broken)})
        size = _most_common(sizes, starts)
        whole = cls(tuple(used), tuple(rooms), size, tuple(starts), dropped, events, tuple(broken))
        return whole._without([place for place, other in enumerate(sizes) if other != size])

    def _without(self, odd: Sequence[int]) -> _Found:
        """The same without the windows of recordings whose pictures are of another size; a note names them."""
        if not odd:
            return self
        starts = tuple([] if place in odd else starts for place, starts in enumerate(self.starts))
        names = ", ".join(self.folders[place].name for place in odd)
        note = f"{len(odd)} recordings LEFT OUT, their pictures are not of {self.size} pixels as most are: {names}"
        lost = sum(map(len, self.starts)) - sum(map(len, starts))
        dropped = self.dropped + Counter({OTHER_SIZE: lost})
        return replace(self, starts=starts, dropped=dropped, notes=(*self.notes, note))

    @property
    def used(self) -> list[int]:
        """Recordings with windows."""
        return [i for i, starts in enumerate(self.starts) if starts]


def _most_common(sizes: Sequence[tuple[int, int]], starts: Sequence[list[int]]) -> tuple[int, int]:
    """The size that most recordings with windows have, of all where none has; the first of those as common."""
    counts = Counter(size for size, found in zip(sizes, starts) if found) or Counter(sizes)
    return counts.most_common(1)[0][0]


def _divided(found: _Found, split: Split) -> tuple[Window, ...]:
    windows = []
    for name, members in (("train", split.train), ("val", split.val), ("test", split.test)):
        for recording in (found.used[member] for member in members):
            starts = found.starts[recording]
            if name == "val" and set(split.val) & set(split.train):
                starts = spread(starts, VAL_FROM_TRAINING)
            windows += [Window(recording, start, name) for start in starts]
    return tuple(windows)


def spread(items: Sequence[T], count: int | None) -> list[T]:
    """At most so many of some things, evenly spread; all where no number is given."""
    kept = len(items) if count is None else min(count, len(items))
    return [items[place] for place in np.linspace(0, len(items) - 1, kept).round().astype(int)]
