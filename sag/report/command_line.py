"""`sag report DIR`: the rows of a folder as tables and a plot."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import matplotlib
from rich.console import Console

from sag.report.html import html
from sag.report.latex import latex
from sag.report.lines import Line, lines_of
from sag.report.markdown import markdown
from sag.report.paper import paper_figures
from sag.report.plot import NO_METADATA, STYLE, plot_of, svg_of
from sag.report.results import check_comparable, read_results
from sag.report.spreadsheet import spreadsheet
from sag.report.table import Report, report_of
from sag.report.terminal import UNBOUNDED, show

DESCRIPTION = """\
Lays the rows of a folder side by side, the paper's figures beside them and figures of our own below:
table.md, table.csv, table.tex, table.html, plot.png and plot.svg. Failed rows and NaN are shown as such;
rows that were measured differently (data, N, encoders, skeleton, fps, samples) are refused."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag report`."""
    made = argparse.ArgumentParser(
        prog="sag report", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("folder", type=Path, metavar="DIR", help="folder that a sweep wrote, such as runs/ablation")
    made.add_argument("--out", type=Path, metavar="DIR", help="folder for the tables (default: DIR)")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the report and returns the exit status 0.

    Raises:
        SagError: no row has finished, a file is damaged, or rows cannot be compared.
    """
    asked = parser().parse_args(arguments)
    results = read_results(asked.folder)
    check_comparable(results)
    lines = lines_of(results)
    title = f"{asked.folder.resolve().name.replace('_', ' ').capitalize()} on {_data(lines)}"
    out = asked.out or asked.folder
    report = write_report(lines, title, out)
    console = Console()
    show(report, console if console.is_terminal else Console(width=UNBOUNDED))
    names = "table.md, .csv, .tex, .html; plot.png, .svg"
    console.print(f"\nreport: {out} ({names})", markup=False, highlight=False, soft_wrap=True)
    return 0


def _data(lines: Sequence[Line]) -> str:
    return next(str(line.finished[0].data.get("name")) for line in lines if line.finished)


def write_report(lines: Sequence[Line], title: str, out: Path) -> Report:
    """Writes all files to a folder and returns the report that Markdown and the terminal show."""
    out.mkdir(parents=True, exist_ok=True)
    paper = paper_figures(_data(lines))
    report = report_of(title, lines)
    plot = plot_of(lines, paper, title)
    (out / "table.md").write_text(markdown(report), encoding="utf-8")
    (out / "table.tex").write_text(latex(report), encoding="utf-8")
    (out / "table.csv").write_text(spreadsheet(lines, paper), encoding="utf-8")
    (out / "table.html").write_text(html(report_of(title, lines, whole=True), svg_of(plot)), encoding="utf-8")
    with matplotlib.rc_context(STYLE):
        plot.savefig(out / "plot.png", dpi=160)
        plot.savefig(out / "plot.svg", metadata=NO_METADATA)
    return report
