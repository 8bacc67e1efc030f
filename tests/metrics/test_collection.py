"""Metrics in collections, which update metrics of equal states as one: together where that is right, and only there."""

import pickle
from typing import Any

import numpy as np
import pytest
import torch
from metric_inputs import (
    FEET,
    WINDOWS,
    asked,
    built,
    encoders,
    every_metric,
    fed,
    needed,
    numbers,
    picked,
    toy_inputs,
    usual_settings,
)  # fmt: skip
from torch import Tensor
from torchmetrics import MetricCollection

from sag.metrics import (
    Acceleration,
    BoneDrift,
    FloorError,
    FootContact,
    FootSkate,
    Jerk,
    NonCollisionRatio,
)  # fmt: skip
from sag.skeleton import GTA_IM_19

BONES = GTA_IM_19.bone_index
OTHER = {
    "encoders": encoders(1),
    "root": 0,
    "bones": np.concatenate([BONES[:-1], [[0, 15]]]),
    "feet": [FEET[0], 3],
    "fps": 5.0,
}
"""Settings that make other figures of the same motions."""


@pytest.fixture(scope="module")
def settings() -> dict[str, Any]:
    return usual_settings()


@pytest.fixture(scope="module")
def inputs() -> dict[str, Any]:
    return toy_inputs()


@pytest.fixture
def collection(settings) -> MetricCollection:
    singles = (BoneDrift, Acceleration, Jerk, FootSkate, FootContact, FloorError)
    return MetricCollection({kind.__name__: built(kind, settings) for kind in singles})


def given(collection: MetricCollection, inputs: dict[str, Any], size: int = 3) -> dict[str, list[float]]:
    for first in range(0, WINDOWS, size):
        part = picked(inputs, slice(first, first + size))
        collection.update(joints=part["joints"], world=part["world"], floor=part["floor"])
    return {name: numbers(value) for name, value in collection.compute().items()}


def test_a_collection_updates_metrics_of_the_same_states_together(collection, settings, inputs):
    found = given(collection, inputs)
    groups = {frozenset(group) for group in collection.compute_groups.values()}
    assert {frozenset({"Acceleration", "Jerk"}), frozenset({"FootSkate", "FootContact"})} < groups and len(groups) == 4
    alone = fed(built(Jerk, settings), inputs)
    assert found["Jerk"] == pytest.approx(numbers(alone.compute()), rel=1e-12)


def still(inputs: dict[str, Any]) -> dict[str, Any]:
    """The first two windows as people who never move, in the air, drawn the same each time."""
    frozen = picked(inputs, slice(0, 2))
    for name in ("samples", "joints", "world"):
        frozen[name] = frozen[name][..., :1, :, :].expand_as(frozen[name])
    frozen["samples"] = frozen["samples"][:, :1].expand_as(frozen["samples"])
    frozen["world"] = frozen["world"] + torch.tensor([0, 0, 1.0])
    return frozen


@pytest.mark.parametrize("changed", OTHER)
def test_a_collection_keeps_apart_what_is_the_same_at_first(changed, settings, inputs):
    kinds = [kind for kind in every_metric() if changed in needed(kind)]
    metrics = {kind.__name__: built(kind, settings) for kind in kinds}
    metrics |= {f"{kind.__name__}_other": built(kind, {**settings, changed: OTHER[changed]}) for kind in kinds}
    alone = {name: metric.clone() for name, metric in metrics.items()}
    together = MetricCollection(metrics)
    for part in (still(inputs), inputs):
        together.update(**part)
        for metric in alone.values():
            metric.update(**asked(type(metric), part))
    own = {name: numbers(metric.compute()) for name, metric in alone.items()}
    for name, expected in own.items():
        assert numbers(together[name].compute()) == pytest.approx(expected, rel=1e-6, nan_ok=True), name
    sure = ("BestOfK", "BoneDrift", "FloorError", "FootSkate", "Jerk", "MotionFID", "Multimodality", "SampleDeviation")
    for name in {kind.__name__ for kind in kinds} & {*sure}:
        assert own[name] != pytest.approx(own[f"{name}_other"], rel=1e-4), name


def test_settings_that_are_close_are_told_apart():
    first, second = (NonCollisionRatio(BONES, seed=1_000_000 + step).settings for step in (0, 1))
    assert not torch.allclose(first, second)


def test_a_collection_is_cloned_with_a_prefix_reset_and_pickled(collection, inputs):
    expected = given(collection, inputs)
    clone = collection.clone(prefix="test/")
    assert {name: numbers(v) for name, v in clone.compute().items()} == {f"test/{k}": v for k, v in expected.items()}
    revived = pickle.loads(pickle.dumps(collection))
    assert {name: numbers(v) for name, v in revived.compute().items()} == expected
    collection.reset()
    assert given(collection, inputs) == expected
    assert isinstance(collection["Jerk"].compute(), Tensor)
