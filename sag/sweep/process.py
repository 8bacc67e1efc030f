"""Processes of rows: each leads its own group, logs to a file, and never outlives the sweep."""

from __future__ import annotations

import ctypes
import os
import platform
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from sag.sweep.resuming import clear
from sag.sweep.status import LOG, Status

GRACE = 10.0
"""Seconds between the request to end and the kill."""

WARNINGS = (signal.SIGUSR1, signal.SIGUSR2)
"""Signals by which schedulers tell that a job's time is nearly over."""

PR_SET_PDEATHSIG = 1
TERMINAL_CODES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
LIBC = ctypes.CDLL(None) if sys.platform == "linux" else None


def cores() -> int:
    """Cores that this process may use: of the machine, or of the SLURM job that it is in."""
    machine = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(machine, int(os.environ.get("SLURM_CPUS_ON_NODE") or machine))


def row_environment(group: str, name: str, slot: Mapping[str, str]) -> dict[str, str]:
    """The environment of a row: its place in W&B, and its share of cores and GPUs.

    In a SLURM job it looks interactive, or Lightning would take the job's tasks for its own and requeue it by itself.
    """
    own = {"WANDB_RUN_GROUP": group, "WANDB_NAME": name, "PYTHONUNBUFFERED": "1", **slot}
    job = {"SLURM_JOB_NAME": "interactive"} if "SLURM_JOB_ID" in os.environ else {}
    return {**os.environ, **own, **job}


def start(
    command: Sequence[str], folder: Path, environment: Mapping[str, str], going_on: bool = False
) -> subprocess.Popen[bytes]:
    """Starts a row in its folder, emptied of an earlier try unless it goes on from there; output goes to `log.txt`."""
    clear(folder, going_on)
    with (folder / LOG).open("ab") as log:
        return subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            env=dict(environment),
            start_new_session=True,
            preexec_fn=_before_row,
        )


def _before_row() -> None:
    """Asks Linux to kill this process when the sweep is gone, even by SIGKILL.

    Schedulers send their warnings to every process of a job: what to do about them the row is told by the sweep.
    """
    for number in WARNINGS:
        signal.signal(number, signal.SIG_IGN)
    if LIBC:
        LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def send(process: subprocess.Popen[bytes], sent: signal.Signals) -> None:
    """Signals a row and everything that it started."""
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, sent)


def stop_leftover(status: Status) -> None:
    """Ends a row that an earlier sweep left running on this machine, so that no two processes write to one folder."""
    here = status.host in (None, platform.node()) and status.job is None
    if status.state != "running" or not here:
        return
    if status.pid is None or status.command[-1] not in _command_line(status.pid):
        return
    deadline = time.monotonic() + GRACE
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(status.pid, signal.SIGTERM)
        while time.monotonic() < deadline and status.command[-1] in _command_line(status.pid):
            time.sleep(0.1)
        os.killpg(status.pid, signal.SIGKILL)


def _command_line(pid: int) -> list[str]:
    """The arguments of a process, none when it is gone: process ids are used again."""
    if Path("/proc/self/cmdline").exists():
        with suppress(OSError):
            return Path(f"/proc/{pid}/cmdline").read_text(errors="replace").rstrip("\0").split("\0")
        return []
    shown = subprocess.run(["ps", "-o", "command=", "-p", str(pid)], capture_output=True, text=True, check=False)
    return shown.stdout.split()


def tail(folder: Path, lines: int = 3) -> list[str]:
    """The last lines of a row's log that say something."""
    with suppress(OSError), (folder / LOG).open("rb") as log:
        log.seek(max(0, log.seek(0, os.SEEK_END) - 8192))
        text = TERMINAL_CODES.sub("", log.read().decode(errors="replace")).replace("\r", "\n")
        return [line.strip() for line in text.splitlines() if line.strip()][-lines:]
    return []


def why(returncode: int, folder: Path) -> str:
    """Why a row failed, in one line: the signal that ended it or the last line of its log."""
    last = (tail(folder, 1) or ["it said nothing"])[0]
    if returncode >= 0:
        return f"exit status {returncode}: {last}"
    return f"killed by {signal.Signals(-returncode).name}; last line: {last}"
