"""Path and pose error of the best of several samples, at a few times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_joints
from sag.metrics.plotted import PlottedMetric
from sag.types import GENERATED


class MotionError(NamedTuple):
    """How far motions are from true ones, frame by frame.

    Attributes:
        path: distance of the roots, metres.
        pose: mean distance of the joints relative to their own root, the root left out, metres.
    """

    path: Float[Tensor, "b k t"]
    pose: Float[Tensor, "b k t"]


def motion_error(samples: Float[Tensor, "b k t j 3"], joints: Float[Tensor, "b t j 3"], root: int) -> MotionError:
    """Path and pose error of every sample in every frame, metres.

    Args:
        samples: k motions of each window, metres, camera frame of frame 0.
        joints: the true motions, metres, in the same frame.
        root: place of the root joint.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.best_of_k import motion_error
        >>> joints = torch.zeros(1, 65, 19, 3)
        >>> error = motion_error(joints[:, None] + torch.tensor([0.0, 0.6, 0.8]), joints, root=12)
        >>> round(float(error.path.mean()), 6), round(float(error.pose.mean()), 6)
        (1.0, 0.0)
    """
    difference = samples - joints[:, None]
    path = difference[:, :, :, root]
    # The root's own term is zero: the sum is over the other joints.
    pose = (difference - path[:, :, :, None]).norm(dim=-1).sum(-1) / max(joints.shape[2] - 1, 1)
    return MotionError(path.norm(dim=-1), pose)


class BestOfK(PlottedMetric):
    r"""Path and pose error of the best of K samples at a few times after the start, metres.

    Cao et al. (ECCV 2020) report path and pose error at 0.5, 1, 1.5 and 2 seconds; of several samples the one with
    the least error counts, as in the errors of DLow (Yuan & Kitani, ECCV 2020):

    .. math:: path_t = \min_i \lVert r_{i, t} - r_t \rVert, \quad
              pose_t = \min_i \frac{1}{J - 1} \sum_j \lVert p_{i, j, t} - p_{j, t} \rVert

    Each figure takes its own minimum at its own time, so more samples never make it worse, and figures of different
    K do not compare. With K = 1 it is the plain error.

    It reacts to whether any sample comes near what truly happened. Path is blind to the pose, pose to the path;
    both are blind to the other K - 1 samples and to all other times. The ground truth has 0.

    Args:
        root: place of the root joint.
        fps: frames a second.
        seconds: times after frame 0; each is read at the nearest frame.
        options: of `torchmetrics.Metric`.

    Raises:
        SagError: a time before frame 1 or after the last frame.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.best_of_k import BestOfK
        >>> joints = torch.zeros(1, 65, 19, 3)
        >>> offsets = torch.tensor([0.5, 0.25])[None, :, None, None, None]
        >>> metric = BestOfK(root=12, fps=30, seconds=(0.5, 2))
        >>> metric.update(joints[:, None] + offsets * torch.tensor([1.0, 0.0, 0.0]), joints)
        >>> {name: float(error) for name, error in metric.compute().items()}
        {'path_0.5': 0.25, 'path_2': 0.25, 'pose_0.5': 0.0, 'pose_2': 0.0}
    """

    title = "best of K"
    higher_is_better = False

    path_errors: Tensor
    pose_errors: Tensor
    windows_compared: Tensor

    def __init__(self, root: int, fps: float, seconds: Sequence[float] = (0.5, 1.0, 1.5, 2.0), **options: Any) -> None:
        super().__init__(**options)
        self.root, self.seconds = root, tuple(seconds)
        self.frames = [_frame(time, fps) for time in self.seconds]
        self._keep_settings(root, *self.frames)
        for name in ("path_errors", "pose_errors"):
            self.add_state(name, torch.zeros(len(self.frames), dtype=torch.float64), dist_reduce_fx="sum")
        self.add_state("windows_compared", torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, samples: Float[Tensor, "b k t j 3"], joints: Float[Tensor, "b t j 3"]) -> None:
        """Adds windows.

        Args:
            samples: k motions of each window, 65 frames, metres, camera frame of frame 0.
            joints: the true motions, 65 frames, metres, in the same frame.

        Raises:
            SagError: samples and true motions do not fit, or a coordinate is not finite.
        """
        check_joints(f"{self.title} (samples)", samples, self.root + 1, dimensions=5)
        check_joints(f"{self.title} (true motions)", joints, self.root + 1)
        if len(samples) != len(joints) or samples.shape[3] != joints.shape[2] or not samples.shape[1]:
            raise SagError(
                f"{self.title} was given samples of shape {tuple(samples.shape)} for true motions of shape "
                f"{tuple(joints.shape)}; it needs at least one sample of each window with the same joints"
            )
        error = motion_error(samples[:, :, self.frames].double(), joints[:, self.frames].double(), self.root)
        self.path_errors = self.path_errors + error.path.amin(1).sum(0)
        self.pose_errors = self.pose_errors + error.pose.amin(1).sum(0)
        self.windows_compared = self.windows_compared + len(joints)

    def compute(self) -> dict[str, Tensor]:
        """Errors in metres as `path_<seconds>` and `pose_<seconds>`.

        Raises:
            SagError: no window was given.
        """
        self._require(self.windows_compared, "window")
        return {
            f"{name}_{time:g}": total / self.windows_compared
            for name, totals in (("path", self.path_errors), ("pose", self.pose_errors))
            for time, total in zip(self.seconds, totals)
        }


def _frame(time: float, fps: float) -> int:
    """The frame nearest to this time (seconds)."""
    frame = int(time * fps + 0.5)
    if not 1 <= frame <= GENERATED:
        raise SagError(
            f"best of K was asked for {time:g} s, which is frame {frame} at {fps:g} fps; "
            f"choose times within frames 1 .. {GENERATED}"
        )
    return frame
