"""Groups: what in a data set is independent of the rest, for floors and intervals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor

from sag.data.cache import WindowCache
from sag.types import Batch

ENOUGH_ROOMS = 8
"""Rooms from which on they are the groups. Recordings of one room may share a camera, a start and a person."""


@dataclass(frozen=True)
class Groups:
    """Rooms where there are enough of them, otherwise recordings.

    Attributes:
        kind: what they are.
        rows: windows that are judged, places in the data set, ascending.
        of_rows: group of each of these windows.
    """

    kind: str
    rows: Int[np.ndarray, " n"]
    of_rows: Int[np.ndarray, " n"]

    @classmethod
    def of(cls, cache: WindowCache, rows: Int[np.ndarray, " n"]) -> Groups:
        """The groups of some windows of a cache."""
        rooms = np.asarray(cache.scene[rows])
        if len(np.unique(rooms)) >= ENOUGH_ROOMS:
            return cls("rooms", rows, rooms)
        return cls("recordings", rows, np.asarray(cache.sequence[rows]))

    @property
    def count(self) -> int:
        """How many groups there are."""
        return len(self._known)

    @cached_property
    def _known(self) -> Int[np.ndarray, " g"]:
        """Every group once, ascending."""
        return np.unique(self.of_rows)

    def fold_of_batch(self, batch: Batch) -> Int[Tensor, " b"]:
        """0 or 1 for each window of a batch: every other group is in the same fold."""
        known = torch.from_numpy(self._known).to(batch.index.device)
        return torch.searchsorted(known, self.of_batch(batch)) % 2

    def of_batch(self, batch: Batch) -> Int[Tensor, " b"]:
        """Group of each window of a batch."""
        return batch.room if self.kind == "rooms" else batch.sequence
