"""The report on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from rich import box
from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from sag.report.table import Report, Table, TableRow

STYLES = {
    "plain": "",
    "best": "bold green",
    "worse": "bold red",
    "bad": "bold white on red",
    "paper": "dim",
    "label": "bold",
}

UNBOUNDED = 1000
"""Columns of text where there is no terminal: no table is that wide."""


def show(report: Report, console: Console) -> None:
    """Prints the tables, notices and facts; on a narrow terminal fewer columns, and further tables only if they fit."""
    for table in report.tables:
        grid = _fitting(table, console.width)
        if not table.title:
            grid.title = report.title
            console.print(grid, width=_natural_width(grid))
        elif _natural_width(grid) <= console.width:
            console.print(grid, width=_natural_width(grid))
            console.print(Text(f"{table.legend}\n", style="dim"))
    for notice in report.notices:
        console.print(Text(f"! {notice}", style="bold red"), soft_wrap=True)
    for name, value in report.facts:
        console.print(Text.assemble((f"{name}: ", "bold"), value), soft_wrap=True)


def _fitting(table: Table, width: int) -> Grid:
    """As many of the columns as fit, details left out first; the least that a table can be where none do."""
    most = max(column.detail for column in table.columns)
    grids = (_grid(table, detail) for detail in range(most, 0, -1))
    return next((grid for grid in grids if _natural_width(grid) <= width), _grid(table, 0))


def _natural_width(grid: Grid) -> int:
    """Columns of text that the grid takes when nothing is cut."""
    return Console(width=UNBOUNDED).measure(grid).maximum


def _grid(table: Table, detail: int) -> Grid:
    """The columns of at most this much detail."""
    places = [place for place, column in enumerate(table.columns) if column.detail <= detail]
    grid = Grid(title=table.title, box=box.SIMPLE_HEAD, pad_edge=False, title_style="bold")
    for column in (table.columns[place] for place in places):
        grid.add_column(f"{column.group.short}\n{column.label}".strip(), justify=column.alignment, no_wrap=True)
    for _, rows in groupby(table.rows, key=lambda row: row.kind):
        for row in rows:
            grid.add_row(*_texts(row, places))
        grid.add_section()
    return grid


def _texts(row: TableRow, places: Sequence[int]) -> list[Text]:
    """Cells in their looks; a label keeps what stands before its explanation."""
    cells = (row.cells[i] for i in places)
    return [Text(c.text.partition(":")[0], style=STYLES[c.look]) for c in cells]
