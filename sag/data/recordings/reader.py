"""What planning and conversion ask of a data set of recordings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sag.data.recordings.splits import Room
from sag.data.recordings.views import WindowFormat


@dataclass(frozen=True)
class Reader:
    """How the recordings of a data set are read.

    Attributes:
        name: of the data set.
        read: a recording of its folder; it has a `room` and a `size`, rows and columns of its pictures.
        starts: frames of a recording where usable windows start, and how many windows were dropped for what;
            given the stride and how windows are stored.
        window: the cache's arrays of the window that starts at a frame, with its cloud where that is asked for;
            nothing when the person is hidden.
        rooms: names of the rooms in the order of their numbers; empty where rooms are numbers.
        events: what happens in a recording that is worth telling, and how often.
    """

    name: str
    read: Callable[[Path], Any]
    starts: Callable[[Any, int, WindowFormat], tuple[list[int], Counter[str]]]
    window: Callable[[Any, int, WindowFormat, bool], dict[str, np.ndarray] | None]
    rooms: tuple[str, ...] = ()
    events: Callable[[Any, WindowFormat], Counter[str]] = lambda recording, form: Counter()

    def number(self, room: Room) -> int:
        """Number of a room in the cache."""
        return self.rooms.index(room) if isinstance(room, str) else room
