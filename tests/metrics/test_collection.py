"""Metrics in use as torchmetrics has it: collections, clones, pickles, plots, low precision, several processes."""

import importlib
import inspect
import pickle
import pkgutil
from typing import Any

import matplotlib
import numpy as np
import pytest
import torch
from torch import Tensor
from torchmetrics import Metric, MetricCollection
from toy_data import walks

import sag.metrics
from sag.metrics import (
    Acceleration,
    AveragePairwiseDistance,
    BestOfK,
    BoneDrift,
    FloorError,
    FootContact,
    FootSkate,
    Jerk,
    Multimodality,
    SampleDeviation,
)
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

matplotlib.use("Agg")

WINDOWS, SAMPLES = 8, 3
FEET = GTA_IM_19.index("right_ankle", "left_ankle")
COMPANIONS = (
    Acceleration, AveragePairwiseDistance, BestOfK, BoneDrift, FootContact, FootSkate, Jerk, Multimodality,
    SampleDeviation,
)  # fmt: skip


def every_metric() -> list[type[Metric]]:
    """The public metrics of the package, those that are not exported included."""
    found: dict[str, type[Metric]] = {}
    for module in pkgutil.walk_packages(sag.metrics.__path__, "sag.metrics."):
        for name, value in vars(importlib.import_module(module.name)).items():
            ours = inspect.isclass(value) and issubclass(value, Metric) and value.__module__.startswith("sag.metrics")
            if ours and not name.startswith("_") and not inspect.isabstract(value):
                found[name] = value
    return [found[name] for name in sorted(found)]


class Ground:
    """Nothing but a level floor at height 0."""

    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        return points[..., 2]

    def floor_height(self, points: np.ndarray) -> np.ndarray:
        return np.zeros(points.shape[:-1])


@pytest.fixture(scope="module")
def settings() -> dict[str, Any]:
    """What the constructors of metrics ask for, by name."""
    torch.manual_seed(0)
    return {
        "encoders": MotionEncoders("gta_im_19", width=0.01).eval(),
        "root": GTA_IM_19.root_index,
        "bones": GTA_IM_19.bone_index,
        "feet": FEET,
        "fps": 30.0,
        "joints": len(GTA_IM_19.joints),
    }


@pytest.fixture(scope="module")
def inputs() -> dict[str, Any]:
    """What updates ask for, by name."""
    samples = torch.from_numpy(walks(WINDOWS * SAMPLES, np.random.default_rng(0))).unflatten(0, (WINDOWS, SAMPLES))
    joints = samples[:, 0]
    world = joints[..., [0, 2, 1]] * torch.tensor([1, 1, -1])
    world[..., 2] -= world[:, :1, FEET, 2].amin((1, 2))[:, None, None] - 0.085
    camera = torch.tensor([[60.0, 0, 32], [0, 60, 18], [0, 0, 1]]).expand(WINDOWS, 3, 3)
    depth = torch.linspace(3, 6, 64).expand(WINDOWS, 36, 64)
    return {
        "samples": samples,
        "joints": joints,
        "moved": joints + torch.tensor([0.5, 0, 0]),
        "world": world,
        "floor": torch.zeros(WINDOWS, 65, 2),
        "cloud": DepthMap(depth, camera),
        "moved_cloud": DepthMap(depth.flip(2), camera),
        "geometry": [Ground()] * WINDOWS,
        "real": torch.arange(WINDOWS) % 2 == 0,
        "predicted": depth + 1,
        "depth": depth,
    }


def built(kind: type[Metric], settings: dict[str, Any]) -> Metric:
    needed = [
        p for p in inspect.signature(kind).parameters.values() if p.default is p.empty and p.kind != p.VAR_KEYWORD
    ]
    return kind(**{p.name: settings[p.name] for p in needed})


def picked(inputs: dict[str, Any], windows: slice) -> dict[str, Any]:
    return {name: value[windows] for name, value in inputs.items()}


def fed(metric: Metric, inputs: dict[str, Any], size: int = WINDOWS) -> Metric:
    names = inspect.signature(metric.update).parameters
    for first in range(0, WINDOWS, size):
        part = picked(inputs, slice(first, first + size))
        metric.update(**{name: value for name, value in part.items() if name in names})
    return metric


def numbers(computed: Any) -> list[float]:
    return [float(value) for value in (computed.values() if isinstance(computed, dict) else [computed])]


def as_type(inputs: dict[str, Any], dtype: torch.dtype) -> dict[str, Any]:
    floats = ("samples", "joints", "world", "floor")
    return {name: value.to(dtype) if name in floats else value for name, value in inputs.items()}


@pytest.mark.parametrize("kind", every_metric(), ids=lambda kind: kind.__name__)
def test_says_which_way_is_better_and_what_it_is_to_torchmetrics(kind):
    own = [base for base in kind.__mro__ if base.__module__.startswith("sag.")]
    assert any("higher_is_better" in vars(base) for base in own)
    assert kind.higher_is_better in (True, False, None)
    assert kind.is_differentiable is False and kind.full_state_update is False


@pytest.mark.parametrize("kind", every_metric(), ids=lambda kind: kind.__name__)
def test_plots_a_figure(kind, settings, inputs):
    metric = fed(built(kind, settings), inputs)
    figure, _ = metric.plot()
    assert isinstance(figure, matplotlib.figure.Figure)
    matplotlib.pyplot.close(figure)


@pytest.mark.parametrize("kind", COMPANIONS, ids=lambda kind: kind.__name__)
def test_starts_anew_after_reset_and_survives_a_pickle_and_a_clone(kind, settings, inputs):
    metric = fed(built(kind, settings), inputs)
    expected = numbers(metric.compute())
    for copied in (metric.clone(), pickle.loads(pickle.dumps(metric))):
        assert numbers(copied.compute()) == expected
        fed(copied, {**inputs, "samples": 2 * inputs["samples"], "joints": 3 * inputs["joints"]})
    assert numbers(metric.compute()) == expected
    metric.reset()
    assert numbers(fed(metric, inputs).compute()) == expected


@pytest.mark.parametrize("kind", COMPANIONS, ids=lambda kind: kind.__name__)
def test_parts_of_several_processes_add_up(kind, settings, inputs):
    whole = fed(built(kind, settings), inputs)
    first, second = (fed(built(kind, settings), picked(inputs, part)) for part in (slice(0, 5), slice(5, WINDOWS)))
    first.merge_state(second)
    assert numbers(first.compute()) == pytest.approx(
        numbers(whole.compute()), rel=1e-6 if kind is Multimodality else 1e-12
    )


@pytest.mark.parametrize("kind", COMPANIONS, ids=lambda kind: kind.__name__)
def test_forward_gives_the_batch_and_keeps_the_sums(kind, settings, inputs):
    names = inspect.signature(kind.update).parameters
    metric, whole = built(kind, settings), fed(built(kind, settings), inputs)
    for part in (slice(0, 5), slice(5, WINDOWS)):
        some = {name: value for name, value in picked(inputs, part).items() if name in names}
        alone = built(kind, settings)
        alone.update(**some)
        assert numbers(metric(**some)) == numbers(alone.compute())
    assert numbers(metric.compute()) == pytest.approx(numbers(whole.compute()), rel=1e-6)


@pytest.mark.parametrize("dtype", [torch.float64, torch.bfloat16, torch.float16], ids=str)
@pytest.mark.parametrize("kind", COMPANIONS, ids=lambda kind: kind.__name__)
def test_reads_any_precision_and_sums_in_float64(kind, dtype, settings, inputs):
    if kind is Multimodality and dtype == torch.float64:
        settings = {**settings, "encoders": MotionEncoders("gta_im_19", width=0.01).double().eval()}
    rounded = as_type(inputs, dtype)
    metric = fed(built(kind, settings), rounded)
    same = as_type(rounded, torch.float64 if dtype == torch.float64 else torch.float32)
    assert numbers(metric.compute()) == pytest.approx(numbers(fed(built(kind, settings), same).compute()), rel=1e-5)
    assert all(getattr(metric, name).dtype == torch.float64 for name in metric._defaults)


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


def test_a_collection_keeps_apart_what_is_all_zero_at_first(settings, inputs):
    metrics = {kind.__name__: built(kind, settings) for kind in COMPANIONS}
    metrics["Other"] = FootContact(FEET, fps=30, tolerance=0.3)
    metrics["Slow"] = Acceleration(fps=5)
    alone = {name: metric.clone() for name, metric in metrics.items()}
    together = MetricCollection(metrics)
    for part in (still(inputs), inputs):
        together.update(**{name: part[name] for name in ("samples", "joints", "world", "floor")})
        for metric in alone.values():
            fed(metric, part)
    found = together.compute()
    for name, metric in alone.items():
        value = metric.compute()
        keys = list(value) if isinstance(value, dict) else [name]
        own = numbers(value)
        assert [float(found[key]) for key in keys] == pytest.approx(own, rel=1e-9), name
    assert own[0] > 0


def test_a_collection_is_cloned_with_a_prefix_reset_and_pickled(collection, inputs):
    expected = given(collection, inputs)
    clone = collection.clone(prefix="test/")
    assert {name: numbers(v) for name, v in clone.compute().items()} == {f"test/{k}": v for k, v in expected.items()}
    revived = pickle.loads(pickle.dumps(collection))
    assert {name: numbers(v) for name, v in revived.compute().items()} == expected
    collection.reset()
    assert given(collection, inputs) == expected
    assert isinstance(collection["Jerk"].compute(), Tensor)
