"""How far raters agree: Krippendorff's alpha for ordered scores."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from sag.study.questions import SCALE, Name
from sag.study.ratings import Rating

DRAWS = 2000
"""Resamples of an interval."""


@dataclass(frozen=True)
class Agreement:
    """How far raters agree in a question.

    Attributes:
        alpha: 1 for perfect agreement, 0 for that of chance; NaN where nothing differs.
        low: lower end of its 95 % interval, motions drawn again with replacement; NaN where alpha is.
        high: upper end.
        motions: that at least two raters scored.
        same: share of pairs of raters with the same score.
        near: share of pairs of raters at most one apart.
    """

    alpha: float
    low: float
    high: float
    motions: int
    same: float
    near: float


def agreement_of(ratings: Sequence[Rating], question: Name) -> Agreement | None:
    """Agreement over all motions that at least two raters scored; nothing where there are none."""
    scores = defaultdict(list)
    for rating in ratings:
        scores[rating.motion].append(rating.answer.scores[question])
    counts = np.array([[own.count(score) for score in SCALE] for own in scores.values()]).reshape(-1, len(SCALE))
    counts = counts[counts.sum(1) > 1]
    if not len(counts):
        return None
    pairs = coincidences(counts)
    total, apart = pairs.sum(0), np.abs(np.subtract.outer(SCALE, SCALE))
    chosen = np.random.default_rng(0).multinomial(len(pairs), np.full(len(pairs), 1 / len(pairs)), DRAWS)
    resampled = [alpha_of(one) for one in np.tensordot(chosen, pairs, 1)]
    known = [one for one in resampled if not math.isnan(one)] or [math.nan]
    low, high = np.quantile(known, (0.025, 0.975)).tolist()
    same, near = (float(total[apart <= most].sum() / total.sum()) for most in (0, 1))
    return Agreement(alpha_of(total), low, high, len(counts), same, near)


def coincidences(counts: Int[np.ndarray, "motions scores"]) -> Float[np.ndarray, "motions scores scores"]:
    """Pairs of scores within each motion, each motion weighing as many as it has scores.

    oᵤ(c, k) = nᵤ(c) (nᵤ(k) - [c = k]) / (mᵤ - 1)

    Args:
        counts: how often each score was given to each motion, at least two a motion.
    """
    both = counts[:, :, None] * counts[:, None, :]
    both = both - counts[:, :, None] * np.eye(counts.shape[1], dtype=int)
    return both / (counts.sum(1) - 1)[:, None, None]


def alpha_of(pairs: Float[np.ndarray, "scores scores"]) -> float:
    """Krippendorff's alpha for ordered scores; NaN where only one score occurs.

    α = 1 - (n - 1) Σ o(c, k) δ²(c, k) / Σ n(c) n(k) δ²(c, k), where δ(c, k) is the number of scores given from c to k,
    those at both ends by half (Krippendorff, Computing Krippendorff's Alpha-Reliability, 2011).

    Args:
        pairs: of scores, summed over motions, see `coincidences`.
    """
    given = pairs.sum(1)
    middle = np.cumsum(given) - given / 2
    apart = np.square(np.subtract.outer(middle, middle))
    expected = float((np.outer(given, given) * apart).sum())
    if expected <= 0:
        return math.nan
    return 1 - (float(given.sum()) - 1) * float((pairs * apart).sum()) / expected
