"""Evidence: what the seeds of each sweep say about its rows, for behind a report's own tables and as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from sag.report.agreement import Agreement, agreement_table, agreements_of
from sag.report.changes import Change, changes_of, changes_table
from sag.report.letters import Letters, letters_of, letters_tables
from sag.report.lines import START, Line
from sag.report.neighbours import Step, neighbours_table, steps_of
from sag.report.paper import PaperFigures
from sag.report.table import Report, Table

HEADINGS = ("sweep", "kind", "subject", "measure", "scale", "estimate", "low", "high", "p", "p_flip", "n", "freedom")


@dataclass(frozen=True)
class Evidence:
    """What the rows of one sweep say together.

    Attributes:
        sweep: its name, where rows of several stand in one report and share names.
        steps: neighbouring rows of the paper's Table 1.
        agreements: with the paper's order.
        letters: effects of the components.
        changes: each row against the one named `start`, where there is one.
    """

    sweep: str
    steps: tuple[Step, ...]
    agreements: tuple[Agreement, ...]
    letters: Letters
    changes: tuple[Change, ...]

    @property
    def tables(self) -> list[Table]:
        """Changes, neighbours, agreement, letters: those that the data give."""
        tables = [
            changes_table(self.changes),
            neighbours_table(self.steps),
            agreement_table(self.agreements),
            *letters_tables(self.letters),
        ]
        suffix = f" ({self.sweep})" if self.sweep else ""
        return [replace(table, title=table.title + suffix) for table in tables if table]


def evidence_of(lines: Sequence[Line], paper: PaperFigures) -> list[Evidence]:
    """The evidence of each sweep: rows of different sweeps are no neighbours."""
    sweeps = dict.fromkeys(line.sweep for line in lines if line.kind != "truth")
    groups = {sweep: [line for line in lines if line.sweep == sweep] for sweep in sweeps}
    return [
        Evidence(
            sweep,
            tuple(steps_of(rows, paper)),
            tuple(agreements_of(rows, paper)),
            letters_of(rows),
            tuple(changes_of(rows)),
        )
        for sweep, rows in groups.items()
    ]


def with_evidence(report: Report, evidence: Sequence[Evidence]) -> Report:
    """The report with the tables of evidence behind its own."""
    return replace(report, tables=(*report.tables, *(table for part in evidence for table in part.tables)))


def statistics_csv(evidence: Sequence[Evidence]) -> str:
    """Everything that the tables of evidence say, with all digits, a line for each estimate; empty where there is none.

    Estimates of scale `ratio` are ratios, of `difference` differences in the figure's own unit, of `tau` rank
    correlations.
    """
    rows = [{"sweep": part.sweep, **row} for part in evidence for row in _rows(part)]
    if not rows:
        return ""
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=HEADINGS, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: "" if value is None else value for name, value in row.items()} for row in rows)
    return text.getvalue()


def _rows(evidence: Evidence) -> Iterator[dict[str, object]]:
    if any(step.difference.count > 1 for step in evidence.steps):
        for step in evidence.steps:
            difference = step.difference
            row = {"kind": "neighbours", "subject": step.name.replace("→", "to"), **step.measure.record(difference)}
            yield {**row, "p": difference.p, "p_flip": difference.p_flip, "n": difference.count}
    for agreement in evidence.agreements:
        row = {"kind": "agreement", "subject": " ".join(agreement.rows), "measure": agreement.measure.metric}
        row |= {"scale": "tau", "estimate": agreement.tau, "low": agreement.low, "high": agreement.high}
        yield {**row, "p": agreement.p, "n": len(agreement.by_seed) or None}
    for effects in evidence.letters.effects.values() if evidence.letters.have_intervals else ():
        for effect in effects:
            if effect.estimate:
                row = {"kind": "letters", "subject": effect.name.replace("×", "x")}
                yield {**row, **effect.measure.record(effect.estimate), "n": effect.twins, "freedom": effect.freedom}
    for change in evidence.changes:
        if found := change.difference.freedom:
            row = {"kind": "changes", "subject": f"{START} to {change.row}", **change.measure.record(change.difference)}
            yield {**row, "p": change.difference.p, "n": change.difference.count, "freedom": found}
