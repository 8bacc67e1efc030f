"""The runner: starts rows as places get free, watches them, and keeps their status on disk."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager
from types import FrameType, TracebackType
from typing import Any, Protocol, runtime_checkable

from sag.sweep import process
from sag.sweep.resuming import GO_ON, goes_on
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


class Interrupts(AbstractContextManager["Interrupts"]):
    """Counts Ctrl-C, SIGTERM and a closed terminal instead of dying of them."""

    SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

    def __init__(self) -> None:
        self.count = 0
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Interrupts:
        self._before = {s: signal.signal(s, self._counted) for s in self.SIGNALS}
        return self

    def _counted(self, number: int, frame: FrameType | None) -> None:
        self.count += 1

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


class Runner:
    """Runs the rows that wait, some at a time.

    Args:
        name: the sweep's, W&B's group.
        tracked: every row with its state.
        jobs: rows at a time.
        display: told of every change.
    """

    def __init__(self, name: str, tracked: Sequence[Tracked], jobs: int, display: Display) -> None:
        self.name = name
        self.tracked = tracked
        self.jobs = jobs
        self.display = display

    def run(self, interrupts: Interrupts) -> None:
        """Runs until every row has ended, a row that the others need has failed, or the user interrupts."""
        while not interrupts.count and (self.running or self.ready):
            for tracked in self.ready[: self.jobs - len(self.running)]:
                self._start(tracked)
            self._watch()
        if self.running:
            self._stop(interrupts)

    @property
    def running(self) -> list[Tracked]:
        """Rows that run."""
        return [t for t in self.tracked if t.process]

    @property
    def ready(self) -> list[Tracked]:
        """Rows that may start: a row that all wait for comes first, and nothing comes after it when it fails."""
        awaited = [t for t in self.tracked if t.row.alone and t.status.state != "finished"]
        return [t for t in awaited or self.tracked if t.status.state == "waiting"]

    def _start(self, tracked: Tracked) -> None:
        threads = max(1, process.cores() // (1 if tracked.row.alone else self.jobs))
        going_on = goes_on(tracked.row.command, tracked.folder)
        place = f"--trainer.default_root_dir={tracked.folder}"
        command = (*tracked.row.command, *([GO_ON] if going_on else []), place)
        environment = process.row_environment(self.name, tracked.row.name, threads)
        tracked.process = process.start(command, tracked.folder, environment, going_on)
        tracked.set(state="running", command=command, pid=tracked.process.pid, started=time.time())
        self.display.changed(tracked)

    def _watch(self) -> None:
        """Waits a moment, then takes in what has happened."""
        time.sleep(POLL)
        for tracked in self.running:
            tracked.progress = read_progress(tracked.folder)
            if tracked.process and tracked.process.poll() is not None:
                self._ended(tracked, tracked.process)
        self.display.tick()

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
            insisted = interrupts.count > 1 or time.monotonic() > deadline
            for tracked in self.running:
                if tracked.process and insisted:
                    process.send(tracked.process, signal.SIGKILL)
                if tracked.process and tracked.process.poll() is not None:
                    self._ended(tracked, tracked.process, interrupted=True)
            time.sleep(POLL / 4)
            self.display.tick()
