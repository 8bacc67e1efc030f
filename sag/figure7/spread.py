"""Trajectories that share their start and their end, and how far they part in between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Generator, Tensor

from sag.errors import SagError
from sag.metrics import sample_deviation
from sag.runs import Run
from sag.types import Batch, Motion

TRAJECTORIES = 5
"""Trajectories of each picture (paper, Figure 7)."""

End = Literal["densest", "true"]
"""How the end point that trajectories share is chosen; see `common_ends`."""


@runtime_checkable
class TakesEnd(Protocol):
    """A method that can be told where the root is to be in the last frame."""

    def sample_to(self, batch: Batch, goals: Float[Tensor, "b 3"]) -> Motion:
        """Motions to places of the root, metres, camera frame of frame 0."""
        ...


@dataclass(frozen=True)
class Spread:
    """Five trajectories of one method to a common end point in each window.

    Attributes:
        name: of the run.
        kind: class of the method.
        told: whether the method was told the end point, or drew often and the nearest were taken.
        roots: metres, camera frame of frame 0.
        ends: the common end points, metres, camera frame of frame 0.
    """

    name: str
    kind: str
    told: bool
    roots: Float[Tensor, "n k t 3"]
    ends: Float[Tensor, "n 3"]

    @property
    def deviations(self) -> Float[Tensor, "n t"]:
        """Standard deviation of the root's place over the trajectories of each window, frame by frame, metres."""
        return sample_deviation(self.roots[:, :, :, None].double(), joint=0)

    @property
    def curve(self) -> Float[Tensor, " t"]:
        """What the figure shows: the deviation of each frame, mean over windows, metres."""
        return self.deviations.mean(dim=0)

    @property
    def misses(self) -> Float[Tensor, " n"]:
        """How far from the common end point the trajectory of a window that ends farthest from it ends, metres."""
        return (self.roots[:, :, -1] - self.ends[:, None]).norm(dim=-1).amax(dim=1)


def check_samples(samples: int) -> None:
    """Refuses fewer samples of a window than the figure takes.

    Raises:
        SagError: there are fewer.
    """
    if samples < TRAJECTORIES:
        raise SagError(f"--samples is {samples}; the figure takes {TRAJECTORIES} trajectories of each window")


@torch.no_grad()
def spreads_of(runs: Sequence[Run], batches: Sequence[Batch], samples: int, seed: int, end: End) -> list[Spread]:
    """The trajectories of every run, all to the same end points.

    Args:
        runs: which methods.
        batches: which windows.
        samples: motions that are drawn for each window, of which the five are taken.
        seed: of what is drawn.
        end: how the common end point is chosen.

    Raises:
        SagError: fewer samples than trajectories are asked for, or no run draws any to find the densest end among.
    """
    check_samples(samples)
    if end == "densest" and all(isinstance(run.method, TakesEnd) for run in runs):
        raise SagError("none of these runs draws motions whose ends could be the densest: add one, or say --end true")
    generators = [torch.Generator(run.method.device).manual_seed(seed) for run in runs]
    parts = [_of_batch(runs, generators, batch, samples, end) for batch in batches]
    return [
        Spread(
            run.name,
            type(run.method).__name__,
            isinstance(run.method, TakesEnd),
            torch.cat([roots[place] for roots, _ in parts]),
            torch.cat([ends for _, ends in parts]),
        )
        for place, run in enumerate(runs)
    ]


def _of_batch(
    runs: Sequence[Run], generators: Sequence[Generator], batch: Batch, samples: int, end: End
) -> tuple[list[Tensor], Tensor]:
    """Roots (b, 5, 65, 3) of each run, and the end points (b, 3) that they share."""
    drawn = {
        place: torch.stack([motion.roots.cpu() for motion in run.method.samples(on, samples, generator)], dim=1)
        for place, (run, generator) in enumerate(zip(runs, generators))
        if not isinstance(run.method, TakesEnd)
        for on in [batch.to(run.method.device)]
    }
    ends = batch.motion.roots[:, -1] if end == "true" else common_ends([roots[:, :, -1] for roots in drawn.values()])
    chosen = [
        nearest(drawn[place], ends) if place in drawn else _told(run, batch, ends) for place, run in enumerate(runs)
    ]
    return chosen, ends


def common_ends(ends: Sequence[Float[Tensor, "b _ 3"]]) -> Float[Tensor, "b 3"]:
    """In each window the densest end point: that one of the drawn ones which five of every method end nearest to.

    The true end point may be one that a method seldom goes to; of 200 samples the five nearest then still end far
    from each other, and what is measured is how they spread at the end. Around the densest one they share their end
    as closely as they can. It is looked for among the ends of all methods, and a method that ends far from it counts,
    so that none chooses for the others.

    Args:
        ends: of the motions that each method drew, metres.
    """
    candidates = torch.cat(list(ends), dim=1)
    reach = [torch.cdist(candidates, own).kthvalue(TRAJECTORIES, dim=2).values for own in ends]
    best = torch.stack(reach).amax(dim=0).argmin(dim=1)
    return candidates[torch.arange(len(candidates)), best]


def nearest(roots: Float[Tensor, "b n t 3"], ends: Float[Tensor, "b 3"]) -> Float[Tensor, "b k t 3"]:
    """The five trajectories of each window that end nearest to an end point."""
    distance = (roots[:, :, -1] - ends[:, None]).norm(dim=-1)
    chosen = distance.topk(TRAJECTORIES, dim=1, largest=False).indices
    return roots[torch.arange(len(roots))[:, None], chosen]


def _told(run: Run, batch: Batch, ends: Tensor) -> Tensor:
    """A method asked five times for the same end points, from another random state each time."""
    on, asked = batch.to(run.method.device), []
    with torch.random.fork_rng():
        for state in range(TRAJECTORIES):
            torch.manual_seed(state)
            asked.append(run.method.sample_to(on, ends.to(run.method.device)).roots.cpu())  # type: ignore[operator]
    return torch.stack(asked, dim=1)
