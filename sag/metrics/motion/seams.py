"""Seams: how much rougher a long motion is where its windows meet than inside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Bool, Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_fps, check_joints
from sag.metrics.plotted import PlottedMetric


class Parted(NamedTuple):
    """Figures of a motion, by where they were taken.

    Attributes:
        inside: away from all seams.
        at_seams: at the seams.
    """

    inside: Float[Tensor, "b _"]
    at_seams: Float[Tensor, "b _"]


def seam_jerks(joints: Float[Tensor, "b t j 3"], seams: Sequence[int], overlap: int, fps: float) -> Parted:
    """Mean jerk of joints in every four frames, inside windows and at seams, m/s^3.

    Four frames are at a seam if a step between two of them lies between the seam's frame and the first one that is the
    next window's alone. The first four frames of all are left out: they span the step off the given frame.

    Args:
        joints: metres, any frame that stands still.
        seams: the frame at which each further window begins, its given one.
        overlap: frames that two windows share.
        fps: frames a second.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.seams import seam_jerks
        >>> joints = torch.zeros(1, 129, 19, 3)
        >>> joints[:, 65:, :, 0] = 0.01
        >>> inside, at_seams = seam_jerks(joints, seams=[64], overlap=1, fps=10)
        >>> inside.max().item(), [round(jerk, 3) for jerk in at_seams[0].tolist()]
        (0.0, [10.0, 20.0, 10.0])
    """
    jerks = joints.diff(3, dim=1).norm(dim=-1).mean(2) * fps**3
    near = _at_seams(jerks.shape[1], 3, seams, overlap)
    away = ~near
    away[0] = False
    return Parted(jerks[:, away], jerks[:, near])


def velocity_jumps(roots: Float[Tensor, "b t 3"], seams: Sequence[int], overlap: int, fps: float) -> Parted:
    """Largest change of the root's velocity from one frame to the next, at each seam and inside windows, m/s.

    A largest of more frames is larger: inside, it is that of as many frames as a seam has, for every such stretch.

    Args:
        roots: metres, any frame that stands still.
        seams: the frame at which each further window begins, its given one.
        overlap: frames that two windows share.
        fps: frames a second.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.seams import velocity_jumps
        >>> roots = torch.zeros(1, 129, 3)
        >>> roots[:, 65:, 0] = 0.01 * torch.arange(1, 65)
        >>> inside, at_seams = velocity_jumps(roots, seams=[64], overlap=1, fps=30)
        >>> round(float(inside.max()), 3), [round(jump, 3) for jump in at_seams[0].tolist()]
        (0.0, [0.3])
    """
    changes = roots.diff(2, dim=1).norm(dim=-1) * fps
    blocked = _at_seams(changes.shape[1], 2, seams, overlap)
    blocked[0] = True
    stretches = F.max_pool1d(changes, overlap + 1, stride=1)
    reached = F.max_pool1d(blocked[None].to(changes), overlap + 1, stride=1)[0] > 0
    largest = [changes[:, seam - 1 : seam + overlap].amax(1) for seam in seams]
    at_seams = torch.stack(largest, dim=1) if largest else changes[:, :0]
    return Parted(stretches[:, ~reached], at_seams)


def _at_seams(count: int, order: int, seams: Sequence[int], overlap: int) -> Bool[Tensor, " n"]:
    """Which differences of this order span a step that belongs to a seam."""
    first = torch.arange(count)
    near = torch.zeros(count, dtype=torch.bool)
    for seam in seams:
        near |= (first < seam + overlap) & (first + order > seam)
    return near


class SeamJerk(PlottedMetric):
    r"""Jerk at the seams of long motions against jerk inside their windows, and the root's velocity jump there.

    A long motion is laid together of windows (paper, 6.2, which leaves its seams unmeasured; this is ours). Jerk is
    that of `Jerk`, over joints, frames and motions; S are the four frames that span a seam, I all others:

    .. math:: ratio = \frac{\text{mean}_{t \in S}\, jerk_t}{\text{mean}_{t \in I}\, jerk_t}, \quad
              jump = \text{mean}_{seams} \max_{t \in seam} \lVert v_{t + 1} - v_t \rVert

    with the root's velocity v. It reacts to whatever happens where windows meet: a jump off the given frame, another
    speed, limbs that change their course. A ratio of 1 is a seam that cannot be told from the inside, and a rough
    method hides its seams: read it beside the jerk inside. It is blind to drift and to whether the windows belong
    together. A wider overlap counts more frames to a seam, so its jerk is a mean over more, and its jump a largest of
    more; the jump inside is taken over stretches as long as a seam's. Without a seam its figures are NaN.

    Args:
        root: place of the root joint.
        fps: frames a second.
        seams: the frame at which each further window begins, its given one.
        overlap: frames that two windows share.
        options: of `torchmetrics.Metric`.

    Raises:
        SagError: a seam before frame 1, or no overlap.

    Example:
        >>> import torch
        >>> from sag.metrics.motion.seams import SeamJerk
        >>> time = torch.arange(129, dtype=torch.float64)[:, None, None]
        >>> joints = (1e-3 * time**3 / 6).repeat(1, 1, 19, 3)
        >>> joints[:, 65:] += 0.5
        >>> metric = SeamJerk(root=12, fps=1, seams=[64])
        >>> metric.update(joints)
        >>> round(float(metric.compute()["jerk_inside"]), 6), round(float(metric.compute()["jerk_ratio"]), 1)
        (0.001732, 667.0)
    """

    title = "seam jerk"
    higher_is_better = None

    totals: Tensor
    counts: Tensor

    def __init__(self, root: int, fps: float, seams: Sequence[int], overlap: int = 1, **options: Any) -> None:
        super().__init__(**options)
        self.root, self.fps, self.seams, self.overlap = root, check_fps(self.title, fps), tuple(seams), overlap
        if overlap < 1 or any(seam < 1 for seam in seams):
            raise SagError(f"{self.title} was given seams {list(seams)} of {overlap} frames; both must be 1 or more")
        self._keep_settings(root, self.fps, overlap, *seams)
        for name in ("totals", "counts"):
            self.add_state(name, torch.zeros(4, dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, joints: Float[Tensor, "b t j 3"]) -> None:
        """Adds motions.

        Args:
            joints: metres, any frame that stands still; of any length that reaches beyond the last seam.

        Raises:
            SagError: motions end before the last seam does anything, or a coordinate is not finite.
        """
        check_joints(self.title, joints, self.root + 1, frames=None)
        least = max((5, *(seam + 2 for seam in self.seams)))
        if joints.shape[1] < least:
            raise SagError(f"{self.title} needs at least {least} frames for its seams, not {joints.shape[1]}")
        wide = joints.double()
        parts = (
            *seam_jerks(wide, self.seams, self.overlap, self.fps),
            *velocity_jumps(wide[:, :, self.root], self.seams, self.overlap, self.fps),
        )
        self.totals = self.totals + torch.stack([part.sum() for part in parts])
        self.counts = self.counts + torch.tensor([part.numel() for part in parts]).to(self.counts)

    def compute(self) -> dict[str, Tensor]:
        """`jerk_inside`, `jerk_at_seams` in m/s^3, their `jerk_ratio`, `jump_inside` and `jump_at_seams` in m/s.

        Raises:
            SagError: no motion was given.
        """
        self._require(self.counts.sum())
        names = ("jerk_inside", "jerk_at_seams", "jump_inside", "jump_at_seams")
        figures = dict(zip(names, self.totals / self.counts))
        return {**figures, "jerk_ratio": figures["jerk_at_seams"] / figures["jerk_inside"]}
