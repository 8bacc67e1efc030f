"""What is filmed for a layout: rooms, recordings and the stretch of each that is kept."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from operator import itemgetter

import numpy as np

from sag.data.rooms.filming import Shoot
from sag.data.rooms.person import FRAME_RATE
from sag.data.rooms.recipe import Recipe
from sag.data.rooms.room import Room
from sag.data.rooms.windows import Recording, Scenery, usable_starts
from sag.errors import SagError
from sag.types import FRAMES

STRIDE = 5
"""Frames from one window to the next with which the layouts are read by default (paper, 4.1)."""

SPARE = 3
"""Recordings that are made for each one that is kept: those with the most usable windows."""


@dataclass(frozen=True)
class Script:
    """What is filmed.

    Attributes:
        rooms: how many rooms.
        recordings: of each room.
        seconds: length of a recording; none is longer than it was acted (3 to 4 s).
        size: rows and columns of the colour pictures.
        every: pictures are made of every so many frames; windows start at frames with pictures only.
        seed: of all that is drawn.
    """

    rooms: int
    recordings: int = 2
    seconds: float = 4.0
    size: tuple[int, int] = (216, 384)
    every: int = 1
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("rooms", "recordings", "every"):
            if getattr(self, name) < 1:
                raise SagError(f"--{name} must be at least 1, found {getattr(self, name)}")
        if self.frames < FRAMES:
            raise SagError(f"--seconds must be at least {FRAMES / FRAME_RATE:.2f}: a window has {FRAMES} frames")
        rows, columns = self.size
        if rows < 36 or 16 * rows != 9 * columns:
            raise SagError(f"--size must be 9:16 and of at least 36 rows, such as 216 384, found {rows} {columns}")

    @property
    def frames(self) -> int:
        """Frames of a recording."""
        return round(self.seconds * FRAME_RATE)


@dataclass(frozen=True)
class FilmedRoom:
    """A room and what was filmed in it.

    Attributes:
        room: with everything in it.
        scenery: the room made ready to be filmed.
        recordings: the person's motions in front of the camera.
    """

    room: Room
    scenery: Scenery
    recordings: tuple[Recording, ...]


def filmed(script: Script, number: int, field: float | None = None) -> FilmedRoom:
    """The room of this number with its recordings; the same script gives the same.

    Args:
        script: what is filmed.
        number: of the room, from 0.
        field: vertical field of view (radians) of one camera for all recordings; without it each has a camera and a
            lens of its own.
    """
    made = SPARE * script.recordings
    views, takes = (made, 1) if field is None else (1, made)
    shoot = Shoot.of(Recipe(script.seed, script.rooms, views=views, recordings=takes), number)
    best = sorted(_stretches(shoot, script, made, field), key=itemgetter(0), reverse=True)[: script.recordings]
    return FilmedRoom(shoot.room, shoot.scenery, tuple(recording for _, recording in best))


def _stretches(shoot: Shoot, script: Script, count: int, field: float | None) -> Iterator[tuple[int, Recording]]:
    """Recordings, each cut to its stretch with the most usable windows, and how many those are."""
    # Those for validation would share their camera with others.
    training = (recording for recording in shoot.recordings() if recording.split == "train")
    for recording in islice(training, count):
        if field is not None:
            recording = replace(recording, camera=replace(recording.camera, field=field))
        starts = np.array(list(usable_starts(recording, shoot.scenery, Counter(), STRIDE)), int)
        firsts = range(0, max(len(recording.joints) - script.frames, 0) + 1, STRIDE)
        inside = [np.sum((starts >= first) & (starts <= first + script.frames - FRAMES)) for first in firsts]
        best = int(np.argmax(inside))
        kept = slice(firsts[best], firsts[best] + script.frames)
        yield int(inside[best]), replace(recording, joints=recording.joints[kept], contact=recording.contact[kept])
