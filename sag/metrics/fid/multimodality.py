"""Multimodality: how far apart several motions of one window are in the features of Motion FID's encoder."""

from __future__ import annotations

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.metrics.fid.clip_metric import identity
from sag.metrics.fid.clips import ClipEncoders
from sag.metrics.motion.pairwise_distance import pairwise_distance
from sag.metrics.plotted import PlottedMetric
from sag.types import GENERATED


@torch.no_grad()
def whole_motion_features(
    encoders: ClipEncoders, joints: Float[Tensor, "n t j 3"], root: int
) -> Float[Tensor, "n dimension"]:
    """One feature for each whole motion: the encoder trained on 64 frames, read at frame 64.

    Args:
        encoders: see `ClipEncoders`.
        joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
        root: place of the root joint; the motion is taken relative to its first generated place.

    Example:
        >>> import torch
        >>> from sag.metrics.fid.multimodality import whole_motion_features
        >>> from sag.models.erd import MotionEncoders
        >>> whole_motion_features(MotionEncoders("gta_im_19", width=0.01), torch.randn(4, 65, 19, 3), root=12).shape
        torch.Size([4, 32])
    """
    encoders.to(joints.device)
    generated = joints[:, 1:].to(torch.promote_types(joints.dtype, torch.float32))
    clips = generated - generated[:, :1, root : root + 1]
    with torch.autocast(joints.device.type, enabled=False):  # a figure must not hang on the run's precision
        return encoders.features(clips, [GENERATED])[max(encoders.frames), GENERATED]


class Multimodality(PlottedMetric):
    r"""Multimodality of the motions that a method draws for one window, in units of the encoder's feature.

    The mean distance between the features of two samples of one condition (Guo et al., Action2Motion, ACM MM
    2020). There a condition is a class of actions and two random subsets are paired; here it is a window, and all
    pairs of its K samples are taken, which has the same expectation and less noise:

    .. math:: \frac{1}{K (K - 1)} \sum_{i \ne j} \lVert \phi(X_i) - \phi(X_j) \rVert_2

    The feature is that of Motion FID's encoder trained on 64 frames, after 64 frames, of the motion relative to its
    first generated root. Only figures under the same encoders compare.

    It reacts to samples that differ in what the encoder notices: where the way leads, how the body moves. It is
    blind to what the encoder does not see, such as jitter of a centimetre, to a shift of a whole motion, and to
    whether motions are good. A method that draws the same motion every time has exactly 0.

    Args:
        encoders: see `ClipEncoders`; they are no part of `state_dict`.
        root: place of the root joint.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.fid.multimodality import Multimodality
        >>> from sag.models.erd import MotionEncoders
        >>> metric = Multimodality(MotionEncoders("gta_im_19", width=0.01).eval(), root=12)
        >>> one = torch.randn(2, 1, 65, 19, 3, generator=torch.manual_seed(0))
        >>> metric.update(one.expand(2, 5, 65, 19, 3))
        >>> round(float(metric.compute()), 6)
        0.0
    """

    title = "multimodality"
    higher_is_better = None  # noise is diverse too: ground truth is the aim where there is one

    spread: Tensor
    windows_spread: Tensor

    def __init__(self, encoders: ClipEncoders, root: int, **options: Any) -> None:
        super().__init__(**options)
        self._encoders = (encoders,)  # in a tuple, or every checkpoint of a run would carry their weights
        self.root = root
        self._keep_settings(root, *identity(encoders))
        self.add_state("spread", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("windows_spread", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    @property
    def encoders(self) -> ClipEncoders:
        """What makes features of motions."""
        return self._encoders[0]

    def update(self, samples: Float[Tensor, "b k t j 3"]) -> None:
        """Adds windows.

        Args:
            samples: k motions of each window, 65 frames, metres, camera frame of frame 0.

        Raises:
            SagError: fewer than two samples, another number of frames or joints, or a coordinate that is not finite.
        """
        check_joints(self.title, samples, self.encoders.joints, exact=True, dimensions=5)
        features = whole_motion_features(self.encoders, samples.flatten(0, 1), self.root)
        self.update_features(features.unflatten(0, samples.shape[:2]))

    def update_features(self, features: Float[Tensor, "b k d"]) -> None:
        """Adds windows whose features are known already, see `whole_motion_features`.

        Raises:
            SagError: fewer than two samples, or a feature that is not finite.
        """
        if not features.isfinite().all():
            raise SagError(f"{self.title} was given features that are not finite; leave such motions out")
        self._computed = None  # `update` would forget the last result and count itself, but may not have been called
        self._update_count = max(1, self._update_count)
        self.spread = self.spread + pairwise_distance(features.double()).sum()
        self.windows_spread = self.windows_spread + len(features)

    def compute(self) -> Tensor:
        """Multimodality, in units of the feature.

        Raises:
            SagError: no window was given.
        """
        self._require(self.windows_spread, "window")
        return self.spread / self.windows_spread
