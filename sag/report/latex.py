"""The tables as LaTeX with booktabs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from sag.report.columns import Column
from sag.report.table import MARK, NONE, Cell, Report, Table

SPECIAL = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "±": r"$\pm$", "↓": r"$\downarrow$", "↑": r"$\uparrow$",
    MARK: r"\checkmark", NONE: "--", "<": r"$<$", ">": r"$>$",
    "∞": r"$\infty$", "δ": r"$\delta$", "₁": "$_1$", "×": r"$\times$", "²": "$^2$", "³": "$^3$", "é": r"\'e",
    "→": r"$\to$", "τ": r"$\tau$", "α": r"$\alpha$",
}  # fmt: skip
"""Characters that LaTeX reads otherwise, or not at all."""


def latex(report: Report) -> str:
    """Each table as a float; notices stand below the first, facts below the last. Wants the packages of line one."""
    floats = ["% \\usepackage{booktabs, amssymb, graphicx}"]
    for table in report.tables:
        notices = report.notices if table is report.tables[0] else ()
        facts = report.facts if table is report.tables[-1] else ()
        below = [f"\\textbf{{{escaped(notice)}}}\\par" for notice in notices]
        below += [f"{escaped(table.legend)}\\par"]
        below += [f"{escaped(name)}: {escaped(value)}\\par" for name, value in facts]
        floats += _float(table, ": ".join(filter(None, (report.title, table.title))), below)
    return "\n".join([*floats, ""])


def _float(table: Table, caption: str, below: Sequence[str]) -> list[str]:
    lines = [
        "\\begin{table*}",
        "\\centering",
        f"\\caption{{{escaped(caption)}}}",
        "\\resizebox{\\textwidth}{!}{%",
        f"\\begin{{tabular}}{{{''.join(map(_alignment, table.columns))}}}",
        "\\toprule",
        *_headings(table.columns),
        "\\midrule",
    ]
    for place, (_, rows) in enumerate(groupby(table.rows, key=lambda row: row.kind)):
        lines += ["\\midrule"] if place else []
        lines += [" & ".join(map(_text, row.cells)) + r" \\" for row in rows]
    lines += ["\\bottomrule", "\\end{tabular}}", "\\par\\smallskip\\raggedright\\footnotesize"]
    return [*lines, *below, "\\end{table*}"]


def _alignment(column: Column) -> str:
    return {"left": "l", "center": "c", "right": "r"}[column.alignment]


def _headings(columns: Sequence[Column]) -> list[str]:
    """Two lines: headings over several columns with their rules, then each column's own."""
    cells, rules, place = [], [], 1
    for group, members in groupby(columns, key=lambda column: column.group.title):
        count = len(list(members))
        cells.append(f"\\multicolumn{{{count}}}{{c}}{{{escaped(group)}}}")
        rules += [f"\\cmidrule(lr){{{place}-{place + count - 1}}}"] if group else []
        place += count
    own = " & ".join(escaped(column.label) for column in columns)
    return [" & ".join(cells) + r" \\", "".join(rules), own + r" \\"]


def _text(cell: Cell) -> str:
    text = escaped(cell.text)
    return f"\\textbf{{{text}}}" if cell.look in ("best", "worse", "bad") else text


def escaped(text: str) -> str:
    """Text in which every character means itself."""
    return "".join(SPECIAL.get(character, character) for character in text)
