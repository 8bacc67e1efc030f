"""Which motion a rater sees when: every scene with every method, in balanced order."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import NamedTuple

from sag.errors import SagError

EARLY, LATE = 1 / 3, 2 / 3
"""Motions that come again are taken from this first share of a session, and come again in what is after the other."""


class Item(NamedTuple):
    """A motion of the study.

    Attributes:
        scene: place of its scene.
        method: place of its method.
    """

    scene: int
    method: int


@dataclass(frozen=True)
class Design:
    """How motions are spread over raters.

    A session has rounds, and each round shows every scene once, with one of the methods, in an order of its own. Which
    method a scene has in a round is said by a Williams square: over as many raters as it has rows, every method comes
    in every round equally often, and after every other of the same scene equally often. Within a round all methods are
    about equally many. Some motions come again near the end, to see how constant a rater is.

    Attributes:
        scenes: how many.
        methods: how many, at least two.
        rounds: motions of each scene that a rater sees, at most one of each method.
        repeats: motions that come again.
        seed: of every order; whoever knows it knows what comes when.
    """

    scenes: int
    methods: int
    rounds: int
    repeats: int
    seed: str

    def __post_init__(self) -> None:
        """Refuses what cannot be shown.

        Raises:
            SagError: rounds or repeats are out of range, or there is nothing to compare.
        """
        if self.methods < 2:
            raise SagError("a study compares methods: name at least one run beside the ground truth")
        if not 1 <= self.rounds <= self.methods:
            raise SagError(f"--rounds is {self.rounds}; a scene can come 1 to {self.methods} times, once a method")
        once = self.scenes * self.rounds
        if not 0 <= self.repeats <= once // 4:
            raise SagError(f"--repeats is {self.repeats}; of {once} motions 0 to {once // 4} may come again")

    @property
    def turns(self) -> int:
        """Motions that a rater is shown."""
        return self.scenes * self.rounds + self.repeats

    def session(self, rater: int) -> list[Item]:
        """What a rater is shown, in order; the same whenever it is asked.

        Args:
            rater: number of the rater, from 0.
        """
        rows = williams(self.methods)
        # Which method and which scene stands where in the square is nobody's to guess.
        study = random.Random(f"{self.seed}|study")
        methods, scenes = list(range(self.methods)), list(range(self.scenes))
        study.shuffle(methods)
        study.shuffle(scenes)
        chance = random.Random(f"{self.seed}|{rater}")
        items: list[Item] = []
        for turn in range(self.rounds):
            order = list(range(self.scenes))
            chance.shuffle(order)
            if items and scenes[order[0]] == items[-1].scene:
                order.reverse()
            items += [Item(scenes[i], methods[rows[(rater + i) % len(rows)][turn]]) for i in order]
        return _with_repeats(items, self.repeats, chance)


def _with_repeats(items: list[Item], count: int, chance: random.Random) -> list[Item]:
    """Some of the first motions once more among the last, never beside another of the same scene if it can be."""
    again = chance.sample(items[: max(count, round(EARLY * len(items)))], count)
    for item in again:
        places = list(range(max(1, round(LATE * len(items))), len(items) + 1))
        apart = [place for place in places if all(one.scene != item.scene for one in items[place - 1 : place + 1])]
        items.insert(chance.choice(apart or places), item)
    return items


def williams(count: int) -> list[list[int]]:
    """A Latin square in which everything comes directly after everything else equally often (Williams, 1949).

    Args:
        count: of things; an odd one needs two squares, so twice as many rows.
    """
    first = [0]
    for step in range(1, count):
        first.append((first[-1] + (step if step % 2 else -step)) % count)
    rows = [[(place + shift) % count for place in first] for shift in range(count)]
    return rows if count % 2 == 0 else rows + [row[::-1] for row in rows]
