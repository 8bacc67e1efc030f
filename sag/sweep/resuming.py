"""Rows that go on: what an earlier try has left that the next one starts from, and what makes way."""

from __future__ import annotations

import shutil
import signal
from collections.abc import Sequence
from pathlib import Path

from sag.sweep.status import METRICS, PROGRESS, STATUS, Status

CHECKPOINTS = "checkpoints"
GO_ON = "--ckpt_path=last"
"""What tells a row to go on from its newest good checkpoint."""

STOPPED = (75, 128 + signal.SIGINT, 128 + signal.SIGTERM, 128 + signal.SIGKILL)
"""Exit statuses of a row that the machine or the user has stopped: no room on the disk, and signals."""


def was_stopped(status: Status) -> bool:
    """Whether the machine or the user ended a row, and not a mistake in it or in its code."""
    if status.state != "failed":
        return status.state != "finished"
    return status.returncode is not None and (status.returncode < 0 or status.returncode in STOPPED)


def goes_on(command: Sequence[str], folder: Path) -> bool:
    """Whether a row trains by this program, and has a checkpoint of the very same command to go on from.

    Checkpoints of another command, or of a row that failed by itself, are removed by `forget` before.
    """
    trains = "run" in command or "fit" in command
    return trains and any((folder / CHECKPOINTS).glob("*.ckpt"))


def forget(folder: Path) -> None:
    """Removes checkpoints that nothing may go on from."""
    shutil.rmtree(folder / CHECKPOINTS, ignore_errors=True)


def clear(folder: Path, going_on: bool) -> None:
    """Removes what an earlier try has left, but its status: without it nobody could tell whose folder this is.

    Args:
        folder: of the row.
        going_on: whether checkpoints, log and W&B's files stay, since the next try is the same run.
    """
    for path in folder.iterdir():
        if going_on and path.name not in (METRICS, PROGRESS):
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path.name != STATUS:
            path.unlink()


def remove_strays(folder: Path) -> None:
    """Removes files that a killed process was about to rename; only when none that writes there is alive.

    Args:
        folder: of a row or of the sweep; its folder of checkpoints is looked at too.
    """
    for place in (folder, folder / CHECKPOINTS):
        for stray in place.glob(".*.[0-9]*"):
            if stray.suffix[1:].isdecimal():
                shutil.rmtree(stray) if stray.is_dir() else stray.unlink()
