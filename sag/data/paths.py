"""Files of a data set: regular, of bounded size, and inside the folder where they seem to lie."""

from __future__ import annotations

import os
from pathlib import Path

from sag.errors import SagError


def contained(path: Path, root: Path) -> Path:
    """The same path.

    Args:
        path: in the root, as it seems.
        root: folder that holds everything that may be read.

    Raises:
        SagError: links lead out of the root.
    """
    real = Path(os.path.realpath(path))
    if not real.is_relative_to(os.path.realpath(root)):
        raise SagError(f"{path} leads out of {root} to {real}; put the original there instead of a link")
    return path


def regular(path: Path) -> Path:
    """The same path, of a file that lies in its own folder.

    Raises:
        SagError: it is missing, no regular file, or a link that leads elsewhere.
    """
    contained(path, path.parent)
    if not path.is_file():
        raise SagError(f"{path} is {'no regular file' if path.exists() else 'missing'}; restore the original file")
    return path


def read_file(path: Path, limit: int) -> bytes:
    """Content of a file that lies in its own folder.

    Args:
        path: of a regular file.
        limit: largest size that is read, bytes.

    Raises:
        SagError: it cannot be read, is larger, or is not `regular`.
    """
    try:
        with regular(path).open("rb") as file:
            content = file.read(limit + 1)
    except OSError as error:
        raise SagError(f"{path} cannot be read ({error}); restore the original file") from error
    if len(content) > limit:
        raise SagError(f"{path} is larger than the {limit:,} bytes that such a file may have")
    return content
