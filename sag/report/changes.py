"""Changes: every other row of a sweep against its row `start`, as a sweep over settings has one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sag.report.columns import ALONE, Column
from sag.report.estimates import estimate_with_interval, written_degrees
from sag.report.lines import START, Line
from sag.report.measures import (
    AWARENESS,
    DEPTH,
    FLOOR,
    INSIDE,
    MOTION_FID,
    SCALE,
    VELOCITY,
    Measure,
)
from sag.report.statistics import Compared, against_control
from sag.report.table import Cell, Table, TableRow

TITLE = "Every row against start"

MEASURED = (MOTION_FID, VELOCITY, AWARENESS, INSIDE, FLOOR, SCALE, DEPTH)

LEGEND = (
    "× marks a ratio (of geometric means over seeds) to the row start, all else are differences from it, with "
    "intervals of Dunnett's test: in each column the true values of all rows lie in theirs in 95 % of experiments. "
    "They rest on one variance for all rows (on the logarithmic scale for ratios), estimated from the scatter of "
    "seeds within each ({freedom} degrees of freedom). Bold: the interval excludes no change; the sign says to which "
    "side. Columns are not corrected for their number."
)


@dataclass(frozen=True)
class Change:
    """A row against `start` in one measure.

    Attributes:
        row: its name.
        measure: what is compared.
        difference: the row less `start`, on the measure's scale.
    """

    row: str
    measure: Measure
    difference: Compared


def changes_of(lines: Sequence[Line]) -> list[Change]:
    """Every row of one sweep against its `start`; nothing without that row or without several seeds.

    A measure that a row or `start` does not have is left out for it; one with NaN in any seed is NaN there, and the
    other rows are compared without it.
    """
    if START not in {line.name for line in lines}:
        return []
    return [change for measure in MEASURED for change in _changes(lines, measure)]


def _changes(lines: Sequence[Line], measure: Measure) -> list[Change]:
    values = {
        line.name: [measure.scaled(value) for value in line.values(measure.metric).values()]
        for line in lines
        if line.kind != "truth"
    }
    sound = {name: found for name, found in values.items() if found and not any(map(math.isnan, found))}
    if START not in sound:
        return []
    control, others = sound.pop(START), sound
    compared = dict(zip(others, against_control(list(others.values()), control)))
    broken = {name: Compared(math.nan) for name, found in values.items() if any(map(math.isnan, found))}
    found = {**compared, **broken}
    return [Change(name, measure, found[name]) for name in values if name in found]


def changes_table(changes: Sequence[Change]) -> Table | None:
    """A line for each row, a column for each measure; none without intervals."""
    freedoms = [change.difference.freedom for change in changes if change.difference.freedom]
    if not freedoms:
        return None
    by_name = {(change.row, change.measure): change.difference for change in changes}
    measures = list(dict.fromkeys(change.measure for change in changes))
    rows = []
    for name in dict.fromkeys(change.row for change in changes):
        cells = (estimate_with_interval(measure, by_name.get((name, measure))) for measure in measures)
        rows.append(TableRow("change", (Cell(name.replace("_", " "), "label"), *cells)))
    columns = (Column(ALONE, "row"), *(Column(ALONE, measure.label) for measure in measures))
    return Table(TITLE, columns, tuple(rows), LEGEND.format(freedom=written_degrees(freedoms)))
