"""Clouds of points that are asked again and again which of them are near."""

from __future__ import annotations

import numpy as np
import torch
from jaxtyping import Float, Int
from scipy.spatial import cKDTree
from torch import Tensor

from sag.errors import SagError

_SLACK = 1e-9
"""Relative widening of a search, far above the rounding of float64."""


class IndexedCloud:
    """Points with a spatial index that is built once, on the processor.

    Args:
        points: metres, any one frame.

    Raises:
        SagError: a coordinate is not finite.

    Example:
        >>> import torch
        >>> from sag.geometry.cloud import IndexedCloud
        >>> cloud = IndexedCloud(torch.tensor([[0.0, 0.0, 2.0], [0.0, 0.3, 2.0], [1.0, 0.0, 2.0]]))
        >>> bone = torch.tensor([[0.0, 0.1, 2.0]]), torch.tensor([[0.0, 0.25, 2.0]])
        >>> cloud.near_segments(*bone, radius=0.06)
        (tensor([0]), tensor([1]))
    """

    def __init__(self, points: Float[Tensor, "n 3"]) -> None:
        if not points.isfinite().all():
            raise SagError("a point cloud has coordinates that are not finite; leave such points out")
        self.points = points.detach().double().cpu()
        self._tree = cKDTree(self.points.numpy())

    def __len__(self) -> int:
        return len(self.points)

    def near_segments(
        self, starts: Float[Tensor, "m 3"], ends: Float[Tensor, "m 3"], radius: float
    ) -> tuple[Int[Tensor, " k"], Int[Tensor, " k"]]:
        """Candidates for what lies within a radius (metres) of segments: every such point, and some farther ones.

        Args:
            starts: metres, frame of the points.
            ends: metres, frame of the points.
            radius: metres.

        Returns:
            Segment and point of each pair, a pair once; on the processor.
        """
        owner, centres = _along(starts.double().cpu(), ends.double().cpu(), radius)
        # No point of a segment is farther than `radius` from a centre, and both its ends are centres: so what is
        # within the radius of the segment is within sqrt(2) of it of a centre, round ends included.
        reach = 2**0.5 * radius * (1 + _SLACK) + _SLACK
        found = self._tree.query_ball_point(centres.numpy(), reach, return_sorted=False)
        counts = np.fromiter(map(len, found), dtype=np.int64, count=len(found))
        points = np.concatenate([*found, []]).astype(np.int64)
        pairs = np.unique(np.repeat(owner.numpy(), counts) * len(self) + points)
        return torch.from_numpy(pairs // max(len(self), 1)), torch.from_numpy(pairs % max(len(self), 1))


Cloud = Float[Tensor, "_ 3"] | IndexedCloud
"""A point cloud: metres, frame of the joints it is held against; an index spares building one each time."""


def indexed(cloud: Cloud) -> IndexedCloud:
    """The cloud with an index."""
    return cloud if isinstance(cloud, IndexedCloud) else IndexedCloud(cloud)


def _along(starts: Tensor, ends: Tensor, radius: float) -> tuple[Tensor, Tensor]:
    """Both ends of each segment and points between them at most two radii apart, and the segment of each."""
    pieces = ((ends - starts).norm(dim=-1) / (2 * radius)).ceil().clamp_min(1).long()
    owner = torch.arange(len(starts)).repeat_interleave(pieces + 1)
    step = torch.arange(len(owner)) - ((pieces + 1).cumsum(0) - pieces - 1)[owner]
    share = (step / pieces[owner])[:, None].double()
    return owner, starts[owner] + share * (ends - starts)[owner]
