"""Whether the weights of a checkpoint fit a method and its data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torch import Tensor

from sag.errors import SagError
from sag.skeleton import Skeleton


def check_skeleton(said: str, checkpoint: Mapping[str, Any], skeleton: Skeleton) -> None:
    """Refuses a checkpoint for another skeleton; equal numbers of joints do not make two alike.

    Args:
        said: how the sentence calls the checkpoint.
        checkpoint: of a method; one that does not tell its skeleton is not refused.
        skeleton: of the data.

    Raises:
        SagError: names, order, bones or groups of the joints differ.
    """
    told, own = checkpoint.get("skeleton"), skeleton.description
    # As text, since the order of groups is the order of nodes.
    if not told or all(str(told.get(field)) == str(own[field]) for field in own if field != "name"):
        return
    there = f"{told.get('name')} ({len(told.get('joints', ()))} joints)"
    raise SagError(
        f"{said} was trained on the skeleton {there}, and the data have another, {skeleton.name} "
        f"({len(skeleton.joints)} joints): train with --data.init_args.skeleton {skeleton.reference}, or test on data "
        "with that skeleton"
    )


def check_shapes(said: str, found: Mapping[str, Tensor], own: Mapping[str, Tensor], way_out: str) -> None:
    """Refuses weights whose names or shapes are others than a method's own.

    Args:
        said: how the sentence begins.
        found: state of the checkpoint.
        own: state of the method.
        way_out: how the sentence ends.

    Raises:
        SagError: a name or shape differs.
    """
    differing = [name for name in sorted({*found, *own}) if _shape(found, name) != _shape(own, name)]
    if differing:
        name = differing[0]
        raise SagError(
            f"{said}: {name} is {_shape(found, name)} there and {_shape(own, name)} here ({len(differing)} such); "
            f"{way_out}"
        )


def _shape(state: Mapping[str, Tensor], name: str) -> str:
    return str(list(state[name].shape)) if name in state else "missing"
