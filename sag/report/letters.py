"""Letters: what M, D, P and C change, alone and two together, and whether each does what it is for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sag.letters import LETTERS
from sag.report.columns import ALONE, ARROWS, Column
from sag.report.effects import EVERY, Effect, effects_of
from sag.report.estimates import estimate_cell, estimate_with_interval, written_degrees
from sag.report.lines import Line
from sag.report.measures import MEASURES, OWN, Measure
from sag.report.table import NONE, Cell, Look, Table, TableRow

OWN_TITLE = "Each letter on its own measure"
MAIN_TITLE = "Letters: what each changes"
TOGETHER_TITLE = "Letters: what two change together"

OWN_LEGEND = (
    "What each component is for, the same in every report. Effect: the mean over all twins, rows that differ in this "
    "letter alone, of with less without, or of their ratio. It holds where the 95 % interval excludes no effect on the "
    "expected side. Only rows with D estimate depth, so that D has no twins there."
)
MAIN_LEGEND = "× marks a ratio, with over without; all else are differences, with less without."
TOGETHER_LEGEND = (
    "Half of what one letter adds to the effect of the other, so that these compare with the effects above: no effect "
    "(×1 or 0) where the two act independently."
)
BOTH_LEGEND = (
    "Bold: the 95 % interval excludes no effect; the sign says to which side. Of twenty intervals one does so by "
    "chance, and they are not corrected for their number."
)


@dataclass(frozen=True)
class Letters:
    """All effects of a sweep.

    Attributes:
        effects: by measure, in the order of `MEASURES`; main effects, then interactions.
    """

    effects: dict[Measure, list[Effect]]

    @property
    def have_intervals(self) -> bool:
        """Whether any effect has one: without seeds and without all 16 rows there is none to show."""
        return any(effect.source for effects in self.effects.values() for effect in effects)

    @property
    def error(self) -> str:
        """Where the intervals come from, in a sentence."""
        shown = [effect for effects in self.effects.values() for effect in effects if effect.source]
        degrees = written_degrees(effect.freedom for effect in shown)
        if any(effect.source == "interactions" for effect in shown):
            return (
                f"One seed: the error is taken from three- and four-way interactions ({degrees} degrees of freedom), "
                "as if these were chance alone; seeds say more."
            )
        return (
            "The error is that of seeds within the rows that an effect compares, what a seed does to all of them left "
            f"out ({degrees} degrees of freedom)."
        )


def letters_of(lines: Sequence[Line]) -> Letters:
    """Effects in every measure that rows have; rows of one sweep."""
    effects = {measure: effects_of(lines, measure) for measure in MEASURES}
    return Letters({measure: found for measure, found in effects.items() if found})


def letters_tables(letters: Letters) -> list[Table]:
    """The small table of own measures, then main effects, then interactions where any can be told."""
    if not letters.have_intervals:
        return []
    main = _effects_table(letters, 1, MAIN_TITLE, MAIN_LEGEND)
    together = _effects_table(letters, 2, TOGETHER_TITLE, TOGETHER_LEGEND)
    return [_own_table(letters), main, *([together] if len(together.columns) > 1 else [])]


def _effects_table(letters: Letters, order: int, title: str, legend: str) -> Table:
    """A line for each measure, a column for each effect of this many letters."""
    names = [
        name
        for name in dict.fromkeys(e.name for effects in letters.effects.values() for e in effects if _is(e, order))
        if any(e.name == name and e.estimate for effects in letters.effects.values() for e in effects)
    ]
    rows = []
    for measure, effects in letters.effects.items():
        by_name = {effect.name: effect for effect in effects}
        cells = (estimate_with_interval(measure, by_name[name].estimate) for name in names)
        rows.append(TableRow("effect", (Cell(measure.label, "label"), *cells)))
    columns = (Column(ALONE, "measure", is_text=True), *(Column(ALONE, name, is_figure=True) for name in names))
    return Table(title, columns, tuple(rows), " ".join((legend, letters.error, BOTH_LEGEND, _twins(letters))).strip())


def _is(effect: Effect, order: int) -> bool:
    return len(effect.components) == order


def _twins(letters: Letters) -> str:
    """How many twins there are where not all 16 rows are there."""
    first = next(iter(letters.effects.values()))
    counts = {effect.name: effect.twins for effect in first if _is(effect, 1)}
    if all(count == len(EVERY) // 2 for count in counts.values()):
        return ""
    return f"Twins: {', '.join(f'{name} {count}' for name, count in counts.items())} of 8."


def _own_table(letters: Letters) -> Table:
    headings = ("expected", "twins", "effect", "95 %", "verdict")
    columns = (Column(ALONE, "letter", is_text=True), Column(ALONE, "measure", is_text=True))
    rows = [_own_row(letters, component, measure) for component, measure in OWN]
    legend = f"{OWN_LEGEND} {letters.error}"
    return Table(OWN_TITLE, (*columns, *(Column(ALONE, heading) for heading in headings)), tuple(rows), legend)


def _own_row(letters: Letters, component: str, measure: Measure) -> TableRow:
    effect = next((e for e in letters.effects.get(measure, ()) if e.components == (component,)), None)
    name = " ".join(filter(None, (measure.name, measure.unit)))
    head = (Cell(LETTERS[component], "label"), Cell(name), Cell(f"{ARROWS[measure.better]} {measure.better}"))
    verdict = Cell(*verdict_of(effect))
    if effect is None or effect.estimate is None:
        return TableRow("own", (*head, Cell(NONE), Cell(NONE), Cell(NONE), verdict))
    found, interval = estimate_cell(measure, effect.estimate), Cell(measure.interval(effect.estimate))
    return TableRow("own", (*head, Cell(str(effect.twins)), found, interval, verdict))


def verdict_of(effect: Effect | None) -> tuple[str, Look]:
    """Whether a letter does what it is for, in words: its effect on its own measure, None where no row has that."""
    if effect is None:
        return "not measured", "plain"
    if effect.estimate is None:
        return "no twins", "plain"
    if math.isnan(effect.estimate.value):
        return "NaN", "bad"
    if not effect.source:
        return "no interval", "plain"
    verdicts: dict[str, tuple[str, Look]] = {
        "better": ("holds", "best"),
        "worse": ("points the other way", "worse"),
        "": ("does not hold", "plain"),
    }
    return verdicts[effect.measure.verdict(effect.estimate)]
