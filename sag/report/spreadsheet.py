"""The rows as CSV: every figure with all its digits, every cell of the paper."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from sag.letters import LETTERS
from sag.report.lines import Line
from sag.report.paper import HORIZONS, RADII, PaperFigures
from sag.report.sections import COMPANIONS, SEES_MORE

PAPER_METRICS = tuple(f"motion_fid/{name}" for name in HORIZONS) + tuple(f"non_collision/{name}" for name in RADII)

OUR_METRICS = tuple(column.metric for section in (SEES_MORE, COMPANIONS) for column in section.columns)


def spreadsheet(lines: Sequence[Line], paper: PaperFigures) -> str:
    """One line for each row: state, letters as 0 or 1, every figure, the paper's cells, effort.

    A figure is its mean over seeds, `/deviation` their standard deviation, `/half` half of the mean's 95 % t-interval.

    Figures stand in their own units (metres, seconds, shares of 1). A cell is empty where there is nothing to say; NaN
    is written as `nan`.
    """
    measured = {name for line in lines for name in line.figures}
    metrics = [*PAPER_METRICS, *(name for name in OUR_METRICS if name in measured)]
    metrics += sorted(measured - set(metrics))
    rows = [_row(line, metrics, paper) for line in lines]
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _row(line: Line, metrics: Sequence[str], paper: PaperFigures) -> dict[str, object]:
    finished, unfinished = line.finished, line.unfinished
    components = line.components
    row: dict[str, object] = {"row": line.label, "method": finished[0].method if finished else ""}
    row |= {letter: int(components[name]) if components else "" for name, letter in LETTERS.items()}
    row["state"] = "finished" if finished else unfinished[0].state
    row["reason"] = "; ".join(f"{result.label}: {result.reason}" for result in unfinished)
    row |= {"n": len(finished), "seeds": " ".join(str(result.seed) for result in finished)}
    for name in metrics:
        figure = line.figures.get(name)
        row[name] = "" if figure is None else repr(figure.mean)
        spread = (None, None) if figure is None else (figure.deviation, figure.half_width)
        row |= {f"{name}/{kind}": "" if v is None else repr(v) for kind, v in zip(("deviation", "half"), spread)}
    printed = paper.cells(line.paper_row)
    row |= {f"paper/{name}": printed.get(name, "") for name in PAPER_METRICS}
    row["steps"] = max((result.steps for result in finished), default="")
    row["minutes"] = "" if line.minutes is None else round(line.minutes, 3)
    row["parameters"] = finished[0].parameters if finished else ""
    return row
