"""What raters think of a method: mean, deviation, and an interval with raters as the unit."""

from __future__ import annotations

import math
import statistics
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from sag.report.statistics import Paired, half_width, paired
from sag.study.questions import SCALE, Name
from sag.study.ratings import Rating


@dataclass(frozen=True)
class Opinion:
    """The scores of one method in one question.

    Attributes:
        mean: of all scores, as the paper's.
        deviation: standard deviation of all scores, as the paper's; None for one score.
        low: lower end of the 95 % interval; None for one rater.
        high: upper end.
        counts: how often each score was given.
        raters: who gave them.
    """

    mean: float
    deviation: float | None
    low: float | None
    high: float | None
    counts: tuple[int, ...]
    raters: int

    @property
    def answers(self) -> int:
        """How many scores."""
        return sum(self.counts)


def opinion_of(ratings: Sequence[Rating], method: str, question: Name) -> Opinion | None:
    """What is thought of a method; nothing where nobody was asked.

    The interval is that of a mean over clusters: scores of one rater depend on each other, raters do not. Where all
    have answered equally much it is the t-interval of the raters' own means.

    m ± t₀.₉₇₅,ᵣ₋₁ √(Σ (nᵢ (mᵢ - m) / n̄)² / (r (r - 1))), over r raters with nᵢ scores of mean mᵢ
    """
    scores = scores_by_rater(ratings, method, question)
    every = [score for own in scores.values() for score in own]
    if not every:
        return None
    mean, usual = statistics.fmean(every), len(every) / len(scores)
    low = high = None
    if len(scores) > 1:
        off = [(sum(own) - mean * len(own)) / usual for own in scores.values()]
        half = half_width(math.sqrt(sum(one**2 for one in off) / (len(off) - 1)), len(off))
        low, high = mean - half, mean + half
    deviation = statistics.stdev(every) if len(every) > 1 else None
    return Opinion(mean, deviation, low, high, tuple(every.count(score) for score in SCALE), len(scores))


def scores_by_rater(ratings: Sequence[Rating], method: str, question: Name) -> dict[str, list[int]]:
    """The scores of each rater who saw motions of a method."""
    scores = defaultdict(list)
    for rating in ratings:
        if rating.method == method:
            scores[rating.rater].append(rating.answer.scores[question])
    return dict(scores)


def change(ratings: Sequence[Rating], before: str, after: str, question: Name) -> Paired | None:
    """How much better raters find one method than another, each rater compared with themselves."""
    first, second = (scores_by_rater(ratings, method, question) for method in (before, after))
    both = [rater for rater in first if rater in second]
    differences = [statistics.fmean(second[rater]) - statistics.fmean(first[rater]) for rater in both]
    return paired(differences) if differences else None
