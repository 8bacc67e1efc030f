"""Non-collision ratio: how often a body keeps clear of the scene's points (paper, 4.2)."""

from __future__ import annotations

from typing import NamedTuple

from jaxtyping import Float, Int
from torch import Tensor

from sag.metrics.collisions.clear_frames import Clouds
from sag.metrics.collisions.clear_frames_metric import ClearFramesMetric


class CollisionSample(NamedTuple):
    """What a non-collision ratio rests on.

    Attributes:
        tested: frames or motions that were judged.
        density: mean number of points of a cloud, with which the number of points that touch grows.
    """

    tested: int
    density: float


class NonCollisionRatio(ClearFramesMetric):
    """Share of generated frames whose body touches at most a few points of the scene.

    A frame is clear at radius r and threshold n if at most n points p of the start frame's depth cloud lie inside a
    bone, |{p : min over bones b of d(p, b) <= r}| <= n; a point that several bones touch counts once. The figure of a
    radius is the mean over thresholds, `average` the mean over radii.

    The paper samples 10,000 frames: here each motion gives `frames` of its 64, drawn by `seed` and its index, so
    that every method is judged on the same frames in any order of batches.

    It reacts to bodies that pass through what the sensor saw. It is blind to what the sensor did not see (the far side
    of furniture, the inside of solids, what is outside the picture), to bodies that float, and to how deep a body
    lies; it rewards standing still. It falls as clouds get denser, so only clouds of one density compare: see `sample`.

    Args:
        bones: places of the two joints of each bone.
        radii: metres.
        thresholds: points that a clear frame may touch.
        frames: sampled from each motion; the paper's 10,000 divided by the number of test motions.
        unit: "frame" judges sampled frames; "motion" all 64, a motion being clear when its worst frame is.
        seed: of the sample.
        farthest: pixels of a depth map beyond this depth (metres) are no points.
        shape: of a bone: "capsule" with round ends, "cylinder" with flat ones.
        options: of `torchmetrics.Metric`.

    Raises:
        SagError: more frames than are generated, or none.

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

    title = "the non-collision ratio"
    higher_is_better = True
    plot_upper_bound = 1.0

    clear: Tensor
    points: Tensor

    def update(self, joints: Float[Tensor, "b t j 3"], cloud: Clouds, index: Int[Tensor, " b"] | None = None) -> None:
        """Adds motions and the scenes around them.

        Args:
            joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
            cloud: what the depth sensor saw at frame 0, the person removed; or for each motion a point cloud in metres
                and the frame of its joints, an `IndexedCloud` where the same points are given again.
            index: place of each motion in the data set, which decides its sample. Give it where several processes
                share a data set: each would count its own motions from 0 on.

        Raises:
            SagError: joints, bones and clouds do not fit; there is no depth, or a cloud without points, in which
                nothing could collide; a coordinate is not finite.
        """
        found = self.clear_frames.judge(joints, cloud, self._places(index, len(joints)))
        self.clear = self.clear + found.clear
        self.tested = self.tested + found.tested
        self.points = self.points + found.points
        self.motions = self.motions + len(joints)

    def compute(self) -> dict[str, Tensor]:
        """The ratio for each radius (its name in millimetres) and their average.

        Raises:
            SagError: nothing was judged.
        """
        each = self._ratios().mean(1)
        names = (f"{1000 * radius:g}" for radius in self.clear_frames.radii)
        return {**dict(zip(names, each)), "average": each.mean()}

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
            return CollisionSample(int(self.tested), float(self.points / self.motions.clamp_min(1)))

    def _sums(self) -> dict[str, tuple[int, ...]]:
        return {"clear": (len(self.clear_frames.radii), len(self.clear_frames.thresholds)), "points": ()}

    def _ratios(self) -> Tensor:
        self._require(self.tested)
        return self.clear.double() / self.tested
