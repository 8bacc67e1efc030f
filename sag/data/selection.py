"""Windows of a data set by their places, or so many of them."""

from __future__ import annotations

from collections.abc import Sequence

from sag.data.base import MotionDataModule, Windows
from sag.errors import SagError
from sag.types import Batch


def spread(places: Sequence[int], count: int) -> list[int]:
    """So many of some places, each the middle of an equal stretch, so that one is not always the first."""
    return [places[int((turn + 0.5) * len(places) / count)] for turn in range(count)]


def chosen_windows(places: Sequence[int], window: Sequence[int] | None, windows: int, whose: str) -> list[int]:
    """The windows that a command's `--window` names, or so many as its `--windows` says.

    Args:
        places: of the test windows that there are, in the data set.
        window: those that are named, if any are.
        windows: how many otherwise, evenly spread.
        whose: what a sentence says of them.

    Raises:
        SagError: one is not there, or there are not so many.
    """
    if window is None:
        if not 1 <= windows <= len(places):
            raise SagError(f"--windows is {windows}, and there are {len(places)} test windows {whose}")
        return spread(places, windows)
    if unknown := [place for place in window if place not in set(places)]:
        near = min(places, key=lambda place: abs(place - unknown[0]), default="none at all")
        raise SagError(f"--window {unknown[0]} is no test window {whose}; the nearest is {near}")
    return list(dict.fromkeys(window))


def windows_at(data: MotionDataModule, split: str, places: Sequence[int], with_cloud: bool = False) -> Batch:
    """Windows of a split by their places in the data set.

    Args:
        data: the data set.
        split: theirs.
        places: of windows of that split.
        with_cloud: gives them their depth clouds, where all of them have one.
    """
    clouds = with_cloud and bool((data.cache.cloud_row[list(places)] >= 0).all())
    windows = Windows(data.cache, split, data.skeleton, with_cloud=clouds)
    order = {int(row): turn for turn, row in enumerate(windows.rows)}
    return windows.__getitems__([order[place] for place in places])
