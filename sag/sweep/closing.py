"""What is said when a sweep ends: what has become of every row, and where to read more."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from sag.sweep.process import tail
from sag.sweep.status import LOG
from sag.sweep.table import state_of
from sag.sweep.tracked import Tracked

OPEN = ("waiting", "running", "interrupted", "lost")
"""States of rows that have not come to an end of their own."""


def close(tracked: Sequence[Tracked], out: Path, took: str, console: Console) -> int:
    """Says how it ended, and for every failed row why and where to read more; the exit status."""
    failed = [t for t in tracked if t.status.state == "failed"]
    stopped = [t for t in tracked if state_of(t) in OPEN]
    tell_failed(failed, console)
    culprit = next((t for t in failed if t.row.alone), None)
    if culprit and stopped:
        say(console, f"\nstopped: the other {len(stopped)} runs need {culprit.row.name}; the same command tries again")
    elif failed or stopped:
        parts = [f"{len(failed)} of {len(tracked)} runs failed"] if failed else []
        parts += [f"{', '.join(t.row.name for t in stopped)} stopped before the end"] if stopped else []
        say(console, f"\n{' and '.join(parts)}; the same command runs these again")
    else:
        say(console, f"all {len(tracked)} runs finished in {took}")
    say(console, f"output: {out}; table: sag report {out}")
    return 1 if failed or stopped else 0


def tell_failed(failed: Sequence[Tracked], console: Console) -> None:
    """Why rows failed, where their logs are, and the end of these."""
    for row in failed:
        say(console, f"\n{row.row.name} failed: {row.status.reason}\n  log: {row.folder / LOG}", style="red")
        for line in tail(row.folder):
            say(console, f"  | {line}")


def say(console: Console, line: str, style: str | None = None) -> None:
    """Prints a line as it is: without markup, colours of its own or breaks."""
    console.print(line, style=style, markup=False, highlight=False, soft_wrap=True)
