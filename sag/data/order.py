"""The order of training windows, drawn anew for each epoch, which goes on in the midst of one."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import torch
from torch.utils.data import BatchSampler, DataLoader, RandomSampler

from sag.processes import own_rows, processes, rank
from sag.types import Batch


class EpochOrder(RandomSampler):
    """A random order of all windows, the same that `RandomSampler` draws, whose seed can be told.

    Attributes:
        seed: of the order of the epoch at hand; None before the first.
        again: seed that the next order has, instead of one drawn from PyTorch's generator.
    """

    seed: int | None = None
    again: int | None = None

    def __iter__(self) -> Iterator[int]:
        self.seed = int(torch.empty((), dtype=torch.int64).random_().item()) if self.again is None else self.again
        self.again = None
        yield from torch.randperm(len(self), generator=torch.Generator().manual_seed(self.seed)).tolist()


class SharedBatches(BatchSampler):
    """Batches of which each of the processes that train together gets its share, one row after another."""

    def __iter__(self) -> Iterator[list[int]]:
        for batch in super().__iter__():
            yield batch[own_rows(len(batch) // processes())]


class OwnBatches(BatchSampler):
    """Every so manyth batch, for processes that test together: each window is in one batch of one of them.

    A batch stays whole, so that its arithmetic is to the bit what it is where one process tests alone. A process for
    which there is none has one without windows: Lightning would leave out its test, and the others wait for it.
    """

    def __iter__(self) -> Iterator[list[int]]:
        own = itertools.islice(super().__iter__(), rank(), None, processes())
        yield next(own, [])
        yield from own

    def __len__(self) -> int:
        return max(1, len(range(rank(), super().__len__(), processes())))


class ResumableLoader(DataLoader[Batch]):
    """A loader that goes on after the batches which it has given, without reading them again.

    Lightning keeps `state_dict` in its checkpoints. The order of the epoch is that of the `EpochOrder` under its
    batches, the same in all processes.

    Attributes:
        given: batches of the epoch at hand that were given.
    """

    given: int = 0
    _skipped: int = 0

    def __iter__(self) -> Any:
        return self._counted(super().__iter__())

    def _counted(self, batches: Any) -> Iterator[Batch]:
        self.given, self._skipped = self._skipped, 0
        for _ in itertools.islice(batches._sampler_iter, self.given):
            pass
        for batch in batches:
            self.given += 1
            yield batch

    def state_dict(self) -> dict[str, Any]:
        """The order of the epoch at hand and the place in it."""
        return {"seed": getattr(self._order, "seed", None), "given": self.given}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Makes the next epoch the rest of the one that a checkpoint was written in."""
        self._skipped = state["given"]
        if isinstance(self._order, EpochOrder):
            self._order.again = state["seed"]

    @property
    def _order(self) -> Any:
        """What the batches are cut from."""
        return getattr(self.batch_sampler, "sampler", None)
