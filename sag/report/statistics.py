"""Statistics of few seeds: intervals, paired comparisons, contrasts of a linear model, agreement of orders."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float
from scipy import optimize, special, stats

LEVEL = 0.95
"""How often an interval holds the true value, if the seeds are normal and independent."""

FLIPPED_AT_MOST = 16
"""Differences of which every choice of signs is tried: 65,536 of them."""

ROUNDING = 1e-12
"""Share of the largest value below which a difference is a rounding error."""

DRAWS = 10_000
"""Resamples of a bootstrap."""

NODES = 100
"""Points at which an integral is taken."""

Numbers = Float[np.ndarray, "..."]


def half_width(deviation: float, count: int, level: float = LEVEL) -> float:
    """Half of the t-interval of a mean: t s / √n, with n - 1 degrees of freedom.

    Args:
        deviation: s, the sample standard deviation.
        count: n, at least 2.
        level: how often such intervals hold the true mean.
    """
    return float(stats.t.ppf((1 + level) / 2, count - 1)) * deviation / math.sqrt(count)


@dataclass(frozen=True)
class Estimate:
    """A difference with its interval; None where the data give none.

    Attributes:
        value: the difference, or the logarithm of a ratio.
        low: lower end of the 95 % interval.
        high: upper end.
    """

    value: float
    low: float | None = None
    high: float | None = None

    @property
    def excludes_zero(self) -> bool:
        """Whether there is an interval, and 0 is outside."""
        return self.low is not None and self.high is not None and not self.low <= 0 <= self.high


@dataclass(frozen=True)
class Paired(Estimate):
    """The mean of differences of pairs.

    Attributes:
        count: pairs.
        p: of a paired t-test, two-sided.
        p_flip: of the exact sign-flip test, two-sided; it cannot fall below 2 / 2ⁿ.
    """

    count: int = 0
    p: float | None = None
    p_flip: float | None = None


def paired(differences: Sequence[float]) -> Paired:
    """Mean, interval and tests of differences within pairs: no interval from one pair, NaN where one is NaN."""
    values = np.asarray(differences, dtype=float)
    mean, count = float(values.mean()), len(values)
    if count < 2 or math.isnan(mean):
        return Paired(mean, count=count)
    half = half_width(float(values.std(ddof=1)), count)
    varies = np.ptp(values) > ROUNDING * np.abs(values).max()
    p = float(stats.ttest_1samp(values, 0.0).pvalue) if varies else float(mean == 0)
    return Paired(mean, mean - half, mean + half, count, p, sign_flip_p(differences))


def sign_flip_p(differences: Sequence[float]) -> float | None:
    """Two-sided p of the exact sign-flip test: the share of all choices of signs with a sum as far from 0.

    Without an effect a difference is as likely as its negative (no normal distribution is assumed; Fisher 1935).
    None for more than `FLIPPED_AT_MOST` differences.
    """
    if len(differences) > FLIPPED_AT_MOST:
        return None
    sums = np.zeros(1)
    for difference in differences:
        sums = np.concatenate([sums + difference, sums - difference])
    rounding = ROUNDING * float(np.abs(differences).sum())
    return float((np.abs(sums) >= abs(sum(differences)) - rounding).mean())


@dataclass(frozen=True)
class Contrasts:
    """Contrasts of a linear model.

    Attributes:
        estimates: in the order in which they were asked for.
        freedom: degrees of freedom of the error; at 0 there are no intervals.
    """

    estimates: tuple[Estimate, ...]
    freedom: int


def contrasts(design: Numbers, values: Numbers, wanted: Numbers) -> Contrasts:
    """Contrasts of the coefficients of a least-squares fit, with t-intervals from the residual error.

    y = X β + e, of one variance; l·β ± t √(σ² lᵀ (XᵀX)⁺ l), σ² = |y - Xβ|² / (n - rank X)

    Args:
        design: X, a line for each value; columns may depend on each other where no contrast feels it.
        values: y.
        wanted: l, a line for each contrast.
    """
    inverse = np.linalg.pinv(design.T @ design)
    coefficients = inverse @ design.T @ values
    freedom = len(values) - int(np.linalg.matrix_rank(design))
    found = wanted @ coefficients
    estimates = np.where(np.abs(found) > ROUNDING * np.abs(values).max(), found, 0.0).tolist()
    if freedom < 1:
        return Contrasts(tuple(map(Estimate, estimates)), 0)
    variance = float(np.square(values - design @ coefficients).sum()) / freedom
    errors = np.sqrt(np.einsum("ij,jk,ik->i", wanted, inverse, wanted).clip(min=0) * variance)
    halves = (errors * stats.t.ppf((1 + LEVEL) / 2, freedom)).tolist()
    return Contrasts(tuple(Estimate(*_ends(e, half)) for e, half in zip(estimates, halves)), freedom)


@dataclass(frozen=True)
class Compared(Estimate):
    """One of several groups against the same control.

    Attributes:
        p: two-sided, of Dunnett's test.
        count: values of the group.
        freedom: degrees of freedom of the error; at 0 there are no intervals.
    """

    p: float | None = None
    count: int = 0
    freedom: int = 0


def against_control(groups: Sequence[Sequence[float]], control: Sequence[float]) -> list[Compared]:
    """Means of groups less that of a control, with the simultaneous intervals of Dunnett's test (1955).

    The error is the scatter within all groups; it is one variance. Without any group of two values, or where nothing
    scatters, there are no intervals.

    Args:
        groups: at least one value in each.
        control: at least one value.
    """
    means = [float(np.mean(values) - np.mean(control)) for values in groups]
    squares = [float(np.square(np.asarray(values) - np.mean(values)).sum()) for values in (*groups, control)]
    freedom = sum(len(values) - 1 for values in (*groups, control))
    if freedom < 1 or not sum(squares):
        return [Compared(mean, count=len(values)) for mean, values in zip(means, groups)]
    counts = np.array([len(values) for values in groups])
    errors = np.sqrt(sum(squares) / freedom * (1 / counts + 1 / len(control)))
    loadings = np.sqrt(counts / (counts + len(control)))
    critical = optimize.brentq(lambda t: _dunnett(t, loadings, freedom) - LEVEL, 0.0, 1000.0)
    found = zip(means, errors.tolist(), counts.tolist())
    return [
        Compared(*_ends(mean, critical * error), _p(mean / error, loadings, freedom), count, freedom)
        for mean, error, count in found
    ]


def _p(t: float, loadings: Numbers, freedom: int) -> float:
    return round(1 - _dunnett(abs(t), loadings, freedom), 6)


def _dunnett(t: float, loadings: Numbers, freedom: int) -> float:
    """Probability that no t-value of groups without a difference from their control is farther from 0 than t.

    Two of them have the product of their loadings as correlation, since they share the control, so that given its
    mean z and the error's deviation s they are independent: both are integrated over.
    """
    (z, weights), (u, shares) = _nodes()
    s = np.sqrt(stats.chi2.ppf((u + 1) / 2, freedom) / freedom)
    middle, rest = loadings * z[:, None, None], np.sqrt(1 - loadings**2)
    width = t * s[:, None]
    within = special.ndtr((middle + width) / rest) - special.ndtr((middle - width) / rest)
    return float(weights @ within.prod(-1) @ shares / weights.sum() / 2)


@cache
def _nodes() -> tuple[tuple[Numbers, Numbers], tuple[Numbers, Numbers]]:
    """Points and weights of an integral over a normal variable, and of one from -1 to 1."""
    return np.polynomial.hermite_e.hermegauss(NODES), np.polynomial.legendre.leggauss(NODES)


def kendall(ours: Sequence[float], theirs: Sequence[float]) -> tuple[float, float]:
    """Kendall's τ of two orders and its two-sided p: exact where nothing is tied."""
    result = stats.kendalltau(ours, theirs)
    return float(result.statistic), float(result.pvalue)


def kendalls(ours: Numbers, theirs: Numbers) -> Numbers:
    """Kendall's τ (b, ties counted) of each line of one array with a single order; NaN where all of a line is tied."""
    first, second = np.triu_indices(len(theirs), 1)
    signs, wanted = np.sign(ours[:, first] - ours[:, second]), np.sign(theirs[first] - theirs[second])
    untied = np.abs(signs).sum(1) * np.abs(wanted).sum()
    with np.errstate(invalid="ignore"):
        return (signs @ wanted) / np.sqrt(untied)


def bootstrap_kendalls(values: Numbers, theirs: Numbers, draws: int = DRAWS) -> Numbers:
    """τ of the means of resampled seeds with an order; the same for any order of the seeds.

    Args:
        values: a line for each seed, a column for each row of the table.
        theirs: one number for each column.
        draws: resamples.
    """
    values = values[np.lexsort(values.T)]
    chosen = np.random.default_rng(0).integers(len(values), size=(draws, len(values)))
    return kendalls(values[chosen].mean(1), theirs)


def _ends(value: float, half: float) -> tuple[float, float, float]:
    """A value and its interval to nine digits: beyond is a machine's rounding, and would make other files of the same
    figures."""
    low, high = value - half, value + half
    return float(f"{value:.9g}"), float(f"{low:.9g}"), float(f"{high:.9g}")
