"""The table before it is Markdown, LaTeX, HTML or lines on a terminal: headings, cells, notices, facts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from sag.letters import LETTERS
from sag.report.facts import facts_of, notices_of
from sag.report.lines import Figure, Line
from sag.report.paper import HORIZONS, RADII, PaperFigures, paper_figures
from sag.report.results import GROUND_TRUTH

Look = Literal["plain", "best", "bad", "paper", "label"]
Kind = Literal["without", "with", "method", "truth"]

MARK = "✓"
NONE = "–"
FLOOR = "motion_fid_floor"


@dataclass(frozen=True)
class Column:
    """A column.

    Attributes:
        group: heading over several columns, or nothing.
        heading: its own.
        metric: the figure it shows; nothing for letters, names and times.
        paper: whether it shows the paper's figure.
    """

    group: str
    heading: str
    metric: str = ""
    paper: bool = False

    @property
    def alignment(self) -> Literal["left", "center", "right"]:
        """Names to the left, letters in the middle, numbers to the right."""
        if self.heading == "row":
            return "left"
        return "center" if self.heading in LETTERS.values() else "right"


@dataclass(frozen=True)
class Cell:
    """A cell: its text and how it looks."""

    text: str
    look: Look = "plain"


@dataclass(frozen=True)
class TableRow:
    """A row of cells; rows of one kind stand together."""

    kind: Kind
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Table:
    """A table with all that must be said about it.

    Attributes:
        title: what it shows.
        columns: from left to right.
        rows: from top to bottom.
        notices: what a reader must know before reading, such as failed rows.
        facts: (name, value) pairs below it.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[TableRow, ...]
    notices: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]


def table_of(title: str, lines: Sequence[Line], whole: bool = False) -> Table:
    """The table of these lines.

    Args:
        title: what it shows.
        lines: in order.
        whole: all of the paper's cells, not its averages alone.
    """
    data = next(line.finished[0].data for line in lines if line.finished)
    paper = paper_figures(str(data.get("name")))
    columns = _columns(paper, whole, several=any(len(line.finished) > 1 for line in lines))
    best = {column.metric: _best(lines, column.metric) for column in columns if column.metric and not column.paper}
    rows = [_row(line, columns, paper, best) for line in lines]
    rows += [_floor(line, columns) for line in lines if f"{FLOOR}/average" in line.figures]
    return Table(title, columns, tuple(rows), notices_of(lines), facts_of(lines, paper))


def _columns(paper: PaperFigures, whole: bool, several: bool) -> tuple[Column, ...]:
    columns = [Column("", "row"), *(Column("", letter) for letter in LETTERS.values())]
    for metric, heading, names in (
        ("motion_fid", "Motion FID ↓", HORIZONS),
        ("non_collision", "Non-collision ↑", RADII),
    ):
        columns += [Column(heading, _heading(name), f"{metric}/{name}") for name in names]
        shown = names if whole else ("average",)
        printed = "paper" if len(shown) == 1 else ""
        group = f"{heading}, paper on {paper.source}" if whole else heading
        columns += [Column(group, printed or _heading(name), f"{metric}/{name}", paper=True) for name in shown]
    columns += [Column("", "n")] if several else []
    return (*columns, Column("", "steps"), Column("", "min"))


def _heading(name: str) -> str:
    return f"{name} mm" if name.isdigit() else name


def _kind(line: Line) -> Kind:
    if line.components is None:
        return "truth" if line.name == GROUND_TRUTH else "method"
    return "with" if line.components["separate"] else "without"


def _row(line: Line, columns: Sequence[Column], paper: PaperFigures, best: dict[str, float]) -> TableRow:
    printed = {name: written(name, Figure(value)) for name, value in paper.cells(line.paper_row).items()}
    cells = [Cell(line.name.replace("_", " "), "label"), *_letters(line)]
    for column in columns[len(cells) :]:
        if column.paper:
            cells.append(Cell(printed.get(column.metric, ""), "paper"))
        elif column.metric:
            cells.append(_figure(line, column.metric, best[column.metric]))
    return TableRow(_kind(line), (*cells, *_effort(line, columns)))


def _effort(line: Line, columns: Sequence[Column]) -> Iterable[Cell]:
    """Seeds, steps and minutes of a row."""
    steps = max((result.steps for result in line.finished), default=0)
    texts = {
        "n": str(len(line.finished)),
        "steps": f"{steps:,}" if steps else "",
        "min": "" if line.minutes is None else f"{line.minutes:.1f}",
    }
    return (Cell(texts[column.heading]) for column in columns if column.heading in texts)


def _letters(line: Line) -> Iterable[Cell]:
    return (Cell(MARK if line.components and line.components.get(name) else "") for name in LETTERS)


def _figure(line: Line, metric: str, best: float) -> Cell:
    if not line.finished:
        return Cell(line.unfinished[0].state, "bad")
    if metric not in line.figures:
        return Cell(NONE)
    figure = line.figures[metric]
    if math.isnan(figure.mean):
        return Cell("NaN", "bad")
    is_best = line.components is not None and figure.mean == best
    return Cell(written(metric, figure), "best" if is_best else "plain")


def _floor(line: Line, columns: Sequence[Column]) -> TableRow:
    """Motion FID of one half of the true motion against the other: nothing can be told apart below it."""
    cells = [Cell("floor: real against real, halves", "label")]
    for column in columns[1:]:
        name = column.metric.replace("motion_fid/", f"{FLOOR}/")
        shown = not column.paper and name.startswith(FLOOR) and name in line.figures
        cells.append(Cell(written(column.metric, line.figures[name]) if shown else ""))
    return TableRow("truth", tuple(cells))


def _best(lines: Sequence[Line], metric: str) -> float:
    means = [line.figures[metric].mean for line in lines if line.components and metric in line.figures]
    means = [mean for mean in means if not math.isnan(mean)]
    return (max if metric.startswith("non_collision") else min)(means, default=math.nan)


def written(metric: str, figure: Figure) -> str:
    """A figure as a table shows it: three decimals for a share, three digits or so for a distance."""
    digits = 3
    if not metric.startswith("non_collision"):
        digits = 1 if figure.mean >= 10 else 2 if figure.mean >= 1 else 3
    deviation = "" if figure.deviation is None else f" ± {figure.deviation:.{digits}f}"
    return f"{figure.mean:.{digits}f}{deviation}"
