"""The Fréchet distance against its definition, other people's code, and what a distance must do."""

import copy

import numpy as np
import pytest
import scipy.linalg
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torchmetrics.image.fid import _compute_fid

from sag.metrics import Gaussian, frechet_distance


def points(seed: int, count: int = 60, dimension: int = 12, scale: float = 1.0) -> torch.Tensor:
    generator = torch.manual_seed(seed)
    mixing = torch.randn(dimension, dimension, generator=generator, dtype=torch.float64)
    return scale * torch.randn(count, dimension, generator=generator, dtype=torch.float64) @ mixing


def gaussian(*args, **options) -> Gaussian:
    return Gaussian.of(points(*args, **options))


def by_scipy(a: Gaussian, b: Gaussian) -> float:
    root = np.real(scipy.linalg.sqrtm(a.covariance.numpy() @ b.covariance.numpy()))
    spread = a.covariance.trace() + b.covariance.trace()
    return float((a.mean - b.mean).square().sum() + spread) - 2 * np.trace(root)


def by_torchmetrics(a: Gaussian, b: Gaussian) -> float:
    return float(_compute_fid(a.mean, a.covariance, b.mean, b.covariance))


@pytest.mark.parametrize("reference", [by_scipy, by_torchmetrics])
@pytest.mark.parametrize("dimension", [2, 12, 200])
def test_equals_other_peoples(dimension, reference):
    a, b = gaussian(0, 400, dimension), gaussian(1, 400, dimension, 2.0)
    assert float(a.distance(b)) == pytest.approx(reference(a, b), rel=1e-9)
    plain = frechet_distance(a.mean, a.covariance, b.mean, b.covariance)
    assert float(plain) == pytest.approx(reference(a, b), rel=1e-9)


@given(seed=st.integers(0, 10_000), count=st.integers(2, 40), scale=st.floats(1e-3, 1e3))
@settings(max_examples=40, deadline=None)
def test_is_symmetric_not_negative_and_does_not_turn_with_the_axes(seed, count, scale):
    sets = points(seed, count, 12, scale), points(seed + 1, 30, 12, scale)
    a, b = map(Gaussian.of, sets)
    distance = float(a.distance(b))
    assert distance >= 0
    assert float(b.distance(a)) == pytest.approx(distance, rel=1e-6)
    turn = torch.linalg.qr(torch.randn(12, 12, generator=torch.manual_seed(seed), dtype=torch.float64))[0]
    turned = [Gaussian.of(x @ turn) for x in sets]
    assert float(turned[0].distance(turned[1])) == pytest.approx(distance, rel=1e-6)


@given(seed=st.integers(0, 10_000), count=st.integers(2, 80), scale=st.floats(1e-3, 1e3))
@settings(max_examples=40, deadline=None)
def test_equal_sets_are_at_distance_zero_of_any_rank_and_in_any_order(seed, count, scale):
    cloud = points(seed, count, 32, scale)
    a, b = Gaussian.of(cloud), Gaussian.of(cloud.flip(0))
    for distance in (a.distance(a), a.distance(b), frechet_distance(a.mean, a.covariance, b.mean, b.covariance)):
        assert 0 <= float(distance) < 1e-6 * float(a.covariance.trace())


def truths(count: int, dimension: int, decay: float) -> list[tuple[Gaussian, Gaussian, float]]:
    """Pairs whose distance is known otherwise: a set moved and scaled, itself, and a unit ball against it."""
    turn = torch.linalg.qr(points(0, dimension, dimension))[0]
    steps = torch.logspace(0, -decay, dimension, dtype=torch.float64)
    cloud = torch.randn(count, dimension, generator=torch.manual_seed(1), dtype=torch.float64) * steps @ turn
    a, ball = Gaussian.of(cloud), Gaussian(torch.zeros(dimension), torch.eye(dimension))
    spreads = torch.linalg.svdvals(cloud - cloud.mean(0)) / (count - 1) ** 0.5
    scaled = float((a.mean + 0.5).square().sum() + a.covariance.trace())
    from_ball = float(a.mean.square().sum() + (1 - spreads).square().sum()) + dimension - len(spreads)
    return [(a, Gaussian.of(2 * cloud + 0.5), scaled), (a, Gaussian.of(cloud.flip(0)), 0.0), (ball, a, from_ball)]


@pytest.mark.parametrize("decay", [0, 1, 4])
@pytest.mark.parametrize("count", [20, 100, 199])
def test_known_distances_of_sets_smaller_than_their_dimension(count, decay):
    for a, b, truth in truths(count, 200, decay):
        error, peers = abs(float(a.distance(b)) - truth), abs(by_torchmetrics(a, b) - truth)
        assert error < 1e-10 * (1 + truth)
        assert error <= peers / 4


def test_plain_covariances_of_low_rank_lose_little():
    for a, b, truth in truths(50, 200, 0):
        found = frechet_distance(a.mean, a.covariance, b.mean, b.covariance)
        assert float(found) == pytest.approx(truth, abs=1e-6)


@pytest.mark.parametrize("count", [3, 8, 100])
def test_the_root_is_a_root_with_as_many_columns_as_the_rank(count):
    a = gaussian(0, count, 32)
    assert a.root.shape == (32, min(count - 1, 32))
    assert torch.allclose(a.root @ a.root.T, a.covariance, atol=1e-12 * float(a.covariance.trace()))
    assert torch.equal(a.root, a.root.tril())
    assert a.root is a.root, "computed once"


def test_blocks_of_columns_make_no_difference(monkeypatch):
    a, b = gaussian(0, 100, 50), gaussian(1, 100, 50)
    whole = float(a.distance(b))
    monkeypatch.setattr("sag.metrics.frechet._BLOCK", 7)
    assert float(copy.deepcopy(a).distance(b)) == pytest.approx(whole, rel=1e-12)


def test_sums_are_enough():
    cloud = points(3)
    halves = [(len(x), x.sum(0), x.T @ x) for x in cloud.split(25)]
    a = Gaussian.of_sums(*map(sum, zip(*halves)))
    assert torch.allclose(a.mean, cloud.mean(0)) and torch.allclose(a.covariance, cloud.T.cov())


def test_the_same_is_the_same_to_the_bit():
    a, b = gaussian(0), gaussian(0)
    assert a.same_as(b)
    b.covariance[3, 3] += 1e-15 * b.covariance[3, 3] * 4
    assert not a.same_as(b)


def test_points_without_spread_are_as_far_as_their_means():
    nothing = torch.zeros(3, 3)
    assert float(frechet_distance(torch.zeros(3), nothing, torch.ones(3), nothing)) == 3


def test_is_blind_to_everything_but_mean_and_covariance():
    corners = torch.tensor([[-1.0], [1.0]]).repeat(50, 1)
    normal = torch.randn(100, 1, generator=torch.manual_seed(0), dtype=torch.float64)
    normal = (normal - normal.mean()) / normal.std() * corners.double().std()
    assert float(Gaussian.of(corners).distance(Gaussian.of(normal))) < 1e-12


def test_is_computed_in_float64_whatever_comes_in():
    a, b = gaussian(0), gaussian(1)
    low = frechet_distance(*(x.float() for x in (a.mean, a.covariance, b.mean, b.covariance)))
    assert low.dtype == torch.float64
    assert float(low) == pytest.approx(float(a.distance(b)), rel=1e-4)


def test_has_a_gradient_for_those_who_want_one():
    a, b = gaussian(0), gaussian(1)
    mean, covariance = b.mean.clone().requires_grad_(), b.covariance.clone().requires_grad_()
    frechet_distance(a.mean, a.covariance, mean, covariance).backward()
    assert torch.allclose(mean.grad, 2 * (b.mean - a.mean))
    step = 1e-5 * torch.eye(12, dtype=torch.float64)
    ahead, behind = (frechet_distance(a.mean, a.covariance, b.mean, b.covariance + x) for x in (step, -step))
    assert float(covariance.grad.trace()) == pytest.approx(float(ahead - behind) / 2e-5, rel=1e-4)
