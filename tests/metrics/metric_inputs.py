"""Every public metric of the package, and toy inputs for all of them."""

import importlib
import inspect
import pkgutil
from typing import Any

import numpy as np
import torch
from torchmetrics import Metric
from toy_data import walks

import sag.metrics
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

WINDOWS, SAMPLES = 8, 3
FEET = GTA_IM_19.index("right_ankle", "left_ankle")


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


def encoders(seed: int = 0) -> MotionEncoders:
    torch.manual_seed(seed)
    return MotionEncoders("gta_im_19", width=0.01).double().eval()


def usual_settings() -> dict[str, Any]:
    """What the constructors of metrics ask for, by name."""
    return {
        "encoders": encoders(),
        "root": GTA_IM_19.root_index,
        "bones": GTA_IM_19.bone_index,
        "feet": FEET,
        "fps": 30.0,
        "joints": len(GTA_IM_19.joints),
        "seams": (30,),
        "channels": 4,
    }


def toy_inputs() -> dict[str, Any]:
    """What updates ask for, by name; in float64."""
    motions = torch.from_numpy(walks(WINDOWS * (SAMPLES + 1), np.random.default_rng(0))).double()
    motions = motions.unflatten(0, (WINDOWS, SAMPLES + 1))
    joints, samples = motions[:, 0], motions[:, 1:]
    world = joints[..., [0, 2, 1]] * torch.tensor([1, 1, -1])
    world[..., 2] -= world[:, :1, FEET, 2].amin((1, 2))[:, None, None] - 0.085
    camera = torch.tensor([[120.0, 0, 64], [0, 120, 36], [0, 0, 1]]).expand(WINDOWS, 3, 3)
    depth = torch.linspace(3, 6, 128) * torch.linspace(1, 1.5, WINDOWS)[:, None, None].expand(-1, 72, -1)
    through_the_body = joints[:, 32, GTA_IM_19.root_index, 2].float()[:, None, None]
    return {
        "samples": samples,
        "joints": joints,
        "moved": joints + torch.tensor([0.1, 0, 0]),
        "world": world,
        "floor": torch.zeros(WINDOWS, 65, 2).double(),
        "cloud": DepthMap(depth, camera),
        "moved_cloud": DepthMap(through_the_body.expand_as(depth), camera),
        "geometry": [Ground()] * WINDOWS,
        "real": torch.arange(WINDOWS) % 2 == 0,
        "index": torch.arange(WINDOWS),
        "predicted": depth + 1,
        "depth": depth,
        "feature": samples[:, 0, 0, :4, 0],
        "fold": torch.arange(WINDOWS) % 2,
    }


def needed(kind: type[Metric]) -> list[str]:
    """Names of what a constructor must be given."""
    parameters = inspect.signature(kind).parameters.values()
    return [p.name for p in parameters if p.default is p.empty and p.kind != p.VAR_KEYWORD]


def built(kind: type[Metric], settings: dict[str, Any]) -> Metric:
    return kind(**{name: settings[name] for name in needed(kind)})


def picked(inputs: dict[str, Any], windows: slice) -> dict[str, Any]:
    return {name: value[windows] for name, value in inputs.items()}


def asked(kind: type[Metric], inputs: dict[str, Any]) -> dict[str, Any]:
    """Those of the inputs that `update` asks for."""
    names = inspect.signature(kind.update).parameters
    return {name: value for name, value in inputs.items() if name in names}


def fed(metric: Metric, inputs: dict[str, Any], size: int = WINDOWS) -> Metric:
    for first in range(0, WINDOWS, size):
        metric.update(**asked(type(metric), picked(inputs, slice(first, first + size))))
    return metric


def numbers(computed: Any) -> list[float]:
    return [float(value) for value in (computed.values() if isinstance(computed, dict) else [computed])]


def as_type(inputs: dict[str, Any], dtype: torch.dtype) -> dict[str, Any]:
    floats = ("samples", "joints", "moved", "world", "floor")
    return {name: value.to(dtype) if name in floats else value for name, value in inputs.items()}
