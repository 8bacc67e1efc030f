"""Neighbours: rows of the paper's Table 1 that differ in one component, compared seed by seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sag.report.columns import ALONE, Column, Group
from sag.report.estimates import estimate_cell, written_p
from sag.report.lines import Line
from sag.report.measures import MOTION_FID, NON_COLLISION, Measure
from sag.report.paper import PaperFigures
from sag.report.statistics import Paired, paired
from sag.report.table import NONE, Cell, Table, TableRow

NEIGHBOURS = (("none", "m"), ("m", "md"), ("md", "mdc"), ("md", "mdp"), ("mdc", "mdpc"), ("mdp", "mdpc"))
"""Pairs of rows of Table 1, without and with one component more."""

TITLE = "Neighbouring rows of the paper's Table 1, paired by seed"

LEGEND = (
    "The row after the arrow against the one before it: FID as a ratio (of geometric means over seeds), NC as a "
    "difference, each seed against the same seed. p: of a paired t-test; "
    "p flip: of the exact sign-flip test, which assumes no distribution and with n pairs cannot fall below 2 / 2^n "
    "(0.0625 for 5). Neither p is corrected for the number of steps. Bold: the interval excludes no difference. "
    "Paper: the change of its printed averages."
)


@dataclass(frozen=True)
class Step:
    """One row against its neighbour in one measure.

    Attributes:
        before: the row without the component.
        after: the row with it.
        measure: what is compared.
        difference: after less before, on the measure's scale.
        printed: the same of the paper's averages, where it prints both.
    """

    before: str
    after: str
    measure: Measure
    difference: Paired
    printed: float | None = None

    @property
    def name(self) -> str:
        """Both rows."""
        return f"{self.before} → {self.after}"


def steps_of(lines: Sequence[Line], paper: PaperFigures) -> list[Step]:
    """Every step for which both rows have the figure for at least one seed in common; rows of one sweep."""
    rows = {line.name: line for line in lines if line.is_plain}
    pairs = [(before, after) for before, after in NEIGHBOURS if before in rows and after in rows]
    steps = (_step(rows[b], rows[a], measure, paper) for b, a in pairs for measure in (MOTION_FID, NON_COLLISION))
    return [step for step in steps if step]


def _step(before: Line, after: Line, measure: Measure, paper: PaperFigures) -> Step | None:
    first, second = before.values(measure.metric), after.values(measure.metric)
    seeds = sorted(set(first) & set(second))
    if not seeds:
        return None
    differences = [measure.scaled(second[seed]) - measure.scaled(first[seed]) for seed in seeds]
    cells = [paper.cells(line.paper_row).get(measure.metric) for line in (before, after)]
    printed = None if None in cells else measure.scaled(float(cells[1] or 0)) - measure.scaled(float(cells[0] or 0))
    return Step(before.name, after.name, measure, paired(differences), printed)


def neighbours_table(steps: Sequence[Step]) -> Table | None:
    """The table; none where no step has two seeds, since one seed has no interval."""
    if not any(step.difference.count > 1 for step in steps):
        return None
    columns = [Column(ALONE, "step", is_text=True)]
    for group in (RATIO, DIFFERENCE):
        columns += [Column(group, heading) for heading in ("n", "change", "95 %", "p", "p flip", "paper")]
    by_name = {(step.name, step.measure): step for step in steps}
    rows = []
    for name in dict.fromkeys(step.name for step in steps):
        cells = [cell for m in (MOTION_FID, NON_COLLISION) for cell in _cells(by_name.get((name, m)))]
        rows.append(TableRow("step", (Cell(name, "label"), *cells)))
    return Table(TITLE, tuple(columns), tuple(rows), LEGEND)


RATIO = Group("Motion FID ↓, ratio", "FID")
DIFFERENCE = Group("Non-collision ↑, difference", "NC")


def _cells(step: Step | None) -> list[Cell]:
    if step is None:
        return [Cell(NONE)] * 6
    difference, measure = step.difference, step.measure
    printed = "" if step.printed is None else measure.written(step.printed)
    return [
        Cell(str(difference.count)),
        estimate_cell(measure, difference),
        Cell(measure.interval(difference)),
        Cell(written_p(difference.p)),
        Cell(written_p(difference.p_flip)),
        Cell(printed, "paper"),
    ]
