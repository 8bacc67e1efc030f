"""The runner: starts rows as slots get free, watches them, and keeps their status on disk."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from sag.sweep import heartbeat, process
from sag.sweep.interrupts import Interrupts
from sag.sweep.resuming import GO_ON, goes_on
from sag.sweep.search import Search
from sag.sweep.slots import Slot
from sag.sweep.status import METRICS, read_progress
from sag.sweep.tracked import Tracked

POLL = 0.2
"""Seconds between two looks at the rows."""


@runtime_checkable
class Display(Protocol):
    """Shows a sweep to the user."""

    def changed(self, tracked: Tracked) -> None:
        """A row has another state."""

    def tick(self) -> None:
        """Some time has passed."""


class Runner:
    """Runs the rows that wait, one in each slot.

    Args:
        name: the sweep's, W&B's group.
        tracked: every row with its state; what a search adds is appended.
        slots: where rows run.
        display: told of every change.
        search: adds rows as others end.
    """

    def __init__(
        self,
        name: str,
        tracked: list[Tracked],
        slots: Sequence[Slot],
        display: Display,
        search: Search | None = None,
    ) -> None:
        self.name = name
        self.tracked = tracked
        self.slots = slots
        self.display = display
        self.search = search

    def run(self, interrupts: Interrupts) -> None:
        """Runs until every row has ended, a row that the others need has failed, or the user interrupts."""
        try:
            while not interrupts.count and self._extend():
                for tracked, slot in zip(self.ready, self._free()):
                    self._start(tracked, slot)
                self._watch()
        finally:
            self._stop(interrupts)

    @property
    def running(self) -> list[Tracked]:
        """Rows that run."""
        return [t for t in self.tracked if t.process]

    @property
    def ready(self) -> list[Tracked]:
        """Rows that may start: a row that all wait for comes first, and nothing comes after it when it fails."""
        return [t for t in self._awaited or self.tracked if t.status.state == "waiting"]

    @property
    def _awaited(self) -> list[Tracked]:
        return [t for t in self.tracked if t.row.alone and t.status.state != "finished"]

    def _extend(self) -> bool:
        """Lets a search fill the slots that nothing waits for; whether there is anything to do."""
        if self.search and not self._awaited:
            room = len(self.slots) - len(self.running) - len(self.ready)
            self.tracked += self.search.more(self.tracked, room)
        return bool(self.running or self.ready)

    def _free(self) -> list[Slot]:
        free = list(self.slots)
        for tracked in self.running:
            free.remove(tracked.slot)  # type: ignore[arg-type]
        return free

    def _start(self, tracked: Tracked, slot: Slot) -> None:
        going_on = goes_on(tracked.row.command, tracked.folder)
        place = f"--trainer.default_root_dir={tracked.folder}"
        command = (*tracked.row.command, *([GO_ON] if going_on else []), place)
        share = slot.environment()
        environment = process.row_environment(self.name, tracked.row.name, share)
        tracked.process, tracked.slot = process.start(command, tracked.folder, environment, going_on), slot
        tracked.started(command, tracked.process.pid, slot.gpus)
        self.display.changed(tracked)

    def _watch(self) -> None:
        """Waits a moment, then takes in what has happened."""
        time.sleep(POLL)
        for tracked in self.running:
            tracked.progress = read_progress(tracked.folder)
            self._beat(tracked)
            if tracked.process and tracked.process.poll() is not None:
                self._ended(tracked, tracked.process)
        self.display.tick()

    def _beat(self, tracked: Tracked) -> None:
        """Says that a row lives; a row that was given to another job meanwhile has to go."""
        if tracked.process and heartbeat.is_due(tracked.status):
            tracked.set(heartbeat=time.time())
            if tracked.superseded:
                process.send(tracked.process, signal.SIGKILL)

    def _ended(self, tracked: Tracked, ended: subprocess.Popen[bytes], interrupted: bool = False) -> None:
        process.send(ended, signal.SIGKILL)  # what the row may have left behind
        tracked.process = None
        code, state, reason = ended.returncode, "finished", None
        if code or (tracked.row.measured and not (tracked.folder / METRICS).is_file()):
            state = "failed"
            reason = process.why(code, tracked.folder) if code else f"it ended without writing {METRICS}"
        if interrupted and (reason or not tracked.row.measured):  # a row may take the request to end as success
            state, reason = "interrupted", "interrupted"
        tracked.set(state=state, ended=time.time(), returncode=code, reason=reason)
        self.display.changed(tracked)

    def _stop(self, interrupts: Interrupts) -> None:
        """Asks every row to end, kills those that do not, at once when the user insists."""
        deadline = time.monotonic() + process.GRACE
        for tracked in self.running:
            process.send(tracked.process, signal.SIGTERM)  # type: ignore[arg-type]
        while self.running:
            insisted = interrupts.insisted or time.monotonic() > deadline
            for tracked in self.running:
                if tracked.process and insisted:
                    process.send(tracked.process, signal.SIGKILL)
                if tracked.process and tracked.process.poll() is not None:
                    self._ended(tracked, tracked.process, interrupted=True)
            time.sleep(POLL / 4)
            self.display.tick()
