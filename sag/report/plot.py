"""The plot: both metrics of every row, ours beside the paper's. Colours are told apart by colour-blind eyes too."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Sequence
from typing import Any

import matplotlib

from sag.report.lines import Figure, Kind, Line
from sag.report.paper import PaperFigures

INK = "#1d2331"
"""Colour of text and axes; in a page it is replaced by the page's own."""

GRID = "#8a93a5"
COLOURS: dict[Kind, str] = {"without": "#D55E00", "with": "#0072B2", "blind": "#CC79A7", "method": "#009E73"}
"""Okabe and Ito's vermilion, blue, reddish purple and bluish green."""

NAMES: dict[Kind, str] = {
    "without": "without M",
    "with": "with M (separate generation)",
    "blind": "blind (scene feature zeroed)",
    "method": "other methods",
}
BAD = "#CC3311"
"""Red for what is missing."""

STYLE: Any = {
    "font.family": "DejaVu Sans", "font.size": 10, "svg.fonttype": "none", "svg.hashsalt": "sag", "text.color": INK,
    "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False,
    "axes.spines.right": False, "axes.spines.left": False, "ytick.left": False,
}  # fmt: skip

NO_METADATA = {"Creator": None, "Date": None, "Format": None, "Type": None}
"""Equal rows make equal files."""


def plot_of(lines: Sequence[Line], paper: PaperFigures, title: str) -> Any:
    """A matplotlib figure: Motion FID on a logarithmic axis, the non-collision score beside it."""
    from matplotlib.figure import Figure as Canvas

    shown = [line for line in lines if line.kind != "truth"]
    truth = next((line for line in lines if line.kind == "truth"), None)
    with matplotlib.rc_context(STYLE):
        canvas = Canvas(figsize=(11.5, 1.9 + 0.32 * len(shown)), layout="constrained")
        left, right = canvas.subplots(1, 2, sharey=True)
        canvas.suptitle(title, fontweight="bold", fontsize=12, color=INK)
        _panel(left, shown, paper, "motion_fid/average")
        left.set_xscale("log")
        left.set_xlabel("Motion FID, average (log scale; lower is better)")
        _panel(right, shown, paper, "non_collision/average")
        right.set_xlabel("Non-collision score, average (higher is better)")
        if truth:
            _reference(left, truth, "motion_fid_floor/average", "floor: real against real")
            _reference(right, truth, "non_collision/average", "ground truth")
        _rows(left, shown)
        _tick_plainly(left)
        _legend(canvas, shown, paper)
    return canvas


def _panel(axes: Any, lines: Sequence[Line], paper: PaperFigures, metric: str) -> None:
    """A dot for ours with its interval and small ones for its seeds, a diamond for the paper's, or what is missing."""
    for place, line in enumerate(lines):
        axes.axhline(place, color=GRID, alpha=0.25, linewidth=0.8, zorder=0)
        printed = paper.cells(line.paper_row).get(metric)
        if printed is not None:
            axes.plot(printed, place, "D", markersize=7, markerfacecolor="none", markeredgecolor=INK, zorder=2)
        figure = line.figures.get(metric)
        if figure is None or not math.isfinite(figure.mean):
            axes.annotate(
                _missing(line, figure),
                (0.5, place),
                xycoords=("axes fraction", "data"),
                color=BAD,
                fontweight="bold",
                va="center",
                ha="center",
            )
            continue
        _dots(axes, place, line, metric, figure)


def _dots(axes: Any, place: int, line: Line, metric: str, figure: Figure) -> None:
    """The mean, its interval, and where there are several seeds each of them."""
    colour = COLOURS[line.kind]
    axes.errorbar(figure.mean, place, xerr=figure.half_width, fmt="o", markersize=8, color=colour, capsize=3, zorder=3)
    if figure.count > 1:
        seeds = list(line.values(metric).values())
        axes.plot(seeds, [place + 0.25] * len(seeds), "o", markersize=3.5, color=colour, alpha=0.6, zorder=2)


def _missing(line: Line, figure: Figure | None) -> str:
    """Why there is no dot."""
    if figure:
        return "NaN"
    return "no figure" if line.finished else line.unfinished[0].state


def _reference(axes: Any, truth: Line, metric: str, text: str) -> None:
    """A dashed line that no row can be expected to pass."""
    figure = truth.figures.get(metric)
    if figure is None or not math.isfinite(figure.mean) or figure.mean <= 0:
        return
    axes.axvline(figure.mean, color=INK, linestyle=(0, (4, 3)), linewidth=1, zorder=1)
    axes.annotate(
        text, (figure.mean, 1), xycoords=("data", "axes fraction"), xytext=(0, 3), textcoords="offset points",
        fontsize=8.5, color=INK, ha="left" if axes.get_xscale() == "log" else "right",
    )  # fmt: skip


def _label(line: Line) -> str:
    letters = line.in_ablation and line.components and any(line.components.values())
    return line.name.upper() if letters and line.is_plain and not line.sweep else line.label.replace("_", " ")


def _rows(axes: Any, lines: Sequence[Line]) -> None:
    """Names of the rows from top to bottom, with a rule between kinds."""
    axes.set_yticks(range(len(lines)), [_label(line) for line in lines])
    axes.set_ylim(len(lines) - 0.4, -0.6)
    for place in range(1, len(lines)):
        if lines[place].kind != lines[place - 1].kind:
            for panel in axes.figure.axes:
                panel.axhline(place - 0.5, color=INK, linewidth=0.8, alpha=0.6)


def _tick_plainly(axes: Any) -> None:
    """20 and 50 rather than powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _legend(canvas: Any, lines: Sequence[Line], paper: PaperFigures) -> None:
    from matplotlib.lines import Line2D

    present = dict.fromkeys(line.kind for line in lines)
    marks = [Line2D([], [], marker="o", linestyle="", color=COLOURS[kind], label=NAMES[kind]) for kind in present]
    hollow: Any = {"markerfacecolor": "none", "markeredgecolor": INK}
    if any(paper.cells(line.paper_row) for line in lines):
        marks.append(Line2D([], [], marker="D", linestyle="", label=f"printed in the paper ({paper.source})", **hollow))
    canvas.legend(handles=marks, loc="outside lower center", ncols=len(marks), frameon=False)


def svg_of(canvas: Any) -> str:
    """The figure as an SVG element for a page: no background, ink in the page's own colour."""
    text = io.StringIO()
    with matplotlib.rc_context(STYLE):
        canvas.savefig(text, format="svg", transparent=True, metadata=NO_METADATA)
    element = text.getvalue()[text.getvalue().index("<svg") :]
    return re.sub(INK, "currentColor", element, flags=re.IGNORECASE)
