"""Collision details: which bone of a motion is where in the scene, in which frame, and how deep. Ours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.geometry.capsule import Shape
from sag.geometry.cloud import Cloud, indexed
from sag.metrics.checking import check_joints
from sag.metrics.collisions.touches import touches_in_cloud, touches_in_depth
from sag.types import DepthMap


class Collision(NamedTuple):
    """One bone in one frame.

    Attributes:
        frame: counted from the first one given.
        bone: names of its two joints.
        points: of the scene that lie inside.
        depth: how deep the deepest of them lies inside, metres.
    """

    frame: int
    bone: str
    points: int
    depth: float


@dataclass(frozen=True, eq=False)
class CollisionDetails:
    """Where a motion collides.

    Attributes:
        points: how many points of the scene each bone touches in each frame; a point that several bones touch is one
            of each.
        depth: how deep the deepest of them lies inside the bone (radius minus distance from its axis), metres; 0 where
            none is.
    """

    points: Int[Tensor, "t m"]
    depth: Float[Tensor, "t m"]

    def worst(self, bones: Sequence[tuple[str, str]], count: int = 10) -> list[Collision]:
        """The deepest collisions, the deepest first; equally deep ones in order of frames.

        Args:
            bones: names of the two joints of each bone, as `Skeleton.bones` has them.
            count: at most so many.

        Raises:
            SagError: not as many names as bones.
        """
        if len(bones) != self.points.shape[1]:
            raise SagError(f"collision details of {self.points.shape[1]} bones were given names of {len(bones)}")
        frames, places = (x.tolist() for x in self.points.nonzero(as_tuple=True))
        found = [
            Collision(frame, "-".join(bones[place]), int(self.points[frame, place]), float(self.depth[frame, place]))
            for frame, place in zip(frames, places)
        ]
        return sorted(found, key=lambda collision: -collision.depth)[:count]

    def lines(self, bones: Sequence[tuple[str, str]], count: int = 10) -> list[str]:
        """The deepest collisions in words, see `worst`."""
        return [
            f"frame {c.frame:2d}  {c.bone:28s} {c.points:5d} points, {1000 * c.depth:3.0f} mm deep"
            for c in self.worst(bones, count)
        ]


def collision_details(
    joints: Float[Tensor, "t j 3"],
    bones: np.ndarray | Int[Tensor, "m 2"],
    cloud: DepthMap | Cloud,
    radius: float,
    shape: Shape = "capsule",
) -> CollisionDetails:
    """Which bones of a motion collide in which frames, with how many points and how deep.

    For bone b in a frame, points = |{p : d(p, b) <= r}| and depth = r - min d(p, b) over these points p. Exactly the
    touches that `collision_counts` counts, before those of several bones are made one. It sees only the skin of solids:
    a bone that is wholly inside one touches nothing.

    Args:
        joints: any number of frames, metres, frame of the cloud.
        bones: places of the two joints of each bone.
        cloud: depth map of one window, or points in metres.
        radius: of the bones, metres.
        shape: "capsule" with round ends, "cylinder" with flat ones.

    Raises:
        SagError: joints, bones and the cloud do not fit, or coordinates are not finite.

    Example:
        >>> import torch
        >>> from sag.metrics import collision_details
        >>> points = torch.tensor([[0.02, 0.1, 3.0], [0.05, 0.1, 3.0], [0.2, 0.1, 3.0]])
        >>> swing = torch.tensor([[[0.0, 0.0, 3.0], [0.0, 0.4, 3.0]], [[0.0, 0.0, 3.0], [0.0, 0.0, 2.6]]])
        >>> details = collision_details(swing, torch.tensor([[0, 1]]), points, radius=0.06)
        >>> details.points.tolist()
        [[2], [0]]
        >>> details.lines([("shoulder", "elbow")])
        ['frame  0  shoulder-elbow                   2 points,  40 mm deep']
    """
    bones = torch.as_tensor(bones, device=joints.device).long()
    check_joints("collision_details", joints, int(bones.max()) + 1, frames=None, dimensions=3)
    if isinstance(cloud, DepthMap):
        if len(cloud.depth) != 1:
            raise SagError(f"collision_details looks at one motion, it was given {len(cloud.depth)} depth maps")
        touches = touches_in_depth(joints, bones, cloud.depth[0], cloud.intrinsics[0], radius, shape)
    else:
        touches = touches_in_cloud(joints, bones, indexed(cloud), radius, shape)
    size = (len(joints), len(bones))
    points = torch.bincount(touches.bone, minlength=size[0] * size[1])
    inside = radius - touches.square.sqrt()
    depth = torch.zeros(size[0] * size[1], dtype=inside.dtype, device=inside.device)
    depth = depth.scatter_reduce(0, touches.bone, inside, "amax").clamp_min(0)
    return CollisionDetails(points.view(size), depth.view(size))
