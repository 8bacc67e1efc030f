"""Portable content: what a file says, without where things lie on one machine."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

ELSEWHERE = "<elsewhere>"
"""Stands for folders that are no business of a reader."""

ABSOLUTE = re.compile(r"""(?<![^\s=:,;'"(\[{])/(?=[^\s/])[^\s=:,;'")\]}]+""")
"""An absolute path, alone or within a text; the second slash of `https://` begins none."""


def portable(value: Any, base: Path) -> Any:
    """A value of JSON or YAML in which no text holds an absolute path.

    Paths under `base` become relative to it; of all others only the last part stays, behind `ELSEWHERE`.

    Args:
        value: mappings, lists and scalars.
        base: the folder that the runs were started from.
    """
    if isinstance(value, Mapping):
        return {name: portable(inner, base) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [portable(inner, base) for inner in value]
    return ABSOLUTE.sub(lambda match: _relative(match[0], base), value) if isinstance(value, str) else value


def _relative(text: str, base: Path) -> str:
    path = PurePosixPath(text)
    if path.is_relative_to(base):
        return str(path.relative_to(base))
    return f"{ELSEWHERE}/{path.name}"


def portable_command(command: list[str], base: Path) -> list[str]:
    """A command whose programs are called by their names and whose paths are `portable`."""
    return [PurePosixPath(part).name if part.startswith("/") else str(portable(part, base)) for part in command]
