"""Files that are whole or not there."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import yaml

from sag.errors import SagError


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Writes a file under a temporary name, syncs it and renames it, so that the old one stays until then.

    Args:
        path: the file; its folder is made.
        write: puts the content into the open file.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with partial.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def writing_in(path: Path, way_out: str) -> Iterator[None]:
    """Says in one sentence why a file or folder cannot be written.

    Args:
        path: what is written, or the folder of it.
        way_out: what to do about it.

    Raises:
        SagError: the system refuses the path, what lies in it, or a folder that it lies in.
    """
    try:
        yield
    except OSError as error:
        refused = Path(error.filename) if isinstance(error.filename, str) else None
        if refused is None or not (refused.is_relative_to(path) or path.is_relative_to(refused)):
            raise
        raise SagError(f"{path} cannot be written ({refused}: {error.strerror}); {way_out}") from error


def read_yaml(path: Path) -> Any:
    """What a YAML file holds.

    Raises:
        SagError: it cannot be read, or is no YAML.
    """
    try:
        return yaml.safe_load(path.read_text())
    except (OSError, ValueError, RecursionError, yaml.YAMLError) as error:
        raise SagError(f"{path} cannot be read as YAML ({' '.join(str(error).split())}); mend or replace it") from error


def sha256_of(path: Path) -> str:
    """Checksum of a file."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Writes a JSON file whole or not at all; what is no number, which JSON does not know, becomes null."""
    text = json.dumps(_plain(content), indent=1, sort_keys=True, allow_nan=False) + "\n"
    write_whole(path, lambda file: file.write(text.encode()))


def _plain(value: Any) -> Any:
    """A value with null for every float that is not finite."""
    if isinstance(value, Mapping):
        return {name: _plain(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
