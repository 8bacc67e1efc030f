"""Means, intervals, agreement and constancy: against published and hand-made figures."""

import math
import statistics
from itertools import permutations

import numpy as np
import pytest
from scipy import stats

from sag.study.agreement import agreement_of, alpha_of, coincidences
from sag.study.answers import Answer
from sag.study.constancy import constancies_of
from sag.study.opinions import change, opinion_of
from sag.study.ratings import Rating

NONE = None
PUBLISHED = [
    [1, 2, 3, 3, 2, 1, 4, 1, 2, NONE, NONE, NONE],
    [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, NONE, 3],
    [NONE, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, NONE],
    [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, NONE],
]
"""Four observers of twelve units: Krippendorff, Computing Krippendorff's Alpha-Reliability (2011), example D."""


def rating(rater: str, method: str, scene: int, score: int, human: int = 3, again: bool = False, seconds=5.0) -> Rating:
    answer = Answer(rater, 0, "", {"scene": score, "human": human}, seconds, 1)
    return Rating(answer, scene, method, again)


def table(rows) -> list[Rating]:
    """Ratings of a table with a line for each rater and a column for each motion."""
    return [
        rating(f"rater {place}", "m", unit, score)
        for place, row in enumerate(rows)
        for unit, score in enumerate(row)
        if score is not None
    ]


def test_alpha_is_the_published_one():
    found = agreement_of(table(PUBLISHED), "scene")
    assert found.alpha == pytest.approx(0.815, abs=5e-4)
    assert found.motions == 11 and found.low < found.alpha < found.high


def slow_alpha(rows) -> float:
    """The same by its definition: every pair of scores of every unit, one after the other."""
    units = [[score for score in unit if score is not None] for unit in zip(*rows)]
    units = [unit for unit in units if len(unit) > 1]
    given = [score for unit in units for score in unit]

    def apart(one: int, other: int) -> float:
        low, high = sorted((one, other))
        ends = (given.count(low) + given.count(high)) / 2
        return (sum(given.count(score) for score in range(low, high + 1)) - ends) ** 2 if low < high else 0.0

    observed = sum(apart(*pair) / (len(unit) - 1) for unit in units for pair in permutations(unit, 2))
    expected = sum(apart(*pair) for pair in permutations(given, 2))
    return 1 - (observed / len(given)) / (expected / (len(given) * (len(given) - 1)))


@pytest.mark.parametrize("seed", range(4))
def test_alpha_is_that_of_its_definition(seed):
    chance = np.random.default_rng(seed)
    rows = np.where(chance.random((5, 9)) < 0.25, 0, chance.integers(1, 6, (5, 9)))
    rows = [[int(score) or None for score in row] for row in rows]
    assert agreement_of(table(rows), "scene").alpha == pytest.approx(slow_alpha(rows), abs=1e-12)


def test_alpha_at_its_ends():
    assert agreement_of(table([[1, 2, 3, 5]] * 3), "scene").alpha == 1
    chance = np.random.default_rng(0).integers(1, 6, (12, 400)).tolist()
    assert abs(agreement_of(table(chance), "scene").alpha) < 0.02
    assert math.isnan(agreement_of(table([[3, 3], [3, 3]]), "scene").alpha)
    assert agreement_of(table([[1, 2, 3]]), "scene") is None
    assert alpha_of(coincidences(np.array([[1, 0, 0, 0, 1], [1, 0, 0, 0, 1]])).sum(0)) < 0


def test_shares_of_pairs_of_raters():
    found = agreement_of(table([[1, 5], [1, 4], [2, 1]]), "scene")
    assert found.same == pytest.approx(1 / 6) and found.near == pytest.approx(4 / 6)


def test_mean_and_deviation_are_of_all_scores_and_the_interval_of_raters():
    rows = [[5, 4, 4], [3, 3, 4], [2, 2, 4], [5, 5, 4]]
    found = opinion_of(table(rows), "m", "scene")
    every, means = [score for row in rows for score in row], [statistics.fmean(row) for row in rows]
    assert (found.mean, found.deviation) == pytest.approx((statistics.fmean(every), statistics.stdev(every)))
    interval = stats.ttest_1samp(means, 0).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((interval.low, interval.high))
    assert found.counts == (0, 2, 2, 5, 3) and found.raters == 4 and found.answers == 12


def test_more_motions_of_the_same_raters_do_not_narrow_the_interval():
    rows = [[5, 4], [3, 3], [2, 2]]
    few, many = (opinion_of(table([row * times for row in rows]), "m", "scene") for times in (1, 50))
    assert many.high - many.low == pytest.approx(few.high - few.low)


def test_a_rater_of_one_answer_weighs_one_answer():
    found = opinion_of(table([[4] * 20, [4] * 20, [1]]), "m", "scene")
    assert found.mean == pytest.approx(161 / 41) and found.low < found.mean < found.high
    assert found.high - found.mean == pytest.approx(found.mean - found.low) and found.low > 3


def test_intervals_hold_the_mean_as_often_as_they_say():
    chance, held = np.random.default_rng(0), 0
    for _ in range(400):
        bias = chance.normal(0, 0.6, 8)
        scores = np.clip(np.round(3 + bias[:, None] + chance.normal(0, 0.5, (8, 6))), 1, 5).astype(int)
        found = opinion_of(table(scores.tolist()), "m", "scene")
        held += found.low <= 3 <= found.high
    assert 0.92 <= held / 400 <= 0.98


def test_one_rater_gives_no_interval_and_nobody_no_opinion():
    found = opinion_of(table([[4, 5]]), "m", "scene")
    assert found.mean == 4.5 and found.low is found.high is None
    assert opinion_of(table([[4]]), "m", "scene").deviation is None and opinion_of([], "m", "scene") is None


def test_changes_compare_raters_with_themselves():
    ratings = [rating(f"{place}", "old", 0, 1 + place) for place in range(4)]
    ratings += [rating(f"{place}", "new", 0, min(5, 2 + place + place % 2)) for place in range(4)]
    found = change(ratings, "old", "new", "scene")
    assert found.value == pytest.approx(1.25) and found.count == 4
    assert found.p == pytest.approx(stats.ttest_1samp([1, 2, 1, 1], 0).pvalue)
    assert change(ratings, "old", "other", "scene") is None


def test_raters_are_marked_for_what_makes_them_doubtful():
    good = [
        rating(f"good {place}", "m", scene, 1 + (scene + place // 2) % 5, 1 + scene % 5)
        for place in range(3)
        for scene in range(10)
    ]
    good += [rating("good 0", "m", 0, 1, 1, again=True)]
    flat = [rating("flat", "m", scene, 3) for scene in range(10)]
    hasty = [rating("hasty", "m", scene, 1 + scene % 5, 1 + scene % 5, seconds=0.4) for scene in range(10)]
    against = [rating("against", "m", scene, 5 - scene % 5, 5 - scene % 5) for scene in range(10)]
    fickle = [rating("fickle", "m", scene, 1 + scene % 5, 1 + scene % 5) for scene in range(10)]
    fickle += [rating("fickle", "m", 0, 5, 5, again=True)]
    found = {one.rater: one for one in constancies_of([*good, *flat, *hasty, *against, *fickle], 2.1)}
    assert {name: one.marks for name, one in found.items()} == {
        **{f"good {place}": () for place in range(3)},
        "flat": ("one score for everything",),
        "hasty": ("answers before a motion can have ended",),
        "against": ("scores against the others",),
        "fickle": ("scores a motion otherwise when it comes again",),
    }
    assert found["good 0"].apart == 0 and found["good 0"].twice == 1 and found["good 1"].apart is None
    assert found["fickle"].apart == 4 and found["flat"].with_others is None and found["good 1"].with_others > 0.5
