"""What metrics refuse, in one sentence each."""

from __future__ import annotations

from collections.abc import Sequence

from torch import Tensor

from sag.errors import SagError
from sag.types import FRAMES

_DIMENSIONS = {3: "(frames, joints, 3)", 4: "(motions, frames, joints, 3)", 5: "(windows, samples, frames, joints, 3)"}


def check_joints(
    metric: str, joints: Tensor, count: int, exact: bool = False, frames: int | None = FRAMES, dimensions: int = 4
) -> None:
    """Refuses motions that a metric cannot read.

    Args:
        metric: its name, as the sentence begins.
        joints: (..., frames, joints, 3).
        count: joints that it needs.
        exact: whether more joints are wrong too.
        frames: frames that it needs; any number when None.
        dimensions: 3 of one motion, 4 of motions, 5 of several motions of each window.

    Raises:
        SagError: another number of dimensions, frames, joints or coordinates, or a coordinate that is not finite.
    """
    if joints.dim() != dimensions:
        raise SagError(f"{metric} needs joints of shape {_DIMENSIONS[dimensions]}, not {tuple(joints.shape)}")
    found_frames, found_joints, axes = joints.shape[-3:]
    enough = found_joints == count if exact else found_joints >= count
    if axes != 3 or not enough or frames not in (None, found_frames):
        wanted = f"{'' if frames is None else f'{frames} frames of '}{'' if exact else 'at least '}{count} joints"
        raise SagError(f"{metric} needs {wanted}, not {found_frames} frames of {found_joints} joints in {axes} numbers")
    if not joints.isfinite().all():
        raise SagError(f"{metric} was given motions with coordinates that are not finite; leave such motions out")


def check_floor(metric: str, floor: Tensor, world: Tensor, feet: Sequence[int]) -> None:
    """Refuses heights of the floor that are not those under the feet of these motions.

    Args:
        metric: its name, as the sentence begins.
        floor: height of the floor under each foot, metres; not a number where it is not known.
        world: (motions, frames, joints, 3).
        feet: places of the ankles among the joints.

    Raises:
        SagError: not one height for each foot at every frame, or an infinite one.
    """
    wanted = (*world.shape[:2], len(feet))
    if tuple(floor.shape) != wanted:
        raise SagError(f"{metric} needs the floor's height under each foot, shape {wanted}, not {tuple(floor.shape)}")
    if floor.isinf().any():
        raise SagError(f"{metric} was given an infinite height of the floor; let it be NaN where it is not known")


def check_fps(metric: str, fps: float) -> float:
    """The frame rate as a float.

    Args:
        metric: its name, for the sentence.
        fps: frames a second.

    Raises:
        SagError: it is not above 0.
    """
    if not fps > 0:
        raise SagError(f"fps of {metric} must be above 0, not {fps}")
    return float(fps)
