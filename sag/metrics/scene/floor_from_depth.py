"""The floor's place under feet, from what the depth sensor saw at the start; ours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.geometry.camera import point_cloud, to_world
from sag.metrics.scene.floor_error import ANKLE_HEIGHT
from sag.types import DepthMap

CELL = 0.1
"""Side of the squares on the ground whose lowest points are the floor, metres."""

LOWEST_SHARE = 0.1
"""Share of a square's points that may lie below its floor, as noise and the foot of a step do."""

RISE = 0.3
"""How far the floor may rise above where a person starts, metres: two steps, and below every seat."""

_POINTS = 150_000  # about as many of a cloud are looked at: all of a 288 x 512 picture, and of larger ones a part
_SQUARES = 1 << 20  # more than there are in a row, so that each has a number of its own


class _Floor(NamedTuple):
    """Heights of the floor at known places over the ground, metres, world frame."""

    places: Float[Tensor, "n 2"]
    heights: Float[Tensor, " n"]


def floor_under_feet(
    world: Float[Tensor, "b t j 3"],
    feet: Sequence[int],
    cloud: DepthMap,
    world2cam: Float[Tensor, "b 4 4"],
    ankle_height: float = ANKLE_HEIGHT,
    rise: float = RISE,
) -> Float[Tensor, "b t feet"]:
    """Height of the floor under each foot as the start frame's depth shows it, metres, world frame.

    Points of the cloud are sorted into squares of 10 cm on the ground; near the bottom of each square's points is
    its floor. So a floor may have steps, ramps and platforms. What is more than `rise` above the start is furniture.
    A foot over a square without points (hidden, or outside the view) takes the floor of the nearest square that has
    some, or the level of the lower foot in frame 0 if that is nearer; where nothing was seen that level is all there
    is. The floor hidden behind furniture is therefore a guess.

    Args:
        world: joints in the world frame, metres, z up.
        feet: places of the ankles among the joints.
        cloud: what the depth sensor saw at frame 0, the person removed.
        world2cam: takes world points to the camera frame of the cloud.
        ankle_height: of a standing person's ankle over the floor, metres.
        rise: how far above the start a floor may be, metres; more for long stairs.

    Raises:
        SagError: not one cloud for each motion.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.floor_from_depth import floor_under_feet
        >>> from sag.types import DepthMap
        >>> above = torch.diag(torch.tensor([1.0, -1.0, -1.0, 1.0]))[None]  # looks down from the world's origin
        >>> cloud = DepthMap(torch.full((1, 60, 60), 3.0), torch.tensor([[[60.0, 0, 30], [0, 60, 30], [0, 0, 1]]]))
        >>> world = torch.tensor([0.0, 0.0, -2.9]).expand(1, 65, 1, 3)
        >>> floor = floor_under_feet(world, feet=[0], cloud=cloud, world2cam=above)
        >>> round(float(floor[0, 0, 0]), 3)
        -3.0
    """
    if len(cloud.depth) != len(world):
        raise SagError(f"the floor needs a depth cloud for each of {len(world)} motions, not {len(cloud.depth)}")
    ankles = world[:, :, list(feet)].float()
    floor = torch.zeros_like(ankles[..., 2])
    with torch.autocast(world.device.type, enabled=False):  # a figure must not hang on the run's precision
        for place, person in enumerate(ankles):
            start = _start(person, ankle_height)
            seen = _seen(cloud[place : place + 1], world2cam[place : place + 1])
            seen = seen[seen[:, 2] < start.heights + rise]
            floor[place] = _nearest(person[..., :2], start, _lowest(seen))
    return floor.to(torch.promote_types(world.dtype, torch.float32))


def _seen(cloud: DepthMap, world2cam: Float[Tensor, "1 4 4"]) -> Float[Tensor, "n 3"]:
    """Points of one depth map, or as many of them as are needed, in the world frame."""
    stride = max(1, cloud.depth.shape[1:].numel() // _POINTS)
    points = to_world(point_cloud(cloud.depth.float(), cloud.intrinsics.float()), world2cam.float())
    return points[cloud.depth > 0][::stride]


def _start(ankles: Float[Tensor, "t feet 3"], ankle_height: float) -> _Floor:
    """The floor under the lower foot of frame 0."""
    lower = ankles[0, ankles[0, :, 2].argmin()][None]
    return _Floor(lower[:, :2], lower[:, 2] - ankle_height)


def _lowest(points: Float[Tensor, "n 3"]) -> _Floor:
    """The height below which the lowest tenth of each square's points lie."""
    ascending = points[points[:, 2].argsort()]
    row, column = (ascending[:, :2] / CELL).floor().long().unbind(1)
    square, order = (row * _SQUARES + column).sort(stable=True)
    _, count = square.unique_consecutive(return_counts=True)
    first = count.cumsum(0) - count
    corners = torch.stack([row, column], dim=1)[order[first]]
    return _Floor((corners + 0.5) * CELL, ascending[order[first + (LOWEST_SHARE * count).long()], 2])


def _nearest(ground: Float[Tensor, "t feet 2"], start: _Floor, seen: _Floor) -> Float[Tensor, "t feet"]:
    """Heights of the known places nearest to points over the ground; the start only where nothing is seen near."""
    points = ground.flatten(0, 1)
    distances = torch.cat([torch.cdist(points, start.places).clamp_min(CELL), torch.cdist(points, seen.places)], dim=1)
    return torch.cat([start.heights, seen.heights])[distances.argmin(1)].unflatten(0, ground.shape[:2])
