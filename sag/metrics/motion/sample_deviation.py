"""Deviation over time of several motions of one window (paper, Figure 7)."""

from __future__ import annotations

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.metrics.plotted import PlottedMetric
from sag.types import FRAMES


def sample_deviation(samples: Float[Tensor, "b k t j 3"], joint: int) -> Float[Tensor, "b t"]:
    """Standard deviation of a joint's place over the k motions of each window, frame by frame, metres.

    The root of the mean squared distance from the samples' mean place, divided by k as a population is.

    Args:
        samples: metres, any frame that the samples of a window share.
        joint: place of the joint, the root for the paper's trajectories.

    Raises:
        SagError: fewer than two samples.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.sample_deviation import sample_deviation
        >>> samples = torch.zeros(1, 2, 65, 19, 3)
        >>> samples[0, 1, 1:, 12, 0] = 0.5
        >>> sample_deviation(samples, joint=12)[0, :3].tolist()
        [0.0, 0.25, 0.25]
    """
    k = samples.shape[1]
    if k < 2:
        raise SagError(f"the deviation of samples needs at least 2 samples of each window, not {k}")
    places = samples[:, :, :, joint]
    places = places - places[:, :1]  # then samples that are all the same have exactly none
    return (places - places.mean(1, keepdim=True)).square().sum(-1).mean(1).sqrt()


class SampleDeviation(PlottedMetric):
    r"""How far the trajectories that a method draws for one window part over time, metres (paper, Figure 7).

    In each frame the standard deviation of the root's place over K samples, averaged over windows; `curve` is what
    the figure shows, the figure itself its mean over the 64 generated frames:

    .. math:: \sigma_t = \sqrt{\frac{1}{K} \sum_i \lVert r_{i, t} - \bar r_t \rVert^2}

    The root, since the figure is about trajectories. The paper's five samples share the end point too; where a
    method is given the start alone, samples part to the end, and the curve is to be read so.

    It reacts to where samples go. It is blind to the pose (poses may differ on one path), to a way that all samples
    share, and to whether the ways are good. A method that draws the same motion every time has exactly 0, as the
    paper says of Cao et al.

    Args:
        root: place of the root joint.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.sample_deviation import SampleDeviation
        >>> samples = torch.zeros(1, 2, 65, 19, 3)
        >>> samples[0, 1, :, :, 0] = torch.arange(65)[:, None] / 32
        >>> metric = SampleDeviation(root=12)
        >>> metric.update(samples)
        >>> metric.curve()[[0, 32, 64]].tolist()
        [0.0, 0.5, 1.0]
    """

    title = "the deviation of samples"
    higher_is_better = None  # noise is diverse too: ground truth is the aim where there is one

    deviations: Tensor
    windows_parted: Tensor

    def __init__(self, root: int, **options: Any) -> None:
        super().__init__(**options)
        self.root = root
        self._keep_settings(root)
        self.add_state("deviations", torch.zeros(FRAMES, dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("windows_parted", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, samples: Float[Tensor, "b k t j 3"]) -> None:
        """Adds windows.

        Args:
            samples: k motions of each window, 65 frames, metres, camera frame of frame 0.

        Raises:
            SagError: fewer than two samples, another number of frames, or a coordinate that is not finite.
        """
        check_joints(self.title, samples, self.root + 1, dimensions=5)
        self.deviations = self.deviations + sample_deviation(samples.double(), self.root).sum(0)
        self.windows_parted = self.windows_parted + len(samples)

    def compute(self) -> Tensor:
        """The mean over the generated frames, metres.

        Raises:
            SagError: no window was given.
        """
        return self._curve()[1:].mean()

    def curve(self) -> Float[Tensor, " t"]:
        """The deviation in each of the 65 frames, metres; 0 at the given frame 0.

        Raises:
            SagError: no window was given.
        """
        with self.sync_context():
            return self._curve()

    def _curve(self) -> Tensor:
        self._require(self.windows_parted, "window")
        return self.deviations / self.windows_parted
