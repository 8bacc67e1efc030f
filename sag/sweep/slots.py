"""Slots: the places on this machine in which rows run, each with a share of its cores and GPUs."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass

from sag.errors import SagError
from sag.sweep import process

USUAL = 2
"""Slots of a machine without GPUs, where nobody says how many."""


@dataclass(frozen=True)
class Slot:
    """A place for one row at a time.

    Attributes:
        threads: cores for its arithmetic.
        gpus: those that it sees; None leaves that as it is.
    """

    threads: int
    gpus: str | None = None

    def environment(self) -> dict[str, str]:
        """What a row in this slot finds in its environment."""
        threads = {"OMP_NUM_THREADS": str(self.threads), "MKL_NUM_THREADS": str(self.threads)}
        return threads if self.gpus is None else {**threads, "CUDA_VISIBLE_DEVICES": self.gpus}


def slots(jobs: int | None = None, gpus_each: int | None = None) -> list[Slot]:
    """The slots of this machine: one for each GPU, or as many as asked, which then share the GPUs and cores.

    Args:
        jobs: how many; by default one for each GPU, or two where there is none.
        gpus_each: GPUs of a slot, 1 by default.

    Raises:
        SagError: a row wants more GPUs than there are.
    """
    found = visible_gpus()
    if gpus_each is not None and gpus_each > len(found):
        raise SagError(f"--gpus {gpus_each}: this machine shows {len(found)} GPUs; ask for fewer, or add --slurm")
    each = 1 if gpus_each is None else gpus_each
    groups = [",".join(found[i : i + each]) for i in range(0, len(found) - each + 1, each)] if each else [""]
    count = jobs or len(groups) or USUAL
    threads = max(1, min(process.cores() // count, _most_threads()))
    return [Slot(threads, groups[i % len(groups)] if groups else None) for i in range(count)]


def _most_threads() -> int:
    """What `OMP_NUM_THREADS` allows, where somebody has set it: a row beside other work stands still with more."""
    said = os.environ.get("OMP_NUM_THREADS", "")
    return int(said) if said.isdecimal() and int(said) else process.cores()


def visible_gpus() -> list[str]:
    """GPUs that this process may use, as `CUDA_VISIBLE_DEVICES` names them; none where there is no driver."""
    chosen = os.environ.get("CUDA_VISIBLE_DEVICES")
    if chosen is not None:
        return [name.strip() for name in chosen.split(",") if name.strip() not in ("", "-1")]
    command = ["nvidia-smi", "--query-gpu=index", "--format=csv,noheader"]
    try:
        listed = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return []
    return listed.split()
