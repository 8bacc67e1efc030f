"""KID: the kernel distance is unbiased, and the metric is bounded and does not hang on batches."""

import math
import pickle

import pytest
import torch
from clip_toys import KEYS, floats, gaussian_features
from hypothesis import given, settings
from hypothesis import strategies as st
from torchmetrics import MetricCollection
from torchmetrics.image.kid import poly_mmd

from sag.errors import SagError
from sag.metrics.fid.clips import clip_features, picked
from sag.metrics.fid.kernel import kernel_distance
from sag.metrics.fid.kid import MotionKID, motion_kid
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


def normal(seed: int, count: int, dimension: int = 6) -> torch.Tensor:
    return torch.randn(count, dimension, generator=torch.manual_seed(seed), dtype=torch.float64)


@pytest.fixture(scope="module")
def sides(encoders, motions, others):
    return clip_features(encoders, motions, ROOT), clip_features(encoders, others, ROOT)


@given(seed=st.integers(0, 1000), shift=st.floats(-2, 2))
@settings(max_examples=25, deadline=None)
def test_kernel_distance_is_torchmetrics_on_sets_of_one_size(seed, shift):
    a, b = normal(seed, 30), normal(seed + 1, 30) + shift
    assert float(kernel_distance(a, b)) == pytest.approx(float(poly_mmd(a, b)), rel=1e-9, abs=1e-12)
    assert float(kernel_distance(b, a)) == pytest.approx(float(kernel_distance(a, b)), rel=1e-9, abs=1e-12)


def test_kernel_distance_has_its_definition_on_sets_of_any_size():
    a, b = normal(0, 5), normal(1, 3)

    def kernel(x, y):
        return float((x @ y / 6 + 1) ** 3)

    within = sum(kernel(x, y) for i, x in enumerate(a) for j, y in enumerate(a) if i != j) / 20
    within += sum(kernel(x, y) for i, x in enumerate(b) for j, y in enumerate(b) if i != j) / 6
    across = sum(kernel(x, y) for x in a for y in b) / 15
    assert float(kernel_distance(a.float(), b.float())) == pytest.approx(within - 2 * across, rel=1e-5)


@pytest.mark.parametrize(("count", "other"), [(8, 8), (8, 40)])
def test_is_unbiased_and_may_be_negative(count, other):
    found = torch.stack([kernel_distance(normal(2 * i, count), normal(2 * i + 1, other)) for i in range(500)])
    error = float(found.std()) / len(found) ** 0.5
    assert abs(float(found.mean())) < 3 * error
    assert 0.2 < float((found < 0).double().mean()) < 0.9


@given(count=st.integers(2, 40), seed=st.integers(0, 99), copies=st.integers(1, 3))
@settings(max_examples=25, deadline=None)
def test_equal_sets_of_equal_indices_are_at_zero_at_any_number(count, seed, copies):
    a, index = normal(seed, copies * count), torch.arange(count).repeat(copies)
    order = torch.randperm(len(a), generator=torch.manual_seed(seed))
    assert float(kernel_distance(a, a[order], (index, index[order]))) == pytest.approx(0, abs=1e-12)


@given(seed=st.integers(0, 99))
@settings(max_examples=20, deadline=None)
def test_leaves_out_pairs_of_one_index_and_no_others(seed):
    a, b, index = normal(seed, 9), normal(seed + 1, 9) + 0.5, torch.arange(9)
    apart = (index, index + 9)
    assert float(kernel_distance(a, b, apart)) == pytest.approx(float(poly_mmd(a, b)), rel=1e-9, abs=1e-12)
    kernel = (a @ b.T / 6 + 1) ** 3
    of_pairs = kernel.diagonal().sum()
    shift = 2 * (kernel.mean() - (kernel.sum() - of_pairs) / 72)
    matched = kernel_distance(a, b, (index, index))
    assert float(matched) == pytest.approx(float(poly_mmd(a, b) + shift), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.4])
def test_sides_that_continue_the_same_windows_are_judged_without_bias(shift):
    """Both motions of a window share most of what they are: comparing them with each other would lower the mean."""
    found, plain = [], []
    for seed in range(300):
        shared, index = normal(seed, 9), torch.arange(9)
        a, b = (shared + 0.5 * normal(seed + offset, 9) for offset in (1000, 2000))
        found.append(kernel_distance(a, b + shift, (index, index)))
        plain.append(kernel_distance(a, b + shift))
    large = [normal(seed, 2000) * 1.25**0.5 for seed in (1, 2)]
    truth = float(kernel_distance(large[0], large[1] + shift))
    error = float(torch.stack(found).std()) / len(found) ** 0.5
    assert abs(float(torch.stack(found).mean()) - truth) < 3 * error + 0.01
    assert float(torch.stack(plain).mean()) < truth - 5 * error


def test_takes_one_clip_of_each_motion_in_turn():
    features = {key: torch.arange(12.0).view(4, 3, 1).expand(4, 3, 2) for key in KEYS}
    shifted = {key: found + 1 for key, found in features.items()}
    chosen = torch.tensor([0.0, 4, 8, 9])[:, None].expand(4, 2)
    expected = float(kernel_distance(chosen + 1, chosen, (torch.arange(4), torch.arange(4))))
    assert floats(motion_kid(shifted, features))["mid"] == pytest.approx(expected)


def test_reacts_to_what_differs_and_not_to_numbers(sides):
    draw = torch.manual_seed(0)
    many, few, moved = (
        gaussian_features(draw, 1000),
        gaussian_features(draw, 100),
        gaussian_features(draw, 100, shift=1),
    )
    assert abs(floats(motion_kid(few, many))["average"]) < 0.1 * floats(motion_kid(moved, many))["average"]


@pytest.mark.parametrize("most", [2000, 20])
@pytest.mark.parametrize("count", [2, 5, 48])
def test_true_motions_against_themselves_are_at_zero(encoders, sides, count, most):
    real = picked(sides[0], slice(count))
    metric = MotionKID(encoders, ROOT, most=most)
    order = torch.randperm(count, generator=torch.manual_seed(0))
    metric.update_features(real, real=True, index=torch.arange(count) + 7)
    metric.update_features(picked(real, order), real=False, index=order + 7)
    zero = dict.fromkeys(("short", "mid", "long", "average"), pytest.approx(0, abs=1e-12))
    assert floats(metric.compute()) == zero
    assert floats(motion_kid(real, real, most=most)) == zero


@pytest.mark.parametrize("most", [2000, 20])
def test_batches_order_and_sides_in_a_batch_make_no_difference(encoders, sides, most):
    real, generated = sides
    whole = MotionKID(encoders, ROOT, most=most)
    whole.update_features(real, real=True)
    whole.update_features(generated, real=False)
    parts, order = MotionKID(encoders, ROOT, most=most), torch.randperm(96)
    both = {key: torch.cat([real[key], generated[key]]) for key in real}
    for chunk in order.split(7):
        parts.update_features(picked(both, chunk), real=chunk < 48, index=chunk % 48)
    assert floats(parts.compute()) == pytest.approx(floats(whole.compute()), abs=1e-12)
    assert floats(whole.compute()) == pytest.approx(floats(motion_kid(generated, real, most=most)), abs=1e-12)
    assert sum(len(clips) for clips in parts.real_clips) <= most


def test_of_more_than_it_holds_it_keeps_some_from_everywhere():
    draw = torch.manual_seed(0)
    features = gaussian_features(draw, 4000)
    for found in features.values():
        found[2000:] += 2
    average = floats(motion_kid(features, gaussian_features(draw, 500), most=500))["average"]
    half = floats(motion_kid(picked(features, torch.randperm(4000)[:500]), gaussian_features(draw, 500)))["average"]
    assert average == pytest.approx(half, rel=0.3)


def test_motions_forward_and_reset(encoders, motions, others, sides):
    expected = floats(motion_kid(sides[1], sides[0]))
    metric = MotionKID(encoders, ROOT, reset_real=False)
    assert all(math.isnan(value) for value in metric(motions[:20], real=True).values())
    alone = metric(torch.cat([motions[20:], others[:30]]), real=torch.arange(58) < 28)
    assert not math.isnan(alone["short"])
    metric.update(others[30:], real=False)
    assert floats(metric.compute()) == pytest.approx(expected, abs=1e-12)
    metric.reset()
    assert metric.has_real
    metric.update(others, real=False)
    copied = pickle.loads(pickle.dumps(metric)).clone()
    assert floats(copied.compute()) == pytest.approx(expected, abs=1e-12)


def test_the_order_of_encoders_and_lengths_makes_no_difference(encoders, sides):
    turned = dict(reversed(sides[1].items()))
    assert motion_kid(turned, sides[0]) == motion_kid(sides[1], sides[0])
    metric = MotionKID(encoders, ROOT)
    metric.update_features(sides[0], real=True)
    metric.update_features(turned, real=False)
    assert metric.compute() == motion_kid(sides[1], sides[0])


def test_a_collection_keeps_metrics_of_other_sizes_apart(encoders, sides):
    collection = MetricCollection({"few": MotionKID(encoders, ROOT, most=20), "all": MotionKID(encoders, ROOT)})
    for metric in collection.values():
        metric.update_features(picked(sides[0], slice(10)), real=True)
    collection._merge_compute_groups()
    assert len(collection.compute_groups) == 2


def test_refuses(encoders, sides):
    metric = MotionKID(encoders, ROOT)
    metric.update_features(sides[0], real=True)
    with pytest.raises(SagError, match="at least 2 generated motions, it was given 0"):
        metric.compute()
    with pytest.raises(SagError, match="at least 2 motions of a side, not 1"):
        MotionKID(encoders, ROOT, most=1)
    with pytest.raises(SagError, match="at least 2 motions of each side, it was given 1"):
        motion_kid(picked(sides[1], slice(1)), sides[0])
    metric.update_features(picked(sides[1], slice(3)), real=False, index=torch.full((3,), 5))
    with pytest.raises(SagError, match="a side has one index only"):
        metric.compute()
