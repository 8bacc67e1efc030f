"""Examples for Figure 7: a few windows with the trajectories of every run as the camera sees them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float

from sag.figure7.spread import Spread
from sag.geometry.camera import project
from sag.types import Batch

EXAMPLES = 4
"""Windows that are shown."""


@dataclass(frozen=True)
class Example:
    """A window.

    Attributes:
        index: its place in the data set.
        image: colours in [0, 1].
        end: pixels of the common end point.
        trajectories: of each run, pixels.
    """

    index: int
    image: Float[np.ndarray, "h w 3"]
    end: Float[np.ndarray, " 2"]
    trajectories: list[Float[np.ndarray, "k t 2"]]


def examples_of(batches: Sequence[Batch], spreads: Sequence[Spread], count: int = EXAMPLES) -> list[Example]:
    """Windows in which the person goes far: one of each room as far as it goes, the common end inside the picture.

    They are those nearest to the upper quartile of the ways from start to end in the picture; the curve is over all
    windows.
    """
    intrinsics = torch.cat([batch.scene.intrinsics for batch in batches])
    rooms = torch.cat([batch.room for batch in batches])
    start = torch.cat([batch.motion.start for batch in batches])
    ends = project(spreads[0].ends, intrinsics)
    images = torch.cat([batch.scene.image for batch in batches])
    way = (ends - project(start, intrinsics)).norm(dim=-1)
    outside = ((ends < 0) | (ends > ends.new_tensor([images.shape[-1], images.shape[-2]]))).any(dim=-1)
    order = ((way - way.quantile(0.75)).abs() + 1e6 * outside).argsort().tolist()
    first_of_room = [w for place, w in enumerate(order) if int(rooms[w]) not in {int(rooms[v]) for v in order[:place]}]
    chosen = [*first_of_room, *(w for w in order if w not in first_of_room)][:count]
    index = torch.cat([batch.index for batch in batches])
    return [
        Example(
            int(index[w]),
            images[w].permute(1, 2, 0).numpy(),
            ends[w].numpy(),
            [project(spread.roots[w : w + 1], intrinsics[w : w + 1])[0].numpy() for spread in spreads],
        )
        for w in chosen
    ]
