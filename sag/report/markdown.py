"""The table as Markdown that also reads well in a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from sag.report.table import Cell, Column, Table

SHORT = {"Motion FID ↓": "FID", "Non-collision ↑": "NC"}
"""Markdown has no headings over several columns."""

RULES = {"left": ("", ""), "center": (":", ":"), "right": ("", ":")}
PADDING = {"left": "<", "center": "^", "right": ">"}

LEGEND = (
    "FID: Motion FID, lower is better (short: clips of 2 and 4 frames, mid: 8 and 16, long: 32 and 64). NC: "
    "non-collision score with cylinders of 30, 45 and 60 mm around the bones, higher is better. Bold: the best row of "
    "the ablation."
)


def markdown(table: Table) -> str:
    """The table with its notices above and its facts below."""
    headings = [f"{SHORT.get(column.group, '')} {column.heading}".strip() for column in table.columns]
    body = [[_text(cell) for cell in row.cells] for row in table.rows]
    widths = [max(3, *map(len, texts)) for texts in zip(headings, *body)]
    rules = [_rule(*RULES[column.alignment], width) for column, width in zip(table.columns, widths)]
    parts = [f"# {table.title}"]
    parts += [f"> **Warning:** {notice}" for notice in table.notices]
    parts.append("\n".join(_line(texts, table.columns, widths) for texts in (headings, rules, *body)))
    parts.append(LEGEND)
    parts.append("\n".join(f"- {name}: {value}" for name, value in table.facts))
    return "\n\n".join(parts) + "\n"


def _text(cell: Cell) -> str:
    text = cell.text.replace("|", r"\|")
    return f"**{text}**" if cell.look in ("best", "bad") else text


def _rule(before: str, after: str, width: int) -> str:
    return before + "-" * (width - len(before) - len(after)) + after


def _line(texts: Sequence[str], columns: Sequence[Column], widths: Sequence[int]) -> str:
    """One line, padded so that it also stands straight as plain text."""
    padded = (f"{text:{PADDING[c.alignment]}{width}}" for text, c, width in zip(texts, columns, widths))
    return "| " + " | ".join(padded) + " |"
