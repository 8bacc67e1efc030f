"""Deviation over time: the figure's curve, what parts samples and what does not."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from toy_data import walks

from sag.errors import SagError
from sag.metrics.motion.sample_deviation import SampleDeviation, sample_deviation
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


def drawn(windows: int, k: int, seed: int = 0) -> Tensor:
    """Samples that leave the same place in different directions."""
    motions = torch.from_numpy(walks(windows * k, np.random.default_rng(seed))).double().unflatten(0, (windows, k))
    return motions - motions[:, :, :1, ROOT : ROOT + 1]


def curve_of(samples: Tensor) -> Tensor:
    metric = SampleDeviation(ROOT)
    metric.update(samples)
    return metric.curve()


@given(seed=st.integers(0, 1000), k=st.integers(2, 6))
@settings(max_examples=20, deadline=None)
def test_equals_numpys_deviation(seed, k):
    samples = drawn(3, k, seed)
    expected = np.sqrt(samples[:, :, :, ROOT].numpy().var(axis=1).sum(-1))
    np.testing.assert_allclose(sample_deviation(samples, ROOT), expected, atol=1e-9)


@given(shift=st.floats(-5, 5), factor=st.floats(0.1, 3))
@settings(max_examples=20, deadline=None)
def test_a_shared_shift_makes_no_difference_and_a_larger_spread_does(shift, factor):
    samples = drawn(2, 4)
    moved = samples + shift * torch.linspace(0, 1, 65).double()[:, None, None]
    torch.testing.assert_close(curve_of(moved), curve_of(samples))
    torch.testing.assert_close(curve_of(factor * samples), factor * curve_of(samples))


@pytest.mark.parametrize("k", [2, 3, 5, 7])
def test_a_method_that_draws_one_motion_has_exactly_none(k):
    same = (drawn(4, 1) + 0.1).float().expand(4, k, 65, 19, 3)
    metric = SampleDeviation(ROOT)
    metric.update(same)
    assert metric.compute() == 0 and not metric.curve().any()


def test_starts_at_none_and_grows_where_ways_part():
    curve = curve_of(drawn(8, 5))
    assert curve.shape == (65,) and curve[0] == 0 and (curve.diff() > 0).all()


def test_the_pose_makes_no_difference():
    samples = drawn(2, 3)
    moving = samples + torch.randn_like(samples) * (torch.arange(19) != ROOT)[:, None]
    assert torch.equal(curve_of(moving), curve_of(samples))


def test_mean_is_over_generated_frames_and_batches_make_no_difference():
    samples = drawn(7, 5)
    metric = SampleDeviation(ROOT)
    for part in samples.split(3):
        metric.update(part)
    torch.testing.assert_close(metric.curve(), curve_of(samples))
    torch.testing.assert_close(metric.compute(), sample_deviation(samples, ROOT)[:, 1:].mean())


def test_refuses():
    metric = SampleDeviation(ROOT)
    with pytest.raises(SagError, match="before any window"):
        metric.compute()
    with pytest.raises(SagError, match="at least 2 samples of each window, not 1"):
        metric.update(drawn(2, 1))
    with pytest.raises(SagError, match="65 frames of at least 13 joints, not 64 frames"):
        metric.update(drawn(2, 2)[:, :, 1:])
    with pytest.raises(SagError, match="not finite"):
        metric.update(drawn(2, 2) / 0)
