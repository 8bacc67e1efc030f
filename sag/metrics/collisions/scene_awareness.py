"""Scene awareness: do motions collide less in their own scene than the same motions in others? Ours."""

from __future__ import annotations

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.errors import SagError
from sag.metrics.collisions.clear_frames import Clouds
from sag.metrics.collisions.clear_frames_metric import ClearFramesMetric


class SceneAwareness(ClearFramesMetric):
    """Share of colliding frames of motions in their own scenes, against the same motions in other scenes.

    Not the paper's. With c the share of frames that are not clear (see `NonCollisionRatio`), averaged over radii and
    thresholds, `matched` is c in the scenes that the motions were made for, `elsewhere` is c of the same frames of the
    same motions moved to other scenes (`sag.geometry.relocation.relocated`), and ratio = matched / elsewhere. Every
    motion counts in both.

    It reacts to scenes: motions in the wrong ones have a ratio about 1. It does not react to jitter of 1 mm, nor to the
    level of collisions alone, since clouds of twice the density or fatter bones raise both shares. It is blind to
    what the sensor did not see, and to motions that go nowhere: who holds frame 0 collides in no scene, since every
    start is free ground. So read it beside Motion FID, which such motions fail.

    Its zero is the figure of a blind row: the same system with its scene feature zeroed. It may lie on either side
    of 1, for frame 0 is given and fits its own scene.

    Args:
        bones: places of the two joints of each bone.
        radii: metres.
        thresholds: points that a clear frame may touch.
        frames: sampled from each motion, the same in both scenes.
        unit: "frame" judges sampled frames; "motion" all 64, a motion being clear when its worst frame is.
        seed: of the sample.
        farthest: pixels of a depth map beyond this depth (metres) are no points.
        shape: of a bone: "capsule" with round ends, "cylinder" with flat ones.
        options: of `torchmetrics.Metric`.

    Raises:
        SagError: more frames than are generated, or none.

    Example:
        >>> import torch
        >>> from sag.metrics import SceneAwareness
        >>> from sag.types import DepthMap
        >>> camera = torch.tensor([[[400.0, 0, 256], [0, 400, 144], [0, 0, 1]]]).expand(2, 3, 3)
        >>> walls = DepthMap(torch.tensor([4.0, 3.0])[:, None, None].expand(2, 288, 512), camera)
        >>> others = DepthMap(torch.full((2, 288, 512), 3.0), camera)
        >>> standing = torch.tensor([[0.0, 0.0, 3.0], [0.0, 0.4, 3.0]]).expand(2, 65, 2, 3)
        >>> metric = SceneAwareness(bones=[[0, 1]])
        >>> metric.update(standing, walls, moved=standing, moved_cloud=others)
        >>> {name: float(share) for name, share in metric.compute().items()}
        {'matched': 0.5, 'elsewhere': 1.0, 'ratio': 0.5}
    """

    title = "scene awareness"
    higher_is_better = False

    colliding: Tensor

    def update(
        self,
        joints: Float[Tensor, "b t j 3"],
        cloud: Clouds,
        moved: Float[Tensor, "n t j 3"],
        moved_cloud: Clouds,
        index: Int[Tensor, " b"] | None = None,
    ) -> None:
        """Adds motions in their own scenes and in others.

        Args:
            joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
            cloud: their own scenes, as in `NonCollisionRatio.update`.
            moved: the same motions in other scenes, metres, frames of those; see `relocated`.
            moved_cloud: these other scenes.
            index: place of each motion in the data set, which decides its sample. Give it where several processes
                share a data set: each would count its own motions from 0 on.

        Raises:
            SagError: joints, bones and clouds do not fit; there is no depth, or a cloud without points, in which
                nothing could collide; a coordinate is not finite.
        """
        if len(moved) != len(joints):
            raise SagError(f"{self.title} was given {len(joints)} motions but {len(moved)} of them moved elsewhere")
        places = self._places(index, len(joints))
        found = [self.clear_frames.judge(*side, places) for side in ((joints, cloud), (moved, moved_cloud))]
        self.colliding = self.colliding + torch.stack([(side.tested - side.clear).sum() for side in found])
        self.tested = self.tested + found[0].tested * found[0].clear.numel()
        self.motions = self.motions + len(joints)

    def compute(self) -> dict[str, Tensor]:
        """Shares of colliding frames, `matched` and `elsewhere`, and their `ratio`, NaN when none collides elsewhere.

        Raises:
            SagError: nothing was judged.
        """
        self._require(self.tested)
        matched, elsewhere = self.colliding.double() / self.tested
        ratio = torch.where(elsewhere > 0, matched / elsewhere, torch.nan)
        return {"matched": matched, "elsewhere": elsewhere, "ratio": ratio}

    def _sums(self) -> dict[str, tuple[int, ...]]:
        return {"colliding": (2,)}
