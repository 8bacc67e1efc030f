"""Velocity Fréchet distance: sees jitter and jumps, and nothing of where motions are."""

import pickle

import numpy as np
import pytest
import scipy.linalg
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from jaxtyping import TypeCheckError
from torch import Tensor
from torchmetrics import MetricCollection
from toy_data import walks

from sag.errors import SagError
from sag.metrics.motion.velocity_frechet import SLOWEST, VelocityFrechet, joint_velocities, velocity_frechet

FPS = 30


@pytest.fixture(scope="module")
def motions() -> Tensor:
    """Walks whose every coordinate moves, so that no deviation is at its least."""
    generator = torch.manual_seed(0)
    sway = 0.02 * torch.randn(120, 1, 19, 3, generator=generator) * torch.linspace(0, 6, 65)[:, None, None].sin()
    return torch.from_numpy(walks(120, np.random.default_rng(1))) + sway


def jittered(motions: Tensor, size: float) -> Tensor:
    noise = size * torch.randn(motions.shape, generator=torch.manual_seed(1))
    noise[:, 0] = 0
    return motions + noise


def test_jitter_of_a_centimetre_is_far_above_the_floor(motions):
    floor = velocity_frechet(motions[::2], motions[1::2], FPS)
    assert velocity_frechet(motions, jittered(motions, 0.01), FPS) > 20 * floor


def test_more_jitter_is_farther(motions):
    distances = [float(velocity_frechet(motions, jittered(motions, size), FPS)) for size in (0, 0.002, 0.005, 0.01)]
    assert distances[0] < 1e-6 and distances == sorted(distances)


def test_a_jump_off_the_given_frame_counts(motions):
    jumped = motions.clone()
    jumped[:, 1:] += torch.tensor([0.3, 0, 0])
    without_jump = motions + torch.tensor([0.3, 0, 0])
    floor = float(velocity_frechet(motions[::2], motions[1::2], FPS))
    assert float(velocity_frechet(motions, without_jump, FPS)) < 1e-4 * floor
    assert float(velocity_frechet(motions, jumped, FPS)) > floor


@given(place=st.tuples(*[st.floats(-10, 10)] * 3), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_places_order_and_batches_do_not_count(motions, place, seed):
    metric = VelocityFrechet(FPS, joints=19)
    metric.update(motions, real=True)
    order = torch.randperm(len(motions), generator=torch.manual_seed(seed))
    moved = motions.double()[order] + torch.tensor(place, dtype=torch.float64)
    for chunk in moved.split(1 + seed % 50):
        metric.update(chunk, real=False)
    assert float(metric.compute()) < 1e-5


def test_equals_its_definition_by_scipy(motions):
    generated = jittered(motions, 0.01) * 1.1
    a, b = (joint_velocities(x, FPS).flatten(0, 1).numpy() for x in (motions, generated))
    scale = np.maximum(a.std(0, ddof=1), SLOWEST)
    a, b = a / scale, b / scale
    root = np.real(scipy.linalg.sqrtm(np.cov(a.T) @ np.cov(b.T)))
    expected = ((a.mean(0) - b.mean(0)) ** 2).sum() + np.trace(np.cov(a.T) + np.cov(b.T) - 2 * root)
    assert float(velocity_frechet(motions, generated, FPS)) == pytest.approx(expected, rel=1e-6)


def test_velocity_is_of_every_step_in_metres_a_second(motions):
    found = joint_velocities(motions, FPS)
    assert found.shape == (120, 64, 57) and found.dtype == torch.float64
    step = (motions[3, 1, 7].double() - motions[3, 0, 7].double()) * FPS
    assert torch.equal(found[3, 0, 21:24], step)


def test_joints_that_stand_still_divide_by_no_zero():
    still = torch.zeros(4, 65, 2, 3)
    assert float(velocity_frechet(still, still, FPS)) == 0
    assert velocity_frechet(still, jittered(still, 0.01), FPS).isfinite()


def test_both_sides_of_one_batch(motions):
    together, apart = VelocityFrechet(FPS, joints=19), VelocityFrechet(FPS, joints=19)
    real = torch.arange(len(motions)) % 3 == 0
    together.update(motions, real=real)
    apart.update(motions[real], real=True)
    apart.update(motions[~real], real=False)
    assert float(together.compute()) == pytest.approx(float(apart.compute()), rel=1e-9)


@pytest.mark.parametrize("dtype", [torch.float64, torch.bfloat16, torch.float16])
def test_takes_any_float(motions, dtype):
    metric = VelocityFrechet(FPS, joints=19)
    metric.update(motions.to(dtype), real=True)
    metric.update(2 * motions.to(dtype), real=False)
    assert metric.compute() > 50 and metric.real_products.dtype == torch.float64


def test_survives_pickle_clone_and_reset(motions):
    metric = VelocityFrechet(FPS, joints=19)
    metric.update(motions, real=True)
    metric.update(jittered(motions, 0.01), real=False)
    expected = metric.compute()
    assert pickle.loads(pickle.dumps(metric)).compute() == expected == metric.clone().compute()
    metric.reset()
    assert metric.real_motions == 0


def test_forward_says_nothing_of_a_batch_with_one_side(motions):
    metric = VelocityFrechet(FPS, joints=19)
    assert metric(motions, real=True).isnan()
    assert metric(jittered(motions, 0.01), real=False).isnan()
    assert float(metric.compute()) == pytest.approx(float(velocity_frechet(motions, jittered(motions, 0.01), FPS)))


def test_a_collection_keeps_frame_rates_apart(motions):
    still = motions[:, :1].expand(-1, 65, -1, -1)
    rates = {name: VelocityFrechet(fps, joints=19) for name, fps in (("slow", 10.0), ("fast", 60.0))}
    collection = MetricCollection(dict(rates))
    collection.update(joints=still, real=True)
    collection.update(joints=jittered(still, 0.01), real=False)
    found = collection.compute()
    assert found["fast"] > 30 * found["slow"]


@pytest.mark.parametrize("broken", ["joints", "frames", "nan"])
def test_refuses(motions, broken):
    bad = motions.clone()
    bad[0, 5, 3] = torch.nan
    given = {"joints": motions[:, :, :18], "frames": motions[:, :64], "nan": bad}[broken]
    with pytest.raises(SagError, match="the velocity Fréchet distance"):
        VelocityFrechet(FPS, joints=19).update(given, real=True)


def test_refuses_sides_of_other_motions(motions):
    with pytest.raises((SagError, TypeCheckError), match="real"):
        VelocityFrechet(FPS, joints=19).update(motions, real=torch.ones(3, dtype=torch.bool))


def test_refuses_to_compare_with_nothing(motions):
    metric = VelocityFrechet(FPS, joints=19)
    metric.update(motions, real=True)
    with pytest.raises(SagError, match="2 generated motions"):
        metric.compute()
    metric.update(motions[:1], real=False)
    with pytest.raises(SagError, match="2 generated motions, it was given 1"):
        metric.compute()
    with pytest.raises(SagError, match="fps"):
        VelocityFrechet(0, joints=19)
