"""Depth error: the field's three figures, over known pixels, each picture alike."""

import pickle

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from torchmetrics.functional import mean_absolute_percentage_error, mean_squared_error

from sag.errors import SagError
from sag.metrics.scene.depth_error import DepthError


def pictures(seed: int, count: int = 6) -> tuple[Tensor, Tensor]:
    """Estimates, and true depth with holes, every picture with another share of them."""
    generator = torch.manual_seed(seed)
    depth = 0.5 + 6 * torch.rand(count, 8, 12, generator=generator)
    hole = torch.rand(depth.shape, generator=generator) < torch.linspace(0, 0.8, count)[:, None, None]
    predicted = depth * (0.6 + 0.8 * torch.rand(depth.shape, generator=generator))
    return predicted, torch.where(hole, 0, depth)


def errors(predicted: Tensor, depth: Tensor, size: int = 6) -> dict[str, float]:
    metric = DepthError()
    for p, d in zip(predicted.split(size), depth.split(size)):
        metric.update(p, d)
    return {name: float(value) for name, value in metric.compute().items()}


@given(seed=st.integers(0, 1000), size=st.integers(1, 6))
@settings(max_examples=15, deadline=None)
def test_is_the_mean_over_pictures_of_torchmetrics_figures_on_known_pixels(seed, size):
    predicted, depth = pictures(seed)
    each = [(p[d > 0].double(), d[d > 0].double()) for p, d in zip(predicted, depth)]
    found = errors(predicted, depth, size)
    relative = [float(mean_absolute_percentage_error(p, d)) for p, d in each]
    square = [float(mean_squared_error(p, d, squared=False)) for p, d in each]
    right = [float((torch.maximum(p / d, d / p) < 1.25).double().mean()) for p, d in each]
    for name, values in (("abs_rel", relative), ("rmse", square), ("delta1", right)):
        assert found[name] == pytest.approx(sum(values) / len(values), rel=1e-9), name


def test_true_depth_is_without_error_whatever_stands_where_none_is_known():
    predicted, depth = pictures(0)
    found = errors(torch.where(depth > 0, depth, 100 * predicted), depth)
    assert found == {"abs_rel": 0, "rmse": 0, "delta1": 1}


@given(scale=st.floats(0.5, 2))
@settings(max_examples=20, deadline=None)
def test_a_wrong_scale_is_an_error_of_its_size(scale):
    depth = pictures(0)[1].double()
    found = errors(scale * depth, depth)
    assert found["abs_rel"] == pytest.approx(abs(scale - 1), abs=1e-12)
    if max(scale, 1 / scale) < 1.2499 or max(scale, 1 / scale) > 1.2501:
        assert found["delta1"] == float(max(scale, 1 / scale) < 1.25)


def test_a_depth_behind_the_camera_is_never_right():
    depth = torch.full((1, 2, 2), 2.0)
    assert errors(-depth, depth)["delta1"] == 0


def test_a_picture_without_known_depth_is_left_out():
    predicted, depth = pictures(0)
    nothing = torch.cat([depth, torch.zeros(1, 8, 12)])
    assert errors(torch.cat([predicted, predicted[:1]]), nothing) == errors(predicted, depth)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64, torch.bfloat16, torch.float16])
def test_takes_any_float(dtype):
    predicted, depth = pictures(0)
    assert errors(predicted.to(dtype), depth.to(dtype))["rmse"] == pytest.approx(
        errors(predicted, depth)["rmse"], rel=0.02
    )


def test_survives_pickle_clone_and_reset():
    metric = DepthError()
    metric.update(*pictures(0))
    expected = metric.compute()
    assert pickle.loads(pickle.dumps(metric)).compute() == expected == metric.clone().compute()
    metric.reset()
    with pytest.raises(SagError, match="before any picture"):
        metric.compute()


def test_refuses_not_finite_depth():
    predicted, depth = pictures(0)
    predicted[0, 0, 0] = torch.inf
    with pytest.raises(SagError, match="not finite"):
        DepthError().update(predicted, depth)
