"""Whether files have changed, without reading them."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path


def digest_of(folders: Iterable[Path]) -> str:
    """Checksum of the names, sizes and times of all files of recordings."""
    digest = hashlib.sha256()
    for folder in folders:
        with os.scandir(folder) as entries:
            files = sorted(_stamp(entry) for entry in entries)
        digest.update(repr((folder.name, files)).encode())
    return digest.hexdigest()


def _stamp(entry: os.DirEntry[str]) -> tuple[str, int, int]:
    """Name, size and time of a file; a link that leads nowhere has none."""
    try:
        found = entry.stat()
    except OSError:
        return entry.name, -1, -1
    return entry.name, found.st_size, found.st_mtime_ns
