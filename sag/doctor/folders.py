"""Folders: whether data and runs can be written, renamed and locked, and whether they fit."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from pathlib import Path

from sag.data.check.report import Line

DATA, RUNS = 0.6e9, 0.5e9
"""Bytes that `make ablation` writes: the rooms' cache with encoders, and 16 rows."""

ROOM = 3
"""Times as much space as is needed, below which one should know."""


def folder_line(name: str, folder: Path, needed: float, way_out: str) -> Line:
    """Whether a folder takes what is to be written.

    Args:
        name: what it is for.
        folder: which need not be there yet.
        needed: bytes.
        way_out: how another one is chosen.
    """
    place = _there(folder)
    try:
        _write(place)
        free = shutil.disk_usage(place).free
    except OSError as error:
        said = f"{folder} cannot be written ({place}: {error.strerror})"
        return Line(name, said, "broken", (f"chown or chmod it, or {way_out}",))
    said = f"{folder.resolve()}, {free / 1e9:.1f} GB free, {needed / 1e9:.1f} needed"
    if free < needed:
        return Line(name, said, "broken", (f"make room, or {way_out}",))
    return Line(
        name, said, "ok" if free > ROOM * needed else "look", () if free > ROOM * needed else ("room for little more",)
    )


def needed_for_data(folder: Path) -> float:
    """What a data folder still takes: nothing where the rooms are there."""
    return 0.0 if any(folder.glob("rooms-*/index.json")) else DATA


def clone_line() -> Line:
    """Whether the working folder holds the configs that commands name."""
    missing = [name for name in ("configs/base.yaml", "sweeps/ablation.yaml", "Makefile") if not Path(name).is_file()]
    if not missing:
        return Line("here", "configs, sweeps and Makefile", "ok")
    way = "cd to the clone: commands name configs from there"
    return Line("here", f"{Path.cwd()} has no {missing[0]}", "look", (way,))


def _there(folder: Path) -> Path:
    """The folder, or the nearest above it that exists."""
    folder = folder.resolve()
    return next(place for place in (folder, *folder.parents) if place.exists())


def _write(place: Path) -> None:
    """Does what runs do with files: write, sync, lock, rename; a place of another kind than a folder is refused."""
    descriptor, name = tempfile.mkstemp(prefix=".sag-doctor-", dir=place)
    renamed = f"{name}.renamed"
    try:
        os.write(descriptor, b"sag")
        os.fsync(descriptor)
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.replace(name, renamed)
    finally:
        os.close(descriptor)
        for left in (name, renamed):
            Path(left).unlink(missing_ok=True)
