"""Average pairwise distance: how far apart several motions of one window are."""

from __future__ import annotations

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.metrics.plotted import PlottedMetric


def pairwise_distance(points: Float[Tensor, "b k d"]) -> Float[Tensor, " b"]:
    """Mean distance between the k points of each row, over all pairs of different places.

    Args:
        points: of any unit, which is the unit of the distance.

    Raises:
        SagError: fewer than two points.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.pairwise_distance import pairwise_distance
        >>> pairwise_distance(torch.tensor([[[0.0, 0.0], [3.0, 4.0]]])).tolist()
        [5.0]
    """
    k = points.shape[1]
    if k < 2:
        raise SagError(f"a distance between samples needs at least 2 samples of each window, not {k}")
    # Not by matrix products, whose rounding would put equal points apart.
    distances = torch.cdist(points, points, compute_mode="donot_use_mm_for_euclid_dist")
    return distances.sum((1, 2)) / (k * (k - 1))


class AveragePairwiseDistance(PlottedMetric):
    r"""Average pairwise distance (APD) of the motions that a method draws for one window, metres.

    A motion is one long vector of its 64 generated frames; windows are averaged (Yuan & Kitani, DLow, ECCV 2020):

    .. math:: APD = \frac{1}{K (K - 1)} \sum_{i \ne j} \lVert X_i - X_j \rVert_2

    There the pose alone is compared; here X is the whole motion, path included. The figure grows with the square
    root of frames and joints, so only motions of one skeleton and length compare.

    It reacts to every difference between samples, on the way or in the pose. It is blind to whether they are good:
    noise is diverse too. What all samples have in common, wrong or right, makes no difference, and the ground
    truth, of which there is one, has none. A method that draws the same motion every time has exactly 0.

    Args:
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.pairwise_distance import AveragePairwiseDistance
        >>> samples = torch.zeros(1, 2, 65, 19, 3)
        >>> samples[0, 1, 5, 0] = torch.tensor([0.0, 0.6, 0.8])
        >>> metric = AveragePairwiseDistance()
        >>> metric.update(samples)
        >>> round(float(metric.compute()), 6)
        1.0
    """

    title = "average pairwise distance"
    higher_is_better = None  # noise is diverse too: ground truth is the aim where there is one

    apart: Tensor
    windows_apart: Tensor

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.add_state("apart", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("windows_apart", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, samples: Float[Tensor, "b k t j 3"]) -> None:
        """Adds windows.

        Args:
            samples: k motions of each window, 65 frames, metres; the given frame 0 is left out.

        Raises:
            SagError: fewer than two samples, another number of frames, or a coordinate that is not finite.
        """
        check_joints(self.title, samples, 1, dimensions=5)
        self.apart = self.apart + pairwise_distance(samples[:, :, 1:].double().flatten(2)).sum()
        self.windows_apart = self.windows_apart + len(samples)

    def compute(self) -> Tensor:
        """APD, metres.

        Raises:
            SagError: no window was given.
        """
        self._require(self.windows_apart, "window")
        return self.apart / self.windows_apart
