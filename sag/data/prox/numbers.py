"""Numbers in the JSON files of PROX, read under a size limit and checked."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from sag.data.paths import read_file
from sag.data.recordings.cameras import improper
from sag.errors import SagError

FARTHEST = 1e4
"""Farthest that anything lies from a camera or from the origin of a scan, metres."""

LARGEST = 1 << 20
"""Bytes of the largest JSON file that is read; the real ones have a few thousand."""


def read_json(path: Path) -> Any:
    """Content of a small JSON file.

    Raises:
        SagError: the file is missing, larger than `LARGEST` or damaged.
    """
    content = read_file(path, LARGEST)
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        raise SagError(f"{path} cannot be read as JSON ({error}); restore the original file") from error


def array_of(content: Any, shape: tuple[int, ...], what: str) -> Float[np.ndarray, ...]:
    """Nested lists of finite numbers as an array.

    Args:
        content: what was read.
        shape: what it must have.
        what: file and place, for the error.

    Raises:
        SagError: it has another shape, or a number that is not finite.
    """
    try:
        values = np.array(content, np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise SagError(f"{what} holds no numbers of shape {shape} ({error}); restore the original file") from error
    if values.shape != shape or not np.isfinite(values).all():
        raise SagError(
            f"{what} has shape {values.shape}, not {shape}, or numbers that are not finite; restore the original file"
        )
    return values


def check_rotation(matrix: Float[np.ndarray, "3 3"], what: str) -> None:
    """Refuses what turns nothing, mirrors or stretches.

    Raises:
        SagError: the matrix is no rotation.
    """
    if improper(matrix[None])[0]:
        raise SagError(f"{what} holds no rotation, so places in it would be wrong; restore the original file")
