"""Lines: one for each row of the ablation, its seeds taken together, in the order in which they are read."""

from __future__ import annotations

import math
import re
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from sag.errors import SagError
from sag.letters import LETTERS, row_name
from sag.report.results import BLIND, GROUND_TRUTH, PREPARATIONS, Result
from sag.report.statistics import half_width

Kind = Literal["without", "with", "blind", "method", "truth"]
"""What a row is: of the ablation without M or with it, blind to the scene, another method, ground truth; in order."""

START = "start"
"""The row with which a sweep over settings begins; each of the others changes one thing of it."""

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

    @property
    def half_width(self) -> float | None:
        """Half of the 95 % t-interval of the mean over seeds, or None for one seed."""
        return None if self.deviation is None else half_width(self.deviation, self.count)


@dataclass(frozen=True)
class Line:
    """A row of the table.

    Attributes:
        name: of the row, without a seed.
        components: component to on or off; None for a method without.
        results: its runs, one for each seed.
        figures: those that all of its finished runs have.
        sweep: where it comes from, if rows of several sweeps stand in one report and share names.
    """

    name: str
    components: dict[str, bool] | None
    results: tuple[Result, ...]
    figures: dict[str, Figure]
    sweep: str = ""

    @property
    def label(self) -> str:
        """The name, with its sweep where that is needed to tell rows apart."""
        return f"{self.name} ({self.sweep})" if self.sweep else self.name

    @property
    def finished(self) -> list[Result]:
        """Runs with figures."""
        return [result for result in self.results if result.finished]

    @property
    def unfinished(self) -> list[Result]:
        """Runs without."""
        return [result for result in self.results if not result.finished]

    @property
    def kind(self) -> Kind:
        """What it is."""
        special: dict[str, Kind] = {GROUND_TRUTH: "truth", BLIND: "blind"}
        if (first := self.name.partition("-")[0]) in special:
            return special[first]
        if self.components is None:
            return "method"
        return "with" if self.components["separate"] else "without"

    @property
    def in_ablation(self) -> bool:
        """Whether it is compared for the best of the ablation and with its twin."""
        return self.kind in ("without", "with")

    @property
    def is_plain(self) -> bool:
        """Whether its components are all that its name says, so that it is no variant of a row."""
        return self.components is not None and self.name == row_name(self.components)

    @property
    def paper_row(self) -> str:
        """What `sag.report.paper` calls this row."""
        return self.name

    def values(self, metric: str) -> dict[int, float]:
        """The figure of each seed that has it."""
        return {r.seed: r.metrics[metric] for r in self.finished if r.seed is not None and metric in r.metrics}

    @property
    def minutes(self) -> float | None:
        """Mean time of training and test."""
        times = [sum(result.seconds.values()) / 60 for result in self.finished]
        return statistics.fmean(times) if times else None


def lines_of(results: Sequence[Result]) -> list[Line]:
    """The lines of a table: rows without M, rows with M, blind ones, other methods, ground truth."""
    groups: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        if result.name not in PREPARATIONS:
            groups.setdefault((without_seed(result.name), result.sweep), []).append(result)
    return sorted((_line(name, sweep, group) for (name, sweep), group in groups.items()), key=_order)


def without_seed(name: str) -> str:
    """The name of a run's row."""
    return SEED.sub("", name)


def _line(name: str, sweep: str, results: Sequence[Result]) -> Line:
    finished = [result for result in results if result.finished]
    seeds = [result.seed for result in finished]
    if len(set(seeds)) < len(seeds):
        runs = ", ".join(result.name for result in finished)
        raise SagError(f"row {name} has several runs of one seed ({runs}); move all but one of them away")
    measured = [name for name in (finished[0].metrics if finished else ()) if all(name in r.metrics for r in finished)]
    figures = {name: Figure.of([result.metrics[name] for result in finished]) for name in measured}
    components = next((r.components for r in [*finished, *results] if r.components), None)
    return Line(name, components, tuple(results), figures, sweep)


def _order(line: Line) -> tuple[int, int, int, bool, str, str]:
    """By kind; then by how many components are on, in the order of the letters; `start` before its changes."""
    on = [bool(line.in_ablation and line.components and line.components.get(name)) for name in LETTERS]
    rank = sum(2**place for place, is_on in enumerate(on) if is_on)
    return (get_args(Kind).index(line.kind), sum(on), rank, line.name != START, line.name, line.sweep)


def twin_ratios(lines: Sequence[Line], metric: str = "motion_fid/average") -> dict[str, float]:
    """How many times larger a figure is without M than in the twin with M, by `name / twin`."""
    rows = {(line.name, line.sweep): line for line in lines if line.in_ablation and metric in line.figures}
    ratios = {}
    for line in rows.values():
        if line.components and line.kind == "without":
            twin = rows.get((row_name({**line.components, "separate": True}), line.sweep))
            if twin and twin.figures[metric].mean:
                ratios[f"{line.label} / {twin.label}"] = line.figures[metric].mean / twin.figures[metric].mean
    return ratios
