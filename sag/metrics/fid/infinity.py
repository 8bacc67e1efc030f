"""Motion FID without the share that the number of motions has in it; ours, not the paper's."""

from __future__ import annotations

import torch
from jaxtyping import Float, Int
from torch import Generator, Tensor

from sag.errors import SagError
from sag.metrics.fid.clips import ClipFeatures, check_paired, motions_of
from sag.metrics.fid.resampling import places_of_groups, weighted_motion_fid

_PIECES = 12
"""Pieces that the set is cut into: halves, thirds and quarters are sums of them."""

_PARTS = (1, 2, 3, 4)
"""Into how many parts the set is split, so that 1/N is evenly spaced."""


def motion_fid_infinity(
    generated_features: ClipFeatures,
    real_features: ClipFeatures,
    group: Int[Tensor, " b"] | None = None,
    repeats: int = 4,
    seed: int = 0,
) -> dict[str, Tensor]:
    """Motion FID extrapolated to infinitely many motions (Chong and Forsyth, CVPR 2020). Ours for motion.

    A Fréchet distance of N motions against N lies above the true one by about c / N, where c depends on the sets, so
    that rows can change places with N. Here the set is split at random into 1, 2, 3 and 4 parts; the mean distance of
    the parts is fitted against 1/N by least squares, and the line read at 1/N = 0:

    F(N) = F_inf + c / N

    Reacts to what Motion FID reacts to. It may come out a little below 0 where there is nothing to tell apart. Do not
    trust it where a quarter of the motions is fewer than a feature has numbers: there the line bends.

    Args:
        generated_features: of generated motions, see `clip_features`.
        real_features: of as many true motions.
        group: of each window its recording or, better, its room: whatever does not share people, places or cameras.
            Given it, parts are made of whole groups, since only groups are independent: further windows of the same
            ones tell less than further groups. Motion i of both sides belongs to window i then.
        repeats: random splits to average.
        seed: of the splits.

    Raises:
        SagError: the sides do not match, or there are too few motions or groups to split.

    Example:
        >>> import torch
        >>> draw = torch.manual_seed(0)
        >>> one, two = ({(16, n): torch.randn(64, 64 // n, 3, generator=draw) for n in (2, 8, 32)} for _ in range(2))
        >>> abs(float(motion_fid_infinity(one, two)["long"])) < 0.1
        True
    """
    check_paired("Motion FID for infinite N", generated_features, real_features)
    motions = motions_of(real_features)
    each_alone = torch.arange(motions)
    unit = each_alone if group is None else places_of_groups("Motion FID for infinite N", group, motions)
    generator = torch.Generator().manual_seed(seed)
    found = [_intercepts(generated_features, real_features, unit, generator) for _ in range(repeats)]
    return {name: torch.stack([each[name] for each in found]).mean() for name in found[0]}


def _intercepts(generated: ClipFeatures, real: ClipFeatures, unit: Tensor, generator: Generator) -> dict[str, Tensor]:
    """The least squares line's value at 1/N = 0 for one random split."""
    order = torch.randperm(int(unit.max()) + 1, generator=generator)
    piece = order[unit] * _PIECES // len(order)
    sizes = torch.bincount(piece, minlength=_PIECES).double()
    splits = [split for split in map(_parts, _PARTS) if (split @ sizes).min() >= 2]
    if len(splits) < 2:
        raise SagError("Motion FID for infinite N needs at least 4 motions, and of 2 groups, to split them in parts")
    figures = weighted_motion_fid(generated, real, piece, torch.cat(splits))
    inverse = torch.stack([(1 / (split @ sizes)).mean() for split in splits])
    lengths = [len(split) for split in splits]
    return {
        name: _at_zero(inverse.to(each.device), torch.stack([part.mean() for part in each.split(lengths)]))
        for name, each in figures.items()
    }


def _parts(count: int) -> Float[Tensor, "{count} pieces"]:
    """Which pieces each of so many parts is made of, 1 or 0."""
    return torch.eye(count, dtype=torch.float64).repeat_interleave(_PIECES // count, dim=1)


def _at_zero(x: Float[Tensor, " n"], y: Float[Tensor, " n"]) -> Tensor:
    """Where the least squares line through points meets x = 0."""
    deviation = x - x.mean()
    return y.mean() - x.mean() * (deviation @ y) / deviation.square().sum()
