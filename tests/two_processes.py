"""Work that two processes of this machine do together, over gloo, as Lightning starts them."""

from __future__ import annotations

import faulthandler
import os
import socket
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import torch
from torch.multiprocessing.spawn import spawn

PATIENCE = 900
"""Seconds after which processes that wait for each other say where, and end."""


def together(work: Callable[..., Any], folder: Path, *arguments: Any) -> list[Any]:
    """What `work(*arguments)` gives in each of two processes, where Lightning takes them for its own."""
    folder.mkdir(parents=True, exist_ok=True)
    spawn(_one_of_two, (work, folder, _free_port(), arguments), nprocs=2)
    return [torch.load(folder / f"{rank}.pt", weights_only=False) for rank in (0, 1)]


def _one_of_two(rank: int, work: Callable[..., Any], folder: Path, port: int, arguments: tuple[Any, ...]) -> None:
    torch.set_num_threads(1)
    faulthandler.dump_traceback_later(PATIENCE, exit=True)
    meeting = {"MASTER_ADDR": "127.0.0.1", "MASTER_PORT": port, "WORLD_SIZE": 2, "NODE_RANK": 0, "LOCAL_RANK": rank}
    os.environ.update({name: str(value) for name, value in meeting.items()})
    torch.save(work(*arguments), folder / f"{rank}.pt")


def _free_port() -> int:
    with closing(socket.socket()) as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]
