"""What the doctor does in a process of its own, since a broken package may end it: imports, and arithmetic on devices.

`python -m sag.doctor.probe MODULE ...` prints a line of JSON for each thing before it begins and when it is done.
"""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

SIDE = 64
"""Rows and columns of the matrices that a device multiplies."""

TOLERANCE = 1e-3
"""Largest error of their product in float32, where numbers are of the order of 1."""

ITSELF = "sag.training"
"""What is imported last: all that a run needs, so that nothing is missed that no list names."""


def main() -> None:
    """Imports the modules that are named and the program's own, and tries every device."""
    for module in (*sys.argv[1:], ITSELF):
        _try(module, partial(_imported, module))
    _try("devices", _devices)


def _imported(module: str) -> str:
    """The version of a module that imports."""
    return str(getattr(importlib.import_module(module), "__version__", ""))


def _try(name: str, work: Callable[[], Any]) -> None:
    _say(name=name)
    try:
        _say(name=name, found=work())
    except BaseException as error:  # whatever a broken package throws is what was looked for
        said = (str(error).strip().splitlines() or [""])[0]
        _say(name=name, error=f"{type(error).__name__}: {said}")


def _say(**line: Any) -> None:
    print(json.dumps(line), flush=True)


def _devices() -> dict[str, Any]:
    """Every device that PyTorch knows, with what is wrong with it, if anything."""
    import torch

    names = {"cpu": f"{torch.get_num_threads()} threads"}
    for index in range(torch.cuda.device_count() if torch.cuda.is_available() else 0):
        about = torch.cuda.get_device_properties(index)
        free = torch.cuda.mem_get_info(index)[0]
        names[f"cuda:{index}"] = f"{about.name}, {free / 1e9:.1f} of {about.total_memory / 1e9:.1f} GB free"
    if torch.backends.mps.is_available():
        names["mps"] = "Apple's"
    found = [{"name": name, "about": about, "error": _multiplied(torch, name)} for name, about in names.items()]
    distributed = torch.distributed.is_available()
    backends = [b for b in ("gloo", "nccl") if distributed and getattr(torch.distributed, f"is_{b}_available")()]
    return {"devices": found, "built_for_cuda": torch.version.cuda, "backends": backends}


def _multiplied(torch: Any, device: str) -> str | None:
    """What is wrong with a product of two matrices on a device; None where nothing is."""
    try:
        generator = torch.Generator().manual_seed(0)
        left, right = (torch.randn(SIDE, SIDE, generator=generator) for _ in range(2))
        product = (left.to(device) @ right.to(device)).cpu().double()
        error = float((product - left.double() @ right.double()).abs().max()) / SIDE**0.5
    except Exception as problem:
        return f"{type(problem).__name__}: {str(problem).splitlines()[0]}"
    return None if error < TOLERANCE else f"a product of two matrices is off by {error:.2g}"


if __name__ == "__main__":
    main()
