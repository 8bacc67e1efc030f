"""The index of a window cache: JSON that knows its own checksum, so that no bit of it can change unnoticed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.files import json_bytes, write_json

NAME = "index.json"

SEAL = "sha256"
"""Key of the checksum: of the file's own bytes, with zeros where the checksum stands."""

ZEROS = "0" * 64


def write_index(folder: Path, content: Mapping[str, Any]) -> None:
    """Writes the index of a cache whole or not at all."""
    seal = _checksum(json_bytes({**content, SEAL: ZEROS}), ZEROS)
    write_json(folder / NAME, {**content, SEAL: seal})


def read_index(folder: Path) -> dict[str, Any]:
    """The index of a cache.

    Raises:
        SagError: there is none, or it is not as it was written, by a single bit.
    """
    path = folder / NAME
    if not path.is_file():
        raise SagError(f"{folder} is no window cache: it has no {NAME}")
    content = path.read_bytes()
    try:
        index: dict[str, Any] = json.loads(content)
        seal = index.pop(SEAL)
        whole = seal == _checksum(content, seal)
        dict(index["files"])
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise SagError(f"{path} cannot be read ({error}); delete {folder} to have it rebuilt") from error
    if not whole:
        raise SagError(f"{path} is not as it was written: its checksum differs; delete {folder} to have it rebuilt")
    return index


def _checksum(content: bytes, seal: str) -> str:
    """Of the bytes of an index, whatever its seal is."""
    return hashlib.sha256(content.replace(seal.encode(), ZEROS.encode())).hexdigest()
