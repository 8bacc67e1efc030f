"""`sag data rooms --layout`: writes rooms as another data set lies on disk."""

from __future__ import annotations

import argparse
from pathlib import Path

from sag.data.layouts import LAYOUTS, write_layout
from sag.data.layouts.script import Script
from sag.errors import SagError


def add_options(rooms: argparse.ArgumentParser) -> None:
    """Adds the options of layouts to those of `sag data rooms`."""
    usual = ", ".join(f"{layout.usual} for {name}" for name, layout in LAYOUTS.items())
    group = rooms.add_argument_group("rooms in the layout of another data set")
    group.add_argument("folder", type=Path, nargs="?", metavar="DIR", help="new or empty folder to write to")
    group.add_argument("--layout", choices=LAYOUTS, help="write rooms to DIR as this data set lies on disk")
    group.add_argument("--rooms", type=int, metavar="N", help=f"how many rooms (default: {usual})")
    group.add_argument("--recordings", type=int, default=Script.recordings, metavar="N", help="of a room (default: 2)")
    group.add_argument("--seconds", type=float, default=Script.seconds, help="of a recording (default: 4)")
    group.add_argument(
        "--size", type=int, nargs=2, default=Script.size, metavar=("ROWS", "COLUMNS"),
        help="of the colour pictures (default: 216 384; the data sets have 1080 1920)",
    )  # fmt: skip
    group.add_argument(
        "--every", type=int, default=Script.every, metavar="N",
        help="pictures of every so many frames; windows start every five (default: 1, all frames)",
    )  # fmt: skip


def write(asked: argparse.Namespace) -> None:
    """Writes the layout that was asked for, and says how to train on it.

    Raises:
        SagError: no folder is given, or it is not empty.
    """
    if asked.folder is None:
        raise SagError(f"--layout {asked.layout} needs the folder to write to: sag data rooms --layout NAME DIR")
    rooms = LAYOUTS[asked.layout].usual if asked.rooms is None else asked.rooms
    script = Script(rooms, asked.recordings, asked.seconds, tuple(asked.size), asked.every, asked.seed)
    write_layout(asked.layout, asked.folder, script, asked.workers)
    config = asked.layout.replace("-", "_")
    print(f"{asked.folder}: {rooms} rooms as {asked.layout}; to train: make ablation DATA={config} ROOT={asked.folder}")
