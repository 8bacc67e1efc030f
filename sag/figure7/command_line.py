"""`sag figure7 RUN [RUN ...] --out DIR`: the paper's Figure 7 from trained runs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

import matplotlib
from rich import box
from rich.console import Console
from rich.table import Table

from sag.errors import SagError
from sag.figure7.examples import examples_of
from sag.figure7.plot import plot_of
from sag.figure7.spread import TRAJECTORIES, End, Spread, TakesEnd, check_samples, spreads_of
from sag.figure7.written import content_of, spreadsheet
from sag.files import write_json
from sag.options import add_cache_dir
from sag.report.plot import STYLE
from sag.runs import read_runs

DESCRIPTION = f"""\
Standard deviation over time of {TRAJECTORIES} trajectories with the same start and end point (the paper's Figure 7).
A method that draws its motions draws many for each window, and the {TRAJECTORIES} that end nearest to a common end
point are taken; one that can be told an end point, as Cao et al., is told this point {TRAJECTORIES} times. How far from
it they end is printed. Leaves figure7.png, figure7.csv and figure7.json."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag figure7`."""
    made = argparse.ArgumentParser(
        prog="sag figure7", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument(
        "runs", type=Path, nargs="+", metavar="RUN", help="folder of a trained run, or of a sweep: then all its rows"
    )
    made.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the figure")
    made.add_argument("--windows", type=int, metavar="N", help="test windows (default: 100, or all of fewer)")
    made.add_argument(
        "--samples", type=int, default=200, metavar="K", help="motions drawn for each window (default: 200)"
    )
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    made.add_argument(
        "--end",
        choices=get_args(End),
        default="densest",
        help="the common end point: the densest of the drawn ones (default), or the true one",
    )
    add_cache_dir(made)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the figure and returns the exit status 0.

    Raises:
        SagError: a folder holds no trained run, runs cannot be compared, or a number is out of range.
    """
    asked = parser().parse_args(arguments)
    if asked.out.is_file():
        raise SagError(f"--out {asked.out} is a file; give a folder")
    check_samples(asked.samples)
    runs = sorted(read_runs(asked.runs, asked.cache_dir), key=lambda run: isinstance(run.method, TakesEnd))
    batches = runs[0].windows(asked.windows)
    spreads = spreads_of(runs, batches, asked.samples, asked.seed, asked.end)
    protocol = {
        "windows": sum(map(len, batches)), "samples": asked.samples, "trajectories": TRAJECTORIES, "seed": asked.seed,
        "end": asked.end, "data": runs[0].data.describe(),
    }  # fmt: skip
    _write(asked.out, spreads, protocol, plot_of(spreads, examples_of(batches, spreads), protocol))
    _show(spreads, protocol, Console())
    print(f"the figure is in {asked.out} (figure7.png, .csv, .json)")
    return 0


def _write(out: Path, spreads: Sequence[Spread], protocol: dict[str, Any], plot: Any) -> None:
    out.mkdir(parents=True, exist_ok=True)
    write_json(out / "figure7.json", content_of(spreads, protocol))
    (out / "figure7.csv").write_text(spreadsheet(spreads, protocol["data"]["fps"]), encoding="utf-8")
    with matplotlib.rc_context(STYLE):
        plot.savefig(out / "figure7.png", dpi=160)


def _show(spreads: Sequence[Spread], protocol: dict[str, Any], console: Console) -> None:
    """The table on the terminal: deviation at four times, and how close to the common end the trajectories end."""
    content = content_of(spreads, protocol)
    title = f"Standard deviation over time of {TRAJECTORIES} trajectories with one start and end, metres (Figure 7)"
    grid = Table(title=title, title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    grid.add_column("run")
    times = list(content["methods"][0]["deviation_at"])
    for heading in (*(f"{time} s" for time in times), "mean", "end off by (median)", "(max)"):
        grid.add_column(heading, justify="right")
    for method in content["methods"]:
        shown = [*method["deviation_at"].values(), method["mean"], *method["end_off_by"].values()]
        grid.add_row(method["run"], *(f"{value:.3f}" for value in shown))
    console.print(grid)
    data = protocol["data"]
    console.print(
        f"{protocol['windows']} test windows of {data['name']} (fingerprint {data['fingerprint']}); "
        f"{protocol['samples']} motions drawn for each, seed {protocol['seed']}; common end point: {protocol['end']}; "
        "end off by: that trajectory of a window which ends farthest from it.",
        markup=False, highlight=False, soft_wrap=True,
    )  # fmt: skip
