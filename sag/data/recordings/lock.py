"""A folder that one process at a time fills."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

try:
    import fcntl
except ImportError:  # where there are no such locks, two conversions of one data set must not run at once
    fcntl = None  # type: ignore[assignment]

LOCK = "lock"
"""File of the folder that is locked; it is gone when the folder is removed."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Makes a folder and keeps other processes out of it, after waiting for those that are in it."""
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / LOCK).open("w") as lock:
            if fcntl is not None:
                _wait(lock, folder)
            # Whoever held the lock before may have removed the folder with it.
            if (folder / LOCK).exists() and os.path.samestat(os.fstat(lock.fileno()), (folder / LOCK).stat()):
                yield
                return


def _wait(lock: TextIO, folder: Path) -> None:
    """Takes the lock, and says so where that takes time."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        print(f"waiting for another process that fills {folder}", flush=True)
        fcntl.flock(lock, fcntl.LOCK_EX)
