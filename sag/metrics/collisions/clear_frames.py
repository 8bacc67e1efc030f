"""Clear frames: those in which a body touches at most a few points of the scene (paper, 4.2)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.geometry.capsule import Shape
from sag.geometry.cloud import Cloud, IndexedCloud, indexed
from sag.metrics.checking import check_joints
from sag.metrics.collisions.counts import collision_counts, collision_counts_in_cloud
from sag.types import GENERATED, DepthMap

Unit = Literal["frame", "motion"]
"""What is judged: sampled frames, or motions by their worst frame."""

Clouds = DepthMap | Sequence[Cloud] | None
"""The scenes of a batch: depth maps, or a point cloud for each motion; None where a data set has no depth."""

RADII = (0.030, 0.045, 0.060)
"""Of the bones, metres (paper, 4.2)."""

THRESHOLDS = (40, 60, 80, 100)
"""Points that a clear frame may touch (paper, 4.2)."""


class Judgement(NamedTuple):
    """What was found of some motions.

    Attributes:
        clear: frames or motions that are clear, for each radius and threshold.
        tested: frames or motions that were judged.
        points: of all their clouds.
    """

    clear: Int[Tensor, "r n"]
    tested: int
    points: int


@dataclass(frozen=True, eq=False)
class ClearFrames:
    """Counts clear frames of motions in their scenes.

    Attributes:
        metric: its name, as sentences begin.
        bones: places of the two joints of each bone.
        radii: metres.
        thresholds: points that a clear frame may touch.
        frames: judged of each motion.
        unit: sampled frames, or whole motions.
        seed: of the sample.
        farthest: depth (metres) beyond which a pixel of a depth map is no point.
        shape: of a bone.

    Raises:
        SagError: more frames than are generated, or none.
    """

    metric: str
    bones: np.ndarray
    radii: tuple[float, ...]
    thresholds: tuple[int, ...]
    frames: int
    unit: Unit
    seed: int
    farthest: float
    shape: Shape

    def __post_init__(self) -> None:
        if not 1 <= self.frames <= GENERATED:
            raise SagError(f"frames of {self.metric} must lie in 1 .. {GENERATED}, not {self.frames}")

    @property
    def settings(self) -> list[float]:
        """Everything that decides what is clear, as numbers."""
        choices = (self.frames, self.unit == "motion", self.seed, self.farthest, self.shape == "cylinder")
        sizes = (len(self.radii), len(self.thresholds))
        return [*sizes, *self.radii, *self.thresholds, *choices, *self.bones.flatten().tolist()]

    def judge(self, joints: Float[Tensor, "b t j 3"], cloud: Clouds, places: Iterable[int]) -> Judgement:
        """Counts the clear frames of motions, or the clear motions.

        Args:
            joints: 65 frames, metres, frame of the clouds; the given frame 0 is left out.
            cloud: the scene of each motion.
            places: of the motions in their data set, which decide the sample of frames.

        Raises:
            SagError: another number of frames, joints or clouds; no depth or a cloud without points, in which nothing
                could collide; coordinates that are not finite.
        """
        with torch.autocast(joints.device.type, enabled=False):  # a figure must not hang on the run's precision
            return self._judge(joints, self._scenes(joints, cloud), places)

    def _judge(self, joints: Tensor, scenes: Sequence[DepthMap | IndexedCloud], places: Iterable[int]) -> Judgement:
        bones = torch.as_tensor(self.bones, device=joints.device)
        thresholds = torch.tensor(self.thresholds, device=joints.device)
        clear = torch.zeros(len(self.radii), len(self.thresholds), dtype=torch.long, device=joints.device)
        tested = points = 0
        for motion, scene, place in zip(joints[:, 1:], scenes, places):
            counts = self._counts(motion[self._chosen(place)], bones, scene)
            clear = clear + (counts[..., None] <= thresholds).sum(0)
            tested, points = tested + len(counts), points + self._points(scene, place)
        return Judgement(clear, tested, points)

    def _counts(self, motion: Tensor, bones: Tensor, scene: DepthMap | IndexedCloud) -> Tensor:
        """Points that each judged frame touches, or the worst frame."""
        if isinstance(scene, IndexedCloud):
            counts = collision_counts_in_cloud(motion, bones, scene, self.radii, self.shape)
        else:
            counts = collision_counts(motion, bones, scene.depth[0], scene.intrinsics[0], self.radii, self.shape)
        return counts.amax(0, keepdim=True) if self.unit == "motion" else counts

    def _scenes(self, joints: Tensor, cloud: Clouds) -> list[DepthMap | IndexedCloud]:
        """The scene of each motion, if everything fits."""
        check_joints(self.metric, joints, int(self.bones.max()) + 1)
        if cloud is None:
            raise SagError(f"{self.metric} needs the depth of frame 0 or a point cloud, and these motions have neither")
        clouds = len(cloud.depth) if isinstance(cloud, DepthMap) else len(cloud)
        if clouds != len(joints):
            raise SagError(f"{self.metric} was given {len(joints)} motions but {clouds} clouds")
        if not isinstance(cloud, DepthMap):
            return [indexed(points) for points in cloud]
        near = DepthMap(torch.where(cloud.depth <= self.farthest, cloud.depth, 0), cloud.intrinsics)
        return [near[place : place + 1] for place in range(clouds)]

    def _points(self, scene: DepthMap | IndexedCloud, place: int) -> int:
        points = len(scene) if isinstance(scene, IndexedCloud) else int((scene.depth > 0).sum())
        if not points:
            raise SagError(
                f"{self.metric} was given a cloud without points for the motion at {place}, in which nothing can "
                "collide; leave such motions out"
            )
        return points

    def _chosen(self, place: int) -> Tensor:
        """Frames of the motion at this place that are judged."""
        if self.unit == "motion":
            return torch.arange(GENERATED)
        generator = torch.Generator().manual_seed(self.seed * 1_000_003 + place)
        return torch.randperm(GENERATED, generator=generator)[: self.frames]
