"""The table on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from rich import box
from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from sag.report.markdown import SHORT
from sag.report.table import Table, TableRow

STYLES = {"plain": "", "best": "bold green", "bad": "bold white on red", "paper": "dim", "label": "bold"}

UNBOUNDED = 1000
"""Columns of text where there is no terminal: no table is that wide."""


def show(table: Table, console: Console) -> None:
    """Prints the table, its notices and its facts; on a narrow terminal the averages alone."""
    places = list(range(len(table.columns)))
    grid = _grid(table, places)
    if _natural_width(grid) > console.width:
        places = [i for i in places if not table.columns[i].metric or table.columns[i].metric.endswith("average")]
        grid = _grid(table, places)
    console.print(grid, width=_natural_width(grid))
    for notice in table.notices:
        console.print(Text(f"! {notice}", style="bold red"), soft_wrap=True)
    for name, value in table.facts:
        console.print(Text.assemble((f"{name}: ", "bold"), value), soft_wrap=True)


def _natural_width(grid: Grid) -> int:
    """Columns of text that the grid takes when nothing is cut."""
    return Console(width=UNBOUNDED).measure(grid).maximum


def _grid(table: Table, places: Sequence[int]) -> Grid:
    """The columns at these places."""
    grid = Grid(title=table.title, box=box.SIMPLE_HEAD, pad_edge=False, title_style="bold")
    for column in (table.columns[i] for i in places):
        heading = f"{SHORT.get(column.group, '')} {column.heading}".strip()
        grid.add_column(heading.replace(" ", "\n", 1), justify=column.alignment, no_wrap=True)
    for _, rows in groupby(table.rows, key=lambda row: row.kind):
        for row in rows:
            grid.add_row(*_texts(row, places))
        grid.add_section()
    return grid


def _texts(row: TableRow, places: Sequence[int]) -> list[Text]:
    """Cells in their looks; a label keeps what stands before its explanation."""
    cells = (row.cells[i] for i in places)
    return [Text(c.text.partition(":")[0], style=STYLES[c.look]) for c in cells]
