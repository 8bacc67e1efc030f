"""A checkpoint as the start of another training: fine-tuning."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import torch
from torch import Tensor

from sag.errors import SagError
from sag.skeleton import Skeleton

State = Mapping[str, Tensor]

OPTION = "--model.init_args.pretrained"

JOINTS = "sampler.scale.pose_mean"
"""Part of every state that has a row for each joint."""

AVERAGED, SAMPLER = "averaged.0.module.", "sampler."

COUNTERS = ("generator_steps", "averaged.0.n_averaged")
"""What counts steps of this training, not of the one before."""


def pretrained_state(path: Path, own: State, skeleton: Skeleton) -> dict[str, Tensor]:
    """State in which a training begins that goes on from a checkpoint.

    Weights, batch-norm buffers and the units of motion are the checkpoint's, counters this training's own. An average
    of weights begins at the checkpoint's average, or at its weights where it kept none.

    Args:
        path: of the checkpoint.
        own: state of the untrained method, with every name and shape.
        skeleton: of the data.

    Raises:
        SagError: the file cannot be read, or holds another skeleton, other components or other sizes.
    """
    found = dict(_read(path))
    if JOINTS not in found:
        raise SagError(f"{OPTION} {path} is no checkpoint of SAG: it holds no {JOINTS}")
    joints = len(found[JOINTS])
    if joints != len(skeleton.joints):
        raise SagError(
            f"{OPTION} {path} was trained on {joints} joints, and {skeleton.name} has {len(skeleton.joints)}: "
            f"pre-train with --data.init_args.skeleton {skeleton.name}"
        )
    averages = {name: found.get(f"{SAMPLER}{name.removeprefix(AVERAGED)}") for name in own if AVERAGED in name}
    begun = {name: value for name, value in averages.items() if value is not None} | found
    begun |= {name: own[name] for name in COUNTERS if name in own}
    kept = {name: value for name, value in begun.items() if name in own or not name.startswith("averaged.")}
    _check_fit(kept, own, path)
    return kept


def _read(path: Path) -> State:
    if not path.is_file():
        raise SagError(f"{OPTION} {path} is no file")
    try:
        return dict(torch.load(path, map_location="cpu", weights_only=True)["state_dict"])
    except Exception as error:  # a damaged checkpoint can raise anything
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise SagError(f"{OPTION} {path} is damaged or no checkpoint of this program: {reason}") from error


def _check_fit(found: State, own: State, path: Path) -> None:
    """Refuses names or shapes that differ."""
    differing = [name for name in sorted({*found, *own}) if _shape(found, name) != _shape(own, name)]
    if differing:
        name = differing[0]
        raise SagError(
            f"{OPTION} {path} does not fit: {name} is {_shape(found, name)} there and {_shape(own, name)} here "
            f"({len(differing)} such); pre-train with the same components, network and image size"
        )


def _shape(state: State, name: str) -> str:
    return str(list(state[name].shape)) if name in state else "missing"
