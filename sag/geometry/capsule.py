"""Capsules and cylinders: what lies within a radius of a segment, as a body's bones are measured in a scene."""

from __future__ import annotations

from typing import Literal

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

Shape = Literal["capsule", "cylinder"]
"""Of a bone: with round ends, or with flat ends, outside which nothing is inside."""

_SLACK = 1e-6
"""Relative widening of a footprint, far above the rounding of float64 and far below a pixel."""


def squared_distance_to_segment(
    points: Float[Tensor, "... 3"],
    starts: Float[Tensor, "... 3"],
    ends: Float[Tensor, "... 3"],
    shape: Shape = "capsule",
) -> Float[Tensor, ...]:
    """Squared distance (square metres) of points to segments, all broadcast against each other.

    For a cylinder it is infinite where the foot of the perpendicular is not on the segment. A segment without length
    is a point in either shape. Coordinates are summed one by one, so a pair of point and segment gives the same bits
    in any batch.
    """
    along = (ends - starts).unbind(-1)
    offset = (points - starts).unbind(-1)
    length = along[0] * along[0] + along[1] * along[1] + along[2] * along[2]
    foot = offset[0] * along[0] + offset[1] * along[1] + offset[2] * along[2]
    foot = foot / length.clamp_min(torch.finfo(length.dtype).tiny)
    share = foot.clamp(0, 1)
    x, y, z = (o - share * a for o, a in zip(offset, along))
    square = x * x + y * y + z * z
    return square if shape == "capsule" else torch.where(foot == share, square, torch.inf)


def points_in_capsules(
    points: Float[Tensor, "n 3"],
    starts: Float[Tensor, "m 3"],
    ends: Float[Tensor, "m 3"],
    radius: float,
    shape: Shape = "capsule",
) -> Bool[Tensor, " n"]:
    """Which points lie inside at least one capsule (or cylinder); metres, any one frame for all.

    Example:
        >>> import torch
        >>> from sag.metrics import points_in_capsules
        >>> bone = torch.tensor([[0.0, 0.0, 2.0]]), torch.tensor([[0.0, 0.5, 2.0]])
        >>> points = torch.tensor([[0.02, 0.3, 2.0], [0.0, 0.54, 2.0], [0.0, 0.56, 2.0]])
        >>> points_in_capsules(points, *bone, radius=0.05)
        tensor([ True,  True, False])
        >>> points_in_capsules(points, *bone, radius=0.05, shape="cylinder")
        tensor([ True, False, False])
    """
    inside = torch.zeros(len(points), dtype=torch.bool, device=points.device)
    for start, end in zip(starts, ends):
        inside |= squared_distance_to_segment(points, start, end, shape) <= radius**2
    return inside


def footprints(
    starts: Float[Tensor, "m 3"],
    ends: Float[Tensor, "m 3"],
    radius: float,
    intrinsics: Float[Tensor, "3 3"],
    size: tuple[int, int],
    nearest: float = 0.0,
) -> Int[Tensor, "m 4"]:
    """Picture rectangles outside which no pixel sees a point inside a capsule.

    A capsule is the hull of two balls, so its x / z and y / z are bounded by the tangents to them. Only what can
    hold a point at `nearest` or beyond counts; where that comes to the camera plane, the whole picture does.

    Args:
        starts: camera frame, metres.
        ends: camera frame, metres.
        radius: metres.
        intrinsics: camera matrix in the pixels of the picture.
        size: rows and columns of the picture.
        nearest: least depth of any point, metres.

    Returns:
        First and last + 1 row, first and last + 1 column; equal where no pixel is left.
    """
    plane = nearest - radius * (1 + _SLACK)
    starts, ends = _in_front(starts, ends, plane), _in_front(ends, starts, plane)
    hidden = torch.maximum(starts[:, 2], ends[:, 2]) < plane
    sides = []
    for axis, pixels in ((1, size[0]), (0, size[1])):
        bounds = [_tangents(centres[:, axis], centres[:, 2], radius) for centres in (starts, ends)]
        low = torch.minimum(bounds[0][0], bounds[1][0]) * intrinsics[axis, axis] + intrinsics[axis, 2]
        high = torch.maximum(bounds[0][1], bounds[1][1]) * intrinsics[axis, axis] + intrinsics[axis, 2]
        # The centre of pixel i is at i + 0.5.
        first = (low - 0.5 - _SLACK * pixels).ceil().clamp(0, pixels)
        stop = (high - 0.5 + _SLACK * pixels).floor().clamp(-1, pixels - 1) + 1
        sides += [first, torch.where(hidden, first, torch.maximum(first, stop))]
    return torch.stack(sides, dim=-1).long()


def _in_front(points: Tensor, others: Tensor, plane: float) -> Tensor:
    """Points moved along their segments to the others until they are not behind a plane of constant depth."""
    rise = others[:, 2] - points[:, 2]
    share = torch.where(points[:, 2] < plane, (plane - points[:, 2]) / rise.clamp_min(_SLACK), 0).clamp(0, 1)
    return points + share[:, None] * (others - points)


def _tangents(across: Tensor, forward: Tensor, radius: float) -> tuple[Tensor, Tensor]:
    """Least and greatest across / forward of discs of this radius; infinite unless wholly in front."""
    radius = radius * (1 + _SLACK)
    front = forward > radius * (1 + _SLACK)
    scale = torch.where(front, forward * forward - radius * radius, 1)
    spread = radius * (across * across + scale).clamp_min(0).sqrt()
    infinite = torch.full_like(across, torch.inf)
    low = torch.where(front, (across * forward - spread) / scale, -infinite)
    high = torch.where(front, (across * forward + spread) / scale, infinite)
    return low, high
