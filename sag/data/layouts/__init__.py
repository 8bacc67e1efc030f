"""Synthetic rooms written exactly as GTA-IM and PROX lie on disk.

Whoever holds neither data set can still run every line of their loaders, from the first file to the trained row.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from sag.data.layouts import gta_im, prox
from sag.data.layouts.script import Script
from sag.data.workers import shared_out
from sag.errors import SagError

__all__ = ["LAYOUTS", "Layout", "Script", "write_layout"]


@dataclass(frozen=True)
class Layout:
    """How a data set lies on disk.

    Attributes:
        rooms: how many rooms the data set has.
        usual: how many are written when nobody says.
        sparse: whether frames may go without pictures.
        write_room: films a room of a script and writes it to a folder.
    """

    rooms: int
    usual: int
    sparse: bool
    write_room: Callable[[Path, Script, int], None]


LAYOUTS: dict[str, Layout] = {
    "gta-im": Layout(len(gta_im.ROOMS), 7, True, gta_im.write_room),
    "prox": Layout(len(prox.SCENES), 4, False, prox.write_room),
}
"""Every layout by the name that the command line gives it."""


def write_layout(name: str, folder: Path, script: Script, workers: int = 1) -> None:
    """Films a script and writes it in the layout of a data set: whole, or not at all.

    Args:
        name: in `LAYOUTS`.
        folder: is made, or is empty.
        script: what is filmed.
        workers: processes; they do not change what is written.

    Raises:
        SagError: the folder is not empty, or the data set has fewer rooms or a picture of every frame.
    """
    layout = LAYOUTS[name]
    if script.rooms > layout.rooms:
        raise SagError(f"--rooms must be at most {layout.rooms}, the rooms of {name}, found {script.rooms}")
    if script.every > 1 and not layout.sparse:
        raise SagError(f"--every must be 1 for {name}, whose frames are known by their pictures; found {script.every}")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise SagError(f"{folder} is not empty: give --layout {name} a new folder, nothing is written over")
    partly = folder.with_name(f"{folder.name}.partial-{os.getpid()}")
    partly.mkdir(parents=True)
    try:
        for _ in shared_out(partial(layout.write_room, partly, script), script.rooms, workers, f"{name}: filming"):
            pass
        if folder.exists():
            folder.rmdir()
        partly.rename(folder)
    finally:
        shutil.rmtree(partly, ignore_errors=True)
