"""The tables of a study's report: Table 5, changes, agreement, scores, raters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from sag.report.columns import ALONE, Column, Group
from sag.report.estimates import written_p
from sag.report.lines import without_seed
from sag.report.paper import TABLE_5, Opinion
from sag.report.statistics import Paired
from sag.report.table import NAME, NONE, Cell, Look, Table, TableRow
from sag.study.agreement import agreement_of
from sag.study.constancy import Constancy
from sag.study.folder import TRUTH
from sag.study.opinions import change, opinion_of
from sag.study.questions import HIGHEST, LOWEST, QUESTIONS, SCALE, Name
from sag.study.ratings import Rating

LABELS = {"none": "none (CSGN)", "md": "md (CSGN+M)", "mdpc": "mdpc (CSGN+M+G)", TRUTH: "ground truth"}
"""What the paper calls rows, behind our names."""

COLUMNS: dict[Name, str] = {"scene": "Scene", "human": "Human"}
"""What the paper calls its columns."""

SCALE_SAYS = f"Scores from {SCALE[0]} ({LOWEST}) to {SCALE[-1]} ({HIGHEST})."

OPINIONS = (
    f"{SCALE_SAYS} Scene: does the motion fit the scene; human: do the movements of the body fit its path. Mean and "
    "standard deviation of all scores, as in the paper's Table 5; 95 %: t-interval with raters as the unit. Bold: the "
    "best method. Motions that came again count once."
)

CHANGES = (
    "The mean of a method less that of the method before it, each rater compared with themselves; 95 % t-interval "
    "over raters and p of the paired t-test, not corrected for their number. Bold: the interval excludes no change. "
    "Paper: the change of its printed means."
)

AGREEMENT = (
    "α: Krippendorff's alpha for ordered scores, 1 for perfect agreement and 0 for chance's; 95 %: motions drawn again "
    "with replacement (2,000 times). Same, near: pairs of raters with the same score for a motion, or at most one "
    "apart."
)

SHARES = "How often a method got each score, in per cent of its answers."

RATERS = (
    "Apart: mean difference between the two scores of a motion that came again. With others: Kendall's τ of the "
    "rater's scores with the mean of the others'. Seconds: median time of an answer. Marked raters are left in; "
    "--without leaves out whom you name."
)


def paper_cells(data: str) -> dict[str, Opinion]:
    """The paper's Table 5 on the data set that is nearest to one of ours."""
    return TABLE_5["prox" if "prox" in data.lower() else "gta_im"]


def printed_of(paper: dict[str, Opinion], method: str, question: Name) -> tuple[float, float] | None:
    """The paper's mean and standard deviation of a method, whatever its seed, where it prints them."""
    row = paper.get(without_seed(method))
    return getattr(row, question) if row else None


def label_of(method: str) -> str:
    """What a method is called in tables."""
    return LABELS.get(method, method.replace("_", " "))


def opinions_table(ratings: Sequence[Rating], methods: Sequence[str], paper: dict[str, Opinion]) -> Table:
    """Table 5."""
    columns, rows = [NAME], []
    for question in QUESTIONS:
        group = Group(f"{COLUMNS[question.name]} ↑", COLUMNS[question.name])
        columns += [Column(group, "mean (std)"), Column(group, "95 %"), Column(group, "paper", paper=True)]
    best = {one.name: _best(ratings, methods, one.name) for one in QUESTIONS}
    for method in methods:
        cells, answers = [Cell(label_of(method), "label")], 0
        for question in QUESTIONS:
            found = opinion_of(ratings, method, question.name)
            looks: Look = "best" if method == best[question.name] else "plain"
            printed = printed_of(paper, method, question.name)
            shown = NONE if found is None else _mean(found.mean, found.deviation)
            interval = NONE if found is None or found.low is None else f"[{found.low:.2f}, {found.high:.2f}]"
            cells += [Cell(shown, looks), Cell(interval), Cell(_mean(*printed) if printed else "", "paper")]
            answers = found.answers if found else 0
        rows.append(TableRow(_kind(method), (*cells, Cell(f"{answers:,}"))))
    return Table("", (*columns, Column(ALONE, "answers")), tuple(rows), OPINIONS)


def _mean(mean: float, deviation: float | None) -> str:
    return f"{mean:.2f}" + ("" if deviation is None else f" ({deviation:.2f})")


def _best(ratings: Sequence[Rating], methods: Sequence[str], question: Name) -> str | None:
    """The method with the highest mean, the ground truth not among them."""
    found = {method: opinion_of(ratings, method, question) for method in methods if method != TRUTH}
    means = {method: one.mean for method, one in found.items() if one}
    return max(means, key=means.__getitem__) if len(means) > 1 else None


def _kind(method: str) -> str:
    return "truth" if method == TRUTH else "method"


def changes_table(ratings: Sequence[Rating], methods: Sequence[str], paper: dict[str, Opinion]) -> Table | None:
    """Each method against the one before it; nothing where no rater saw two."""
    columns, rows = [Column(ALONE, "step", is_text=True)], []
    for question in QUESTIONS:
        group = Group(COLUMNS[question.name], COLUMNS[question.name])
        columns += [Column(group, "change"), Column(group, "p"), Column(group, "paper", paper=True)]
    for before, after in pairwise(methods):
        cells = [Cell(f"{label_of(before)} → {label_of(after)}", "label")]
        for question in QUESTIONS:
            found = change(ratings, before, after, question.name)
            first, second = (printed_of(paper, method, question.name) for method in (before, after))
            step = f"{second[0] - first[0]:+.2f}" if first and second else ""
            cells += [_change(found), Cell(written_p(found.p if found else None)), Cell(step, "paper")]
        rows.append(TableRow("change", tuple(cells)))
    empty = all(cell.text == NONE for row in rows for cell in (row.cells[1], row.cells[4]))
    return None if empty else Table("Step by step, paired by rater", tuple(columns), tuple(rows), CHANGES)


def _change(found: Paired | None) -> Cell:
    if found is None:
        return Cell(NONE)
    if found.low is None:
        return Cell(f"{found.value:+.2f}")
    look: Look = "plain" if not found.excludes_zero else "best" if found.value > 0 else "worse"
    return Cell(f"{found.value:+.2f} [{found.low:+.2f}, {found.high:+.2f}]", look)


def agreement_table(ratings: Sequence[Rating]) -> Table | None:
    """How far raters agree; nothing where no motion was scored by two."""
    headings = ("α", "95 %", "motions", "same", "near")
    columns = (Column(ALONE, "question", is_text=True), *(Column(ALONE, heading) for heading in headings))
    rows = []
    for question in QUESTIONS:
        if found := agreement_of(ratings, question.name):
            unknown = math.isnan(found.alpha)
            interval = NONE if unknown else f"[{found.low:.2f}, {found.high:.2f}]"
            cells = (NONE if unknown else f"{found.alpha:.2f}", interval, f"{found.motions:,}")
            shares = (f"{100 * found.same:.0f} %", f"{100 * found.near:.0f} %")
            rows.append(TableRow("agreement", tuple(map(Cell, (question.title, *cells, *shares)))))
    return Table("Agreement of raters", columns, tuple(rows), AGREEMENT) if rows else None


def shares_table(ratings: Sequence[Rating], methods: Sequence[str]) -> Table:
    """How often each score was given."""
    groups = [Group(COLUMNS[question.name], COLUMNS[question.name]) for question in QUESTIONS]
    columns = [NAME, *(Column(group, str(score)) for group in groups for score in SCALE)]
    rows = []
    for method in methods:
        cells = [Cell(label_of(method), "label")]
        for question in QUESTIONS:
            found = opinion_of(ratings, method, question.name)
            shares = [f"{100 * count / found.answers:.0f}" for count in found.counts] if found else [NONE] * len(SCALE)
            cells += map(Cell, shares)
        rows.append(TableRow(_kind(method), tuple(cells)))
    return Table("How often each score was given", tuple(columns), tuple(rows), SHARES)


def raters_table(constancies: Sequence[Constancy]) -> Table:
    """How constant each rater is."""
    headings = ("answers", "seen twice", "apart", "with others", "seconds")
    columns = (
        Column(ALONE, "rater", is_text=True),
        *(Column(ALONE, heading) for heading in headings),
        Column(ALONE, "marks", is_text=True),
    )
    rows = []
    for one in constancies:
        apart = NONE if one.apart is None else f"{one.apart:.2f}"
        others = NONE if one.with_others is None else f"{one.with_others:.2f}"
        texts = (one.rater, f"{one.answers}", f"{one.twice}", apart, others, f"{one.seconds:.1f}")
        rows.append(TableRow("rater", (*map(Cell, texts), Cell("; ".join(one.marks), "bad" if one.marks else "plain"))))
    return Table("Raters", columns, tuple(rows), RATERS)
