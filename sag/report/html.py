"""The report as one HTML file that needs nothing else, in light and in dark."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from html import escape
from itertools import groupby

from sag.report.columns import Column
from sag.report.table import Cell, Report, Table

STYLE = """
:root { color-scheme: light dark; --ink: #1d2330; --soft: #667085; --line: #e3e6ec; --page: #f6f7f9; --card: #fff;
  --good: #0b6e4f; --bad: #b42318; --bad-back: #fee4e2; --stripe: #f9fafb; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e8ee; --soft: #98a2b3; --line: #2c3341; --page: #11141b;
  --card: #181d27; --good: #5fd3a8; --bad: #fda29b; --bad-back: #55160c; --stripe: #1c222d; } }
* { box-sizing: border-box; }
body { margin: 0; padding: 2rem 1rem; background: var(--page); color: var(--ink);
  font: 14.5px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
main { max-width: 1400px; margin: 0 auto; }
h1 { font-size: 1.5rem; margin: 0 0 1rem; }
h2 { font-size: 1.15rem; margin: 2rem 0 .8rem; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 12px; overflow-x: auto;
  margin: 0 0 1.25rem; }
.notice { background: var(--bad-back); color: var(--bad); border-radius: 10px; padding: .6rem 1rem; margin: 0 0 .6rem;
  font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: .88rem; font-variant-numeric: tabular-nums;
  white-space: nowrap; }
th, td { padding: .38rem .34rem; text-align: right; }
th:last-child, td:last-child { padding-right: 1rem; }
thead th { font-weight: 600; color: var(--soft); font-size: .82rem; line-height: 1.25; vertical-align: bottom;
  white-space: normal; }
thead tr.groups th { text-align: center; color: var(--ink); padding-top: .8rem; }
thead tr.groups th:not(:empty) { border-bottom: 1px solid var(--line); }
thead tr:last-child th { border-bottom: 2px solid var(--line); }
th.left, td.left { text-align: left; font-weight: 600; padding-left: 1rem; min-width: 9.5rem; white-space: normal;
  position: sticky; left: 0; background: var(--card); }
th.center, td.center { text-align: center; padding: .38rem .15rem; }
td small { display: block; font-size: .85em; font-weight: 400; line-height: 1.1; color: var(--soft); }
tbody + tbody tr:first-child td { border-top: 2px solid var(--line); }
tbody tr:nth-child(even), tbody tr:nth-child(even) td.left { background: var(--stripe); }
td.best { color: var(--good); font-weight: 700; }
td.worse { color: var(--bad); font-weight: 700; }
td.bad { color: var(--bad); background: var(--bad-back); font-weight: 700; }
td.paper { color: var(--soft); }
figure { margin: 0; padding: 1rem; min-width: 720px; }
figure svg { width: 100%; height: auto; color: var(--ink); }
p.legend { color: var(--soft); font-size: .9rem; margin: 0 0 1.25rem; }
dl { display: grid; grid-template-columns: minmax(9rem, 14rem) 1fr; gap: .35rem 1rem; margin: 0; padding: 1rem; }
dl.sheets { grid-template-columns: minmax(6rem, 10rem) 1fr; align-items: center; }
dl.sheets dt { color: var(--ink); font-weight: 600; } dl.sheets img { width: 100%; max-width: 972px; display: block;
  border-radius: 6px; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
"""


SHORT = 9
"""Characters of a heading that are not worth a second line."""

NO_BREAK = "&nbsp;"


def html(report: Report, plot: str, further_plots: Sequence[str] = (), sheets: Sequence[tuple[str, bytes]] = ()) -> str:
    """The page.

    Args:
        report: with all of the paper's cells.
        plot: an SVG element drawn in `currentColor`, for below the first table.
        further_plots: more of them, for below the last.
        sheets: contact sheets of rows, a name and a PNG each, for below all.
    """
    notices = "\n".join(f'<p class="notice">{escape(notice)}</p>' for notice in report.notices)
    facts = "\n".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in report.facts)
    title = escape(report.title)
    first, *further = map(_section, report.tables)
    further += [*map(_drawing, further_plots), _sheets(sheets)]
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{STYLE}</style>
</head>
<body><main>
<h1>{title}</h1>
{notices}
{first}
{_drawing(plot)}
{"".join(further)}
<div class="card"><dl>
{facts}
</dl></div>
</main></body>
</html>
"""


def _drawing(plot: str) -> str:
    return f'<div class="card"><figure>{plot}</figure></div>\n'


def _sheets(sheets: Sequence[tuple[str, bytes]]) -> str:
    if not sheets:
        return ""
    pictures = "\n".join(
        f'<dt>{escape(name)}</dt><dd><img alt="samples of {escape(name)}" '
        f'src="data:image/png;base64,{base64.b64encode(content).decode()}"></dd>'
        for name, content in sheets
    )
    return f"""<h2>Samples</h2>
<div class="card"><dl class="sheets">
{pictures}
</dl></div>
<p class="legend">A motion for each of the same test windows: six poses from the given one (dark) to the last (bright).
</p>
"""


def _section(table: Table) -> str:
    heading = f"<h2>{escape(table.title)}</h2>\n" if table.title else ""
    return f"""{heading}<div class="card"><table>
<thead>
{_headings(table.columns)}
</thead>
{_bodies(table)}
</table></div>
<p class="legend">{escape(table.legend)}</p>
"""


def _headings(columns: Sequence[Column]) -> str:
    groups = [(group, len(list(members))) for group, members in groupby(columns, key=lambda column: column.group.title)]
    over = "".join(f'<th colspan="{count}">{escape(group)}</th>' for group, count in groups)
    own = "".join(f'<th class="{column.alignment}">{_heading(column)}</th>' for column in columns)
    return f'<tr class="groups">{over}</tr>\n<tr>{own}</tr>'


def _heading(column: Column) -> str:
    """A heading of one line where it is short, and never a line for its arrow alone."""
    label = escape(column.label)
    spaces = label.count(" ") if len(column.label) <= SHORT else int(column.label != column.heading)
    return NO_BREAK.join(label.rsplit(" ", spaces))


def _bodies(table: Table) -> str:
    bodies = []
    for kind, rows in groupby(table.rows, key=lambda row: row.kind):
        lines = []
        for row in rows:
            pairs = zip(table.columns, row.cells)
            cells = (f'<td class="{column.alignment} {cell.look}">{_text(cell)}</td>' for column, cell in pairs)
            lines.append(f"<tr>{''.join(cells)}</tr>")
        bodies.append(f'<tbody class="{kind}">' + "\n".join(lines) + "</tbody>")
    return "\n".join(bodies)


def _text(cell: Cell) -> str:
    """An interval stands below its mean, so that wide tables stay readable."""
    return re.sub(r" (±.*|\[.*\])$", r"<small>\1</small>", escape(cell.text))
