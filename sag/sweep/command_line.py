"""`sag sweep FILE`: runs a sweep file on this machine or on a SLURM cluster."""

from __future__ import annotations

import argparse
import shlex
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from sag.errors import INTERRUPTED, SagError
from sag.sweep.arguments import check, parser, sbatch_flags
from sag.sweep.closing import close, say
from sag.sweep.command import Additions
from sag.sweep.definition import Sweep, read_sweep
from sag.sweep.display import LiveTable, PlainLines
from sag.sweep.estimate import duration
from sag.sweep.heartbeat import is_alive
from sag.sweep.interrupts import Interrupts
from sag.sweep.overview import show
from sag.sweep.rows import Row, plan
from sag.sweep.runner import Runner
from sag.sweep.search import Search
from sag.sweep.slots import USUAL, slots
from sag.sweep.slurm import Watcher
from sag.sweep.slurm_queue import ENDING, Queue, Submission
from sag.sweep.status import locked, read_status
from sag.sweep.tracked import Tracked, track
from sag.sweep.trials import Trial, drawn, recorded


@dataclass(frozen=True)
class Call:
    """A call of `sag sweep`, with what it runs.

    Attributes:
        asked: the arguments.
        sweep: the file.
        rows: those that are known before anything runs.
        out: folder of the rows.
        search: adds rows, where the method is `bayes`.
    """

    asked: argparse.Namespace
    sweep: Sweep
    rows: list[Row]
    out: Path
    search: Search | None


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a sweep and returns the exit status: 0, 1 when a row failed or stopped, 130 when interrupted.

    Raises:
        SagError: the sweep file, a flag or a config is wrong, or another sweep holds the folder.
    """
    asked = parser().parse_args(arguments)
    check(asked)
    sweep = read_sweep(asked.file)
    out = asked.out or Path("runs") / sweep.name
    console = Console()
    if asked.status:
        return show(sweep.name, out, console)
    settings = tuple(setting.removeprefix("--") for setting in asked.set)
    additions = Additions(tuple(asked.config), settings, asked.pretrained)
    rows = plan(sweep, additions, asked.seeds, _trials(sweep, out, asked.search_seed))
    if asked.dry_run:
        for row in rows:
            say(console, f"{row.name}: {shlex.join(row.command)}")
        return 0
    search = Search(sweep, additions, asked.seeds, out, asked.search_seed) if sweep.method == "bayes" else None
    call = Call(asked, sweep, rows, out, search)
    with locked(out):
        return _in_slurm(call, console) if asked.slurm else _here(call, console)


def _trials(sweep: Sweep, out: Path, seed: int) -> list[Trial]:
    return drawn(sweep, seed) if sweep.method == "random" else recorded(sweep, out) if sweep.method == "bayes" else []


def _here(call: Call, console: Console) -> int:
    """Runs the rows in the slots of this machine."""
    began = time.monotonic()
    places = slots(call.asked.jobs, call.asked.gpus)
    tracked = track(call.rows, call.out)
    _greet(call, tracked, f"{len(places)} at a time", console)
    shown = LiveTable if console.is_terminal else PlainLines
    with Interrupts() as interrupts, shown(tracked, len(places), console) as display:
        Runner(call.sweep.name, tracked, places, display, call.search).run(interrupts)
    took = duration(time.monotonic() - began)
    if interrupts.count:
        say(console, f"interrupted after {took}; run the same command again to continue")
        return INTERRUPTED
    return close(tracked, call.out, took, console)


def _in_slurm(call: Call, console: Console) -> int:
    """Hands the rows to SLURM and follows them."""
    began = time.monotonic()
    if call.search and call.asked.detach:
        raise SagError("--detach: a Bayesian search chooses rows by the results of others and must stay; leave it out")
    queue = Queue(call.sweep.name, call.out, Submission(sbatch_flags(call.asked), call.asked.jobs))
    tracked = track(call.rows, call.out, _kept(call, queue))
    width = call.asked.jobs or (USUAL if call.search else len(tracked))
    _greet(call, tracked, f"{width} at a time at most, by SLURM", console)
    shown = LiveTable if console.is_terminal else PlainLines
    with Interrupts() as interrupts, shown(tracked, width, console) as display:
        watcher = Watcher(tracked, queue, display, call.search, width)
        watcher.submit()
        if not call.asked.detach:
            watcher.run(interrupts)
    if call.asked.detach or interrupts.count:
        say(console, f"the rows go on without this command; see sag sweep {call.asked.file} --out {call.out} --status")
        return INTERRUPTED if interrupts.count else 0
    return close(tracked, call.out, duration(time.monotonic() - began), console)


def _kept(call: Call, queue: Queue) -> set[str]:
    """Rows that SLURM has and does not end just now, or that live in a job that it has just lost."""
    held = queue.held()
    if held is None:
        raise SagError("--slurm: squeue does not answer, so nobody can say which rows SLURM has; try again later")
    alive = {row.name for row in call.rows if (s := read_status(call.out / row.name)) and s.job and is_alive(s)}
    return alive | {row for row, state in held.items() if state != ENDING}


def _greet(call: Call, tracked: Sequence[Tracked], width: str, console: Console) -> None:
    finished = [t for t in tracked if t.status.state == "finished"]
    kept = f"; {len(finished)} finished before and are kept" if finished else ""
    elsewhere = sorted({str(Path(t.status.taken_from).parent) for t in finished if t.status.taken_from})
    kept += f" (from {', '.join(elsewhere)} too, where the same commands ran)" if elsewhere else ""
    count = f"{len(tracked)} runs" + (f" and trials up to {call.sweep.run_cap}" if call.search else "")
    say(console, f"{call.sweep.name}: {count}, {width}, in {call.out}{kept}")
