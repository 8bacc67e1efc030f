"""Motion FID: its sums, its two sides, what it reacts to and what it refuses."""

import copy
import math
import pickle
import warnings

import numpy as np
import pytest
import torch
from clip_toys import floats
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from torchmetrics import MetricCollection
from torchmetrics.image.fid import _compute_fid

from sag.errors import SagError
from sag.metrics import MotionFID, motion_fid_of_features
from sag.metrics.fid.clips import GROUPS, LENGTHS, ClipFeatures, clip_features, picked
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


@pytest.fixture(scope="module")
def sides(encoders, motions, others) -> tuple[ClipFeatures, ClipFeatures]:
    """Features of real and of generated motions."""
    return clip_features(encoders, motions, ROOT), clip_features(encoders, others, ROOT)


def motion_fid(encoders: MotionEncoders, real: Tensor, generated: Tensor, size: int = 48) -> dict[str, float]:
    metric = MotionFID(encoders, ROOT)
    for side, is_real in ((real, True), (generated, False)):
        for chunk in side.split(size):
            metric.update(chunk, real=is_real)
    return floats(metric.compute())


def filled(encoders: MotionEncoders, real: ClipFeatures, generated: ClipFeatures, **options) -> MotionFID:
    metric = MotionFID(encoders, ROOT, **options)
    metric.update_features(real, real=True)
    metric.update_features(generated, real=False)
    return metric


def test_equals_its_definition_by_torchmetrics(encoders, motions, others, sides):
    distances = {}
    for key in sides[0]:
        a, b = (side[key].flatten(0, 1) for side in sides)
        distances[key] = float(_compute_fid(a.mean(0), a.T.cov(), b.mean(0), b.T.cov()))
    expected = {
        name: np.mean([d for (_, length), d in distances.items() if length in group]) for name, group in GROUPS.items()
    }
    expected["average"] = np.mean(list(expected.values()))
    assert len(distances) == 18
    assert motion_fid(encoders, motions, others) == pytest.approx(expected, abs=1e-6)


def test_identical_sets_are_at_zero_and_others_are_not(encoders, motions, others):
    floor = motion_fid(encoders, motions, motions.flip(0))
    assert min(floor.values()) >= 0 and max(floor.values()) < 1e-9
    assert min(motion_fid(encoders, motions, others).values()) > 1e3 * max(floor.values())


@given(size=st.integers(1, 48), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_batches_and_order_make_no_difference(encoders, sides, size, seed):
    order = torch.randperm(96, generator=torch.manual_seed(seed))
    together = {key: torch.cat([side[key] for side in sides]) for key in sides[0]}
    metric = MotionFID(encoders, ROOT)
    for chunk in order.split(size):
        metric.update_features(picked(together, chunk), real=chunk < 48)
    whole = floats(filled(encoders, *sides).compute())
    assert floats(metric.compute()) == pytest.approx(whole, rel=1e-9, abs=1e-12)


def test_motions_features_and_the_function_say_the_same(encoders, motions, others, sides):
    metric = MotionFID(encoders, ROOT)
    both = torch.cat([motions, others])
    metric.update(both, real=torch.arange(96) < 48)
    expected = floats(metric.compute())
    assert floats(filled(encoders, *sides).compute()) == pytest.approx(expected, abs=1e-12)
    assert floats(motion_fid_of_features(sides[1], sides[0])) == pytest.approx(expected, abs=1e-9)


def test_where_a_motion_happens_makes_no_difference_and_how_does(encoders, motions, others):
    whole = motion_fid(encoders, motions, others)
    elsewhere = others + torch.tensor([3.0, 0, -1])
    assert motion_fid(encoders, motions, elsewhere) == pytest.approx(whole, rel=1e-6)
    still = others[:, :1].expand_as(others)
    assert motion_fid(encoders, motions, still)["long"] > 2 * whole["long"]


def test_variety_that_is_missing_is_seen(encoders, motions):
    few = motions[:6].repeat(8, 1, 1, 1)
    assert motion_fid(encoders, motions, few)["average"] > 10 * motion_fid(encoders, motions, motions)["average"]


def test_distances_say_dimension_and_sizes(encoders, sides):
    real, generated = sides
    metric = filled(encoders, real, picked(generated, slice(30)), unequal="ignore")
    found = metric.distances()
    assert set(found) == {(frames, length) for frames in (16, 32, 64) for length in LENGTHS}
    assert found[16, 8][1:] == (encoders.dimension, 48 * 8, 30 * 8)
    short = [distance.distance for (_, length), distance in found.items() if length in GROUPS["short"]]
    assert float(metric.compute()["short"]) == pytest.approx(np.mean(short))


def test_unequal_sides_are_refused_or_said_aloud(encoders, sides):
    real, few = sides[0], picked(sides[1], slice(30))
    for figures in (MotionFID.compute, MotionFID.distances):
        with pytest.raises(SagError, match=r"given 48 real and 30 generated motions.*unequal='warn'"):
            figures(filled(encoders, real, few))
    with pytest.warns(UserWarning, match="48 real and 30 generated"):
        said = filled(encoders, real, few, unequal="warn").compute()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert said == filled(encoders, real, few, unequal="ignore").compute()
        filled(encoders, *sides, unequal="warn").compute()


def test_reset_forgets_both_sides_or_only_the_generated_one(encoders, sides):
    real, generated = sides
    expected = floats(filled(encoders, real, generated).compute())
    for kept in (False, True):
        metric = filled(encoders, real, real, reset_real=not kept)
        metric.compute()
        metric.reset()
        assert metric.has_real == kept
        if not kept:
            metric.update_features(real, real=True)
        metric.update_features(generated, real=False)
        assert floats(metric.compute()) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("reset_real", [True, False])
def test_forward_adds_and_says_what_the_batch_alone_is(encoders, motions, others, reset_real):
    metric = MotionFID(encoders, ROOT, reset_real=reset_real)
    assert all(math.isnan(value) for value in metric(motions[:20], real=True).values())
    together = torch.cat([motions[20:], others[:30]])
    alone = metric(together, real=torch.arange(58) < 28)
    assert floats(alone)["short"] > 0, "28 against 30, without refusing"
    assert all(math.isnan(value) for value in metric(others[30:], real=False).values())
    assert floats(metric.compute()) == pytest.approx(motion_fid(encoders, motions, others), abs=1e-9)
    apart = MotionFID(encoders, ROOT, unequal="ignore")
    apart.update(together, real=torch.arange(58) < 28)
    assert floats(alone) == pytest.approx(floats(apart.compute()), abs=1e-12)


def test_clones_and_pickles_carry_their_state(encoders, sides):
    metric = filled(encoders, *sides)
    expected = metric.compute()
    for copied in (metric.clone(), pickle.loads(pickle.dumps(metric))):
        assert copied.compute() == expected
    clone = metric.clone()
    clone.update_features(sides[0], real=False)
    clone.unequal = "ignore"
    assert metric.compute() == expected and clone.compute() != expected


def test_a_checkpoint_does_not_carry_the_encoders(encoders):
    holder = torch.nn.ModuleDict({"metric": MotionFID(encoders, ROOT)})
    assert not holder.state_dict() and not list(holder.parameters())


def test_the_real_side_can_be_shared(encoders, motions, others, sides):
    first, second = MotionFID(encoders, ROOT), MotionFID(encoders, ROOT)
    first.update_features(sides[0], real=True)
    second.update_features(sides[1], real=False)
    second.share_real(first)
    assert floats(second.compute()) == pytest.approx(motion_fid(encoders, motions, others), abs=1e-12)


def test_goes_into_a_collection_and_onto_a_plot(encoders, motions, others):
    metrics = MetricCollection({"a": MotionFID(encoders, ROOT), "b": MotionFID(encoders, ROOT)})
    metrics.update(joints=motions, real=True)
    metrics.update(joints=others, real=False)
    found = floats(metrics.compute())
    assert found["a_short"] == found["b_short"] > 0
    assert metrics["a"].plot()[0] is not None
    assert metrics["a"].higher_is_better is False


def test_half_precision_joints_are_nearly_the_same(encoders, motions, others):
    """Three metres away bfloat16 rounds to 1.6 cm."""
    single = copy.deepcopy(encoders).float()
    whole = motion_fid(single, motions, others)
    for kind in (torch.float32, torch.bfloat16, torch.float16):
        assert motion_fid(single, motions.to(kind), others.to(kind)) == pytest.approx(whole, rel=0.1)


def test_refuses(encoders, motions, sides):
    metric = MotionFID(encoders, ROOT)
    with pytest.raises(SagError, match="65 frames of 19 joints"):
        metric.update(motions[:, 1:], real=True)
    with pytest.raises(SagError, match="3 values of real for 48 motions"):
        metric.update_features(sides[0], real=torch.ones(3).bool())
    with pytest.raises(SagError, match="features that its encoders do not make"):
        metric.update_features({key: features[..., :3] for key, features in sides[0].items()}, real=True)
    metric.update(motions, real=True)
    metric.update(motions[:0], real=False)
    with pytest.raises(SagError, match="at least 2 generated motions, it was given 0"):
        metric.compute()
    with pytest.raises(SagError, match="equally many"):
        motion_fid_of_features(picked(sides[1], slice(9)), sides[0])
    with pytest.raises(SagError, match="different encoders"):
        motion_fid_of_features({(16, 2): sides[1][16, 2]}, sides[0])
