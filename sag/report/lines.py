"""Lines: one for each row of the ablation, its seeds taken together, in the order in which they are read."""

from __future__ import annotations

import math
import re
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from sag.errors import SagError
from sag.letters import LETTERS, row_name
from sag.report.results import GROUND_TRUTH, PREPARATIONS, Result

SEED = re.compile(r"-s\d+$")


@dataclass(frozen=True)
class Figure:
    """A figure over seeds.

    Attributes:
        mean: over the seeds; NaN when one of them is.
        deviation: sample standard deviation, or None for one seed.
        count: seeds.
    """

    mean: float
    deviation: float | None = None
    count: int = 1

    @classmethod
    def of(cls, values: Sequence[float]) -> Figure:
        """The figure of these seeds."""
        if any(math.isnan(value) for value in values):
            return cls(math.nan, None, len(values))
        return cls(statistics.fmean(values), statistics.stdev(values) if len(values) > 1 else None, len(values))


@dataclass(frozen=True)
class Line:
    """A row of the table.

    Attributes:
        name: of the row, without a seed.
        components: component to on or off; None for a method without.
        results: its runs, one for each seed.
        figures: of the runs that have finished.
    """

    name: str
    components: dict[str, bool] | None
    results: tuple[Result, ...]
    figures: dict[str, Figure]

    @property
    def finished(self) -> list[Result]:
        """Runs with figures."""
        return [result for result in self.results if result.finished]

    @property
    def unfinished(self) -> list[Result]:
        """Runs without."""
        return [result for result in self.results if not result.finished]

    @property
    def paper_row(self) -> str:
        """What `sag.report.paper` calls this row."""
        return row_name(self.components) if self.components and self.name == row_name(self.components) else self.name

    @property
    def minutes(self) -> float | None:
        """Mean time of training and test."""
        times = [sum(result.seconds.values()) / 60 for result in self.finished]
        return statistics.fmean(times) if times else None


def lines_of(results: Sequence[Result]) -> list[Line]:
    """The lines of a table: rows without M, rows with M, other methods, ground truth."""
    groups: dict[str, list[Result]] = {}
    for result in results:
        if result.name not in PREPARATIONS:
            groups.setdefault(SEED.sub("", result.name), []).append(result)
    return sorted((_line(name, group) for name, group in groups.items()), key=_order)


def _line(name: str, results: Sequence[Result]) -> Line:
    finished = [result for result in results if result.finished]
    seeds = [result.seed for result in finished]
    if len(set(seeds)) < len(seeds):
        runs = ", ".join(result.name for result in finished)
        raise SagError(f"row {name} has several runs of one seed ({runs}); move all but one of them away")
    names = dict.fromkeys(metric for result in finished for metric in result.metrics)
    figures = {n: Figure.of([r.metrics.get(n, math.nan) for r in finished]) for n in names}
    components = next((r.components for r in [*finished, *results] if r.components), None)
    return Line(name, components, tuple(results), figures)


def _order(line: Line) -> tuple[int, int, int, str]:
    """Without M before M; then by how many components are on, in the order of the letters."""
    if line.components is None:
        return (3 if line.name == GROUND_TRUTH else 2, 0, 0, line.name)
    on = [bool(line.components.get(name)) for name in LETTERS]
    rank = sum(2**place for place, is_on in enumerate(on) if is_on)
    return (int(on[0]), sum(on), rank, line.name)


def twin_ratios(lines: Sequence[Line], metric: str = "motion_fid/average") -> dict[str, float]:
    """How many times larger a figure is without M than in the twin with M, by `name / twin`."""
    means = {line.paper_row: line.figures[metric].mean for line in lines if line.components and metric in line.figures}
    ratios = {}
    for line in lines:
        if line.components and not line.components["separate"] and line.paper_row in means:
            twin = row_name({**line.components, "separate": True})
            if means.get(twin):
                ratios[f"{line.name} / {twin}"] = means[line.paper_row] / means[twin]
    return ratios
