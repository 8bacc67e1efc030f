"""How many points of a scene lie inside a body's bones, exactly and without testing all against all."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.geometry.capsule import Shape
from sag.geometry.cloud import Cloud, indexed
from sag.metrics.collisions.touches import Touches, touches_in_cloud, touches_in_depth


def collision_counts(
    joints: Float[Tensor, "t j 3"],
    bones: Int[Tensor, "m 2"],
    depth: Float[Tensor, "h w"],
    intrinsics: Float[Tensor, "3 3"],
    radii: Sequence[float],
    shape: Shape = "capsule",
) -> Int[Tensor, "t r"]:
    """Points of a depth map inside the bones, for each frame and radius (paper, 4.2).

    A point counts once however many bones it touches: the count is |{p : min over bones b of d(p, b) <= r}|. Only
    pixels inside a bone's footprint are tested, and the counts are those of all points against all bones. Computed
    in float64. The counts grow with the density of the picture; they see no scene that the picture does not show.

    Args:
        joints: metres, camera frame of the depth map.
        bones: places of the two joints of each bone.
        depth: planar z, metres; 0 is no point.
        intrinsics: camera matrix in the pixels of the depth map.
        radii: of the bones, metres.
        shape: "capsule" with round ends, "cylinder" with flat ones.

    Example:
        >>> import torch
        >>> from sag.metrics import collision_counts
        >>> depth = torch.full((288, 512), 3.0)
        >>> intrinsics = torch.tensor([[400.0, 0, 256], [0, 400, 144], [0, 0, 1]])
        >>> touching_the_wall = torch.tensor([[[0.0, 0.0, 3.0], [0.0, 0.4, 3.0]]])
        >>> collision_counts(touching_the_wall, torch.tensor([[0, 1]]), depth, intrinsics, (0.03, 0.06))
        tensor([[ 476, 1058]])
    """
    touches = touches_in_depth(joints, bones, depth, intrinsics, max(radii), shape)
    return _distinct(touches, radii, len(joints), len(bones), depth.numel())


def collision_counts_in_cloud(
    joints: Float[Tensor, "t j 3"],
    bones: Int[Tensor, "m 2"],
    points: Cloud,
    radii: Sequence[float],
    shape: Shape = "capsule",
) -> Int[Tensor, "t r"]:
    """Points of any cloud inside the bones, for each frame and radius, as `collision_counts` counts them.

    Args:
        joints: metres, frame of the cloud.
        bones: places of the two joints of each bone.
        points: metres; an `IndexedCloud` where the same points are asked again.
        radii: of the bones, metres.
        shape: "capsule" with round ends, "cylinder" with flat ones.

    Raises:
        SagError: a point of the cloud is not finite.

    Example:
        >>> import torch
        >>> from sag.metrics import collision_counts_in_cloud
        >>> points = torch.tensor([[0.02, 0.1, 3.0], [0.05, 0.1, 3.0], [0.0, 0.44, 3.0]])
        >>> arm, bones = torch.tensor([[[0.0, 0.0, 3.0], [0.0, 0.4, 3.0]]]), torch.tensor([[0, 1]])
        >>> collision_counts_in_cloud(arm, bones, points, (0.03, 0.06))
        tensor([[1, 3]])
        >>> collision_counts_in_cloud(arm, bones, points, (0.03, 0.06), shape="cylinder")
        tensor([[1, 2]])
    """
    cloud = indexed(points)
    touches = touches_in_cloud(joints, bones, cloud, max(radii), shape)
    return _distinct(touches, radii, len(joints), len(bones), len(cloud))


def _distinct(touches: Touches, radii: Sequence[float], frames: int, bones: int, points: int) -> Tensor:
    """Points for each frame and radius, those of several bones once."""
    frame = touches.bone.div(bones, rounding_mode="floor")
    places, place = (frame * points + touches.point).unique(return_inverse=True)
    nearest = torch.full_like(places, torch.inf, dtype=touches.square.dtype)
    nearest = nearest.scatter_reduce(0, place, touches.square, "amin")
    frame = places.div(max(points, 1), rounding_mode="floor")
    return torch.stack([torch.bincount(frame[nearest <= radius**2], minlength=frames) for radius in radii], dim=-1)
