"""What is known of a row on disk: `status.json`, written here, and `progress.json`, written by the row."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from sag.errors import SagError
from sag.files import write_json

State = Literal["waiting", "running", "finished", "failed", "interrupted"]

STATUS = "status.json"
PROGRESS = "progress.json"
METRICS = "metrics.json"
LOG = "log.txt"
LOCK = ".sweep.lock"

FIT_SHARE = 0.9
"""How much of a row's time its training takes, roughly; the rest is its test."""


@dataclass(frozen=True)
class Status:
    """The state of a row.

    Attributes:
        state: a failed or interrupted row, or a running one whose process is gone, is run again.
        command: what was run.
        command_hash: fingerprint of the command and its configs.
        pid: process and process group of the row.
        started: seconds since the epoch.
        ended: seconds since the epoch.
        returncode: exit status, negative for a signal.
        reason: why it failed, in one line.
        taken_from: folder of the row that this is a copy of, in a sweep that ran the same command before.
        heartbeat: seconds since the epoch when the row was last seen alive by what started it.
        host: machine that it runs on.
        gpus: `CUDA_VISIBLE_DEVICES` of its slot, where the machine has any.
        job: of the scheduler that started it.
        ticket: of the submission that may run it: a job with another one leaves the row alone.
        trial: number of the row in a search.
        point: values that the search has drawn for it.
    """

    state: State
    command: tuple[str, ...]
    command_hash: str
    pid: int | None = None
    started: float | None = None
    ended: float | None = None
    returncode: int | None = None
    reason: str | None = None
    taken_from: str | None = None
    heartbeat: float | None = None
    host: str | None = None
    gpus: str | None = None
    job: str | None = None
    ticket: str | None = None
    trial: int | None = None
    point: dict[str, Any] | None = None

    def write(self, folder: Path) -> None:
        """Replaces the row's `status.json` whole: a reader never sees half of it."""
        write_json(folder / STATUS, asdict(self))

    @property
    def seconds(self) -> float | None:
        """How long the row ran, once it has ended."""
        return None if self.started is None or self.ended is None else self.ended - self.started


def read_status(folder: Path) -> Status | None:
    """The state of the row in this folder; None where there is none or it cannot be read."""
    try:
        content = json.loads((folder / STATUS).read_text())
        return Status(**{**content, "command": tuple(content["command"])})
    except (OSError, ValueError, TypeError, KeyError):
        return None


@dataclass(frozen=True)
class Progress:
    """How far a row says it is.

    Attributes:
        step: steps done in this stage.
        steps: steps of this stage.
        stage: `fit` or `test`.
    """

    step: int = 0
    steps: int = 0
    stage: str = ""

    @property
    def fraction(self) -> float:
        """Share of the whole row, 0 to 1."""
        done = min(self.step / self.steps, 1.0) if self.steps > 0 else 0.0
        return FIT_SHARE + (1 - FIT_SHARE) * done if self.stage == "test" else FIT_SHARE * done


def read_progress(folder: Path) -> Progress:
    """The row's own word; nothing yet where its file is missing or half written."""
    try:
        content = json.loads((folder / PROGRESS).read_text())
        return Progress(int(content["step"]), int(content["steps"]), str(content["stage"]))
    except (OSError, ValueError, TypeError, KeyError):
        return Progress()


@contextmanager
def locked(out: Path) -> Iterator[None]:
    """Holds a folder for one sweep. The lock dies with its process, however that ends.

    Raises:
        SagError: another sweep that is alive holds the folder.
    """
    out.mkdir(parents=True, exist_ok=True)
    with (out / LOCK).open("a+") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            file.seek(0)
            holder = file.read().strip() or "unknown"
            raise SagError(f"{out} is used by another sweep (process {holder}); wait for it or choose --out") from error
        file.truncate(0)
        file.write(str(os.getpid()))
        file.flush()
        yield
