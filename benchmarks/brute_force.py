"""Points of a cloud inside a body's bones by testing all against all, written in three ways, float64 in each.

Each takes points and the two ends of the bones (metres, camera frame) and counts the points within each radius of the
nearest bone.
"""

from __future__ import annotations

import numpy as np
import torch
from jaxtyping import Float, Int

Points = Float[np.ndarray, "n 3"]
Ends = Float[np.ndarray, "m 3"]
Counts = Int[np.ndarray, " r"]

_BLOCK = 16_384
"""Points that stay in the processor's cache together with what is computed of them."""


def by_numpy(points: Points, starts: Ends, ends: Ends, radii: tuple[float, ...]) -> Counts:
    """The whole cloud against one bone after another."""
    nearest = np.full(len(points), np.inf)
    for start, end in zip(starts, ends):
        along, offset = end - start, points - start
        share = np.clip(offset @ along / (along @ along), 0, 1)
        aside = offset - share[:, None] * along
        np.minimum(nearest, np.einsum("nc,nc->n", aside, aside), out=nearest)
    return np.array([(nearest <= radius**2).sum() for radius in radii])


def by_torch(points: Points, starts: Ends, ends: Ends, radii: tuple[float, ...]) -> Counts:
    """Points and bones broadcast against each other, in blocks of points since all do not fit the memory."""
    first, along = torch.from_numpy(starts), torch.from_numpy(ends - starts)
    counts = torch.zeros(len(radii), dtype=torch.long)
    for block in torch.from_numpy(points).split(_BLOCK):
        offset = block[:, None] - first
        share = ((offset * along).sum(-1) / (along * along).sum(-1)).clamp(0, 1)
        nearest = (offset - share[..., None] * along).square().sum(-1).amin(1)
        counts += torch.stack([(nearest <= radius**2).sum() for radius in radii])
    return counts.numpy()


def by_columns(points: Points, starts: Ends, ends: Ends, radii: tuple[float, ...]) -> Counts:
    """Coordinates in columns (a view of a (3, n) array), in blocks that fit the cache: the fastest we could write."""
    counts = np.zeros(len(radii), np.int64)
    for first in range(0, len(points), _BLOCK):
        columns = points[first : first + _BLOCK].T
        nearest = np.full(columns.shape[1], np.inf)
        for start, end in zip(starts, ends):
            along = end - start
            x, y, z = (column - place for column, place in zip(columns, start))
            share = (x * along[0] + y * along[1] + z * along[2]) / (along @ along)
            np.clip(share, 0, 1, out=share)
            for coordinate, part in zip((x, y, z), along):
                coordinate -= share * part
            np.minimum(nearest, x * x + y * y + z * z, out=nearest)
        counts += [(nearest <= radius**2).sum() for radius in radii]
    return counts


class NearBody:
    """All points inside the body's bounding box against all bones: exact too, and cheap enough for 10,000 frames.

    A point within a radius of a bone lies within that radius of the box around all joints.

    Args:
        points: of the cloud.
    """

    def __init__(self, points: Points) -> None:
        self._columns = np.ascontiguousarray(points[points[:, 2].argsort()].T)

    def counts(self, starts: Ends, ends: Ends, radii: tuple[float, ...]) -> Counts:
        """Points within each radius of the nearest bone."""
        both = np.concatenate([starts, ends])
        margin = 1.001 * max(radii)
        low, high = both.min(0) - margin, both.max(0) + margin
        first, stop = np.searchsorted(self._columns[2], [low[2], high[2]])
        near = self._columns[:, first:stop]
        for axis in (0, 1):
            near = near[:, (near[axis] >= low[axis]) & (near[axis] <= high[axis])]
        return by_columns(near.T, starts, ends, radii)
