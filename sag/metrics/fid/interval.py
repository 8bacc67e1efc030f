"""How sure a Motion FID is: a bootstrap over whole groups of motions; ours, not the paper's."""

from __future__ import annotations

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.metrics.fid.clips import ClipFeatures, check_paired, motions_of
from sag.metrics.fid.resampling import places_of_groups, weighted_motion_fid


class Interval(NamedTuple):
    """An interval of a figure.

    Attributes:
        low: its lower end.
        high: its upper end.
    """

    low: float
    high: float


def motion_fid_interval(
    generated_features: ClipFeatures,
    real_features: ClipFeatures,
    group: Int[Tensor, " b"],
    resamples: int = 200,
    level: float = 0.95,
    seed: int = 0,
) -> dict[str, Interval]:
    """Where Motion FID would lie had other groups of windows been taken, equally many: a bootstrap by group. Ours.

    Windows of one recording overlap, and recordings of one room may share people and cameras. A group is all that
    belongs together, and only groups are independent, so its windows are drawn together (Davison and Hinkley, 1997,
    3.8): each resample draws as many groups as there are, with replacement, and both sides follow, since motion i of
    either belongs to window i.

    A resample has fewer distinct motions than the set, and a Fréchet distance F grows as sets shrink: F* of resamples
    lies above F, up to twice as high near the floor. So their spread is taken and their place is not: the interval is

    (sqrt(F) + quantiles of (sqrt(F*) - mean of sqrt(F*)))^2,

    moved along the distance itself, the root of F, whose spread depends little on its level. It answers what the
    figure *at this number of motions* may be; `motion_fid_infinity` is about the number.

    Reacts to how few groups there are and how they differ. Blind to the training run: another seed of it may differ
    by more than this shows. Too narrow where groups are not independent, as recordings of one room are not.

    Time: 18 distances a resample, for three encoders and six clip lengths, all of which the average takes. At d = 1000
    one is about 0.15 s on a CPU, so 200 resamples take about 9 minutes. Features stay on the device they are on.

    Args:
        generated_features: of generated motions, see `clip_features`.
        real_features: of the true motions of the same windows.
        group: of each window its recording or, better, its room: whatever does not share people, places or cameras.
        resamples: how many.
        level: share of the resamples inside.
        seed: of the drawing.

    Raises:
        SagError: the sides do not match, or fewer than two groups, or a number out of its range.

    Example:
        >>> import torch
        >>> draw = torch.manual_seed(0)
        >>> real = {(16, n): torch.randn(40, 64 // n, 3, generator=draw) for n in (2, 4, 8, 16, 32, 64)}
        >>> moved = {key: features + 1 for key, features in real.items()}
        >>> interval = motion_fid_interval(moved, real, group=torch.arange(40) // 4)["average"]
        >>> interval.low <= 3 <= interval.high
        True
    """
    check_paired("the interval of Motion FID", generated_features, real_features)
    place = places_of_groups("the interval of Motion FID", group, motions_of(real_features))
    if place.max() < 1:
        raise SagError("the interval of Motion FID needs motions of at least 2 groups, since it draws whole ones")
    if resamples < 2 or not 0 < level < 1:
        raise SagError(
            f"the interval of Motion FID needs 2 resamples or more and a level in 0 .. 1, not {resamples}, {level}"
        )
    count = int(place.max()) + 1
    weights = torch.cat([torch.ones(1, count, dtype=torch.float64), _resampled(count, resamples, seed)])
    found = weighted_motion_fid(generated_features, real_features, place, weights)
    return {name: _centred(figures[0], figures[1:], level) for name, figures in found.items()}


def _resampled(count: int, resamples: int, seed: int) -> Float[Tensor, "resamples count"]:
    """How often each of `count` groups is drawn in each resample."""
    generator = torch.Generator().manual_seed(seed)
    drawn = torch.randint(count, (resamples, count), generator=generator)
    return torch.zeros(resamples, count, dtype=torch.float64).scatter_add_(1, drawn, torch.ones_like(drawn).double())


def _centred(figure: Tensor, replicates: Float[Tensor, " resamples"], level: float) -> Interval:
    """Quantiles of replicates that were moved, as distances, so that their mean is at the figure."""
    roots = replicates.sqrt()
    ends = roots.quantile(roots.new_tensor([(1 - level) / 2, (1 + level) / 2])) - roots.mean() + figure.sqrt()
    return Interval(*ends.clamp_min(0).square().tolist())
