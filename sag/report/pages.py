"""Tables of kept results in a page of Markdown: between two marks, put there and renewed by a command.

    <!-- table of results/table1: the paper's figures -->
    <!-- end of table -->

The first mark names a folder of results and a table of its report by its title (the first has none and is "the paper's
figures"). What stands between the marks is replaced; nothing else of the page is touched.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from sag.errors import SagError
from sag.report.markdown import grid
from sag.report.table import Report, Table

PAPER = "the paper's figures"
"""Name of the table that has no title."""

BLOCK = re.compile(r"(?m)^(<!-- table of (?P<folder>\S+): (?P<title>.+?) -->\n)(?s:.*?)^(<!-- end of table -->)$")
OPENING = re.compile(r"(?m)^<!-- table of ")


def with_tables(page: str, read: Callable[[str], Report]) -> str:
    """The page with every marked table renewed, columns of detail left out.

    Args:
        page: Markdown.
        read: the report of a folder.

    Raises:
        SagError: a mark is not closed, or its report has no table of that title.
    """
    reports: dict[str, Report] = {}

    def renewed(found: re.Match[str]) -> str:
        folder, title = found["folder"], found["title"]
        if folder not in reports:
            reports[folder] = read(folder)
        return f"{found[1]}{grid(_brief(_named(reports[folder], title, folder)))}\n{found[4]}"

    made, count = BLOCK.subn(renewed, page)
    if count < len(OPENING.findall(page)):
        raise SagError("a mark '<!-- table of FOLDER: TITLE -->' has no title, or no '<!-- end of table -->' below it")
    return made


def _named(report: Report, title: str, folder: str) -> Table:
    titles = [table.title or PAPER for table in report.tables]
    if title not in titles:
        raise SagError(f"the report of {folder} has no table {title!r}; it has {', '.join(map(repr, titles))}")
    return report.tables[titles.index(title)]


def _brief(table: Table) -> Table:
    """The columns without which the table would not be one, those without any content left out."""
    filled = [any(row.cells[place].text for row in table.rows) for place in range(len(table.columns))]
    kept = [place for place, column in enumerate(table.columns) if not column.detail and filled[place]]
    rows = (replace(row, cells=tuple(row.cells[place] for place in kept)) for row in table.rows)
    return replace(table, columns=tuple(table.columns[place] for place in kept), rows=tuple(rows))
