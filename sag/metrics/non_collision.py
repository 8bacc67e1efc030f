"""Non-collision ratio: how often a body keeps clear of the scene's points (paper, 4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torchmetrics import Metric

from sag.errors import SagError
from sag.metrics.collisions import collision_counts
from sag.types import GENERATED, DepthMap


class CollisionSample(NamedTuple):
    """What a non-collision ratio rests on.

    Attributes:
        tested: frames or motions that were judged.
        density: mean number of points of a cloud, with which the number of points that touch grows.
    """

    tested: int
    density: float


class NonCollisionRatio(Metric):
    """Share of generated frames whose body touches at most a few points of the scene.

    Bones are capsules; a frame is clear at radius r and threshold n if at most n points of the start frame's depth
    cloud lie inside. The figure of a radius is the mean over thresholds, `average` the mean over radii. A point
    that several bones touch counts once.

    The paper samples 10,000 frames: here each motion gives `frames` of its 64, drawn by `seed` and its index, so
    that every method is judged on the same frames in any order of batches.

    Args:
        bones: places of the two joints of each bone.
        radii: metres.
        thresholds: points that a clear frame may touch.
        frames: sampled from each motion; the paper's 10,000 divided by the number of test motions.
        unit: "frame" judges sampled frames; "motion" all 64, a motion being clear when its worst frame is.
        seed: of the sample.
        farthest: points beyond this depth (metres) are no points.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics import NonCollisionRatio
        >>> from sag.types import DepthMap
        >>> wall = DepthMap(torch.full((1, 288, 512), 3.0), torch.tensor([[[400.0, 0, 256], [0, 400, 144], [0, 0, 1]]]))
        >>> standing = torch.tensor([[0.0, 0.0, 2.95], [0.0, 0.4, 2.95]]).expand(1, 65, 2, 3)
        >>> metric = NonCollisionRatio(bones=[[0, 1]])
        >>> metric.update(standing, wall)
        >>> {name: float(ratio) for name, ratio in metric.compute().items() if name != "average"}
        {'30': 1.0, '45': 1.0, '60': 0.0}
    """

    higher_is_better = True
    is_differentiable = False
    full_state_update = False
    plot_lower_bound = 0.0
    plot_upper_bound = 1.0

    bones: Tensor
    thresholds: Tensor
    clear: Tensor
    tested: Tensor
    points: Tensor
    clouds: Tensor

    def __init__(
        self,
        bones: np.ndarray | Sequence[Sequence[int]],
        radii: Sequence[float] = (0.030, 0.045, 0.060),
        thresholds: Sequence[int] = (40, 60, 80, 100),
        frames: int = 10,
        unit: Literal["frame", "motion"] = "frame",
        seed: int = 0,
        farthest: float = 20.0,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if not 1 <= frames <= GENERATED:
            raise SagError(f"frames of the non-collision ratio must lie in 1 .. {GENERATED}, not {frames}")
        self.radii, self.frames, self.unit, self.seed, self.farthest = tuple(radii), frames, unit, seed, farthest
        self.register_buffer("bones", torch.as_tensor(np.asarray(bones)).long(), persistent=False)
        self.register_buffer("thresholds", torch.tensor(list(thresholds)), persistent=False)
        zero = torch.zeros((), dtype=torch.long)
        self.add_state("clear", zero.expand(len(radii), len(thresholds)).clone(), dist_reduce_fx="sum")
        for name in ("tested", "points", "clouds"):
            self.add_state(name, zero.clone(), dist_reduce_fx="sum")

    def update(self, joints: Float[Tensor, "b t j 3"], cloud: DepthMap, index: Int[Tensor, " b"] | None = None) -> None:
        """Adds motions and the clouds of their start frames.

        Args:
            joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
            cloud: what the depth sensor saw at frame 0, the person removed.
            index: place of each motion in the data set, which decides its sample; counted on when not given.

        Raises:
            SagError: joints and bones do not fit, or a coordinate is not finite.
        """
        self._check(joints, cloud)
        depth = torch.where(cloud.depth <= self.farthest, cloud.depth, 0)
        first = int(self.clouds)
        places = range(first, first + len(joints)) if index is None else index.tolist()
        for motion, picture, intrinsics, place in zip(joints[:, 1:], depth, cloud.intrinsics, places):
            chosen = motion[self._chosen(place)]
            counts = collision_counts(chosen, self.bones, picture, intrinsics, self.radii)
            if self.unit == "motion":
                counts = counts.amax(0, keepdim=True)
            self.clear = self.clear + (counts[..., None] <= self.thresholds).sum(0)
            self.tested = self.tested + len(counts)
        self.points = self.points + (depth > 0).sum()
        self.clouds = self.clouds + len(joints)

    def compute(self) -> dict[str, Tensor]:
        """The ratio for each radius (its name in millimetres) and their average.

        Raises:
            SagError: nothing was judged.
        """
        each = self._ratios().mean(1)
        return {**{f"{1000 * r:g}": ratio for r, ratio in zip(self.radii, each)}, "average": each.mean()}

    def ratios(self) -> Float[Tensor, "r n"]:
        """The ratio for each radius and threshold.

        Raises:
            SagError: nothing was judged.
        """
        with self.sync_context():
            return self._ratios()

    def sample(self) -> CollisionSample:
        """How many frames or motions were judged, and how dense their clouds are."""
        with self.sync_context():
            return CollisionSample(int(self.tested), float(self.points / self.clouds.clamp_min(1)))

    def _ratios(self) -> Tensor:
        if not self.tested:
            raise SagError("the non-collision ratio was asked for before any motion was given")
        return self.clear.double() / self.tested

    def _chosen(self, place: int) -> Tensor:
        """Frames of the motion at this place that are judged."""
        if self.unit == "motion":
            return torch.arange(GENERATED)
        generator = torch.Generator().manual_seed(self.seed * 1_000_003 + place)
        return torch.randperm(GENERATED, generator=generator)[: self.frames]

    def _check(self, joints: Tensor, cloud: DepthMap) -> None:
        if joints.shape[1] != GENERATED + 1 or joints.shape[2] <= int(self.bones.max()):
            raise SagError(
                f"the non-collision ratio needs {GENERATED + 1} frames of at least {int(self.bones.max()) + 1} joints, "
                f"as its bones do, not {joints.shape[1]} of {joints.shape[2]}"
            )
        if len(cloud.depth) != len(joints):
            raise SagError(f"the non-collision ratio was given {len(joints)} motions but {len(cloud.depth)} clouds")
        if not joints.isfinite().all():
            raise SagError("the non-collision ratio was given coordinates that are not finite; leave such motions out")
