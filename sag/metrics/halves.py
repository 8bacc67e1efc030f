"""Random halves of the real motions, of which floors are distances."""

from __future__ import annotations

import torch
from jaxtyping import Int
from torch import Generator, Tensor

from sag.errors import SagError


def random_halves(group: Int[Tensor, " b"], splits: int = 8, seed: int = 0) -> Int[Tensor, "splits b"]:
    """Random splits of motions into two halves of whole groups, equally many motions in both. Ours.

    The groups of a split are put in random order and cut in the middle; the group there goes to the side that most
    of it lies on. Then motions of the larger side are left out at random, until both have the same number. A rule
    such as every other recording would not do: recordings may come in pairs that share a camera or a path, and it
    would deal these out to both sides each time.

    Args:
        group: the group of each motion, any whole numbers: what shares people, places or cameras with no other
            group, as rooms do or, at the least, recordings.
        splits: how many, 1 or more.
        seed: of the drawing, which is done on the CPU and so is the same on any device.

    Returns:
        For each split and motion its side, 0 or 1, or -1 where the motion is left out.

    Raises:
        SagError: fewer than two groups, or no split asked for.

    Example:
        >>> import torch
        >>> side = random_halves(torch.arange(5).repeat_interleave(4), splits=1)[0]
        >>> [int((side == name).sum()) for name in (0, 1, -1)]
        [8, 8, 4]
    """
    place, sizes = torch.unique(group.cpu(), return_inverse=True, return_counts=True)[1:]
    if len(sizes) < 2:
        raise SagError(f"random halves are made of whole groups and need motions of 2 or more, not of {len(sizes)}")
    if splits < 1:
        raise SagError(f"random halves need splits to be 1 or more, not {splits}")
    generator = torch.Generator().manual_seed(seed)
    return torch.stack([_split(place, sizes, generator) for _ in range(splits)]).to(group.device)


def _split(place: Int[Tensor, " b"], sizes: Int[Tensor, " g"], generator: Generator) -> Int[Tensor, " b"]:
    """The side of each motion in one split, of places of groups and their sizes."""
    order = torch.randperm(len(sizes), generator=generator)
    middles = sizes[order].cumsum(0) - sizes[order] / 2  # the first lies before the cut and the last after it, always
    sides = torch.empty_like(order)
    sides[order] = (middles >= len(place) / 2).long()
    return _evened(sides[place], generator)


def _evened(side: Int[Tensor, " b"], generator: Generator) -> Int[Tensor, " b"]:
    """The sides with motions of the larger left out at random until both are equally many."""
    counts = side.bincount(minlength=2)
    larger = (side == counts.argmax()).nonzero().flatten()
    surplus = torch.randperm(len(larger), generator=generator)[: int(counts.max() - counts.min())]
    return side.index_fill(0, larger[surplus], -1)
