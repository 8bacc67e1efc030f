"""Columns: what a table's figures are called, in which unit they stand, and which way is better."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sag.letters import LETTERS
from sag.report.lines import Figure

ARROWS = {"lower": "↓", "higher": "↑", "": ""}


@dataclass(frozen=True)
class Group:
    """A heading over several columns.

    Attributes:
        title: where a table has such headings.
        short: said before each column's own heading where it has none.
        legend: a sentence on what the figures are, for below the table.
    """

    title: str = ""
    short: str = ""
    legend: str = ""


ALONE = Group()


@dataclass(frozen=True)
class Column:
    """A column.

    Attributes:
        group: heading over several columns, or none.
        heading: its own.
        metric: the figure it shows; nothing for names, letters and effort.
        better: which figures are better; nothing where neither is, or ground truth's are.
        factor: what the figure is multiplied by, from metres to millimetres or from a share to per cent.
        digits: behind the point; by the figure's size when left out.
        until: the figure at the other end, where the column shows an interval.
        floor: the figure of real motion against real.
        paper: whether it shows the paper's figure.
        detail: how soon it goes where there is little room; 0 stays.
        is_text: whether it names things, which stand to the left.
        is_figure: whether its figures stand to the right although it is called by a letter.
    """

    group: Group
    heading: str
    metric: str = ""
    better: Literal["lower", "higher", ""] = ""
    factor: float = 1.0
    digits: int | None = None
    until: str = ""
    floor: str = ""
    paper: bool = False
    detail: int = 0
    is_text: bool = False
    is_figure: bool = False

    @property
    def label(self) -> str:
        """The heading, with an arrow where the group has none that speaks for all."""
        arrow = "" if self.paper or self.group.title.endswith(tuple("↓↑")) else ARROWS[self.better]
        return f"{self.heading} {arrow}".strip()

    @property
    def alignment(self) -> Literal["left", "center", "right"]:
        """Names to the left, letters in the middle, numbers to the right."""
        if self.heading == "row" or self.is_text:
            return "left"
        return "center" if self.heading in LETTERS.values() and not self.is_figure else "right"

    def written(self, figure: Figure) -> str:
        """A figure as the table shows it, with the digits asked for, or three or so: mean ± half of its interval."""
        mean = figure.mean * self.factor
        digits = _digits(abs(mean)) if self.digits is None else self.digits
        mean = round(mean, digits) + 0.0  # never -0.000
        half = "" if figure.half_width is None else f" ± {figure.half_width * self.factor:,.{digits}f}"
        return f"{mean:,.{digits}f}{half}"


def _digits(size: float) -> int:
    return next((digits for least, digits in ((1000, 0), (10, 1), (1, 2)) if size >= least), 3)
