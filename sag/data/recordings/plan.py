"""The windows of a data set: found by their motion, before any picture is decoded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.progress import track

from sag.data.recordings.filters import BROKEN, OTHER_ROOM, Limits
from sag.data.recordings.reader import Reader
from sag.data.recordings.splits import Room, RoomSplit, Split
from sag.errors import SagError

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
    limits: Limits,
    rule: RoomSplit,
    reader: Reader,
    skip_broken: bool = False,
) -> Plan:
    """Finds the usable windows and gives each its split.

    With windows in fewer than two recordings the stride becomes 1, and a note says so.

    Args:
        folders: all recordings.
        stride: frames from one window to the next.
        limits: what a window must keep to.
        rule: how recordings are divided.
        reader: how the data set is read.
        skip_broken: leaves recordings out that cannot be read; a note names each.

    Raises:
        SagError: a recording cannot be read and is not left out, or none can be read.
    """
    found = _Found.of(folders, stride, limits, reader, skip_broken)
    notes = found.broken
    if len(found.used) < 2 and stride > 1:
        notes += (f"stride 1 instead of {stride}: it leaves windows in {len(found.used)} recordings only",)
        found = _Found.of(folders, 1, limits, reader, skip_broken)
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
    broken: tuple[str, ...]

    @classmethod
    def of(cls, folders: Sequence[Path], stride: int, limits: Limits, reader: Reader, skip_broken: bool) -> _Found:
        used, sizes, rooms, starts, broken = [], [], [], [], []
        dropped, events = Counter[str](), Counter[str]()
        for folder in track(folders, f"{reader.name}: looking for windows", transient=True):
            try:
                recording = reader.read(folder)
            except SagError as error:
                if not skip_broken:
                    raise
                broken.append(f"{folder.name} LEFT OUT, it is broken: {error}")
                continue
            used.append(folder)
            sizes.append(recording.size)
            found, faults = reader.starts(recording, stride, limits, sizes[0])
            rooms.append(recording.room)
            starts.append(found)
            dropped += faults
            events += reader.events(recording, limits)
        if not used:
            raise SagError(f"all {len(broken)} recordings are broken, the first: {broken[0]}")
        dropped += Counter({BROKEN: len(broken)})
        return cls(tuple(used), tuple(rooms), sizes[0], tuple(starts), dropped, events, tuple(broken))

    @property
    def used(self) -> list[int]:
        """Recordings with windows."""
        return [i for i, starts in enumerate(self.starts) if starts]


def _divided(found: _Found, split: Split) -> tuple[Window, ...]:
    windows = []
    for name, members in (("train", split.train), ("val", split.val), ("test", split.test)):
        for recording in (found.used[member] for member in members):
            starts = found.starts[recording]
            if name == "val" and set(split.val) & set(split.train):
                starts = _spread(starts, VAL_FROM_TRAINING)
            windows += [Window(recording, start, name) for start in starts]
    return tuple(windows)


def _spread(starts: list[int], count: int) -> list[int]:
    """At most so many of the starts, evenly spread."""
    places = np.linspace(0, len(starts) - 1, min(count, len(starts))).round().astype(int)
    return [starts[place] for place in places]
