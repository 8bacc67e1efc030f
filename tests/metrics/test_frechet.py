"""The Fréchet distance: what a distance must be, then scipy as the reference."""

import numpy as np
import pytest
import scipy.linalg
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from sag.metrics import frechet_distance

Moments = tuple[torch.Tensor, torch.Tensor]


def moments(seed: int, count: int = 60, dimension: int = 12, scale: float = 1.0) -> Moments:
    generator = torch.manual_seed(seed)
    mixing = torch.randn(dimension, dimension, generator=generator, dtype=torch.float64)
    points = scale * torch.randn(count, dimension, generator=generator, dtype=torch.float64) @ mixing
    return points.mean(0), points.T.cov()


def by_scipy(a: Moments, b: Moments) -> float:
    root = np.real(scipy.linalg.sqrtm(a[1].numpy() @ b[1].numpy()))
    return float((a[0] - b[0]).square().sum() + a[1].trace() + b[1].trace()) - 2 * np.trace(root)


@pytest.mark.parametrize("dimension", [2, 12, 64])
def test_equals_scipy(dimension):
    a, b = moments(0, 200, dimension), moments(1, 200, dimension, 2.0)
    assert float(frechet_distance(*a, *b)) == pytest.approx(by_scipy(a, b), rel=1e-9)


@given(seed=st.integers(0, 10_000), count=st.integers(2, 40), scale=st.floats(1e-3, 1e3))
@settings(max_examples=40, deadline=None)
def test_is_symmetric_not_negative_and_does_not_turn_with_the_axes(seed, count, scale):
    a, b = moments(seed, count, 12, scale), moments(seed + 1, 30, 12, scale)
    distance = float(frechet_distance(*a, *b))
    assert distance >= 0
    assert float(frechet_distance(*b, *a)) == pytest.approx(distance, rel=1e-6)
    turn = torch.linalg.qr(torch.randn(12, 12, generator=torch.manual_seed(seed), dtype=torch.float64))[0]
    turned = [(turn @ mean, turn @ covariance @ turn.T) for mean, covariance in (a, b)]
    assert float(frechet_distance(*turned[0], *turned[1])) == pytest.approx(distance, rel=1e-6)


@pytest.mark.parametrize("count", [2, 8, 100])
def test_identical_sets_are_at_distance_zero_of_any_rank(count):
    a = moments(0, count, 32)
    distance = float(frechet_distance(*a, *a))
    assert 0 <= distance < 1e-9 * float(a[1].trace())


@pytest.mark.parametrize("count", [5, 20, 300])
def test_known_distance_of_a_scaled_and_shifted_set(count):
    mean, covariance = moments(0, count, 64)
    truth = 64 * 0.5**2 + covariance.trace()
    found = frechet_distance(mean, covariance, mean + 0.5, 4 * covariance)
    assert float(found) == pytest.approx(float(truth), rel=1e-9)


def test_points_without_spread_are_as_far_as_their_means():
    nothing = torch.zeros(3, 3)
    assert float(frechet_distance(torch.zeros(3), nothing, torch.ones(3), nothing)) == 3


def test_is_computed_in_float64_whatever_comes_in():
    a, b = moments(0), moments(1)
    low = frechet_distance(*(x.float() for x in (*a, *b)))
    assert low.dtype == torch.float64
    assert float(low) == pytest.approx(float(frechet_distance(*a, *b)), rel=1e-4)
