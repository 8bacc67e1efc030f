"""How an estimate and its p-value stand in a table."""

from __future__ import annotations

import math
from collections.abc import Iterable

from sag.report.measures import Measure
from sag.report.statistics import Estimate
from sag.report.table import NONE, Cell, Look

LOOKS: dict[str, Look] = {"better": "best", "worse": "worse", "": "plain"}


def estimate_cell(measure: Measure, estimate: Estimate) -> Cell:
    """A difference, marked where its interval points to one side."""
    if math.isnan(estimate.value):
        return Cell("NaN", "bad")
    return Cell(measure.written(estimate.value), LOOKS[measure.verdict(estimate)])


def estimate_with_interval(measure: Measure, estimate: Estimate | None) -> Cell:
    """A difference with its interval, where there is one; a dash where there is no difference."""
    if estimate is None:
        return Cell(NONE)
    cell, interval = estimate_cell(measure, estimate), measure.interval(estimate)
    return cell if interval == NONE or cell.look == "bad" else Cell(f"{cell.text} {interval}", cell.look)


def written_degrees(freedoms: Iterable[int]) -> str:
    """Degrees of freedom of several errors, or from which to which."""
    least, most = min(found := list(freedoms)), max(found)
    return f"{least}" if least == most else f"{least} to {most}"


def written_p(p: float | None) -> str:
    """A p-value with two digits that say something; a dash where there is none."""
    if p is None or math.isnan(p):
        return NONE
    if p < 0.001:
        return "<0.001"
    return f"{p:.3f}" if p < 0.1 else f"{p:.2f}"
