"""Processes that train or test one model together: what each does of the work, and what they say as one.

Alone, everything here is what it would be without it, to the bit and without any communication.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import torch
import torch.distributed as dist
from jaxtyping import Float, Num
from torch import Tensor

T = TypeVar("T")
Drawn = TypeVar("Drawn", Tensor, tuple[Tensor, ...])


def processes() -> int:
    """How many there are, over all machines."""
    return dist.get_world_size() if dist.is_available() and dist.is_initialized() else 1


def rank() -> int:
    """Which of them this one is, counted from 0."""
    return dist.get_rank() if processes() > 1 else 0


def own_rows(count: int) -> slice:
    """Which rows of a batch of all processes are this one's, who has so many: those after the processes before it."""
    return slice(rank() * count, (rank() + 1) * count)


def drawn(draw: Callable[[int], Drawn], count: int) -> Drawn:
    """Random numbers for so many windows of a batch that processes train on together, as one process draws them.

    Every process draws the numbers of the whole batch, from generators that stand alike, and keeps its own rows. So the
    generators stay alike, no two windows share their noise, and a training depends on its seed alone and not on how
    many processes there are.

    Args:
        draw: makes numbers for so many windows, one row each, as a tensor or several.
        count: windows of this process.
    """
    if processes() == 1:
        return draw(count)
    found = draw(processes() * count)
    own = own_rows(count)
    return found[own] if isinstance(found, Tensor) else tuple(each[own] for each in found)


class _Summed(torch.autograd.Function):
    """Adds up over processes; what depends on the sum asks every process for its share, so the derivative adds too."""

    @staticmethod
    def forward(ctx: Any, x: Tensor) -> Tensor:
        total = x.clone(memory_format=torch.contiguous_format)
        dist.all_reduce(total)
        return total

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> Tensor:  # type: ignore[override]
        return _Summed.apply(gradient)


def summed(x: Num[Tensor, "*any"]) -> Num[Tensor, "*any"]:
    """The sum over all processes, which each of them gets, with derivatives of any order.

    Its gradient is that of the losses of all processes added up. Lightning's DDP averages the gradients of weights over
    processes: so the loss of all is the average of the processes' losses.
    """
    return x if processes() == 1 else _Summed.apply(x)


def stacked(x: Float[Tensor, "*any"]) -> Float[Tensor, n * any]:
    """What each of the n processes has, in their order, with derivatives of any order."""
    if processes() == 1:
        return x[None]
    own = torch.arange(processes(), device=x.device) == rank()
    return summed(torch.where(own.view(-1, *[1] * x.dim()), x, 0))


def mean(x: Float[Tensor, "*any"]) -> Float[Tensor, ""]:
    """The mean over the elements of all processes, who may have unequally many, as a term of a loss; 0 of none.

    Every process gets its own part of it, scaled so that the average of the parts is the mean: DDP averages them.
    """
    if processes() == 1:
        return x.mean() if x.numel() else x.sum()
    count = summed(torch.tensor(x.numel(), dtype=torch.float64, device=x.device)).clamp_min(1)
    return x.sum() * (processes() / count).to(x.dtype)


def largest(x: Float[Tensor, ""]) -> Float[Tensor, ""]:
    """The largest of the numbers that the processes have; no gradient flows through it."""
    if processes() == 1:
        return x
    most = x.detach().clone()
    dist.all_reduce(most, dist.ReduceOp.MAX)
    return most


def everyones(value: T) -> list[T]:
    """What each process has of anything that can be pickled, in their order."""
    if processes() == 1:
        return [value]
    values: list[Any] = [None] * processes()
    dist.all_gather_object(values, value)
    return values
