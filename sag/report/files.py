"""The files of a report."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

from sag.report.evidence import Evidence, evidence_of, statistics_csv, with_evidence
from sag.report.html import html
from sag.report.latex import latex
from sag.report.letters_plot import letters_plot_of
from sag.report.lines import Line
from sag.report.markdown import markdown
from sag.report.paper import PaperFigures, paper_figures
from sag.report.plot import NO_METADATA, STYLE, plot_of, svg_of
from sag.report.spreadsheet import spreadsheet
from sag.report.table import Report, report_of


def write_report(lines: Sequence[Line], title: str, out: Path) -> tuple[Report, str]:
    """Writes all files to a folder; returns the report that Markdown and the terminal show, and the files' names."""
    out.mkdir(parents=True, exist_ok=True)
    paper = _paper(lines)
    evidence = evidence_of(lines, paper)
    report = with_evidence(report_of(title, lines), evidence)
    whole = with_evidence(report_of(title, lines, whole=True), evidence)
    plot, letters = plot_of(lines, paper, title), _letters(evidence, title)
    (out / "table.md").write_text(markdown(report), encoding="utf-8")
    (out / "table.tex").write_text(latex(report), encoding="utf-8")
    (out / "table.csv").write_text(spreadsheet(lines, paper), encoding="utf-8")
    further = [svg_of(canvas) for canvas in letters.values()]
    (out / "table.html").write_text(html(whole, svg_of(plot), further, _sheets(lines)), encoding="utf-8")
    names = ["table.md, .csv, .tex, .html"]
    if statistics := statistics_csv(evidence):
        (out / "statistics.csv").write_text(statistics, encoding="utf-8")
        names.append("statistics.csv")
    for name, canvas in {"plot": plot, **letters}.items():
        draw(canvas, out, name)
        names.append(f"{name}.png, .svg")
    return report, "; ".join(names)


def whole_report(lines: Sequence[Line], title: str) -> Report:
    """The report that Markdown and the terminal show, without files."""
    paper = _paper(lines)
    return with_evidence(report_of(title, lines), evidence_of(lines, paper))


def _paper(lines: Sequence[Line]) -> PaperFigures:
    return paper_figures(str(next(line.finished[0].data.get("name") for line in lines if line.finished)))


def _sheets(lines: Sequence[Line]) -> list[tuple[str, bytes]]:
    """Name and contact sheet of each row that left one, of its first seed."""
    first = [(line.label, result.sheet) for line in lines for result in line.finished[:1]]
    return [(label.replace("_", " "), sheet.read_bytes()) for label, sheet in first if sheet is not None]


def _letters(evidence: Sequence[Evidence], title: str) -> dict[str, Any]:
    """The factorial plot of each sweep that has intervals, by the name of its file."""
    plots = {}
    for part in evidence:
        if part.letters.have_intervals:
            of_sweep = f" ({part.sweep})" if part.sweep else ""
            name = re.sub(r"[^\w.=+-]+", "_", f"letters-{part.sweep}" if part.sweep else "letters")
            plots[name] = letters_plot_of(part.letters, f"{title}: what each letter changes{of_sweep}")
    return plots


def draw(canvas: Any, out: Path, name: str) -> None:
    """Writes a matplotlib figure as .png and .svg."""
    with matplotlib.rc_context(STYLE):
        canvas.savefig(out / f"{name}.png", dpi=160)
        canvas.savefig(out / f"{name}.svg", metadata=NO_METADATA)
