"""`sag study report`: what the answers say, as tables, a plot and plain data."""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from sag.errors import SagError
from sag.files import writing_in
from sag.report.files import draw
from sag.report.html import html
from sag.report.latex import latex
from sag.report.markdown import markdown
from sag.report.paper import Opinion, paper_figures
from sag.report.plot import svg_of
from sag.report.table import Report
from sag.report.terminal import UNBOUNDED, show
from sag.study.constancy import constancies_of
from sag.study.folder import Study, read_study
from sag.study.handouts import read_returned
from sag.study.opinions import opinion_of
from sag.study.plotting import plot_of
from sag.study.questions import QUESTIONS
from sag.study.ratings import Rating, first_ones, ratings_of
from sag.study.store import Store
from sag.study.tables import (
    agreement_table,
    changes_table,
    opinions_table,
    paper_cells,
    printed_of,
    raters_table,
    shares_table,
)
from sag.text import plain

OPINIONS_HEAD = (
    "method", "question", "mean", "deviation", "low", "high", "answers", "raters", "paper_mean", "paper_deviation",
)  # fmt: skip

ANSWERS_HEAD = ("rater", "turn", "window", "method", "again", "scene", "human", "seconds", "plays")


def report(asked: argparse.Namespace) -> int:
    """Writes the report and shows it; returns the exit status 0.

    Raises:
        SagError: there is no study or no answer, or a file that came back is refused; the sentence names it.
    """
    study = read_study(asked.study)
    ratings = read_ratings(study, asked.returned, asked.without)
    told = report_of(study, ratings, asked.without)
    out = asked.out or asked.study / "report"
    with writing_in(out, "give another folder by --out"):
        _write(study, told, ratings, out)
    console = Console()
    show(told, console if console.is_terminal else Console(width=UNBOUNDED))
    names = "table.md, .csv, .tex, .html; plot.png, .svg; answers.csv"
    console.print(f"\nreport: {plain(str(out))} ({names})", markup=False, highlight=False, soft_wrap=True)
    return 0


def read_ratings(study: Study, returned: Sequence[Path] = (), without: Sequence[str] = ()) -> list[Rating]:
    """All answers of a study, those of files that came back among them.

    Args:
        study: that was made.
        returned: files of answers.
        without: raters to leave out.

    Raises:
        SagError: there are no answers, a file is refused, or a rater to leave out is unknown.
    """
    store = Store(study.answers)
    raters, answers = store.raters(), store.answers()
    store.close()
    answers += read_returned(study, raters, returned)
    known = {answer.rater for answer in answers}
    if unknown := [name for name in without if name not in known]:
        raise SagError(f"--without {unknown[0]} is no rater who has answered; the table of raters has their names")
    left = [answer for answer in answers if answer.rater not in without]
    if not left:
        raise SagError(f"{study.folder} has no answers yet; sag study serve {study.folder} collects them")
    return ratings_of(study, raters, left)


def report_of(study: Study, ratings: Sequence[Rating], without: Sequence[str] = ()) -> Report:
    """The report of these ratings.

    Args:
        study: that they belong to.
        ratings: of all raters, motions that came again among them.
        without: raters who were left out.
    """
    made, first = study.settings, first_ones(ratings)
    paper, methods = paper_cells(made.data), made.methods
    tables = (
        opinions_table(first, methods, paper),
        changes_table(first, methods, paper),
        agreement_table(first),
        shares_table(first, methods),
        raters_table(constancies_of(ratings, made.frames / made.fps)),
    )
    notices = _notices(study, ratings, without)
    return Report(_title(study), tuple(table for table in tables if table), notices, _facts(study, ratings))


def _title(study: Study) -> str:
    return f"User study on {study.settings.data}"


def _notices(study: Study, ratings: Sequence[Rating], without: Sequence[str]) -> tuple[str, ...]:
    """What must be known before the tables are read."""
    notices, found = [], constancies_of(ratings, study.settings.frames / study.settings.fps)
    if len(found) < 2:
        notices.append("one rater gives no interval: ask more")
    if unfinished := sum(one.answers < study.design.turns for one in found):
        notices.append(f"{unfinished} of {len(found)} raters have not answered everything; what they answered counts")
    if marked := sum(bool(one.marks) for one in found):
        notices.append(f"{marked} of {len(found)} raters are marked in the table of raters; they are not left out")
    if without:
        notices.append(f"left out by --without: {', '.join(without)}")
    return tuple(notices)


def _facts(study: Study, ratings: Sequence[Rating]) -> tuple[tuple[str, str], ...]:
    made, design = study.settings, study.design
    source = paper_figures(made.data).source
    return (
        ("answers", f"{len(ratings):,} by {len({rating.rater for rating in ratings})} raters"),
        ("shown", f"{len(made.windows)} scenes, {design.turns} motions for each rater, {design.repeats} of them twice"),
        ("motions", f"{made.frames / made.fps:.2f} s at {made.fps:g} fps; drawn with seed {made.sampling_seed}"),
        ("data", f"{made.data} {made.fingerprint}; the paper's cells are of {source}, other scenes and other raters"),
        ("made", f"{made.made} by sag {made.version}"),
    )


def _write(study: Study, told: Report, ratings: Sequence[Rating], out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    made, first = study.settings, first_ones(ratings)
    paper = paper_cells(made.data)
    plot = plot_of(first, made.methods, paper, told.title, paper_figures(made.data).source)
    texts = {
        "table.md": markdown(told),
        "table.tex": latex(told),
        "table.html": html(told, svg_of(plot)),
        "table.csv": opinions_csv(first, made.methods, paper),
        "answers.csv": answers_csv(study, ratings),
    }
    for name, text in texts.items():
        (out / name).write_text(text, encoding="utf-8")
    draw(plot, out, "plot")


def opinions_csv(ratings: Sequence[Rating], methods: Sequence[str], paper: dict[str, Opinion]) -> str:
    """Every figure of Table 5 with all its digits, a line for each method and question."""
    lines: list[Sequence[object]] = [OPINIONS_HEAD]
    for method in methods:
        for question in QUESTIONS:
            printed = printed_of(paper, method, question.name) or ("", "")
            if found := opinion_of(ratings, method, question.name):
                figures = (found.mean, found.deviation, found.low, found.high, found.answers, found.raters)
                lines.append((method, question.name, *figures, *printed))
    return _csv(lines)


def answers_csv(study: Study, ratings: Sequence[Rating]) -> str:
    """Every answer, no longer blind: for statistics of your own."""
    lines: list[Sequence[object]] = [ANSWERS_HEAD]
    for rating in ratings:
        answer = rating.answer
        about = (rating.rater, answer.turn, study.settings.windows[rating.scene], rating.method, int(rating.again))
        lines.append((*about, answer.scores["scene"], answer.scores["human"], answer.seconds, answer.plays))
    return _csv(lines)


def _csv(lines: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    return text.getvalue()
