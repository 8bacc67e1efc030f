"""Trials: the points of a search, drawn by chance or read again from the rows that have them."""

from __future__ import annotations

import random
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from sag.sweep.definition import Point, Sweep
from sag.sweep.status import STATUS, read_status

DRAWS = 100
"""How often a point is drawn again that was there before."""


@dataclass(frozen=True)
class Trial:
    """One point of a search.

    Attributes:
        number: from 0 on, in the order in which points were drawn.
        point: what was drawn.
    """

    number: int
    point: Point


def chance_of(seed: int, number: int) -> random.Random:
    """The chance that decides about one trial: of the seed alone, however often the sweep was interrupted."""
    return random.Random(f"{seed}:{number}")


def draw(sweep: Sweep, chance: random.Random, known: Collection[Point]) -> Point | None:
    """A point that is not known yet, or None where it seems that all are."""
    for _ in range(DRAWS):
        point = {name: given.draw(chance) for name, given in sweep.parameters.items()}
        if point not in known:
            return point
    return None


def drawn(sweep: Sweep, seed: int) -> list[Trial]:
    """All trials of a random search: the same whenever they are asked for."""
    trials: list[Trial] = []
    for number in range(sweep.run_cap or 0):
        point = draw(sweep, chance_of(seed, number), [trial.point for trial in trials])
        if point is not None:
            trials.append(Trial(number, point))
    return trials


def recorded(sweep: Sweep, out: Path) -> list[Trial]:
    """The trials that rows in a folder have, as far as they fit the sweep file as it is now."""
    found: dict[int, Point] = {}
    for path in sorted(out.glob(f"*/{STATUS}")):
        status = read_status(path.parent)
        if status and status.trial is not None and status.point is not None and _fits(sweep, status.point):
            found[status.trial] = {name: status.point[name] for name in sweep.parameters}
    return [Trial(number, found[number]) for number in sorted(found)]


def _fits(sweep: Sweep, point: Point) -> bool:
    return set(point) == set(sweep.parameters) and all(
        given.holds(point[name]) for name, given in sweep.parameters.items()
    )
