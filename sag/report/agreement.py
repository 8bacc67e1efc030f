"""Agreement: whether the rows stand in the paper's order, by Kendall's rank correlation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sag.report.columns import ALONE, Column
from sag.report.estimates import written_p
from sag.report.lines import Line
from sag.report.measures import MOTION_FID, NON_COLLISION, Measure
from sag.report.paper import PaperFigures
from sag.report.statistics import bootstrap_kendalls, kendall, kendalls
from sag.report.table import NONE, Cell, Table, TableRow

TITLE = "Agreement with the paper's order"

LEAST_ROWS = 3
"""Rows below which an order says nothing."""

LEGEND = (
    "τ: Kendall's rank correlation of the rows' means with the paper's printed averages, 1 for the same order, -1 for "
    "the reverse; its p is two-sided and exact, against any order being as likely. By seed: τ of each seed's own rows, "
    "median [least, greatest]. Resampled: 95 % of the τ of means over seeds drawn again with replacement (10,000 "
    "times), rough for few seeds."
)


@dataclass(frozen=True)
class Agreement:
    """How far the rows of a sweep stand in the paper's order.

    Attributes:
        measure: by which they are ordered.
        rows: those for which the paper prints a figure.
        tau: of the rows' means; NaN where a mean is.
        p: two-sided, of independence.
        agreeing: pairs of rows in the paper's order.
        by_seed: τ of each seed that all rows have.
        low: 2.5 % of the resampled τ; None below two seeds.
        high: 97.5 % of them.
    """

    measure: Measure
    rows: tuple[str, ...]
    tau: float
    p: float
    agreeing: int
    by_seed: tuple[float, ...] = ()
    low: float | None = None
    high: float | None = None

    @property
    def pairs(self) -> int:
        """Pairs of rows."""
        return math.comb(len(self.rows), 2)


def agreements_of(lines: Sequence[Line], paper: PaperFigures) -> list[Agreement]:
    """For both of the paper's metrics; rows of one sweep. Nothing below `LEAST_ROWS` rows that the paper prints too."""
    found = (_agreement(lines, measure, paper) for measure in (MOTION_FID, NON_COLLISION))
    return [agreement for agreement in found if agreement]


def _agreement(lines: Sequence[Line], measure: Measure, paper: PaperFigures) -> Agreement | None:
    metric = measure.metric
    rows = [line for line in lines if metric in line.figures and metric in paper.cells(line.paper_row)]
    if len(rows) < LEAST_ROWS:
        return None
    printed = np.array([paper.cells(line.paper_row)[metric] for line in rows])
    means = np.array([line.figures[metric].mean for line in rows])
    tau, p = kendall(means.tolist(), printed.tolist()) if np.isfinite(means).all() else (math.nan, math.nan)
    agreeing = sum((means[i] - means[j]) * (printed[i] - printed[j]) > 0 for i, j in combinations(range(len(rows)), 2))
    found = Agreement(measure, tuple(line.name for line in rows), tau, p, int(agreeing))
    seeds = sorted(set.intersection(*(set(line.values(metric)) for line in rows)))
    values = np.array([[line.values(metric)[seed] for line in rows] for seed in seeds]).reshape(len(seeds), len(rows))
    if len(seeds) < 2 or not np.isfinite(values).all():
        return found
    return _over_seeds(found, values, printed)


def _over_seeds(found: Agreement, values: np.ndarray, printed: np.ndarray) -> Agreement:
    """With τ of each seed and the interval of resampled ones."""
    by_seed = tuple(float(tau) for tau in kendalls(values, printed))
    low, high = np.nanquantile(bootstrap_kendalls(values, printed), (0.025, 0.975)).tolist()
    return Agreement(found.measure, found.rows, found.tau, found.p, found.agreeing, by_seed, low, high)


def agreement_table(agreements: Sequence[Agreement]) -> Table | None:
    """The table; none where there is nothing to compare."""
    if not agreements:
        return None
    has_seeds = any(agreement.by_seed for agreement in agreements)
    headings = ["rows", "pairs in order", "τ", "p", *(["n", "by seed", "resampled"] if has_seeds else [])]
    columns = (Column(ALONE, "order by", is_text=True), *(Column(ALONE, heading) for heading in headings))
    rows = [TableRow("agreement", _cells(agreement, has_seeds)) for agreement in agreements]
    legend = LEGEND if has_seeds else LEGEND.partition(" By seed")[0]
    return Table(TITLE, columns, tuple(rows), legend)


def _cells(agreement: Agreement, has_seeds: bool) -> tuple[Cell, ...]:
    tau = Cell("NaN", "bad") if math.isnan(agreement.tau) else Cell(f"{agreement.tau:.2f}")
    cells = [
        Cell(agreement.measure.label, "label"),
        Cell(str(len(agreement.rows))),
        Cell(f"{agreement.agreeing} of {agreement.pairs}"),
        tau,
        Cell(written_p(agreement.p)),
    ]
    return (*cells, *_over_seeds_cells(agreement)) if has_seeds else tuple(cells)


def _over_seeds_cells(agreement: Agreement) -> list[Cell]:
    if not agreement.by_seed or agreement.low is None or agreement.high is None:
        return [Cell(NONE)] * 3
    taus = sorted(agreement.by_seed)
    return [
        Cell(str(len(taus))),
        Cell(f"{np.median(taus):.2f} [{taus[0]:.2f}, {taus[-1]:.2f}]"),
        Cell(f"[{agreement.low:.2f}, {agreement.high:.2f}]"),
    ]
