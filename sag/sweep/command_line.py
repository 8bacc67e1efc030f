"""`sag sweep FILE`: runs a sweep file on this machine."""

from __future__ import annotations

import argparse
import shlex
import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from sag.errors import SagError
from sag.sweep.command import Additions
from sag.sweep.definition import Sweep, read_sweep
from sag.sweep.display import LiveTable, PlainLines
from sag.sweep.estimate import duration
from sag.sweep.process import tail
from sag.sweep.rows import Row, plan
from sag.sweep.runner import Interrupts, Runner
from sag.sweep.status import LOG, locked
from sag.sweep.tracked import Tracked, track

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells have it."""

DESCRIPTION = """\
Trains and tests every row of a sweep file (W&B's format, grid search), each in a process of its own,
after the encoders of Motion FID and the ground truth; last, where components vary, a row that is blind to
the scene. Rows that have finished are not run again, so the same command continues after Ctrl-C, a crash or
a changed config, and rows that a sweep in a folder beside this one has finished are copied from there;
a row that fails does not stop the others.
Every row has a folder with its log.txt, status.json and metrics.json; `sag report` makes tables of them."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag sweep`."""
    made = argparse.ArgumentParser(
        prog="sag sweep", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("file", type=Path, metavar="FILE", help="sweep file, such as sweeps/ablation.yaml")
    made.add_argument("--out", type=Path, metavar="DIR", help="folder of the rows (default: runs/<name of the sweep>)")
    made.add_argument("--jobs", type=int, default=2, metavar="N", help="rows at a time (default: 2)")
    made.add_argument("--seeds", type=int, metavar="N", help="run every row with the seeds 0 to N-1")
    made.add_argument(
        "--config",
        action="append",
        default=[],
        metavar="YAML",
        help="config laid over those of the file, such as configs/data/gta_im.yaml; may be given again",
    )
    made.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="key set for every row, such as data.init_args.root=PATH; may be given again",
    )
    made.add_argument(
        "--pretrained",
        type=Path,
        metavar="DIR",
        help="folder of the same sweep on other data: every row starts in the last checkpoint of its namesake there",
    )
    made.add_argument("--dry-run", action="store_true", help="print the commands and run nothing")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a sweep and returns the exit status: 0, 1 when a row failed, 130 when interrupted.

    Raises:
        SagError: the sweep file, a flag or a config is wrong, or another sweep holds the folder.
    """
    asked = parser().parse_args(arguments)
    _check(asked)
    sweep = read_sweep(asked.file)
    out = asked.out or Path("runs") / sweep.name
    settings = tuple(setting.removeprefix("--") for setting in asked.set)
    rows = plan(sweep, Additions(tuple(asked.config), settings, asked.pretrained), asked.seeds)
    console = Console()
    if asked.dry_run:
        for row in rows:
            console.print(f"{row.name}: {shlex.join(row.command)}", markup=False, highlight=False, soft_wrap=True)
        return 0
    with locked(out):
        return _run(sweep, rows, out, asked.jobs, console)


def _check(asked: argparse.Namespace) -> None:
    if asked.jobs < 1:
        raise SagError(f"--jobs {asked.jobs}: at least one row runs at a time")
    if asked.seeds is not None and asked.seeds < 1:
        raise SagError(f"--seeds {asked.seeds}: every row needs at least one seed")
    for setting in asked.set:
        if "=" not in setting:
            raise SagError(f"--set {setting}: write it as key=value, such as data.init_args.root=PATH")


def _run(sweep: Sweep, rows: Sequence[Row], out: Path, jobs: int, console: Console) -> int:
    began = time.monotonic()
    tracked = track(rows, out)
    finished = [t for t in tracked if t.status.state == "finished"]
    kept = f"; {len(finished)} finished before and are kept" if finished else ""
    elsewhere = sorted({str(Path(t.status.taken_from).parent) for t in finished if t.status.taken_from})
    kept += f" (from {', '.join(elsewhere)} too, where the same commands ran)" if elsewhere else ""
    _print(console, f"{sweep.name}: {len(tracked)} runs, {jobs} at a time, in {out}{kept}")
    with Interrupts() as interrupts:
        with (LiveTable if console.is_terminal else PlainLines)(tracked, jobs, console) as display:
            Runner(sweep.name, tracked, jobs, display).run(interrupts)
        took = duration(time.monotonic() - began)
    if interrupts.count:
        _print(console, f"interrupted after {took}; run the same command again to continue")
        return INTERRUPTED
    return _close(tracked, out, took, console)


def _close(tracked: Sequence[Tracked], out: Path, took: str, console: Console) -> int:
    """Says how it ended, and for every failed row why and where to read more."""
    failed = [t for t in tracked if t.status.state == "failed"]
    for row in failed:
        _print(console, f"\n{row.row.name} failed: {row.status.reason}\n  log: {row.folder / LOG}", style="red")
        for line in tail(row.folder):
            _print(console, f"  | {line}")
    waiting = sum(t.status.state == "waiting" for t in tracked)
    if waiting:
        _print(console, f"\nstopped: the other {waiting} runs need {failed[0].row.name}; the same command tries again")
    elif failed:
        _print(console, f"\n{len(failed)} of {len(tracked)} runs failed; the same command runs these again")
    else:
        _print(console, f"all {len(tracked)} runs finished in {took}")
    _print(console, f"output: {out}; table: sag report {out}")
    return 1 if failed else 0


def _print(console: Console, line: str, style: str | None = None) -> None:
    console.print(line, style=style, markup=False, highlight=False, soft_wrap=True)
