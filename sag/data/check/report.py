"""What a check found, and how it stands on a terminal."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from rich.console import Console
from rich.table import Table
from rich.text import Text

from sag.text import plain

Verdict = Literal["", "ok", "look", "broken"]
"""Told only, as it should be, unusual, or unusable."""

STYLES = {"": "", "ok": "green", "look": "yellow", "broken": "bold red"}

WIDTH = 100
"""Most columns of text that a report takes; farther apart, a value and its name are hard to read together."""

NAMES = 15
"""Columns of text for the names of lines."""

SHOWN = 8
"""Most details of a line that are shown."""

FRAMES_SHOWN = 12
"""Most frames of a recording that are shown."""


@dataclass(frozen=True)
class Line:
    """One thing that was looked at.

    Attributes:
        name: what it is.
        value: what was found.
        verdict: what to think of it.
        details: such as files or frames, the first few of which are shown.
    """

    name: str
    value: str
    verdict: Verdict = ""
    details: tuple[str, ...] = ()


@dataclass(frozen=True)
class Section:
    """Lines that belong together.

    Attributes:
        title: over them.
        lines: in order.
    """

    title: str
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Report:
    """Everything that was found.

    Attributes:
        title: data set and place.
        sections: in order.
        good: what is said where nothing is broken.
    """

    title: str
    sections: tuple[Section, ...]
    good: str = "nothing is broken"

    def lines(self, verdict: Verdict) -> list[Line]:
        """Lines with this verdict."""
        return [line for section in self.sections for line in section.lines if line.verdict == verdict]

    @property
    def verdict(self) -> str:
        """All of it in one sentence."""
        broken, unusual = (", ".join(dict.fromkeys(line.name for line in self.lines(v))) for v in ("broken", "look"))
        if broken:
            return f"BROKEN: {broken}"
        return self.good + (f"; worth a look: {unusual}" if unusual else "")


def show(report: Report, console: Console) -> None:
    """Prints a report, at most `WIDTH` columns wide."""
    width = min(WIDTH, console.width)
    console.print(Text(plain(report.title), style="bold"), width=width)
    for section in report.sections:
        console.print()
        console.print(Text(plain(section.title), style="bold"), width=width)
        console.print(_grid(section.lines, width))
    style = "bold red" if report.lines("broken") else "bold green"
    console.print()
    console.print(Text(report.verdict, style=style), width=width)


def _grid(lines: Sequence[Line], width: int) -> Table:
    grid = Table.grid(padding=(0, 1))
    grid.width = width
    grid.add_column(width=6)
    grid.add_column(width=NAMES)
    grid.add_column(ratio=1, overflow="fold")
    for line in lines:
        style = STYLES[line.verdict]
        grid.add_row(Text(line.verdict, style=style), Text(line.name), Text(plain(line.value), style=style))
        for detail in _first(line.details):
            grid.add_row("", "", Text(plain(detail), style="dim"))
    return grid


def _first(details: Sequence[str]) -> list[str]:
    more = len(details) - SHOWN
    return [*details[:SHOWN], *([f"and {more:,} more"] if more > 0 else [])]


def graded(value: float, usual: float, usable: float) -> Verdict:
    """What to think of a number that should be small."""
    return "ok" if value <= usual else "look" if value <= usable else "broken"


def several(count: int, one: str) -> str:
    """A count with its noun."""
    return f"{count:,} {one}{'' if count == 1 else 's'}"


def within(sentences: Iterable[str], root: Path) -> tuple[str, ...]:
    """Sentences with places in a root told from there on, as long paths are hard to read."""
    return tuple(sentence.replace(f"{root}{os.sep}", "") for sentence in sentences)


def by_recording(found: Iterable[tuple[Path, Sequence[object]]]) -> tuple[str, ...]:
    """A detail for each recording that has such frames."""
    return tuple(f"{folder.name}: {_listed(frames)}" for folder, frames in found if frames)


def _listed(frames: Sequence[object]) -> str:
    more = len(frames) - FRAMES_SHOWN
    return ", ".join(map(str, frames[:FRAMES_SHOWN])) + (f" and {more:,} more" if more > 0 else "")
