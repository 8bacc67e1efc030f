"""A sweep's rows with what is on disk of each: what need not run again, and what makes way."""

from __future__ import annotations

import glob
import os
import platform
import shutil
import subprocess
import time
from collections.abc import Container, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.sweep import process
from sag.sweep.heartbeat import is_elsewhere
from sag.sweep.resuming import forget, remove_strays, was_stopped
from sag.sweep.rows import Row
from sag.sweep.slots import Slot
from sag.sweep.status import LOG, METRICS, Progress, Status, read_progress, read_status

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
        process: while it runs here.
        slot: in which it runs here.
    """

    row: Row
    folder: Path
    status: Status
    progress: Progress = field(default_factory=Progress)
    process: subprocess.Popen[bytes] | None = None
    slot: Slot | None = None

    def set(self, **changes: Any) -> None:
        """Changes the status, here and on disk, where it stays as it is if the row was given to another job."""
        self.status = replace(self.status, **changes)
        if not self.superseded:
            self.status.write(self.folder)

    def started(self, command: tuple[str, ...], pid: int, gpus: str | None) -> None:
        """Notes that the row runs on this machine."""
        now, host = time.time(), platform.node()
        here = {"command": command, "pid": pid, "host": host, "gpus": gpus}
        self.set(state="running", **here, started=now, heartbeat=now, ended=None, returncode=None, reason=None)

    @property
    def superseded(self) -> bool:
        """Whether the row was given to another job, which alone may run it."""
        on_disk = read_status(self.folder)
        return on_disk is not None and on_disk.ticket != self.status.ticket


def track(rows: Sequence[Row], out: Path, kept: Container[str] = ()) -> list[Tracked]:
    """Every row with its state: finished rows stay so unless something changed, all others wait.

    A row left running by a sweep that was killed is ended first. Checkpoints of a row that was stopped stay, if its
    command is still the same, so that it goes on. A row that has finished under the same command in a sweep beside
    this one is copied from there.

    Args:
        rows: of the sweep.
        out: folder of the rows.
        kept: names of rows that a scheduler has, and which are left as they are unless something changed.

    Raises:
        SagError: a row's folder holds what no sweep wrote, or a row runs elsewhere.
    """
    before = {row.name: read_status(out / row.name) for row in rows}
    for row in rows:
        _check_elsewhere(row, before[row.name], out / row.name, row.name in kept)
    remove_strays(out)
    return [_tracked(row, before[row.name], out / row.name, row.name in kept) for row in rows]


def _check_elsewhere(row: Row, before: Status | None, folder: Path, kept: bool) -> None:
    """Refuses to take a row from whoever runs it, before anything is touched."""
    if before is None or not is_elsewhere(before) or (kept and before.command_hash == row.fingerprint):
        return
    where = f"on {before.host}" + (f" in job {before.job}" if before.job else "")
    raise SagError(f"row {row.name} runs {where}; wait for it or end it there (its log is {folder / LOG})")


def _tracked(row: Row, before: Status | None, folder: Path, kept: bool) -> Tracked:
    kept = kept and before is not None and before.state != "failed" and before.command_hash == row.fingerprint
    if before and (kept or is_finished(before, row, folder)):
        return Tracked(row, folder, before, read_progress(folder))
    _make_way(before, row, folder)
    waiting = Status("waiting", row.command, row.fingerprint, trial=row.trial, point=row.point)
    tracked = Tracked(row, folder, _from_beside(row, folder) or waiting)
    tracked.status.write(folder)
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
