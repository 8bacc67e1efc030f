"""Depth read off scene features: equal to a ridge regression written out, and blind where the feature is."""

import numpy as np
import pytest
import torch

from sag.errors import SagError
from sag.metrics.scene.depth_probe import RIDGE, DepthProbe, depth_map

FOLD = torch.arange(80) % 2


def pictures(seed: int = 0) -> tuple[torch.Tensor, torch.Tensor]:
    """Features of 80 pictures, and depth that hangs together with them."""
    noise = torch.Generator().manual_seed(seed)
    feature = torch.randn(80, 5, generator=noise, dtype=torch.float64) * 3 + 1
    weights = torch.randn(5, 144, generator=noise, dtype=torch.float64)
    cells = (0.1 * feature @ weights + 0.3 * torch.randn(80, 144, generator=noise)).view(80, 9, 16)
    return feature, (1 + cells).exp().repeat_interleave(2, 1).repeat_interleave(2, 2)


def probed(feature: torch.Tensor, depth: torch.Tensor, fold: torch.Tensor = FOLD) -> dict[str, float]:
    metric = DepthProbe(feature.shape[1])
    for part in torch.arange(len(feature)).split(17):
        metric.update(feature[part], depth[part], fold[part])
    return {name: float(value) for name, value in metric.compute().items()}


def written_out(feature: np.ndarray, target: np.ndarray) -> tuple[float, float]:
    """Squared errors of ridge regression, and of the mean, each fitted on one fold and tried on the other."""
    probe = mean = 0.0
    for tried in (0, 1):
        fitted = FOLD.numpy() != tried
        x, y = feature[fitted], target[fitted]
        centre, deviation = x.mean(0), x.std(0)
        z = (x - centre) / deviation
        slope = np.linalg.solve(z.T @ z / len(z) + RIDGE * np.eye(z.shape[1]), z.T @ (y - y.mean(0)) / len(z))
        predicted = (feature[~fitted] - centre) / deviation @ slope + y.mean(0)
        probe += ((target[~fitted] - predicted) ** 2).sum()
        mean += ((target[~fitted] - y.mean(0)) ** 2).sum()
    return probe, mean


def test_it_is_ridge_regression_across_folds():
    feature, depth = pictures()
    probe, mean = written_out(feature.numpy(), depth_map(depth).numpy())
    found = probed(feature, depth)
    assert found["rmse"] == pytest.approx(np.sqrt(probe / 80 / 144), rel=1e-9)
    assert found["explained"] == pytest.approx(1 - probe / mean, rel=1e-9)
    assert 0.1 < found["explained"] < 1


def test_scale_and_order_of_features_do_not_matter():
    feature, depth = pictures()
    assert probed(100 * feature.flip(1), depth) == pytest.approx(probed(feature, depth), rel=1e-6)


def test_a_feature_that_does_not_look_explains_nothing():
    feature, depth = pictures()
    assert probed(torch.zeros_like(feature), depth)["explained"] == pytest.approx(0, abs=1e-9)
    assert probed(feature[torch.randperm(80)], depth)["explained"] < 0.05


def test_unknown_depth_is_left_out():
    feature, depth = pictures()
    holes = depth.clone()
    holes[:, ::2, 1::2] = 0  # one pixel of each cell's four; they all have the cell's depth
    assert probed(feature, holes) == pytest.approx(probed(feature, depth))
    holes[3] = 0
    rest = torch.arange(80) != 3
    assert probed(feature, holes) == pytest.approx(probed(feature[rest], depth[rest], FOLD[rest]))


def test_a_cell_without_depth_takes_the_mean():
    depth = torch.full((1, 18, 32), 2.0)
    depth[:, :2, :2] = 0
    assert torch.allclose(depth_map(depth), torch.full((1, 144), 2.0).double().log())


def test_wrong_features_are_refused():
    feature, depth = pictures()
    with pytest.raises(SagError, match="features of 4 numbers"):
        DepthProbe(4).update(feature, depth, FOLD)
    with pytest.raises(SagError, match="finite"):
        DepthProbe(5).update(feature / 0, depth, FOLD)


def test_one_fold_tells_nothing():
    feature, depth = pictures()
    assert probed(feature, depth, 0 * FOLD) == {}
