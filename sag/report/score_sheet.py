"""The score sheet: every figure of one file of motions beside the ground truth's, for a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from sag.report.columns import ARROWS, Column
from sag.report.facts import FEW_MOTIONS
from sag.report.lines import Figure
from sag.report.paper import paper_figures
from sag.report.sections import COMPANIONS, SEES_MORE, paper_section
from sag.report.table import NONE

Figures = Mapping[str, float]

ENCODERS = (
    "no Motion FID: its encoders for this data are missing; train them once by sag fit --config configs/base.yaml "
    "--config configs/presets/quick.yaml --config configs/data/<data set>.yaml --config configs/methods/erd.yaml"
)
"""Said where there is no Motion FID."""


def show_scores(title: str, content: Mapping[str, Any], console: Console | None = None) -> None:
    """Prints what `sag score` found.

    Args:
        title: of the sheet.
        content: `metrics`, `ground_truth`, `protocol` and `data`, as the file of scores has them.
        console: where to; the terminal if none is given.
    """
    console = console or Console()
    figures, truth = content["metrics"], content["ground_truth"]
    grid = Grid(title=title, box=box.SIMPLE_HEAD, pad_edge=False, title_style="bold")
    for heading, side in (("", "left"), ("motions", "right"), ("truth", "right"), ("floor", "right")):
        grid.add_column(heading, justify=side, no_wrap=True)  # type: ignore[arg-type]
    for name, columns in _sections(str(content["data"]["name"])):
        shown = [column for column in columns if column.metric in figures]
        if shown:
            grid.add_section()
            grid.add_row(Text(name, style="bold"), "", "", "")
        for column in shown:
            grid.add_row(*_row(column, figures, truth))
    console.print(grid)
    for notice in _notices(content):
        console.print(Text(f"! {notice}", style="bold red"), soft_wrap=True)
    console.print(Text(_protocol(content)), soft_wrap=True)


def _sections(data: str) -> Iterator[tuple[str, list[Column]]]:
    """Titles with their columns, the letters and the paper's own figures left out."""
    for title, section in (
        ("The paper's", paper_section(paper_figures(data), whole=False)),
        ("What Motion FID cannot see: ours", SEES_MORE),
        ("Companions: ours", COMPANIONS),
    ):
        yield title, [column for column in section.columns if column.metric and not column.paper]


def _row(column: Column, figures: Figures, truth: Figures) -> list[str]:
    group = column.group.title.rstrip(" ↑↓").partition(",")[0]
    name = f"  {group}, {column.heading} {ARROWS[column.better]}".rstrip()
    floor = _text(column, truth, column.floor) if column.floor else ""
    return [name, _text(column, figures, column.metric), _text(column, truth, column.metric), floor]


def _text(column: Column, figures: Figures, metric: str) -> str:
    """A figure, or both ends of an interval, as reports write them."""
    if metric not in figures:
        return NONE
    ends = [metric, column.until] if column.until and metric == column.metric else [metric]
    texts = ["NaN" if math.isnan(figures[end]) else column.written(Figure(figures[end])) for end in ends]
    return " … ".join(texts) if len(set(texts)) == len(texts) else NONE


def _notices(content: Mapping[str, Any]) -> Iterator[str]:
    motions, windows = int(content["protocol"]["motions"]), int(content["data"]["windows"]["test"])
    if motions < FEW_MOTIONS:
        yield f"N = {motions} is far too small for these figures to mean anything."
    if motions < windows:
        yield f"the file has motions for {motions:,} of {windows:,} test windows; Motion FID shrinks as N grows."
    if not content["protocol"]["encoders"]:
        yield ENCODERS
    yield from (f"{str(note).rstrip('.')}." for note in content["data"].get("notes", []))


def _protocol(content: Mapping[str, Any]) -> str:
    """N of everything, and what the figures rest on."""
    protocol, data = content["protocol"], content["data"]
    parts = (
        f"N: {protocol['motions']:,} motions of {protocol['groups']}",
        f"{protocol['samples']} for each window",
        f"{protocol['collision_frames']:,} frames (non-collision, {protocol['collision_shape']}s)",
        f"{protocol['cloud_points']:,.0f} scene points a frame",
        f"floor {protocol['floor']}",
        f"{data['name']} (fingerprint {data['fingerprint']})",
        f"{data['fps']:g} fps",
        f"encoders {protocol['encoders']}",
        f"interval from {protocol['resamples']} resamples" if protocol["resamples"] else "no interval",
    )
    return "; ".join(parts) + "."
