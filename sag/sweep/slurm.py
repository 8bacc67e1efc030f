"""A sweep on a SLURM cluster: rows handed to its queue, then watched by what they write, from any machine."""

from __future__ import annotations

import time
from collections import Counter

from sag.sweep.heartbeat import is_alive, is_lost
from sag.sweep.interrupts import Interrupts
from sag.sweep.runner import Display
from sag.sweep.search import Search
from sag.sweep.slurm_queue import Queue
from sag.sweep.status import read_progress, read_status
from sag.sweep.tracked import Tracked

POLL = 1.0
"""Seconds between two looks at the rows."""

ASK = 10.0
"""Seconds between two questions to SLURM, which serves others too."""

AGAIN = 3
"""How often a row is handed over again because its heartbeat has stopped."""


class Watcher:
    """Hands rows over and follows them. The rows do not need it: when it ends they go on.

    Args:
        tracked: every row with its state; what a search adds is appended.
        queue: of the cluster.
        display: told of every change.
        search: adds rows as others end.
        width: rows of a search at a time.
    """

    def __init__(
        self, tracked: list[Tracked], queue: Queue, display: Display, search: Search | None = None, width: int = 1
    ) -> None:
        self.tracked = tracked
        self.queue = queue
        self.display = display
        self.search = search
        self.width = width
        self.held: dict[str, str] | None = {}
        self.asked = 0.0
        self.again: Counter[str] = Counter()

    def submit(self) -> None:
        """Hands over every row that waits and that the queue does not have."""
        self._ask()
        self._submit([t for t in self.tracked if t.status.state == "waiting" and not self._is_held(t)])

    def run(self, interrupts: Interrupts) -> None:
        """Follows the rows until none runs or will run, or the user interrupts, which ends no row."""
        self._extend()
        while not interrupts.count and any(map(self._goes_on, self.tracked)):
            time.sleep(POLL)
            if time.monotonic() - self.asked >= ASK:
                self._ask()
            else:
                self._look()
            self._submit_lost()
            self._extend()
            self.display.tick()

    def _submit_lost(self) -> None:
        """Hands rows over again whose machine or job has died under them."""
        lost = [t for t in self.tracked if self._is_lost(t)]
        self.again.update(t.row.name for t in lost)
        self._submit(lost)

    def _extend(self) -> None:
        """Hands over the next trial of a search when there is room."""
        if self.search is None or any(t.row.alone and t.status.state != "finished" for t in self.tracked):
            return
        trials = [t for t in self.tracked if t.row.trial is not None and self._goes_on(t)]
        added = self.search.more(self.tracked, self.width - len(trials))
        self.tracked += added
        self._submit(added)

    def _submit(self, rows: list[Tracked]) -> None:
        if rows:
            held = [t.row.name for t in self.tracked if t.row.alone and t.row.name in (self.held or {})]
            self.queue.submit(rows, after=held)
            self._ask()

    def _ask(self) -> None:
        """Asks SLURM, then looks at the rows: one that the queue does not have any more has written its last word."""
        self.held, self.asked = self.queue.held(), time.monotonic()
        self._look()

    def _is_held(self, tracked: Tracked) -> bool:
        """Whether the queue has the row's job, as far as that can be known."""
        return self.held is None or tracked.row.name in self.held

    def _goes_on(self, tracked: Tracked) -> bool:
        """Whether a row has not ended: it lives, its job is in the queue, or it is handed over again."""
        if tracked.status.state in ("finished", "failed"):
            return False
        return is_alive(tracked.status) or self._is_held(tracked) or self._is_lost(tracked)

    def _is_lost(self, tracked: Tracked) -> bool:
        lost = is_lost(tracked.status) and not self._is_held(tracked)
        return lost and self.again[tracked.row.name] < AGAIN

    def _look(self) -> None:
        """Takes in what the rows have written."""
        for tracked in self.tracked:
            before, now = tracked.status, read_status(tracked.folder)
            if now is None or before.state in ("finished", "failed"):
                continue
            tracked.status, tracked.progress = now, read_progress(tracked.folder)
            if now.state != before.state:
                self.display.changed(tracked)
