"""Average pairwise distance: a distance, over all pairs, of the generated frames."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from sag.errors import SagError
from sag.metrics.motion.pairwise_distance import AveragePairwiseDistance, pairwise_distance


def apd(samples: torch.Tensor, size: int = 100) -> float:
    metric = AveragePairwiseDistance()
    for part in samples.split(size):
        metric.update(part)
    return float(metric.compute())


@given(seed=st.integers(0, 1000), k=st.integers(2, 30))
@settings(max_examples=20, deadline=None)
def test_equals_scipy(seed, k):
    points = torch.randn(3, k, 12, generator=torch.manual_seed(seed)).double()
    expected = [pdist(window.numpy()).mean() for window in points]
    np.testing.assert_allclose(pairwise_distance(points), expected, rtol=1e-12)


@given(seed=st.integers(0, 1000), k=st.integers(2, 6))
@settings(max_examples=20, deadline=None)
def test_order_turn_and_shift_make_no_difference_and_size_does(seed, k):
    generator = torch.manual_seed(seed)
    samples = torch.randn(2, k, 65, 4, 3, generator=generator).double()
    rotation = torch.linalg.qr(torch.randn(3, 3, generator=generator).double())[0]
    expected = apd(samples)
    assert apd(samples.flip(1)) == pytest.approx(expected)
    assert apd(samples @ rotation + torch.randn(3)) == pytest.approx(expected)
    assert apd(2 * samples) == pytest.approx(2 * expected)


@pytest.mark.parametrize("k", [2, 5, 40])
def test_equal_samples_are_at_exactly_zero(k):
    assert apd(torch.randn(3, 1, 65, 19, 3).expand(3, k, 65, 19, 3)) == 0


def test_the_given_frame_is_left_out_and_batches_make_no_difference():
    samples = torch.randn(7, 5, 65, 19, 3)
    changed = samples.clone()
    changed[:, :, 0] = torch.randn(7, 5, 19, 3)
    assert apd(changed) == apd(samples) == pytest.approx(apd(samples, size=3), rel=1e-12)


def test_refuses():
    metric = AveragePairwiseDistance()
    with pytest.raises(SagError, match="before any window"):
        metric.compute()
    with pytest.raises(SagError, match="at least 2 samples of each window, not 1"):
        metric.update(torch.zeros(2, 1, 65, 19, 3))
    with pytest.raises(SagError, match="65 frames"):
        metric.update(torch.zeros(2, 2, 64, 19, 3))
    with pytest.raises(SagError, match="not finite"):
        metric.update(torch.full((2, 2, 65, 19, 3), torch.nan))
