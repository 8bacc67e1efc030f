"""A claim: what was measured, what was asked, and whether that is met."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

from benchmarks.paired import Pairing

Say = Callable[[str], None]
"""Takes a line about what is going on."""


@dataclass(frozen=True)
class Claim:
    """One line of the table.

    Attributes:
        what: is claimed, in words.
        peer: what it is compared with.
        found: the figure that is judged.
        asked: the bound of it; None for a figure that is only told.
        ours: our side as a reader wants it, with its unit.
        theirs: the peer's side likewise.
        at_least: whether the figure must not be smaller than the bound; otherwise it must not be larger.
        spread: smallest and largest of the rounds.
        rounds: how many there were.
        unit: of the figure.
        note: what else a reader must know.
    """

    what: str
    peer: str
    found: float
    asked: float | None
    ours: str
    theirs: str
    at_least: bool = True
    spread: tuple[float, float] | None = None
    rounds: int = 1
    unit: str = "x"
    note: str = ""

    @property
    def met(self) -> bool:
        """Whether the figure is within its bound; a figure that is only told always is, one that is no number never."""
        if self.asked is None:
            return True
        return self.found >= self.asked if self.at_least else self.found <= self.asked


def faster(what: str, peer: str, pairing: Pairing, least: float | None, note: str = "") -> Claim:
    """The claim to be this many times faster than a peer, by the median of the paired ratios."""
    return Claim(
        what,
        peer,
        found=pairing.ratio,
        asked=least,
        ours=duration(median(pairing.ours)),
        theirs=duration(median(pairing.theirs)),
        spread=(min(pairing.ratios), max(pairing.ratios)),
        rounds=len(pairing.ratios),
        note=note,
    )


def duration(seconds: float) -> str:
    """A time in three digits."""
    return f"{1e3 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"
