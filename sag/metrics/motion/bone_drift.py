"""Bone drift: how much a body's bones change their lengths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.metrics.plotted import PlottedMetric

SHORTEST = 1e-3
"""A bone shorter than this in frame 0 (metres) has no length to compare with."""


def bone_drift(
    joints: Float[Tensor, "b t j 3"], bones: np.ndarray | Sequence[Sequence[int]] | Tensor
) -> Float[Tensor, "b bones"]:
    """Mean relative change of each bone's length against frame 0, over the frames after it.

    Args:
        joints: metres, any frame.
        bones: places of the two joints of each bone.

    Raises:
        SagError: a bone without length in frame 0.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.bone_drift import bone_drift
        >>> joints = torch.tensor([[[[0.0, 0, 0], [0.4, 0, 0]], [[0, 0, 0], [0.5, 0, 0]], [[1, 0, 0], [1.4, 0, 0]]]])
        >>> round(float(bone_drift(joints, [[0, 1]])), 6)
        0.125
    """
    ends = torch.as_tensor(np.asarray(bones)) if not isinstance(bones, Tensor) else bones
    start, end = ends.to(joints.device).long().T
    lengths = (joints[:, :, end] - joints[:, :, start]).norm(dim=-1)
    first = lengths[:, :1]
    if (first < SHORTEST).any():
        raise SagError("bone drift was given a bone without length in frame 0; leave such motions or bones out")
    return ((lengths[:, 1:] - first).abs() / first).mean(1)


class BoneDrift(PlottedMetric):
    r"""Mean relative change of bone lengths against frame 0; 0.1 is a tenth of a bone's length.

    Over the 64 generated frames, all bones and all motions (ours; the field reports bone lengths in several ways):

    .. math:: \frac{1}{64 B} \sum_t \sum_b \frac{|l_{b, t} - l_{b, 0}|}{l_{b, 0}}

    It reacts to limbs that stretch or shrink, also where joints jitter, since that changes lengths. It is blind to
    any rigid motion of the body and to joints that bend. Real bones keep their lengths, recorded ones nearly: read
    it beside the ground truth's.

    Args:
        bones: places of the two joints of each bone.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.bone_drift import BoneDrift
        >>> joints = torch.tensor([[0.0, 0.0, 2.0], [0.0, 0.4, 2.0]]).repeat(1, 65, 1, 1)
        >>> joints[:, 1:, 1, 1] = 0.5
        >>> metric = BoneDrift(bones=[[0, 1]])
        >>> metric.update(joints)
        >>> round(float(metric.compute()), 6)
        0.25
    """

    title = "bone drift"
    higher_is_better = False

    bones: Tensor
    drift: Tensor
    motions_drifted: Tensor

    def __init__(self, bones: np.ndarray | Sequence[Sequence[int]], **options: Any) -> None:
        super().__init__(**options)
        self.register_buffer("bones", torch.as_tensor(np.asarray(bones)).long(), persistent=False)
        self._keep_settings(*self.bones.flatten().tolist())
        self.add_state("drift", torch.zeros(len(self.bones), dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("motions_drifted", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, joints: Float[Tensor, "b t j 3"]) -> None:
        """Adds motions.

        Args:
            joints: 65 frames, metres, any frame.

        Raises:
            SagError: joints and bones do not fit, a coordinate is not finite, or a bone has no length in frame 0.
        """
        check_joints(self.title, joints, int(self.bones.max()) + 1)
        self.drift = self.drift + bone_drift(joints.double(), self.bones).sum(0)
        self.motions_drifted = self.motions_drifted + len(joints)

    def compute(self) -> Tensor:
        """The mean over bones.

        Raises:
            SagError: no motion was given.
        """
        return self._each().mean()

    def each(self) -> Float[Tensor, " bones"]:
        """The drift of each bone, in the order of `bones`.

        Raises:
            SagError: no motion was given.
        """
        with self.sync_context():
            return self._each()

    def _each(self) -> Tensor:
        self._require(self.motions_drifted)
        return self.drift / self.motions_drifted
