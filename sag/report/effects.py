"""Effects of the letters: what switching a component on changes, over all twins that differ in it alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Literal

import numpy as np

from sag.letters import LETTERS
from sag.report.lines import Line
from sag.report.measures import Measure
from sag.report.statistics import Estimate, Numbers, contrasts

Cell = tuple[bool, ...]
"""A combination of components, in the order of `LETTERS`."""

Source = Literal["seeds", "interactions", ""]
"""Where the error of an effect comes from: the seeds, three- and four-way interactions, or nowhere."""

Fitted = tuple[Estimate | None, int, Source]
"""An effect, the degrees of freedom of its error, and where that comes from."""

EVERY = tuple(product((False, True), repeat=len(LETTERS)))
UNKNOWN: Fitted = (Estimate(math.nan), 0, "")
WITHOUT_TWINS: Fitted = (None, 0, "")

SUBJECTS = tuple(c for order in (1, 2) for c in combinations(range(len(LETTERS)), order))
"""Main effects, then two-way interactions, as places in `LETTERS`."""


@dataclass(frozen=True)
class Effect:
    """What a component, or two together, change in a measure.

    Attributes:
        components: one for a main effect, two for an interaction.
        measure: of what.
        estimate: mean of the measure with the component less without; for two, half of what the second adds to the
            effect of the first. None where no rows are twins.
        twins: pairs of rows that differ in the component alone, or fours that differ in the two.
        source: of the interval.
        freedom: degrees of freedom of the error.
    """

    components: tuple[str, ...]
    measure: Measure
    estimate: Estimate | None = None
    twins: int = 0
    source: Source = ""
    freedom: int = 0

    @property
    def name(self) -> str:
        """The letters, such as `M` and `P×C`."""
        return "×".join(LETTERS[component] for component in self.components)


def effects_of(lines: Sequence[Line], measure: Measure) -> list[Effect]:
    """Main effects and two-way interactions in a measure; nothing where no row has it.

    With seeds: y = row + seed + e over the rows that an effect compares, the interval from what is left; the row's part
    is free, so that interactions of any order are no error. Other rows have no say in it, since seeds scatter some rows
    several times as much as others. With one seed and all 16 rows: y = mean + main effects + two-way interactions + e,
    in +-1 coding, so that three- and four-way interactions are the error. Effects whose rows hold NaN are NaN.
    """
    cells = _cells(lines, measure)
    weights = [_weights(subject, set(cells)) for subject in SUBJECTS]
    whole = {cell: seeds for cell, seeds in cells.items() if not any(map(math.isnan, seeds.values()))}
    known = [place for place, weight in enumerate(weights) if weight and set(weight) <= set(whole)]
    fitted = dict(zip(known, _fitted(whole, [SUBJECTS[k] for k in known], [weights[k] for k in known])))
    effects = []
    for place, (subject, weight) in enumerate(zip(SUBJECTS, weights) if cells else ()):
        estimate, freedom, source = fitted.get(place, UNKNOWN) if weight else WITHOUT_TWINS
        components = tuple(list(LETTERS)[k] for k in subject)
        twins = len(_twins(subject, set(cells)))
        effects.append(Effect(components, measure, estimate, twins, source, freedom))
    return effects


def _cells(lines: Sequence[Line], measure: Measure) -> dict[Cell, dict[int, float]]:
    """Scaled figures by seed of every plain row of the ablation that has them."""
    rows = [line for line in lines if line.in_ablation and line.components and line.is_plain]
    values = {tuple(line.components[name] for name in LETTERS): line.values(measure.metric) for line in rows}  # type: ignore[index]
    return {cell: {seed: measure.scaled(v) for seed, v in seeds.items()} for cell, seeds in values.items() if seeds}


def _twins(subject: Sequence[int], cells: set[Cell]) -> list[list[Cell]]:
    """Sets of rows that are equal in all components but the subject's, all of them there."""
    groups: dict[Cell, list[Cell]] = {}
    for cell in sorted(cells):
        rest = tuple(is_on for place, is_on in enumerate(cell) if place not in subject)
        groups.setdefault(rest, []).append(cell)
    return [group for group in groups.values() if len(group) == 2 ** len(subject)]


def _weights(subject: Sequence[int], cells: set[Cell]) -> dict[Cell, float]:
    """The contrast of rows that is an effect: the mean over twins, of with less without."""
    twins = _twins(subject, cells)
    size = len(twins) * 2 ** (len(subject) - 1)
    return {cell: float(_sign(subject, cell)) / size for group in twins for cell in group}


def _sign(subject: Sequence[int], cell: Cell) -> int:
    return math.prod(1 if cell[place] else -1 for place in subject)


def _fitted(
    cells: Mapping[Cell, Mapping[int, float]],
    subjects: Sequence[Sequence[int]],
    weights: Sequence[Mapping[Cell, float]],
) -> list[Fitted]:
    if sum(map(len, cells.values())) == len(EVERY) == len(cells):
        return _from_interactions(cells, subjects)
    return [_from_seeds({cell: cells[cell] for cell in weight}, weight) for weight in weights]


def _from_interactions(cells: Mapping[Cell, Mapping[int, float]], subjects: Sequence[Sequence[int]]) -> list[Fitted]:
    values = np.array([value for seeds in cells.values() for value in seeds.values()])
    design = np.array([[1] + [_sign(subject, cell) for subject in SUBJECTS] for cell in cells], dtype=float)
    wanted = 2 * np.array([[0] + [subject == other for other in SUBJECTS] for subject in subjects], dtype=float)
    fitted = contrasts(design, values, wanted)
    return [(estimate, fitted.freedom, "interactions") for estimate in fitted.estimates]


def _from_seeds(cells: Mapping[Cell, Mapping[int, float]], weight: Mapping[Cell, float]) -> Fitted:
    values = np.array([value for seeds in cells.values() for value in seeds.values()])
    design = _rows_and_seeds(cells)
    wanted = np.zeros((1, design.shape[1]))
    wanted[0, : len(cells)] = [weight[cell] for cell in cells]
    fitted = contrasts(design, values, wanted)
    return fitted.estimates[0], fitted.freedom, "seeds" if fitted.freedom else ""


def _rows_and_seeds(cells: Mapping[Cell, Mapping[int, float]]) -> Numbers:
    """A column for each row, then one for each seed, so that what a seed does to all rows is no error.

    Seeds have none where rows share too few: then they could not be told from the rows.
    """
    pairs = [(place, seed) for place, seeds in enumerate(cells.values()) for seed in seeds]
    seeds = sorted({seed for _, seed in pairs})
    rows = np.array([[place == other for other in range(len(cells))] for place, _ in pairs], dtype=float)
    blocks = np.array([[seed == other for other in seeds] for _, seed in pairs], dtype=float)
    both = np.hstack([rows, blocks])
    return both if np.linalg.matrix_rank(both) == len(cells) + len(seeds) - 1 else rows
