"""`sag critics RUN ...`: what the critics of trained runs listen to."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence

import torch
from rich import box
from rich.console import Console
from rich.table import Table

from sag.critics.listening import STEP, Listening, listening_of
from sag.data.selection import spread, windows_at
from sag.errors import SagError
from sag.methods.wgan import WGAN
from sag.options import add_cache_dir
from sag.runs import read_runs
from sag.shipped import add_runs
from sag.types import Batch

DESCRIPTION = """\
What the critics of trained runs listen to, on validation windows: how much of their scores comes from the motion, from
the scene feature, which no generator can change, and from both together; how hard each pulls at a generated motion; and
how often a recorded motion scores above a generated one, and above itself lifted off the floor or sunk into it."""

LEGEND = (
    "Motion, f, both: shares of the variance of the scores of every recorded motion beside every window's feature f, "
    "per cent. Pull: norm of the score's gradient at a generated motion's joints, scores per metre. >: per cent of "
    "the recorded motions that score above what was generated for the same window, and above themselves {step:.0f} cm "
    "higher and lower after the first pose; a critic that knows the floor has both of these above 50."
)


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag critics`."""
    made = argparse.ArgumentParser(
        prog="sag critics", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_runs(made)
    made.add_argument("--windows", type=int, metavar="N", help="validation windows (default: 100, or all of fewer)")
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is generated (default: 0)")
    add_cache_dir(made)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints a table and returns the exit status 0.

    Raises:
        SagError: a folder holds no trained run, runs cannot be compared, have no critics, or there are too few windows.
    """
    asked = parser().parse_args(arguments)
    runs = read_runs(asked.runs, asked.cache_dir)
    judged = {run.name: run.method for run in runs if isinstance(run.method, WGAN)}
    if not judged:
        raise SagError(f"{runs[0].name} has no critics: it is a {type(runs[0].method).__name__}")
    data = runs[0].data
    known = data.cache.rows("val").tolist()
    count = min(100, len(known)) if asked.windows is None else asked.windows
    if not 2 <= count <= len(known):
        raise SagError(f"--windows is {count}, and {data.name} has {len(known)} validation windows; at least 2")
    batch = windows_at(data, "val", spread(known, count))
    console = Console()
    console.print(_table({name: _listening(method, batch, asked.seed) for name, method in judged.items()}))
    console.print(
        f"{count} validation windows of {data.name} (fingerprint {data.cache.fingerprint}), seed "
        f"{asked.seed}. {LEGEND.format(step=100 * STEP)}",
        markup=False, highlight=False, soft_wrap=True,
    )  # fmt: skip
    return 0


def _listening(method: WGAN, batch: Batch, seed: int) -> dict[str, Listening]:
    return listening_of(method, batch.to(method.device), torch.Generator(method.device).manual_seed(seed))


def _table(found: Mapping[str, dict[str, Listening]]) -> Table:
    """A line for each critic of each run."""
    grid = Table(title="What critics listen to", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    grid.add_column("run", overflow="fold")
    grid.add_column("critic", no_wrap=True)
    for heading in ("motion", "f", "both", "pull", "> fake", "> lifted", "> sunk"):
        grid.add_column(heading, justify="right", no_wrap=True)
    for name, critics in found.items():
        for turn, (critic, heard) in enumerate(critics.items()):
            shares = (f"{share:.1f}" for share in (heard.motion, heard.feature, heard.both))
            preferred = (f"{share:.0f}" for share in (heard.real, heard.lifted, heard.sunk))
            last = turn == len(critics) - 1
            grid.add_row(name if not turn else "", critic, *shares, f"{heard.pull:.3g}", *preferred, end_section=last)
    return grid
