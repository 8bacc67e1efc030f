"""A sweep's rows with what is on disk of each: what need not run again, and what makes way."""

from __future__ import annotations

import glob
import os
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.sweep import process
from sag.sweep.resuming import forget, remove_strays, was_stopped
from sag.sweep.rows import Row
from sag.sweep.status import METRICS, Progress, Status, read_status

REPLACED = "replaced"
"""Folder beside the rows that keeps those which another command or config has taken the place of."""


@dataclass
class Tracked:
    """A row while the sweep runs.

    Attributes:
        row: what is run.
        folder: where it writes.
        status: as on disk.
        progress: the row's own word.
        process: while it runs.
    """

    row: Row
    folder: Path
    status: Status
    progress: Progress = field(default_factory=Progress)
    process: subprocess.Popen[bytes] | None = None

    def set(self, **changes: Any) -> None:
        """Changes the status, here and on disk."""
        self.status = replace(self.status, **changes)
        self.status.write(self.folder)


def track(rows: Sequence[Row], out: Path) -> list[Tracked]:
    """Every row with its state: finished rows stay so unless something changed, all others wait.

    A row left running by a sweep that was killed is ended first. Checkpoints of a row that was stopped stay, if its
    command is still the same, so that it goes on. A row that has finished under the same command in a sweep beside
    this one is copied from there.

    Raises:
        SagError: a row's folder holds what no sweep wrote.
    """
    tracked = []
    remove_strays(out)
    for row in rows:
        folder = out / row.name
        before = read_status(folder)
        waiting = Tracked(row, folder, Status("waiting", row.command, row.fingerprint))
        if before and is_finished(before, row, folder):
            waiting.status = before
        else:
            _make_way(before, row, folder)
            waiting.status = _from_beside(row, folder) or waiting.status
            waiting.status.write(folder)
        tracked.append(waiting)
    return tracked


def _make_way(before: Status | None, row: Row, folder: Path) -> None:
    """Ends what was left running; what had finished under another command is moved, not emptied."""
    if before and before.state == "finished" and (folder / METRICS).is_file():
        kept = folder.parent / REPLACED / f"{folder.name}-{before.command_hash[:8]}"
        shutil.rmtree(kept, ignore_errors=True)
        kept.parent.mkdir(exist_ok=True)
        folder.rename(kept)
    elif before:
        process.stop_leftover(before)
        remove_strays(folder)
        if before.command_hash != row.fingerprint or not was_stopped(before):
            forget(folder)
    elif folder.is_dir() and any(folder.iterdir()):
        raise SagError(f"{folder} holds files that no sweep wrote; move them away or choose another --out")


def _from_beside(row: Row, folder: Path) -> Status | None:
    """The row's status after a copy from another sweep that has run the very same; None where none has."""
    for other in sorted(folder.parent.parent.glob(f"*/{glob.escape(row.name)}")):
        status = read_status(other) if other != folder else None
        if status and is_finished(status, row, other):
            partial = folder.with_name(f".{folder.name}.{os.getpid()}")
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(other, partial)
            partial.rename(folder)
            return replace(status, taken_from=status.taken_from or str(other))
    return None


def is_finished(status: Status, row: Row, folder: Path) -> bool:
    """Whether the row need not run: it ended well, nothing it reads has changed, its figures are there."""
    unchanged = status.state == "finished" and status.command_hash == row.fingerprint
    return unchanged and (not row.measured or (folder / METRICS).is_file())
