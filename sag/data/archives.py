"""Arrays from `.npz` archives, of which nothing is unpacked before its size, type and shape are known to be right."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sag.data.paths import regular
from sag.errors import SagError

ROWS_LIMIT = 200_000
"""Most rows of an array that are read; at 30 frames a second nearly two hours."""

_HEADER = 65_536
"""Bytes that a header of an array may have besides the numbers."""


def read_archive(path: Path, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, np.ndarray]:
    """Named arrays of an archive as float64, all with the same number of rows; others in it are not touched.

    Args:
        path: of the archive.
        shapes: for each name the shape of one row.

    Raises:
        SagError: the archive is missing or damaged, or an array is missing, of another shape, longer than
            `ROWS_LIMIT`, or holds anything but finite numbers.
    """
    regular(path)
    try:
        with zipfile.ZipFile(path) as archive:
            arrays = {name: _array(archive, name, shape) for name, shape in shapes.items()}
    except SagError as error:
        raise SagError(f"{path} {error}; restore the original file") from error
    except Exception as error:  # a damaged archive can raise anything
        said = str(error) or type(error).__name__
        raise SagError(f"{path} cannot be read ({said}); restore the original file") from error
    if len({len(array) for array in arrays.values()}) > 1:
        lengths = ", ".join(f"{len(array)} {name}" for name, array in arrays.items())
        raise SagError(f"{path} holds arrays of different lengths ({lengths}); restore the original file")
    return arrays


def names_in(path: Path) -> set[str]:
    """Names of the arrays of an archive; none where it cannot be read."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {name.removesuffix(".npy") for name in archive.namelist()}
    except (OSError, ValueError, zipfile.BadZipFile):
        return set()


def _array(archive: zipfile.ZipFile, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """One array; the error tells no file."""
    found = [member for member in archive.infolist() if member.filename == f"{name}.npy"]
    if len(found) != 1:
        raise SagError(f"holds {name} {len(found)} times, not once")
    limit = ROWS_LIMIT * int(np.prod(shape)) * 8 + _HEADER
    if found[0].file_size > limit:
        raise SagError(f"holds {name} of {found[0].file_size:,} bytes, more than the {limit:,} that it may have")
    # No more than the size that is told comes out of the archive.
    return _parsed(archive.read(found[0]), name, shape)


def _parsed(content: bytes, name: str, shape: tuple[int, ...]) -> np.ndarray:
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    found, fortran, dtype = read(stream)
    if found[1:] != shape or dtype.kind != "f" or not 0 < found[0] <= ROWS_LIMIT:
        raise SagError(f"holds {name} of shape {found} and type {dtype}, not (frames, {', '.join(map(str, shape))})")
    numbers = np.frombuffer(content, dtype, int(np.prod(found)), stream.tell())
    array = numbers.reshape(found, order="F" if fortran else "C").astype(np.float64)
    if not np.isfinite(array).all():
        frame = int(np.argwhere(~np.isfinite(array))[0, 0])
        raise SagError(f"holds {name} that is not finite, first in frame {frame}")
    return array
