"""Which rooms train and test when a config says nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from sag.data.recordings.splits import FALLBACK_TEST_SHARE, Room, RoomSplit, Split
from sag.errors import SagError


@dataclass(frozen=True)
class NamedRooms(RoomSplit):
    """Rooms by name; where the config tells none, the last of the names test and the others train.

    Where it tells only those that train, the others test, and the other way round.
    """

    def divided(self, rooms: Sequence[Room]) -> Split:
        """The split of recordings, given the room of each.

        Raises:
            SagError: a room that was told is the room of no recording that has windows.
        """
        names = in_order({str(room) for room in rooms})
        for option in ("train_rooms", "test_rooms"):
            if strangers := [room for room in getattr(self, option) if room not in names]:
                known = ", ".join(names)
                raise SagError(f"data.init_args.{option} tells {strangers[0]!r}; rooms with windows are {known}")
        test = tuple(map(str, self.test_rooms)) or self._last(names)
        train = self.train_rooms or tuple(name for name in names if name not in test)
        found = RoomSplit(train, test, self.shared_test_share, self.val_share).divided(rooms)
        if self.test_rooms or not test:
            return found
        note = f"test rooms: {', '.join(test)} (last of the names; set data.init_args.test_rooms to choose)"
        return replace(found, notes=(note, *found.notes))

    def _last(self, names: tuple[str, ...]) -> tuple[str, ...]:
        """Rooms to test on: all that do not train, or the last share of all; none where there is but one."""
        if self.train_rooms:
            return tuple(name for name in names if name not in self.train_rooms)
        count = max(1, round(FALLBACK_TEST_SHARE * len(names)))
        return names[-count:] if len(names) > 1 else ()


def in_order(names: Iterable[str]) -> tuple[str, ...]:
    """Names of rooms in order: numbers first, as numbers."""
    return tuple(sorted(names, key=lambda name: (not name.isdecimal(), int(name) if name.isdecimal() else 0, name)))
