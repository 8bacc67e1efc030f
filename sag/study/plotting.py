"""The plot of a study: what raters think of each method, the paper's means beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib

from sag.report.paper import Opinion
from sag.report.plot import GRID, INK, STYLE
from sag.study.folder import TRUTH
from sag.study.opinions import opinion_of
from sag.study.questions import HIGHEST, LOWEST, QUESTIONS, SCALE, Question
from sag.study.ratings import Rating
from sag.study.tables import label_of, printed_of

OURS, REAL = "#0072B2", "#009E73"
"""Colours of methods and of the ground truth (Okabe and Ito)."""


def plot_of(
    ratings: Sequence[Rating], methods: Sequence[str], paper: dict[str, Opinion], title: str, source: str
) -> Any:
    """A matplotlib figure: a panel for each question, a dot with its 95 % interval for each method.

    Args:
        ratings: each motion once for each rater.
        methods: from top to bottom.
        paper: its means, by method.
        title: of the figure.
        source: of the paper's means.
    """
    from matplotlib.figure import Figure as Canvas
    from matplotlib.lines import Line2D

    with matplotlib.rc_context(STYLE):
        canvas = Canvas(figsize=(9.5, 1.7 + 0.42 * len(methods)), layout="constrained")
        canvas.suptitle(title, fontweight="bold", fontsize=12, color=INK)
        panels = canvas.subplots(1, len(QUESTIONS), sharey=True)
        for axes, question in zip(panels, QUESTIONS):
            _panel(axes, ratings, methods, paper, question)
        panels[0].set_yticks(range(len(methods)), [label_of(method) for method in methods])
        panels[0].set_ylim(len(methods) - 0.5, -0.5)
        hollow: Any = {"markerfacecolor": "none", "markeredgecolor": INK}
        marks = [Line2D([], [], marker="o", linestyle="", color=OURS, label="mean and 95 % interval over raters")]
        marks += [Line2D([], [], marker="D", linestyle="", label=f"printed in the paper ({source})", **hollow)]
        canvas.legend(handles=marks, loc="outside lower center", ncols=2, frameon=False)
    return canvas


def _panel(
    axes: Any, ratings: Sequence[Rating], methods: Sequence[str], paper: dict[str, Opinion], question: Question
) -> None:
    for place, method in enumerate(methods):
        axes.axhline(place, color=GRID, alpha=0.25, linewidth=0.8, zorder=0)
        if printed := printed_of(paper, method, question.name):
            axes.plot(printed[0], place, "D", markersize=7, markerfacecolor="none", markeredgecolor=INK, zorder=2)
        found = opinion_of(ratings, method, question.name)
        if found:
            half = None if found.low is None or found.high is None else (found.high - found.low) / 2
            colour = REAL if method == TRUTH else OURS
            axes.errorbar(found.mean, place, xerr=half, fmt="o", markersize=8, color=colour, capsize=3, zorder=3)
    axes.set_xlim(SCALE[0] - 0.1, SCALE[-1] + 0.1)
    axes.set_xticks(SCALE)
    axes.set_xlabel(f"{question.title}\n{SCALE[0]} {LOWEST} … {SCALE[-1]} {HIGHEST}")
