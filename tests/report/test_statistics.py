"""Against scipy, cases done by hand, and how often intervals of made-up data hold the truth."""

import math
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from sag.report.statistics import (
    FLIPPED_AT_MOST,
    Estimate,
    _dunnett,
    against_control,
    bootstrap_kendalls,
    contrasts,
    half_width,
    kendall,
    kendalls,
    paired,
    sign_flip_p,
)

numbers = st.floats(-100, 100).map(lambda value: round(value, 3))


def test_half_of_an_interval_by_hand():
    assert half_width(4.0, 3) == pytest.approx(4.302653 * 4 / math.sqrt(3))
    assert half_width(1.0, 2) == pytest.approx(12.7062047 / math.sqrt(2))


@given(st.lists(numbers, min_size=2, max_size=8))
def test_a_paired_comparison_is_scipys(differences):
    found = paired(differences)
    if np.ptp(differences) < 1e-6:
        return
    theirs = stats.ttest_1samp(differences, 0.0)
    interval = theirs.confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((interval.low, interval.high), rel=1e-6, abs=1e-6)
    assert found.p == pytest.approx(theirs.pvalue, abs=1e-9)
    assert found.count == len(differences)


@given(st.lists(numbers, min_size=1, max_size=7), st.randoms())
def test_the_order_of_seeds_changes_nothing(differences, chance):
    mixed = list(differences)
    chance.shuffle(mixed)
    one, other = paired(differences), paired(mixed)
    assert one.value == pytest.approx(other.value) and one.p_flip == other.p_flip
    assert (one.low is None) == (other.low is None) == (len(differences) == 1)


def test_sign_flips_by_hand():
    assert sign_flip_p([1.0, 2.0, 3.0]) == 2 / 8
    assert sign_flip_p([1.0, 1.0, -1.0]) == 1.0
    assert sign_flip_p([3.0, 2.0, -1.0]) == 4 / 8, "sums of at least 4: two of either sign"
    assert sign_flip_p([0.1, 0.2, 0.3, 0.4, 0.5]) == 2 / 32
    assert sign_flip_p([1.0] * (FLIPPED_AT_MOST + 1)) is None


def test_sign_flips_are_scipys_permutation_test():
    differences = np.random.default_rng(1).normal(0.4, 1, 7)
    theirs = stats.permutation_test(
        (differences,), np.mean, permutation_type="samples", n_resamples=np.inf, alternative="two-sided"
    )
    assert sign_flip_p(list(differences)) == pytest.approx(theirs.pvalue)


def test_what_does_not_vary_has_a_p_too():
    assert (paired([0.0, 0.0]).p, paired([0.0, 0.0]).p_flip) == (1.0, 1.0)
    assert paired([2.0, 2.0]).p == 0.0


def test_nan_stays_nan_and_one_pair_has_no_interval():
    assert math.isnan(paired([1.0, math.nan]).value) and paired([1.0, math.nan]).low is None
    assert paired([1.0]) == paired([1.0]).__class__(1.0, None, None, 1, None, None)
    assert not Estimate(1.0).excludes_zero and Estimate(1.0, 0.1, 1.9).excludes_zero


def test_intervals_hold_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(0)
    held = [found.low <= 0.3 <= found.high for found in map(paired, rng.normal(0.3, 1, (2000, 5)).tolist())]
    assert np.mean(held) == pytest.approx(0.95, abs=0.015)


def test_contrasts_are_those_of_a_t_test():
    one, other = [1.0, 2.0, 4.0, 3.0], [5.0, 4.0, 7.0]
    design = np.array([[1, 0]] * 4 + [[0, 1]] * 3, dtype=float)
    found = contrasts(design, np.array(one + other), np.array([[-1.0, 1.0]]))
    theirs = stats.ttest_ind(other, one).confidence_interval(0.95)
    (estimate,) = found.estimates
    assert (estimate.low, estimate.high) == pytest.approx((theirs.low, theirs.high)) and found.freedom == 5


def test_blocks_make_contrasts_a_paired_t_test():
    one, other = [1.0, 2.0, 4.0, 3.0], [2.5, 3.0, 5.5, 5.0]
    rows, seeds = np.repeat(np.eye(2), 4, 0), np.tile(np.eye(4), (2, 1))
    found = contrasts(np.hstack([rows, seeds]), np.array(one + other), np.array([[-1.0, 1.0] + [0.0] * 4]))
    theirs = paired([b - a for a, b in zip(one, other)])
    (estimate,) = found.estimates
    assert (estimate.value, estimate.low, estimate.high) == pytest.approx((theirs.value, theirs.low, theirs.high))
    assert found.freedom == 3


def test_a_model_without_residuals_has_no_intervals():
    found = contrasts(np.eye(2), np.array([1.0, 3.0]), np.array([[-1.0, 1.0]]))
    assert found.freedom == 0 and found.estimates[0].low is None
    assert found.estimates[0].value == pytest.approx(2.0)


@given(st.lists(st.integers(0, 4), min_size=4, max_size=4))
def test_many_taus_are_scipys_ties_included(ours):
    theirs = np.array([3.0, 1.0, 2.0, 2.5])
    found = kendalls(np.array([ours], dtype=float), theirs)[0]
    assert found == pytest.approx(kendall(ours, theirs.tolist())[0], nan_ok=True)


def test_tau_is_one_for_the_same_order_and_its_p_exact():
    order = [3.0, 1.0, 2.0, 5.0, 4.0, 6.0]
    assert kendall(order, order) == pytest.approx((1.0, 2 / math.factorial(6)))
    assert kendall([-x for x in order], order)[0] == pytest.approx(-1.0)
    taus = [kendall(list(p), [1, 2, 3, 4])[0] for p in permutations([1, 2, 3, 4])]
    assert kendall([1, 2, 4, 3], [1, 2, 3, 4])[1] == pytest.approx(np.mean(np.abs(taus) >= 4 / 6 - 1e-9))


def test_resampled_taus_do_not_depend_on_the_order_of_seeds():
    rng = np.random.default_rng(0)
    values, theirs = rng.normal(size=(5, 6)) + np.arange(6) / 2, np.arange(6.0)
    taus = bootstrap_kendalls(values, theirs, 500)
    assert taus.shape == (500,) and np.abs(taus).max() <= 1
    assert np.array_equal(taus, bootstrap_kendalls(values[[3, 1, 4, 0, 2]], theirs, 500))
    alike = bootstrap_kendalls(np.tile(theirs, (4, 1)), theirs, 50)
    assert alike == pytest.approx(1.0)


def test_contrasts_are_the_same_on_machines_that_round_otherwise():
    chance = np.random.default_rng(0)
    values, design = chance.normal(size=12), np.c_[np.ones(12), np.tile([0.0, 1.0], 6)]
    wanted = np.array([[0.0, 1.0]])
    rounded = values * (1 + 1e-14 * chance.normal(size=12))
    assert not np.array_equal(values, rounded)
    assert contrasts(design, values, wanted) == contrasts(design, rounded, wanted)


def test_one_group_against_a_control_is_a_t_test_of_one_variance():
    group, control = [3.0, 4.5, 5.0], [1.0, 2.0, 2.5, 1.5]
    (found,) = against_control([group], control)
    interval = stats.ttest_ind(group, control).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((interval.low, interval.high), rel=1e-4)
    assert found.p == pytest.approx(stats.ttest_ind(group, control).pvalue, abs=1e-5)
    assert found.value == pytest.approx(np.mean(group) - np.mean(control))
    assert (found.count, found.freedom) == (3, 5)


@pytest.mark.parametrize(("groups", "freedom", "critical"), [(2, 10, 2.57), (3, 20, 2.54), (9, 60, 2.77)])
def test_critical_values_are_those_of_dunnetts_table(groups, freedom, critical):
    """Two-sided, 5 %, as many values in each group as in the control (Dunnett 1964)."""
    assert _dunnett(critical, np.full(groups, math.sqrt(0.5)), freedom) == pytest.approx(0.95, abs=0.001)


def test_p_values_are_scipys():
    generator = np.random.default_rng(2)
    control, *groups = generator.normal(size=(6, 4)).tolist()
    theirs = stats.dunnett(*groups, control=control).pvalue
    assert [found.p for found in against_control(groups, control)] == pytest.approx(theirs, abs=0.01)


def test_more_groups_widen_every_interval_and_a_single_value_leans_on_the_others():
    generator = np.random.default_rng(0)
    control, *groups = generator.normal(size=(9, 3)).tolist()
    few, many = against_control([*groups[:1], [0.0]], control), against_control([*groups, [0.0]], control)
    assert many[-1].freedom == 18 and many[-1].count == 1
    t = stats.t.ppf(0.975, 18) * math.sqrt(np.mean([np.var(g, ddof=1) for g in (control, *groups)]) * 2 / 3)
    assert many[0].high - many[0].value > 1.2 * t
    assert many[-1].high - many[-1].value > many[0].high - many[0].value
    assert few[0].value == many[0].value


def test_without_scatter_there_are_differences_and_no_intervals():
    assert [found.low for found in against_control([[1.0], [2.0]], [3.0])] == [None, None]
    (found,) = against_control([[1.0, 1.0]], [3.0, 3.0])
    assert (found.value, found.low, found.freedom) == (-2.0, None, 0)


def test_simultaneous_intervals_hold_all_truths_at_once():
    generator = np.random.default_rng(1)
    held = [
        all(found.low <= 0 <= found.high for found in against_control(draw[1:].tolist(), draw[0].tolist()))
        for draw in generator.normal(size=(100, 6, 3))
    ]
    assert 0.88 <= np.mean(held) <= 1
