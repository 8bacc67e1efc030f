"""How much memory something takes at most."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LEAST_MEMORY = 48 << 20
"""Bytes that refusing a file may take besides what the process has."""


@contextmanager
def little_memory(limit: int = LEAST_MEMORY) -> Iterator[None]:
    """Fails where what is done inside takes more than this besides what the process has, bytes; on Linux alone."""
    if sys.platform != "linux":
        yield
        return
    Path("/proc/self/clear_refs").write_text("5")  # the peak is that of now
    before = _told("VmRSS")
    yield
    assert _told("VmHWM") - before < limit


def _told(name: str) -> int:
    """A figure of this process, bytes."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(f"{name}:"))
