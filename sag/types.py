"""What flows through the platform: motions, scenes and batches.

Legend, valid everywhere in this package:

=======  ==========================================================================================
symbol   meaning
=======  ==========================================================================================
X        the motion, joints in metres in the camera frame of frame 0 (x right, y down, z forward)
R        the trajectory: the root relative to where it starts, so R at frame 0 is zero (paper, 3.2.1)
P        the pose sequence: joints relative to the root of their own frame (paper, 3.2.2)
S        the scene: picture, depth and camera of frame 0
f        the scene feature that the scene encoder makes of the picture (paper, 3.1)
b        batch; t frames; j joints; h, w picture rows and columns
=======  ==========================================================================================

A window has 65 frames: frame 0 is given, 64 are generated. Picture coordinates are continuous pixels
with the origin at the top left corner, so the centre of the first pixel is (0.5, 0.5) and resizing a
picture scales its intrinsics. Depth is planar z in metres, 0 where it is not known.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Protocol, TypeVar, runtime_checkable

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

FRAMES = 65
"""Frames of a window: the given one and the 64 generated (paper, 4.1)."""

GENERATED = FRAMES - 1
"""Frames that are generated (paper, 4.2)."""

T = TypeVar("T", bound="Tensors")


class Tensors:
    """A dataclass of tensors that moves and is indexed as one."""

    def to(self: T, *args: object, **kwargs: object) -> T:
        """Moves every tensor, as `torch.Tensor.to` does."""
        return self._map(lambda x: x.to(*args, **kwargs))

    def __getitem__(self: T, index: object) -> T:
        """Picks windows of the batch."""
        return self._map(lambda x: x[index])

    def detach(self: T) -> T:
        """The same values without their history."""
        return self._map(lambda x: x.detach())

    def _map(self: T, function: object) -> T:
        changed = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        return replace(self, **{k: None if v is None else function(v) for k, v in changed.items()})  # type: ignore


@dataclass
class Motion(Tensors):
    """A motion X as start, trajectory R and pose sequence P: X = start + R + P.

    Attributes:
        start: root at frame 0, metres, camera frame of frame 0.
        trajectory: R, metres, zero at frame 0.
        pose: P, metres, zero at the root joint.
    """

    start: Float[Tensor, "b 3"]
    trajectory: Float[Tensor, "b t 3"]
    pose: Float[Tensor, "b t j 3"]

    @classmethod
    def from_joints(cls, joints: Float[Tensor, "b t j 3"], root: int) -> Motion:
        """The motion whose joints are at these places (metres, camera frame of frame 0)."""
        roots = joints[:, :, root]
        start = roots[:, 0]
        return cls(start, roots - start[:, None], joints - roots[:, :, None])

    @property
    def roots(self) -> Float[Tensor, "b t 3"]:
        """The root joint, metres, camera frame of frame 0."""
        return self.start[:, None] + self.trajectory

    @property
    def joints(self) -> Float[Tensor, "b t j 3"]:
        """X: all joints, metres, camera frame of frame 0."""
        return self.roots[:, :, None] + self.pose

    @property
    def first(self) -> Motion:
        """Frame 0 alone: what a generator may see."""
        return Motion(self.start, self.trajectory[:, :1], self.pose[:, :1])

    def continued(self, trajectory: Float[Tensor, "b n 3"], pose: Float[Tensor, "b n j 3"]) -> Motion:
        """The first frame of this motion followed by the frames given (the paper's 64 become 65)."""
        return Motion(
            self.start,
            torch.cat([self.trajectory[:, :1], trajectory], dim=1),
            torch.cat([self.pose[:, :1], pose], dim=1),
        )


@dataclass
class DepthMap(Tensors):
    """A depth map and the camera that sees it.

    Attributes:
        depth: planar z, metres, 0 where it is not known.
        intrinsics: camera matrix in the pixels of this map.
    """

    depth: Float[Tensor, "b h w"]
    intrinsics: Float[Tensor, "b 3 3"]


@dataclass
class Scene(Tensors):
    """S: what is known of the scene at frame 0, with the person's root at the picture's centre.

    Attributes:
        image: colours in [0, 1].
        depth: planar z, metres, the person included, 0 where it is not known.
        person: where the person stands in the picture.
        intrinsics: camera matrix in the pixels of this picture.
    """

    image: Float[Tensor, "b 3 h w"]
    depth: Float[Tensor, "b h w"]
    person: Bool[Tensor, "b h w"]
    intrinsics: Float[Tensor, "b 3 3"]


@dataclass
class Condition(Tensors):
    """What generators and critics are told of S.

    Attributes:
        feature: f, from the scene encoder.
        initial_pose: normalised joints of frame 0 relative to the root, with the root's own absolute
            place (camera frame) in its otherwise empty slot: 3 numbers a joint, 57 for 19 joints.
    """

    feature: Float[Tensor, "b f"]
    initial_pose: Float[Tensor, "b p"]


@dataclass
class Batch(Tensors):
    """Windows of a data set.

    Attributes:
        motion: the true motion, 65 frames.
        scene: picture, depth and camera of frame 0.
        index: place of each window in the data set.
        sequence: the recording each window was cut from.
        room: the room each window was recorded in.
        world2cam: takes homogeneous world points (metres, z up, column vectors) to the camera frame of frame 0.
        cloud: depth of frame 0 at the sensor's own resolution without the person; test windows only.
    """

    motion: Motion
    scene: Scene
    index: Int[Tensor, " b"]
    sequence: Int[Tensor, " b"]
    room: Int[Tensor, " b"]
    world2cam: Float[Tensor, "b 4 4"]
    cloud: DepthMap | None = None

    def __len__(self) -> int:
        return len(self.index)


@runtime_checkable
class KnownGeometry(Protocol):
    """A room whose solids and floor are known exactly; world frame, metres, z up."""

    def signed_distance(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any"]:
        """Distance to the nearest furniture or wall, negative inside."""
        ...

    def floor_height(self, points: Float[np.ndarray, "*any 2"]) -> Float[np.ndarray, "*any"]:
        """Height of the floor under points over the ground."""
        ...
