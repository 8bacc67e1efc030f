"""Which recordings train, validate and test."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sag.errors import SagError

Room = int | str
"""A room as its data set tells it: by number or by name."""

FALLBACK_TEST_SHARE = 0.3
"""Share of the recordings that test when the rooms cannot decide; the paper's is 30 of 100."""


@dataclass(frozen=True)
class Split:
    """Recordings of each split, by place; a recording in two splits gives its windows to both.

    Attributes:
        train: recordings to train on.
        val: recordings held out of training.
        test: recordings to test on.
        notes: what a reader of figures must know.
    """

    train: tuple[int, ...]
    val: tuple[int, ...]
    test: tuple[int, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class RoomSplit:
    """Rooms to train and to test on; those in both are divided by recording.

    The paper trains on 70 recordings of 6 rooms and tests on 30 of 3, two of them shared (paper, 4.1), and does
    not say which.

    Attributes:
        train_rooms: rooms to train on.
        test_rooms: rooms to test on.
        shared_test_share: share of a shared room's recordings that test.
        val_share: share of the training recordings that are held out.

    Raises:
        SagError: a share cannot be one, or a room is named twice.
    """

    train_rooms: tuple[Room, ...]
    test_rooms: tuple[Room, ...]
    shared_test_share: float
    val_share: float

    def __post_init__(self) -> None:
        if not 0 < self.shared_test_share < 1:
            raise SagError(f"data.init_args.shared_test_share must lie between 0 and 1, found {self.shared_test_share}")
        if not 0 <= self.val_share < 1:
            raise SagError(f"data.init_args.val_share must be at least 0 and below 1, found {self.val_share}")
        for name in ("train_rooms", "test_rooms"):
            for room, count in Counter(getattr(self, name)).most_common(1):
                if count > 1:
                    raise SagError(f"data.init_args.{name} names the room {room} {count} times; name it once")

    def divided(self, rooms: Sequence[Room]) -> Split:
        """The split of recordings, given the room of each.

        With too few recordings some train and test on the same windows, and a note says so.
        """
        test = self._test_recordings(rooms)
        train = tuple(i for i, room in enumerate(rooms) if room in self.train_rooms and i not in test)
        notes: tuple[str, ...] = ()
        if not train or not test:
            notes = (self._warning(rooms),)
            train, test = _by_recording(len(rooms))
        val = self._held_out(train)
        if not val:
            notes += ("VALIDATION WINDOWS ARE TRAINING WINDOWS: too few recordings to hold one out",)
            return Split(train, train[:1], test, notes)
        return Split(tuple(i for i in train if i not in val), val, test, notes)

    def _test_recordings(self, rooms: Sequence[Room]) -> tuple[int, ...]:
        test: list[int] = []
        for room in self.test_rooms:
            inside = [i for i, r in enumerate(rooms) if r == room]
            shared = room in self.train_rooms
            test += _last(inside, self.shared_test_share) if shared else inside
        return tuple(sorted(test))

    def _warning(self, rooms: Sequence[Room]) -> str:
        """Why figures mean less, or nothing, when the rooms cannot decide."""
        if len(rooms) < 2:
            return "TRAINING AND TEST WINDOWS ARE THE SAME, figures mean nothing: only one recording has windows"
        return (
            "SPLIT BY RECORDING, NOT BY ROOM, so test rooms have been seen: there are rooms "
            f"{sorted(set(rooms), key=str)}, not train_rooms {self.train_rooms} and test_rooms {self.test_rooms}"
        )

    def _held_out(self, train: tuple[int, ...]) -> tuple[int, ...]:
        """Recordings held out, spread over the training ones; none when there are fewer than three."""
        if len(train) < 3:
            return ()
        count = max(1, round(self.val_share * len(train)))
        places = np.linspace(0, len(train) - 1, count + 2)[1:-1].round().astype(int)
        return tuple(train[place] for place in places)


def _by_recording(count: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Training and test recordings whatever their rooms; the same one where there is but one."""
    everything = list(range(count))
    test = _last(everything, FALLBACK_TEST_SHARE) or everything
    return tuple(i for i in everything if i not in test) or tuple(test), tuple(test)


def _last(recordings: list[int], share: float) -> list[int]:
    """The last share of some recordings: at least one, and never all."""
    count = min(max(1, round(share * len(recordings))), len(recordings) - 1)
    return recordings[len(recordings) - count :] if count > 0 else []
