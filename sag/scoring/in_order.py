"""Parts of a test that several processes have done, put together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar, runtime_checkable

from sag.processes import everyones, processes


@runtime_checkable
class OfBatch(Protocol):
    """What is kept of a batch, and which it is."""

    @property
    def first(self) -> int:
        """Place of the batch's first window in the data set."""
        ...


Part = TypeVar("Part", bound=OfBatch)


def in_order(parts: Sequence[Part]) -> list[Part]:
    """The parts of all processes, as one process that tests all windows in their order has them."""
    if processes() == 1:
        return list(parts)
    return sorted((part for own in everyones(parts) for part in own), key=lambda part: part.first)
