"""Files that are whole or not there."""

from __future__ import annotations

import errno
import glob
import hashlib
import json
import math
import os
import platform
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

import yaml

from sag.errors import SagError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""How systems say that there is no room."""


def write_whole(path: Path, write: Callable[[BinaryIO], object], keep: Path | None = None) -> None:
    """Writes a file under a temporary name, syncs it and renames it, so that the old one stays until then.

    What a process that was killed has left half written of the same file is removed.

    Args:
        path: the file; its folder is made.
        write: puts the content into the open file.
        keep: name in the same folder under which a file that is replaced stays.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    for replaced in (path, *([keep] if keep else [])):
        _remove_strays(replaced)
    partial = _partial(path)
    try:
        with partial.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        if keep is not None and path.exists():
            _keep(path, keep)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
    _sync_folder(path.parent)


def _partial(path: Path) -> Path:
    """The name of a file while it is written: of this machine's process, since machines share folders."""
    return path.with_name(f".{path.name}.{platform.node()}.{os.getpid()}")


def _remove_strays(path: Path) -> None:
    """Removes partial files and folders of processes of this machine that are gone."""
    own = _partial(path).stem
    for stray in path.parent.glob(f"{glob.escape(own)}.*"):
        if stray.suffix[1:].isdecimal() and not _alive(int(stray.suffix[1:])):
            shutil.rmtree(stray, ignore_errors=True) if stray.is_dir() else stray.unlink(missing_ok=True)


@contextmanager
def scratch_folder(path: Path) -> Iterator[Path]:
    """A folder beside a path for what is needed while that is made; gone afterwards.

    Those that killed processes of this machine have left for the same path are removed.

    Args:
        path: what is made; the folder around it is made too.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    _remove_strays(path)
    scratch = _partial(path)
    scratch.mkdir()
    try:
        yield scratch
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:  # somebody else's
        return True
    return True


def _keep(path: Path, keep: Path) -> None:
    """Gives a file a second name, so that it has one at every moment; where links are unknown, the other name."""
    spare = _partial(keep)
    try:
        spare.unlink(missing_ok=True)
        os.link(path, spare)
        spare.replace(keep)
    except OSError:
        path.replace(keep)
    finally:
        spare.unlink(missing_ok=True)


def _sync_folder(folder: Path) -> None:
    """Makes a rename last, where the system syncs folders."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            os.fsync(descriptor)
    finally:
        os.close(descriptor)


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
    write_whole(path, lambda file: file.write(json_bytes(content)))


def json_bytes(content: Mapping[str, Any]) -> bytes:
    """What `write_json` writes."""
    return (json.dumps(finite(content), indent=1, sort_keys=True, allow_nan=False) + "\n").encode()


def finite(value: Any) -> Any:
    """A value of JSON with None for every float that is not finite, which JSON does not know."""
    if isinstance(value, Mapping):
        return {name: finite(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
