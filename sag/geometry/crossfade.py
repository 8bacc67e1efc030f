"""From one motion into another without a jump and without shrinking bones."""

from __future__ import annotations

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor


def smoothstep(share: Float[Tensor, "*any"]) -> Float[Tensor, "*any"]:
    """3 s^2 - 2 s^3: from 0 to 1 as s does, level at both ends."""
    return share**2 * (3 - 2 * share)


def crossfaded(
    before: Float[Tensor, "b n j 3"], after: Float[Tensor, "b t j 3"], bones: np.ndarray, root: int
) -> Float[Tensor, "b t j 3"]:
    r"""A motion that begins as the one and passes smoothly into the other, which goes on longer; joints in metres.

    Over the n frames of `before`, frame i has the share :math:`w_i = 3 s^2 - 2 s^3, s = i / n` of `after`; w is level
    at both ends, so that velocities are continuous too.

    Of the root, velocities are mixed and not places: those of the step to frame i as :math:`w_i` says. Places that are
    mixed come back to `after` only by running ahead of both, up to 1.7 times the difference of their velocities. So
    what follows is `after`, moved by the way that was mixed away. Of the pose, bones are mixed one by one, direction
    and length each on its own, and laid end to end again from the root. Mixed joints would cut the corner between two
    directions, and a limb that swings would be too short on its way. (Bones in opposite directions have no way between
    them and meet as a point.)

    Args:
        before: metres, any frame; not longer than `after`.
        after: the other motion, from the same frame on.
        bones: (bones, 2) places of parent and child, each after the one that leads to its parent.
        root: place of the joint where the first bones begin.

    Example:
        >>> import numpy as np
        >>> import torch
        >>> from sag.geometry.crossfade import crossfaded
        >>> right = torch.tensor([[0.0, 0, 0], [0.4, 0, 0]]).repeat(1, 4, 1, 1)
        >>> down = torch.tensor([[0.0, 0, 0], [0, 0.4, 0]]).repeat(1, 5, 1, 1)
        >>> down[..., 0] += torch.arange(5.0)[:, None]
        >>> mixed = crossfaded(right, down, bones=np.array([[0, 1]]), root=0)
        >>> [round(float(x), 3) for x in mixed[0, :, 0, 0].diff()]
        [0.156, 0.5, 0.844, 1.0]
        >>> [round(float(length), 3) for length in (mixed[0, :, 1] - mixed[0, :, 0]).norm(dim=-1)]
        [0.4, 0.4, 0.4, 0.4, 0.4]
    """
    count, frames = before.shape[1], after.shape[1]
    weight = smoothstep(torch.arange(count, dtype=after.dtype, device=after.device) / count)[:, None]
    slower = (before[:, :, root].diff(dim=1) - after[:, :count, root].diff(dim=1)) * (1 - weight[1:])
    moved = after + F.pad(slower, (0, 0, 1, frames - count)).cumsum(dim=1)[:, :, None]
    shared = moved[:, :count, root, None] + _turned(before, after[:, :count], bones, weight)
    return torch.cat([before[:, :1], shared[:, 1:], moved[:, count:]], dim=1)


def _turned(
    before: Float[Tensor, "b n j 3"], after: Float[Tensor, "b n j 3"], bones: np.ndarray, weight: Float[Tensor, "n 1"]
) -> Float[Tensor, "b n j 3"]:
    """Joints relative to the root, every bone on its way from one direction and length to another."""
    pose = torch.zeros_like(before)
    for parent, child in bones.tolist():
        ends = [joints[:, :, child] - joints[:, :, parent] for joints in (before, after)]
        direction = torch.lerp(F.normalize(ends[0], dim=-1), F.normalize(ends[1], dim=-1), weight)
        lengths = [bone.norm(dim=-1, keepdim=True) for bone in ends]
        length = torch.lerp(lengths[0], lengths[1], weight)
        pose[:, :, child] = pose[:, :, parent] + length * F.normalize(direction, dim=-1)
    return pose
