"""Scene Fréchet distance: sees whether motions fit their own scene, which Motion FID cannot; ours, not the paper's."""

from __future__ import annotations

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.geometry.camera import project
from sag.metrics.checking import check_joints
from sag.metrics.frechet import Gaussian
from sag.metrics.sides import Real, TwoGaussians
from sag.types import GENERATED, DepthMap

EVERY = 8
"""Frames from one look at the scene to the next, as the paper's context critic takes its crops (Table 9)."""

REACH = 1.0
"""Farther than this before or behind a surface is as far as this, metres."""


def room_behind(roots: Float[Tensor, "b t 3"], cloud: DepthMap, reach: float = REACH) -> Float[Tensor, "b t"]:
    """How far the surface that the camera sees at the root's pixel lies behind the root, in metres within +-reach.

    Negative where the root is inside or behind what the camera sees. Where no depth is known, outside the picture
    included, nothing is known to be in the way: `reach`. Computed in float64.

    Args:
        roots: metres, camera frame of the depth map.
        cloud: what the depth sensor saw, the person removed.
        reach: metres.

    Example:
        >>> import torch
        >>> wall = DepthMap(torch.full((1, 36, 64), 3.0), torch.tensor([[[50.0, 0, 32], [0, 50, 18], [0, 0, 1]]]))
        >>> room_behind(torch.tensor([[[0.0, 0, 1.0], [0, 0, 2.5], [0, 0, 3.25], [9, 0, 3.25]]]), wall)
        tensor([[ 1.0000,  0.5000, -0.2500,  1.0000]], dtype=torch.float64)
    """
    roots, (height, width) = roots.double(), cloud.depth.shape[1:]
    column, row = project(roots, cloud.intrinsics.double()).floor().unbind(-1)
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    place = torch.where(inside, row * width + column, 0).long()
    seen = cloud.depth.flatten(1).gather(1, place).double()
    free = (seen - roots[..., 2]).clamp(-reach, reach)
    return torch.where(inside & (seen > 0), free, reach)


class SceneFrechet(TwoGaussians):
    """Fréchet distance of true and generated pairs of a motion and its scene, in square metres. Ours.

    A pair is seen as 8 numbers: how far behind the root, at frames 8, 16, ..., 64, the surface lies that the camera
    sees there at frame 0, c_t = clip(D(pixel of R_t) - z of R_t, -1 m, 1 m). With their means and covariances,

    d = |m_r - m_g|^2 + tr(C_r + C_g - 2 (C_r^1/2 C_g C_r^1/2)^1/2)

    The distance of pairs is the Fréchet joint distance (DeVries et al. 2019, arXiv 1907.08175), which puts an
    embedding of the motion beside one of the scene. Beside each other they were too weak here: between true motions in
    scenes of other rooms and the floor of true motions lay a factor of 1.5 to 2.5, for relative depth around the start
    and for clearance by direction alike. So the embedding is one of the pair: relative depth along the motion, what
    the paper's context critic looks at (3.3, Table 9). It is fixed: no network, the same for every method.

    Reacts to motions in the wrong scene and to good motions that take no notice of it: roots in or behind furniture
    and walls more often, or less often, than true ones. Blind to the pose and its jitter, to feet and floor, to what
    the camera does not see, and to speed unless it leads elsewhere. It judges sets, so a single occluded motion is no
    fault. Its floor is far from 0: print that of true motions (split by sequence) beside it.

    Args:
        root: place of the root joint.
        reach: see `room_behind`, metres.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.scene_frechet import SceneFrechet
        >>> from sag.types import DepthMap
        >>> camera = torch.tensor([[50.0, 0, 32], [0, 50, 18], [0, 0, 1]]).expand(8, 3, 3)
        >>> wall = DepthMap(torch.full((8, 36, 64), 3.0), camera)
        >>> motions = torch.zeros(8, 65, 19, 3)
        >>> motions[..., 2] = 2.5
        >>> metric = SceneFrechet(root=12)
        >>> metric.update(motions, wall, real=True)
        >>> metric.update(motions + torch.tensor([0, 0, 1.0]), wall, real=False)
        >>> float(metric.compute())
        8.0
    """

    title = "the scene Fréchet distance"

    def __init__(self, root: int, reach: float = REACH, **options: Any) -> None:
        super().__init__(GENERATED // EVERY, 1, root, reach, **options)
        self.root, self.reach = root, reach

    def update(self, joints: Float[Tensor, "b t j 3"], cloud: DepthMap, real: Real) -> None:
        """Adds motions and the clouds of their start frames to a side.

        Args:
            joints: 65 frames, metres, camera frame of frame 0.
            cloud: what the depth sensor saw at frame 0, the person removed.
            real: whether these are true motions in their own scenes, for all or for each.

        Raises:
            SagError: another number of frames, no root among the joints, not one cloud for each motion, a cloud
                without any depth, or a coordinate that is not finite.
        """
        check_joints(self.title, joints, self.root + 1)
        if len(cloud.depth) != len(joints):
            raise SagError(f"{self.title} was given {len(joints)} motions but {len(cloud.depth)} depth maps")
        if not (cloud.depth > 0).flatten(1).any(1).all():
            raise SagError(f"{self.title} was given a depth map without any depth; leave windows without depth out")
        looked_at = joints[:, EVERY::EVERY, self.root]
        self._add_features(room_behind(looked_at, cloud, self.reach)[:, None], real)

    def _distance(self, real: Gaussian, generated: Gaussian) -> Float[Tensor, ""]:
        return real.distance(generated)
