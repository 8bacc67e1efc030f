"""Tables before they are Markdown, LaTeX, HTML or lines on a terminal: headings, cells, notices, facts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from sag.letters import LETTERS
from sag.report.columns import ALONE, Column
from sag.report.facts import facts_of, notices_of
from sag.report.lines import Figure, Line
from sag.report.paper import PaperFigures, paper_figures
from sag.report.sections import COMPANIONS, SEES_MORE, Section, paper_section

Look = Literal["plain", "best", "worse", "bad", "paper", "label"]
"""`best` is the best row, or a change to the better beyond chance; `worse` one to the worse; `bad` is missing."""

MARK = "✓"
NONE = "–"
NAME = Column(ALONE, "row")
BEST = "Bold: the best row of the ablation."


@dataclass(frozen=True)
class Cell:
    """A cell: its text and how it looks."""

    text: str
    look: Look = "plain"


@dataclass(frozen=True)
class TableRow:
    """A row of cells; rows of one kind stand together."""

    kind: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Table:
    """A table and what its headings mean.

    Attributes:
        title: what it shows, where the report's title does not say it.
        columns: from left to right.
        rows: from top to bottom.
        legend: for below it.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[TableRow, ...]
    legend: str


@dataclass(frozen=True)
class Report:
    """Tables with all that must be said about them.

    Attributes:
        title: what it shows.
        tables: the paper's figures, then ours.
        notices: what a reader must know before reading, such as failed rows.
        facts: (name, value) pairs for below.
    """

    title: str
    tables: tuple[Table, ...]
    notices: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]


def report_of(title: str, lines: Sequence[Line], whole: bool = False) -> Report:
    """The report of these lines.

    Args:
        title: what it shows.
        lines: in order.
        whole: all of the paper's cells, not its averages alone.
    """
    data = next(line.finished[0].data for line in lines if line.finished)
    paper = paper_figures(str(data.get("name")))
    first = _table(paper_section(paper, whole), lines, paper)
    further = (_table(section, lines, paper) for section in (SEES_MORE, COMPANIONS))
    tables = (first, *(table for table in further if len(table.columns) > 1))
    return Report(title, tables, notices_of(lines, paper), facts_of(lines, paper))


def _table(section: Section, lines: Sequence[Line], paper: PaperFigures) -> Table:
    columns = (NAME, *(column for column in section.columns if _has_content(column, lines)))
    best = {column: _best(lines, column) for column in columns}
    rows = [TableRow(line.kind, tuple(_cell(line, c, best[c], paper) for c in columns)) for line in lines]
    floors = {column.floor for column in columns if column.floor}
    rows += [_floor(line, columns) for line in lines if floors & set(line.figures)]
    legend = " ".join(dict.fromkeys([*(c.group.legend for c in columns if c.group.legend), BEST]))
    return Table(section.title, columns, tuple(rows), legend)


def _has_content(column: Column, lines: Sequence[Line]) -> bool:
    """Whether any row has the figure; seeds are counted where a row has several."""
    if column.heading == "n":
        return any(len(line.finished) > 1 for line in lines)
    return column.paper or not column.metric or any(column.metric in line.figures for line in lines)


def _cell(line: Line, column: Column, best: float, paper: PaperFigures) -> Cell:
    if column.paper:
        printed = paper.cells(line.paper_row).get(column.metric)
        return Cell("" if printed is None else column.written(Figure(printed)), "paper")
    if column.metric:
        return _figure(line, column, best)
    return Cell(OF_ROW[column.heading](line), "label" if column is NAME else "plain")


def _figure(line: Line, column: Column, best: float) -> Cell:
    if not line.finished:
        return Cell(line.unfinished[0].state, "bad")
    shown = [line.figures.get(metric) for metric in (column.metric, column.until) if metric]
    figures = [figure for figure in shown if figure is not None]
    if len(figures) < len(shown):
        return Cell(NONE)
    if any(math.isnan(figure.mean) for figure in figures):
        return Cell("NaN", "bad")
    if column.until:
        return Cell(NONE.join(column.written(Figure(figure.mean)) for figure in figures))
    is_best = line.in_ablation and column.written(Figure(figures[0].mean)) == column.written(Figure(best))
    return Cell(column.written(figures[0]), "best" if is_best else "plain")


def _best(lines: Sequence[Line], column: Column) -> float:
    """The best mean among the rows of the ablation; NaN where nothing is better than another."""
    means = [line.figures[column.metric].mean for line in lines if line.in_ablation and column.metric in line.figures]
    means = [mean for mean in means if not math.isnan(mean)]
    choose = {"lower": min, "higher": max}.get(column.better)
    return choose(means) if choose and means else math.nan


def _floor(line: Line, columns: Sequence[Column]) -> TableRow:
    """Distances of one half of the true motion from the other: nothing can be told apart below them."""
    figures = (line.figures.get(column.floor) for column in columns[1:])
    cells = (Cell("" if figure is None else c.written(figure)) for c, figure in zip(columns[1:], figures))
    return TableRow("truth", (Cell("floor: real against real, halves", "label"), *cells))


def _name(line: Line) -> str:
    blind = ": scene feature zeroed" if line.kind == "blind" else ""
    return line.label.replace("_", " ") + blind


def _letter(component: str) -> Callable[[Line], str]:
    return lambda line: MARK if line.components and line.components.get(component) else ""


def _steps(line: Line) -> str:
    steps = max((result.steps for result in line.finished), default=0)
    return f"{steps:,}" if steps else ""


OF_ROW: dict[str, Callable[[Line], str]] = {
    "row": _name,
    **{letter: _letter(component) for component, letter in LETTERS.items()},
    "n": lambda line: str(len(line.finished)),
    "steps": _steps,
    "min": lambda line: "" if line.minutes is None else f"{line.minutes:.1f}",
}
"""What columns without a figure show, by heading."""
