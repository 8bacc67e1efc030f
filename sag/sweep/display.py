"""What a user sees while a sweep runs: a live table on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from sag.sweep.table import event, rows_table, summary, visible
from sag.sweep.tracked import Tracked

SUMMARY_EVERY = 30.0
"""Seconds between two lines about the whole, where there is no terminal."""


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
        if time.monotonic() - self.beaten >= SUMMARY_EVERY:
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
        return rows_table(visible(self.rows, self.console.height - 6), summary(self.rows, self.jobs))
