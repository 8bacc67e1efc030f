"""`sag report DIR`: the rows of a folder, or of several, as tables and plots."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from sag.errors import SagError
from sag.files import write_whole
from sag.report.files import whole_report, write_report
from sag.report.keep import keep
from sag.report.lines import Line, lines_of
from sag.report.pages import with_tables
from sag.report.results import check_comparable
from sag.report.sweeps import read_sweeps, sweep_names
from sag.report.terminal import UNBOUNDED, show

DESCRIPTION = """\
Lays the rows of a folder side by side, the paper's figures beside them and figures of our own below:
table.md, table.csv, table.tex, table.html, plot.png and plot.svg. Failed rows and NaN are shown as such;
rows that were measured differently (data, N, encoders, skeleton, fps, samples) are refused.

Seeds give means with 95 % intervals, tests between neighbouring rows of the paper's Table 1, agreement with the
paper's order, and what each letter changes (letters.png, letters.svg); statistics.csv has them all. Rows of several
folders stand in one report; rows of one name are then called by their folder too.

--keep copies figures, configs and states, small files without absolute paths, into a folder to be committed;
the same command makes the same report of it, without checkpoints.

--page renews the tables of a page of Markdown that stand between <!-- table of DIR: TITLE --> and
<!-- end of table -->; it needs no other DIR."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag report`."""
    made = argparse.ArgumentParser(
        prog="sag report", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument(
        "folders", type=Path, nargs="*", metavar="DIR", help="folder that a sweep wrote, such as runs/ablation"
    )
    made.add_argument("--out", type=Path, metavar="DIR", help="folder for the report (default: DIR, if it is one)")
    made.add_argument("--keep", type=Path, metavar="DIR", help="folder to keep the results in, such as results/table1")
    made.add_argument("--overwrite", action="store_true", help="replace results that were kept there before")
    made.add_argument("--page", type=Path, metavar="FILE", help="page of Markdown whose marked tables are renewed")
    made.add_argument("--wandb", action="store_true", help="log tables and plots as a W&B run, offline by default")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the report and returns the exit status 0.

    Raises:
        SagError: no row has finished, a file is damaged, rows cannot be compared, or options contradict each other.
    """
    asked = parser().parse_args(arguments)
    _check_options(asked)
    if asked.page:
        renew(asked.page)
        return 0
    lines, title = _read(asked.folders)
    if asked.keep:
        keep(asked.folders[0], asked.keep, asked.overwrite)
        write_report(*_read([asked.keep]), asked.keep)
    out = asked.out or asked.folders[0]
    report, names = write_report(lines, title, out)
    console = Console()
    show(report, console if console.is_terminal else Console(width=UNBOUNDED))
    console.print(f"\nreport: {out} ({names})", markup=False, highlight=False, soft_wrap=True)
    if asked.wandb:
        from sag.report.weights_and_biases import track  # takes a second to import

        console.print(f"W&B: {track(out, title)}", markup=False, highlight=False, soft_wrap=True)
    if asked.keep:
        console.print(f"kept: {asked.keep}", markup=False, highlight=False, soft_wrap=True)
    return 0


def renew(page: Path) -> None:
    """Renews the marked tables of a page of Markdown, whole or not at all.

    Raises:
        SagError: there is no such page, a mark is wrong, or a report cannot be made.
    """
    if not page.is_file():
        raise SagError(f"--page {page} is not a file")
    made = with_tables(page.read_text(encoding="utf-8"), lambda folder: whole_report(*_read([Path(folder)])))
    write_whole(page, lambda file: file.write(made.encode()))
    Console().print(f"renewed: {page}", markup=False, highlight=False, soft_wrap=True)


def _check_options(asked: argparse.Namespace) -> None:
    if asked.page and (asked.folders or asked.keep or asked.out):
        raise SagError("--page stands alone: its marks name the folders")
    if not asked.folders and not asked.page:
        raise SagError("name a folder that a sweep wrote, such as runs/ablation, or --page FILE")
    if len(asked.folders) > 1 and asked.keep:
        raise SagError("--keep takes one folder; keep each on its own, then report on the kept ones together")
    if len(asked.folders) > 1 and not asked.out:
        raise SagError("a report on several folders belongs to none of them; name its own by --out DIR")
    if asked.overwrite and not asked.keep:
        raise SagError("--overwrite is for --keep DIR; a report always replaces its own files")


def _read(folders: Sequence[Path]) -> tuple[list[Line], str]:
    """The lines of a report and its title."""
    results = read_sweeps(folders)
    check_comparable(results)
    lines = lines_of(results)
    names = " and ".join(name.replace("_", " ") for name in sweep_names(folders))
    data = next(str(line.finished[0].data.get("name")) for line in lines if line.finished)
    return lines, f"{names[:1].upper()}{names[1:].lower()} on {data}"
