"""What a user sees while a sweep runs: a live table on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from sag.sweep.estimate import duration, elapsed, fraction_done, remaining, remaining_of_all
from sag.sweep.status import LOG
from sag.sweep.tracked import Tracked

HEARTBEAT = 30.0
"""Seconds between two lines about the whole, where there is no terminal."""

STYLES = {"waiting": "dim", "running": "bold cyan", "finished": "green", "failed": "bold red", "interrupted": "yellow"}


class PlainLines:
    """One line for every change and one every half minute about the whole."""

    def __init__(self, rows: Sequence[Tracked], jobs: int, console: Console) -> None:
        self.rows = rows
        self.jobs = jobs
        self.console = console
        self.beaten = time.monotonic()

    def __enter__(self) -> PlainLines:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Nothing to put back."""

    def changed(self, tracked: Tracked) -> None:
        """Says what happened to a row."""
        self._say(f"{tracked.row.name}: {event(tracked)}")

    def tick(self) -> None:
        """Says how far all rows are, now and then."""
        if time.monotonic() - self.beaten >= HEARTBEAT:
            self.beaten = time.monotonic()
            self._say(summary(self.rows, self.jobs))

    def _say(self, line: str) -> None:
        self.console.print(f"[{time.strftime('%H:%M:%S')}] {line}", markup=False, highlight=False, soft_wrap=True)


class LiveTable:
    """A table of all rows that renews itself."""

    def __init__(self, rows: Sequence[Tracked], jobs: int, console: Console) -> None:
        self.rows = rows
        self.jobs = jobs
        self.console = console
        self.live = Live(console=console, get_renderable=self._table, refresh_per_second=4)

    def __enter__(self) -> LiveTable:
        self.live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.live.stop()

    def changed(self, tracked: Tracked) -> None:
        """Leaves a line above the table for what must not scroll away."""
        if tracked.status.state == "failed":
            self.live.console.print(Text(f"{tracked.row.name}: {event(tracked)}", style="red"))

    def tick(self) -> None:
        """The table renews itself."""

    def _table(self) -> Table:
        table = Table(caption=summary(self.rows, self.jobs), caption_justify="left", box=None, pad_edge=False)
        for heading in ("row", "state", "progress", "steps", "time", "left", "log"):
            table.add_column(heading, no_wrap=True, justify="right" if heading in ("steps", "time", "left") else "left")
        for tracked in visible(self.rows, self.console.height - 5):
            table.add_row(*_cells(tracked))
        return table


def _cells(tracked: Tracked) -> list[Text | ProgressBar | str]:
    state = tracked.status.state
    log = "" if state == "waiting" else str(tracked.folder / LOG)
    return [
        Text(tracked.row.name, style="bold"),
        Text(state, style=STYLES[state]),
        ProgressBar(1.0, fraction_done(tracked), 20, complete_style="cyan", finished_style=STYLES[state]),
        _steps(tracked),
        duration(elapsed(tracked)),
        duration(remaining(tracked)),
        Text(log, style="dim"),
    ]


def _steps(tracked: Tracked) -> str:
    """Where a running row is, once it says so."""
    progress = tracked.progress
    return f"{progress.stage} {progress.step}/{progress.steps}" if tracked.process and progress.steps else ""


def visible(rows: Sequence[Tracked], most: int) -> list[Tracked]:
    """The rows that fit on the terminal, in order: running and failed ones first of all, finished ones last."""
    urgency = {"running": 0, "failed": 0, "interrupted": 0, "waiting": 1, "finished": 2}
    chosen = sorted(range(len(rows)), key=lambda i: urgency[rows[i].status.state])[: max(most, 1)]
    return [rows[i] for i in sorted(chosen)]


def event(tracked: Tracked) -> str:
    """What has just happened to a row."""
    status, log = tracked.status, tracked.folder / LOG
    if status.state == "running":
        return f"started, process {status.pid}, log {log}"
    if status.state == "finished":
        return f"finished in {duration(elapsed(tracked))}"
    if status.state == "interrupted":
        return f"interrupted after {duration(elapsed(tracked))}"
    return f"failed after {duration(elapsed(tracked))} ({status.reason}), log {log}"


def summary(rows: Sequence[Tracked], jobs: int) -> str:
    """The whole sweep in one line."""
    states = [t.status.state for t in rows]
    parts = [f"{states.count('finished')} of {len(rows)} finished"]
    parts += [f"{states.count('failed')} failed"] if "failed" in states else []
    running = [f"{t.row.name} {_steps(t)}".strip() for t in rows if t.process]
    parts += ["running: " + ", ".join(running)] if running else []
    parts.append(f"{100 * sum(map(fraction_done, rows)) / len(rows):.0f} % done")
    left = remaining_of_all(rows, jobs)
    return "; ".join([*parts, "about " + duration(left) + " left"] if left and running else parts)
