"""What the process that may break has found, and where it broke."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

PATIENCE = 300.0
"""Seconds after which imports and arithmetic count as hanging; a cold disk may well take a minute."""


@dataclass(frozen=True)
class Probed:
    """Answers of `sag.doctor.probe`.

    Attributes:
        found: what went well, by name.
        errors: what did not, by name.
    """

    found: dict[str, Any]
    errors: dict[str, str]


def probed(modules: Sequence[str], python: str = sys.executable, patience: float = PATIENCE) -> Probed:
    """Imports modules in a process of its own, then tries the devices.

    Args:
        modules: to import.
        python: interpreter of the process.
        patience: seconds until it is ended.
    """
    command = [python, "-W", "ignore", "-m", "sag.doctor.probe", *modules]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=patience, check=False)
        output, ending = done.stdout, _ending(done.returncode, done.stderr)
    except subprocess.TimeoutExpired as hung:
        said = hung.stdout or b""
        output = said.decode(errors="replace") if isinstance(said, bytes) else said
        ending = f"it had not ended after {patience:g} s"
    except OSError as error:
        output, ending = "", f"{python} cannot be started ({error.strerror})"
    return _read(output, ending)


def _ending(status: int, said: str) -> str:
    if status < 0:
        return f"it ended the process by {signal.Signals(-status).name}"
    return f"it ended the process with status {status}: {(said.strip().splitlines() or ['nothing was said'])[-1]}"


def _read(output: str, ending: str) -> Probed:
    """Lines of JSON among whatever packages print; what has begun and said no more is what broke."""
    found: dict[str, Any] = {}
    errors: dict[str, str] = {}
    begun = "probe"
    for line in _lines(output):
        name = line["name"]
        if "found" in line:
            found[name] = line["found"]
        elif "error" in line:
            errors[name] = line["error"]
        else:
            begun = name
    if "devices" not in {*found, *errors}:
        errors[begun] = ending
    return Probed(found, errors)


def _lines(output: str) -> list[dict[str, Any]]:
    lines = []
    for text in output.splitlines():
        with suppress(ValueError):
            line = json.loads(text)
            if isinstance(line, dict) and "name" in line:
                lines.append(line)
    return lines
