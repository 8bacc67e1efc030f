"""`sag extend RUN --frames N`: motions of any length from a trained run, and how rough their seams are (paper, 6.2)."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from jaxtyping import Float
from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from torch import Tensor

from sag.data.motion_file import MotionFile, write_motions
from sag.errors import SagError
from sag.methods.sliding import LONGEST_OVERLAP, sample_long, window_starts
from sag.metrics import SeamJerk
from sag.options import add_cache_dir
from sag.runs import Run, read_run
from sag.shipped import beside, run_path
from sag.types import FRAMES, Batch

COLUMNS = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
"""Of the progress bar."""

FIGURES = {
    "jerk_inside": ",.0f",
    "jerk_at_seams": ",.0f",
    "jerk_ratio": ".2f",
    "jump_inside": ".2f",
    "jump_at_seams": ".2f",
}
"""Columns of the table, and how they are written."""

DESCRIPTION = """\
Samples motions of any length from a trained run by a sliding window (the paper's appendix 6.2) and writes them to a
.npz as sag predict does: joints (n, k, frames, j, 3) in metres, camera frame of frame 0, and the index of each window.
Prints the jerk and the jump of the root's velocity inside windows, at these seams, and at plain ones, where the next
window begins at the last frame and nothing is blended."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag extend`."""
    made = argparse.ArgumentParser(
        prog="sag extend", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("run", type=run_path, metavar="RUN", help="folder of a trained run, or shipped")
    made.add_argument("--frames", type=int, required=True, metavar="T", help="of each motion, the given one included")
    made.add_argument(
        "--overlap",
        type=int,
        default=8,
        metavar="O",
        help=f"frames that windows share, 1 to {LONGEST_OVERLAP} (default: 8)",
    )
    made.add_argument("--samples", type=int, default=1, metavar="K", help="motions of each window (default: 1)")
    made.add_argument("--windows", type=int, metavar="N", help="test windows (default: 100, or all of fewer)")
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    made.add_argument("--out", type=Path, metavar="FILE.npz", help="default: extended.npz in the run's folder")
    add_cache_dir(made)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Samples, writes and measures; returns the exit status 0.

    Raises:
        SagError: the folder holds no trained run, or a number is out of range.
    """
    asked = parser().parse_args(arguments)
    window_starts(asked.frames, asked.overlap)
    out = _out(asked.out or beside(asked.run, "extended.npz"))
    if asked.samples < 1:
        raise SagError(f"--samples is {asked.samples}; at least one motion of each window is needed")
    run = read_run(asked.run, asked.cache_dir)
    batches = run.windows(asked.windows)
    overlaps = dict.fromkeys((1, asked.overlap)) if asked.frames > FRAMES else (asked.overlap,)
    console = Console()
    with Progress(*COLUMNS, console=console, disable=not console.is_terminal) as progress:
        drawn = {overlap: _drawn(run, batches, asked, overlap, progress) for overlap in overlaps}
    index = torch.cat([batch.index for batch in batches]).numpy()
    write_motions(out, MotionFile(out, drawn[asked.overlap].numpy(), index, run.data.fps, run.method.skeleton.name))
    _show(run, batches, drawn, asked, console)
    print(f"motions {tuple(drawn[asked.overlap].shape)} are in {out}")
    return 0


@torch.no_grad()
def _drawn(
    run: Run, batches: Sequence[Batch], asked: argparse.Namespace, overlap: int, progress: Progress
) -> Float[Tensor, "n k t j 3"]:
    """Motions of all windows with seams of one overlap; the same noise whatever the overlap."""
    generator = torch.Generator(run.method.device).manual_seed(asked.seed)
    task = progress.add_task(f"windows that share {overlap} frame{'s' * (overlap > 1)}", total=sum(map(len, batches)))
    parts = []
    for batch in batches:
        on = batch.to(run.method.device)
        samples = [sample_long(run.method, on, asked.frames, overlap, generator) for _ in range(asked.samples)]
        parts.append(torch.stack(samples, dim=1).cpu())
        progress.advance(task, len(batch))
    return torch.cat(parts)


def _show(
    run: Run, batches: Sequence[Batch], drawn: Mapping[int, Tensor], asked: argparse.Namespace, console: Console
) -> None:
    """The table on the terminal: the recorded motion, then the long ones with seams of each overlap."""
    title = f"{run.name}: the seams of motions of {asked.frames} frames"
    grid = Table(title=title, title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    grid.add_column("motions", no_wrap=True)
    for heading in ("seams", "jerk, m/s³\ninside", "\nat seams", "\nratio", "jump, m/s\ninside", "\nat seams"):
        grid.add_column(heading, justify="right")
    recorded = torch.cat([batch.motion.joints for batch in batches])
    _add(grid, "recorded", run, recorded, (), asked.overlap)  # every row over stretches of the same length
    for overlap, motions in drawn.items():
        seams = window_starts(asked.frames, overlap)[1:]
        name = "one window" if not seams else "plain seams" if overlap == 1 else f"blended over {overlap}"
        _add(grid, name, run, motions.flatten(0, 1), seams, asked.overlap)
    console.print(grid)
    console.print(
        f"{sum(map(len, batches))} test windows of {run.data.name} (fingerprint {run.data.cache.fingerprint}), "
        f"{asked.samples} of each, seed {asked.seed}; a seam: the {asked.overlap} frames from where a window begins; "
        "jump: of the root's velocity from one frame to the next, the largest at a seam, and inside over as many "
        "frames.",
        markup=False, highlight=False, soft_wrap=True,
    )  # fmt: skip


def _add(grid: Table, name: str, run: Run, joints: Tensor, seams: Sequence[int], overlap: int) -> None:
    """A row of the table."""
    metric = SeamJerk(run.method.skeleton.root_index, run.data.fps, seams, overlap)
    metric.update(joints)
    found = metric.compute()
    texts = ("-" if found[key].isnan() else f"{float(found[key]):{form}}" for key, form in FIGURES.items())
    grid.add_row(name, f"{len(joints) * len(seams):,}", *texts)


def _out(path: Path) -> Path:
    if path.suffix != ".npz" or path.is_dir():
        raise SagError(f"--out {path} must be a file that ends in .npz")
    return path
