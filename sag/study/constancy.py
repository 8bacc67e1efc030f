"""How constant raters are: motions seen twice, agreement with the others, haste. Marks leave nobody out."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from sag.report.statistics import kendall
from sag.study.questions import QUESTIONS
from sag.study.ratings import Rating, first_ones

FAR_APART = 1.5
"""Mean difference between scores of one motion from which a rater is marked; guessing at random gives 1.6."""

LEAST_COMMON = 8
"""Motions that others scored too, below which agreement with them says nothing."""


@dataclass(frozen=True)
class Constancy:
    """What is known of how a rater answered.

    Attributes:
        rater: who.
        answers: given.
        twice: motions scored twice.
        apart: mean difference of the two scores; None where no motion was scored twice.
        with_others: Kendall's τ of a rater's scores with the mean of the others', the mean of both questions; None
            where too little is in common, or all scores are one.
        seconds: median of an answer.
        marks: what makes answers doubtful, in words.
    """

    rater: str
    answers: int
    twice: int
    apart: float | None
    with_others: float | None
    seconds: float
    marks: tuple[str, ...]


def constancies_of(ratings: Sequence[Rating], length: float) -> list[Constancy]:
    """Of every rater who answered, in the order of the ratings.

    Args:
        ratings: of all raters.
        length: of a motion, seconds.
    """
    own: dict[str, list[Rating]] = defaultdict(list)
    for rating in ratings:
        own[rating.rater].append(rating)
    return [_constancy(mine, ratings, length) for mine in own.values()]


def _constancy(mine: Sequence[Rating], ratings: Sequence[Rating], length: float) -> Constancy:
    apart = _apart(mine)
    mean_apart = statistics.fmean(apart) if apart else None
    with_others = _with_others(mine, ratings)
    seconds = statistics.median(rating.answer.seconds for rating in mine)
    scores = {score for rating in mine for score in rating.answer.scores.values()}
    reasons = {
        "one score for everything": len(mine) > 1 and len(scores) == 1,
        "scores a motion otherwise when it comes again": mean_apart is not None and mean_apart >= FAR_APART,
        "scores against the others": with_others is not None and with_others < 0,
        "answers before a motion can have ended": seconds < length,
    }
    marks = tuple(reason for reason, holds in reasons.items() if holds)
    twice = len(apart) // len(QUESTIONS)
    return Constancy(mine[0].rater, len(mine), twice, mean_apart, with_others, seconds, marks)


def _apart(mine: Sequence[Rating]) -> list[int]:
    """Differences between the first and the second score of motions seen twice, of both questions."""
    first = {rating.motion: rating.answer.scores for rating in mine if not rating.again}
    again = {rating.motion: rating.answer.scores for rating in mine if rating.again}
    both = [motion for motion in again if motion in first]
    return [abs(first[motion][one.name] - again[motion][one.name]) for motion in both for one in QUESTIONS]


def _with_others(mine: Sequence[Rating], ratings: Sequence[Rating]) -> float | None:
    others: dict[tuple[int, str], list[Rating]] = defaultdict(list)
    for rating in first_ones(ratings):
        if rating.rater != mine[0].rater:
            others[rating.motion].append(rating)
    common = [rating for rating in first_ones(mine) if others[rating.motion]]
    if len(common) < LEAST_COMMON:
        return None
    taus = []
    for name in (question.name for question in QUESTIONS):
        theirs = [statistics.fmean(one.answer.scores[name] for one in others[rating.motion]) for rating in common]
        tau, _ = kendall([rating.answer.scores[name] for rating in common], theirs)
        taus += [tau] if tau == tau else []  # NaN where all scores are one
    return statistics.fmean(taus) if taus else None
