"""Judged motions: samples of a batch with everything that a metric may hold them against."""

from __future__ import annotations

from functools import cached_property

import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.geometry.camera import to_world
from sag.geometry.relocation import relocated
from sag.metrics.fid.clips import ClipEncoders, ClipFeatures, clip_features
from sag.metrics.scene.floor_error import known_floor
from sag.metrics.scene.floor_from_depth import floor_under_feet
from sag.types import Batch, DepthMap, KnownGeometry


class Judged:
    """Motions of a batch, and what they are judged by; each thing is worked out once, when it is first asked for.

    Args:
        batch: the windows.
        samples: motions that continue them, metres, camera frame of frame 0; single figures judge the first.
        data: where the windows come from.
        encoders: of Motion FID, if there are any.
    """

    def __init__(
        self,
        batch: Batch,
        samples: Float[Tensor, "b k t j 3"],
        data: MotionDataModule,
        encoders: ClipEncoders | None,
    ) -> None:
        self.batch, self.samples, self.data, self.encoders = batch, samples, data, encoders
        self.skeleton = data.skeleton
        self.feet = self.skeleton.feet

    @property
    def joints(self) -> Float[Tensor, "b t j 3"]:
        """The first motion of each window, metres, camera frame of frame 0."""
        return self.samples[:, 0]

    @property
    def truth(self) -> Float[Tensor, "b t j 3"]:
        """The true motions, metres, camera frame of frame 0."""
        return self.batch.motion.joints

    @property
    def cloud(self) -> DepthMap:
        """What the depth sensor saw at frame 0, the person removed.

        Raises:
            SagError: the data set has no depth for these windows.
        """
        if self.batch.cloud is None:
            raise SagError(f"{self.data.name} has no depth for these windows, and collisions need it")
        return self.batch.cloud

    @cached_property
    def features(self) -> ClipFeatures:
        """Features of the clips of the first motion of each window."""
        return clip_features(self._encoders, self.joints, self.skeleton.root_index)

    @cached_property
    def true_features(self) -> ClipFeatures:
        """Features of the clips of the true motions."""
        if torch.equal(self.joints, self.truth):
            return self.features
        return clip_features(self._encoders, self.truth, self.skeleton.root_index)

    @cached_property
    def world(self) -> Float[Tensor, "b t j 3"]:
        """The first motion of each window in the world frame, metres, z up."""
        return to_world(self.joints.double(), self.batch.world2cam)

    @cached_property
    def geometry(self) -> list[KnownGeometry]:
        """The room around each window, where rooms are known exactly; otherwise empty."""
        rooms = [self.data.geometry(room) for room in self.batch.room.tolist()]
        return [room for room in rooms if room is not None]

    @cached_property
    def floor(self) -> Float[Tensor, "b t f"]:
        """Height of the floor under each ankle, metres: known, or else as the depth sensor saw it."""
        if self.geometry:
            return known_floor(self.world, self.feet, self.geometry)
        return floor_under_feet(self.world, self.feet, self.cloud, self.batch.world2cam, self.data.ankle_height)

    @cached_property
    def elsewhere(self) -> Batch | None:
        """The windows of other rooms that the motions are tried in."""
        other = self.data.elsewhere(self.batch)
        return None if other is None else other.to(self.batch.index.device)

    def moved_to(self, other: Batch) -> Float[Tensor, "b t j 3"]:
        """The first motion of each window as it would be in another window's place, metres, that camera's frame."""
        root, own = self.skeleton.root_index, self.batch.world2cam
        return relocated(self.joints, root, self.feet, own, other.motion.joints, other.world2cam)

    @property
    def _encoders(self) -> ClipEncoders:
        if self.encoders is None:
            raise SagError("Motion FID was asked for, but there are no encoders to make its features")
        return self.encoders
