"""A checkpoint as the start of another training: fine-tuning."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from sag.errors import SagError
from sag.methods.weights import check_shapes, check_skeleton
from sag.seal import read_sealed
from sag.skeleton import Skeleton

State = Mapping[str, Tensor]

OPTION = "--pretrained"

AVERAGED, SAMPLER = "averaged.0.module.", "sampler."

COUNTERS = ("generator_steps", "stage_steps", "averaged.0.n_averaged")
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
    checkpoint = read_checkpoint(OPTION, path)
    check_skeleton(f"{OPTION} {path}", checkpoint, skeleton)
    found = dict(checkpoint["state_dict"])
    averages = {name: found.get(f"{SAMPLER}{name.removeprefix(AVERAGED)}") for name in own if AVERAGED in name}
    begun = {name: value for name, value in averages.items() if value is not None} | found
    begun |= {name: own[name] for name in COUNTERS if name in own}
    kept = {name: value for name, value in begun.items() if name in own or not name.startswith("averaged.")}
    fix = "pre-train with the same components, network and image size"
    check_shapes(f"{OPTION} {path} does not fit", kept, own, fix)
    return kept


def read_checkpoint(option: str, path: Path) -> Mapping[str, Any]:
    """What a checkpoint holds, its weights under `state_dict`.

    Args:
        option: that names it.
        path: of the checkpoint.

    Raises:
        SagError: the file is missing, damaged or no checkpoint.
    """
    if not path.is_file():
        raise SagError(f"{option} {path} is no file")
    try:
        content = torch.load(read_sealed(path)[0], map_location="cpu", weights_only=True)
        return {**content, "state_dict": dict(content["state_dict"])}
    except Exception as error:  # a damaged checkpoint can raise anything
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise SagError(f"{option} {path} is damaged or no checkpoint of this program: {reason}") from error
