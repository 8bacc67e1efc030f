"""How rows are shown: a table of them, the whole in one line, and what happens to one in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from sag.sweep.estimate import duration, elapsed, fraction_done, remaining, remaining_of_all
from sag.sweep.heartbeat import age, is_lost
from sag.sweep.status import LOG, State, Status
from sag.sweep.tracked import Tracked

Shown = State | Literal["lost"]

STYLES: dict[Shown, str] = {
    "waiting": "dim",
    "running": "bold cyan",
    "finished": "green",
    "failed": "bold red",
    "interrupted": "yellow",
    "lost": "bold yellow",
}

BAR = 16
"""Columns of a progress bar, at most."""


def rows_table(rows: Sequence[Tracked], caption: str) -> Table:
    """A line for each row: how far it is, when it was last seen alive, and where that was."""
    logs = f"\nlogs: {rows[0].folder.parent}/ROW/{LOG}" if rows else ""
    table = Table(caption=caption + logs, caption_justify="left", box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("row", "state"):
        table.add_column(heading, no_wrap=True)
    table.add_column("", min_width=BAR // 2, max_width=BAR)
    for heading in ("steps", "time", "left", "beat"):
        table.add_column(heading, no_wrap=True, justify="right")
    table.add_column("where", no_wrap=True)
    for tracked in rows:
        table.add_row(*_cells(tracked))
    return table


def _cells(tracked: Tracked) -> list[Text | ProgressBar | str]:
    shown = state_of(tracked)
    return [
        Text(tracked.row.name, style="bold"),
        Text(shown, style=STYLES[shown]),
        ProgressBar(1.0, fraction_done(tracked), complete_style="cyan", finished_style=STYLES[shown]),
        _steps(tracked),
        duration(elapsed(tracked)),
        duration(remaining(tracked)),
        duration(age(tracked.status)),
        Text(_where(tracked.status) if shown not in ("waiting", "finished") else "", style="dim"),
    ]


def state_of(tracked: Tracked) -> Shown:
    """The state of a row as people are told it: one whose heartbeat has stopped is lost."""
    return "lost" if is_lost(tracked.status) and tracked.process is None else tracked.status.state


def _where(status: Status) -> str:
    """The machine of a row that runs or ran, with its GPU or job."""
    parts = [status.host or "", f"GPU {status.gpus}" if status.gpus else "", f"job {status.job}" if status.job else ""]
    return " ".join(part for part in parts if part)


def _steps(tracked: Tracked) -> str:
    """Where a running row is, once it says so."""
    progress = tracked.progress
    runs = tracked.status.state == "running" and progress.steps
    return f"{progress.stage} {progress.step}/{progress.steps}" if runs else ""


def visible(rows: Sequence[Tracked], most: int) -> list[Tracked]:
    """The rows that fit on the terminal, in order: running and failed ones first of all, finished ones last."""
    urgency = {"waiting": 1, "finished": 2}
    chosen = sorted(range(len(rows)), key=lambda i: urgency.get(rows[i].status.state, 0))[: max(most, 1)]
    return [rows[i] for i in sorted(chosen)]


def event(tracked: Tracked) -> str:
    """What has just happened to a row."""
    status, log = tracked.status, tracked.folder / LOG
    if status.state == "running":
        where = f" on {_where(status)}" if status.host else ""
        return f"started, process {status.pid}{where}, log {log}"
    if status.state == "waiting":
        return "waits again"
    if status.state == "finished":
        return f"finished in {duration(elapsed(tracked))}"
    if status.state == "interrupted":
        return f"interrupted after {duration(elapsed(tracked))}"
    return f"failed after {duration(elapsed(tracked))} ({status.reason}), log {log}"


def summary(rows: Sequence[Tracked], jobs: int) -> str:
    """The whole sweep in one line."""
    states = [state_of(t) for t in rows]
    parts = [f"{states.count('finished')} of {len(rows)} finished"]
    parts += [f"{states.count(shown)} {shown}" for shown in ("failed", "lost") if shown in states]
    running = [f"{t.row.name} {_steps(t)}".strip() for t in rows if state_of(t) == "running"]
    parts += ["running: " + ", ".join(running)] if running else []
    parts.append(f"{100 * sum(map(fraction_done, rows)) / len(rows):.0f} % done")
    left = remaining_of_all(rows, jobs)
    return "; ".join([*parts, "about " + duration(left) + " left"] if left and running else parts)
