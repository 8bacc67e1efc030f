"""SLURM's queue: rows handed to it by submitit as job arrays, and which of them it still has."""

from __future__ import annotations

import getpass
import importlib
import json
import subprocess
import uuid
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from sag.errors import SagError
from sag.files import write_json
from sag.sweep.slurm_job import WARNING, SlurmJob
from sag.sweep.status import read_status
from sag.sweep.tracked import Tracked

FOLDER = "slurm"
"""Folder beside the rows in which submitit keeps its scripts and logs."""

JOBS = "jobs.json"
"""File in it that tells which job each row was handed to."""

ENDING = "COMPLETING"
"""State of a job that has ended or is to be queued again, while its node cleans up."""

WARNED = 90
"""Seconds before a job's time is over at which it is told so."""


@dataclass(frozen=True)
class Submission:
    """How rows are handed to SLURM.

    Attributes:
        flags: sbatch's long options with their values, such as `partition`.
        parallel: rows of an array that run at a time, or None for as many as SLURM likes.
    """

    flags: dict[str, str]
    parallel: int | None = None


class Handed(NamedTuple):
    """What is known of a row that was handed over: its job, as `squeue` lists it, and the ticket that the job has."""

    job: str
    ticket: str


class Queue:
    """The queue of the cluster that this machine belongs to.

    Args:
        name: of the sweep; jobs are called after it.
        out: folder of the rows, which all machines of the cluster see.
        submission: how rows are handed over.

    Raises:
        SagError: there is no SLURM, or submitit is not installed.
    """

    def __init__(self, name: str, out: Path, submission: Submission) -> None:
        self.name = name
        self.folder = out / FOLDER
        self.submission = submission
        self.out = out
        self.jobs: dict[str, Handed] = {}
        with suppress(OSError, ValueError):
            self.jobs = {row: Handed(*handed) for row, handed in json.loads((self.folder / JOBS).read_text()).items()}
        self._submitit = _submitit()
        try:
            self._submitit.SlurmExecutor(self.folder)
        except RuntimeError as error:
            raise SagError("--slurm: there is no SLURM here (srun is missing); leave --slurm out") from error

    def held(self) -> dict[str, str] | None:
        """Rows whose job is still theirs, with its state, such as `PENDING`; None where SLURM does not answer."""
        command = ["squeue", "--noheader", "--array", "--format=%i %T", f"--user={getpass.getuser()}"]
        try:
            listed = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
        except (OSError, subprocess.SubprocessError):
            return None
        states = dict(line.split() for line in listed.splitlines())
        mine = {row: handed.job for row, handed in self.jobs.items() if self._is_valid(row, handed)}
        return {row: states[job] for row, job in mine.items() if job in states}

    def _is_valid(self, row: str, handed: Handed) -> bool:
        status = read_status(self.out / row)
        return status is not None and status.ticket == handed.ticket

    def submit(self, rows: Sequence[Tracked], after: Sequence[str] = ()) -> None:
        """Hands rows over, as one array; those that all wait for as a job before it, on which it depends.

        Args:
            rows: that are to run.
            after: rows that were handed over before, and which the array waits for too.

        Raises:
            SagError: SLURM refuses them; its own words are in the message.
        """
        first = [tracked for tracked in rows if tracked.row.alone]
        rest = [tracked for tracked in rows if not tracked.row.alone]
        awaited = self._submit(first, {}) + [self.jobs[name].job for name in after]
        depends = {"dependency": f"afterok:{':'.join(awaited)}", "kill-on-invalid-dep": "yes"} if awaited else {}
        self._submit(rest, depends)

    def _submit(self, rows: Sequence[Tracked], depends: dict[str, str]) -> list[str]:
        """The ids of the jobs. Each row gets a new ticket before, so that a job of an earlier one leaves it alone."""
        if not rows:
            return []
        ticket = uuid.uuid4().hex[:12]
        for tracked in rows:
            tracked.status = replace(tracked.status, state="waiting", ticket=ticket)
            tracked.status.write(tracked.folder)
        jobs = [SlurmJob(self.name, tracked.row, tracked.folder.absolute(), ticket) for tracked in rows]
        try:
            submitted = self._executor(depends).submit_array(jobs)
        except self._submitit.core.utils.FailedJobError as error:
            raise SagError(f"SLURM refuses the jobs: {' '.join(str(error).split())}") from error
        self.jobs.update({tracked.row.name: Handed(job.job_id, ticket) for tracked, job in zip(rows, submitted)})
        write_json(self.folder / JOBS, self.jobs)
        return [job.job_id for job in submitted]

    def _executor(self, depends: dict[str, str]) -> Any:
        executor = self._submitit.SlurmExecutor(self.folder)
        flags = {"requeue": True, "signal": f"{WARNING.name[3:]}@{WARNED}", **self.submission.flags, **depends}
        executor.update_parameters(
            job_name=f"sag-{self.name}", time=None, wckey=None, additional_parameters=flags, stderr_to_stdout=True
        )
        if self.submission.parallel is not None:
            executor.update_parameters(array_parallelism=self.submission.parallel)
        return executor


def _submitit() -> Any:
    try:
        return importlib.import_module("submitit")
    except ImportError as error:
        raise SagError("--slurm needs submitit, which is not installed; pip install 'sag[slurm]'") from error
