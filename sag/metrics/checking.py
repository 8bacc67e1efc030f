"""What metrics refuse, in one sentence each."""

from __future__ import annotations

from torch import Tensor

from sag.errors import SagError
from sag.types import FRAMES


def check_joints(metric: str, joints: Tensor, count: int, exact: bool = False, frames: int | None = FRAMES) -> None:
    """Refuses motions that a metric cannot read.

    Args:
        metric: its name, as the sentence begins.
        joints: (..., frames, joints, 3).
        count: joints that it needs.
        exact: whether more joints are wrong too.
        frames: frames that it needs; any number when None.

    Raises:
        SagError: another number of frames, joints or coordinates, or a coordinate that is not finite.
    """
    found_frames, found_joints, axes = joints.shape[-3:]
    enough = found_joints == count if exact else found_joints >= count
    if axes != 3 or not enough or frames not in (None, found_frames):
        wanted = f"{'' if frames is None else f'{frames} frames of '}{'' if exact else 'at least '}{count} joints"
        raise SagError(f"{metric} needs {wanted}, not {found_frames} frames of {found_joints} joints in {axes} numbers")
    if not joints.isfinite().all():
        raise SagError(f"{metric} was given motions with coordinates that are not finite; leave such motions out")
