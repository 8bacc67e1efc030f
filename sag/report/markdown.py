"""The report as Markdown that also reads well in a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from sag.report.columns import Column
from sag.report.table import Cell, Report, Table

RULES = {"left": ("", ""), "center": (":", ":"), "right": ("", ":")}
PADDING = {"left": "<", "center": "^", "right": ">"}


def markdown(report: Report) -> str:
    """The tables with notices above and facts below."""
    parts = [f"# {report.title}"]
    parts += [f"> **Warning:** {notice}" for notice in report.notices]
    for table in report.tables:
        parts += [f"## {table.title}"] if table.title else []
        parts += [grid(table), table.legend]
    parts.append("\n".join(f"- {name}: {value}" for name, value in report.facts))
    return "\n\n".join(parts) + "\n"


def grid(table: Table) -> str:
    """A table alone. Markdown has no headings over several columns, so that each says its group's."""
    headings = [f"{column.group.short} {column.label}".strip() for column in table.columns]
    body = [[_text(cell) for cell in row.cells] for row in table.rows]
    widths = [max(3, *map(len, texts)) for texts in zip(headings, *body)]
    rules = [_rule(*RULES[column.alignment], width) for column, width in zip(table.columns, widths)]
    return "\n".join(_line(texts, table.columns, widths) for texts in (headings, rules, *body))


def _text(cell: Cell) -> str:
    text = cell.text.replace("|", r"\|")
    return f"**{text}**" if cell.look in ("best", "worse", "bad") else text


def _rule(before: str, after: str, width: int) -> str:
    return before + "-" * (width - len(before) - len(after)) + after


def _line(texts: Sequence[str], columns: Sequence[Column], widths: Sequence[int]) -> str:
    """One line, padded so that it also stands straight as plain text."""
    padded = (f"{text:{PADDING[c.alignment]}{width}}" for text, c, width in zip(texts, columns, widths))
    return "| " + " | ".join(padded) + " |"
