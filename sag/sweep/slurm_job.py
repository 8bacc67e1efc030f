"""What a SLURM job does: it runs one row as a sweep does here, and asks to be queued again when it must go."""

from __future__ import annotations

import os
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path

from sag.errors import SagError
from sag.sweep import process
from sag.sweep.interrupts import SIGNALS, Interrupts
from sag.sweep.resuming import CHECKPOINTS, forget, remove_strays, was_stopped
from sag.sweep.rows import Row
from sag.sweep.runner import Runner
from sag.sweep.slots import Slot
from sag.sweep.status import read_status
from sag.sweep.tracked import Tracked

WARNING = signal.SIGUSR2
"""Signal by which SLURM tells that a job's time is nearly over."""

IDLE_RESTARTS = 3
"""How often a row may be queued again without a new checkpoint: then its time is too short to get anywhere."""


class Silent:
    """Shows nothing: the row's status tells all."""

    def changed(self, tracked: Tracked) -> None:
        """Says in the job's own log what has happened."""
        print(f"{tracked.row.name}: {tracked.status.state} {tracked.status.reason or ''}", flush=True)

    def tick(self) -> None:
        """Nothing to show."""


@dataclass(frozen=True)
class SlurmJob:
    """One row as a job.

    Attributes:
        sweep: name of the sweep, W&B's group.
        row: what is run.
        folder: where it writes, absolute.
        ticket: of the submission.
    """

    sweep: str
    row: Row
    folder: Path
    ticket: str

    def __call__(self) -> None:
        """Runs the row, unless it has finished or was given to another job.

        Raises:
            SagError: the row failed, so that the job does too.
        """
        status = read_status(self.folder)
        if status is None or status.ticket != self.ticket or status.state == "finished":
            print(f"{self.row.name} is not this job's any more", flush=True)
            return
        remove_strays(self.folder)
        if not was_stopped(status):
            forget(self.folder)
        tracked = Tracked(self.row, self.folder, status)
        tracked.set(state="waiting", job=_job_id())
        with Interrupts((*SIGNALS, WARNING), patient=True) as interrupts:
            Runner(self.sweep, [tracked], [Slot(process.cores())], Silent()).run(interrupts)
        if tracked.status.state == "interrupted" and _still_wanted():
            _queue_again(tracked)
        if tracked.status.state == "failed":
            raise SagError(f"{self.row.name} failed: {tracked.status.reason}; its log is in {self.folder}")


def _job_id() -> str:
    """As `squeue` shows it."""
    array, place = os.environ.get("SLURM_ARRAY_JOB_ID"), os.environ.get("SLURM_ARRAY_TASK_ID")
    return f"{array}_{place}" if array else os.environ.get("SLURM_JOB_ID", "")


def _still_wanted() -> bool:
    """Whether SLURM ends the job for its time or for another job, and not because somebody has cancelled it."""
    return _slurm("squeue", "--noheader", "--format=%T", f"--jobs={os.environ['SLURM_JOB_ID']}") == "RUNNING"


def _queue_again(tracked: Tracked) -> None:
    newest = max((path.stat().st_mtime for path in (tracked.folder / CHECKPOINTS).glob("*.ckpt")), default=0.0)
    if newest < (tracked.status.started or 0.0) and int(os.environ.get("SLURM_RESTART_COUNT", 0)) >= IDLE_RESTARTS:
        tracked.set(state="failed", reason="its job's time ends before a checkpoint is written; give more by --time")
        return
    print(_slurm("scontrol", "requeue", os.environ["SLURM_JOB_ID"]), flush=True)


def _slurm(*command: str) -> str:
    """What SLURM says, or nothing where it does not answer."""
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout.strip()
    except (OSError, subprocess.SubprocessError) as error:
        return f"{' '.join(command)} failed: {error}"
