"""The machine: devices that compute, memory, and whether processes can meet."""

from __future__ import annotations

import os
import shutil
import socket
from contextlib import suppress
from pathlib import Path
from typing import Any

from sag.data.check.report import Line, Verdict
from sag.doctor.probed import Probed

DRIVER = Path("/proc/driver/nvidia/version")
MEMORY = Path("/proc/meminfo")

ENOUGH, LEAST = 4e9, 2e9
"""Bytes of free memory for two rows at a time, and for one."""


def device_lines(probed: Probed) -> list[Line]:
    """Every device with what a product of two matrices says of it, then what processes talk by."""
    tried = probed.found.get("devices")
    if tried is None:
        return [Line("devices", "not tried, since torch does not import", "broken")]
    lines = [_device(each) for each in tried["devices"]]
    return [*lines, *_without_gpu(tried), processes_line(tried["backends"])]


def _device(tried: dict[str, Any]) -> Line:
    name, about, error = (tried[key] for key in ("name", "about", "error"))
    if not error:
        return Line(name, f"{about}, computes", "ok")
    needed = name == "cpu" or name.startswith("cuda")  # `accelerator: auto` takes a GPU where there is one
    ways = (error, "look at nvidia-smi and install a torch for this driver", "or go without: CUDA_VISIBLE_DEVICES=")
    return Line(name, f"{about}, does not compute", "broken" if needed else "look", ways if name != "cpu" else (error,))


def _without_gpu(tried: dict[str, Any]) -> list[Line]:
    """What to say where there is a GPU that torch does not see, or none."""
    if any(each["name"] != "cpu" for each in tried["devices"]):
        return []
    if not (DRIVER.exists() or shutil.which("nvidia-smi")):
        return [Line("gpu", "none; the preset quick needs none")]
    if tried["built_for_cuda"] is None:
        way = "pip install --upgrade --force-reinstall torch, from the index of pytorch.org for your CUDA"
        return [Line("gpu", "there is one, and this torch was built without CUDA", "look", (way,))]
    return [
        Line("gpu", "there is one, and torch cannot use it", "look", ("does nvidia-smi show it, and a new driver?",))
    ]


def processes_line(backends: list[str]) -> Line:
    """What several processes talk by, and whether they can meet on this machine."""
    if not backends:
        return Line("processes", "this torch has no backend for several", "look", ("one device trains all the same",))
    try:
        with socket.socket() as meeting:
            meeting.bind(("127.0.0.1", 0))
    except OSError as error:
        return Line(
            "processes", f"cannot meet on 127.0.0.1 ({error.strerror})", "look", ("one device trains all the same",)
        )
    return Line("processes", f"several can train together by {' and '.join(backends)}", "ok")


def memory_line() -> Line:
    """Cores and free memory beside what rows of `make ablation` take."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    said = f"{cores} core{'s' if cores > 1 else ''}"
    free = free_memory()
    if free is None:
        return Line("memory", said)
    verdict: Verdict = "ok" if free >= ENOUGH else "look" if free >= LEAST else "broken"
    ways = () if verdict == "ok" else ("a row takes up to 2 GB: close something, or make ablation JOBS=1",)
    return Line("memory", f"{said}, {free / 1e9:.1f} GB of memory free", verdict, ways)


def free_memory() -> float | None:
    """Bytes that programs may still take, where the system tells."""
    with suppress(OSError, ValueError, IndexError, StopIteration):
        line = next(line for line in MEMORY.read_text().splitlines() if line.startswith("MemAvailable"))
        return 1024.0 * int(line.split()[1])
    return None
