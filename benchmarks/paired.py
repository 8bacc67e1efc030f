"""Paired timing: ours and each peer by turns in one process, so that what slows the machine slows both."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any


@dataclass(frozen=True)
class Work:
    """Something to time.

    Attributes:
        run: does it, given the number of the round.
        units: how many things one run handles; times are those of one of them.
    """

    run: Callable[[int], Any]
    units: float = 1


@dataclass
class Pairing:
    """What the rounds with one peer took, process seconds for each unit.

    Attributes:
        ours: one time for each round.
        theirs: one time for each round.
        found: what ours and the peer returned, one pair for each round.
    """

    ours: list[float] = field(default_factory=list)
    theirs: list[float] = field(default_factory=list)
    found: list[tuple[Any, Any]] = field(default_factory=list)

    @property
    def ratios(self) -> list[float]:
        """How many times faster ours was, round by round."""
        return [theirs / ours for ours, theirs in zip(self.ours, self.theirs)]

    @property
    def ratio(self) -> float:
        """The median of the paired ratios."""
        return median(self.ratios)


def paired(ours: Work, peers: Mapping[str, Work], rounds: int) -> dict[str, Pairing]:
    """Times ours beside each peer, once to warm up and then in every round, first the one and then the other."""
    pairings = {name: Pairing() for name in peers}
    for number in range(-1, rounds):
        for name, peer in peers.items():
            works = (ours, peer) if number % 2 else (peer, ours)
            timed = {id(work): _timed(work, max(number, 0)) for work in works}
            if number < 0:
                continue
            (our_time, our_result), (their_time, their_result) = timed[id(ours)], timed[id(peer)]
            pairings[name].ours.append(our_time)
            pairings[name].theirs.append(their_time)
            pairings[name].found.append((our_result, their_result))
    return pairings


def _timed(work: Work, number: int) -> tuple[float, Any]:
    """Process seconds for each unit, and what came out."""
    gc.collect()
    start = time.process_time()
    found = work.run(number)
    return (time.process_time() - start) / work.units, found
