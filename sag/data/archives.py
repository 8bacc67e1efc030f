"""Arrays from `.npz` archives, of which nothing is unpacked before its size, type and shape are known to be right."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sag.data.paths import regular
from sag.errors import SagError

ROWS_LIMIT = 200_000
"""Most rows of an array that are read; at 30 frames a second nearly two hours."""

_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Ways in which numpy stores an array; what others unpack is not bounded while it unpacks."""

_HEADER = 65_536
"""Bytes that a header of an array may have besides the numbers."""

ORIGINAL = "restore the original file"
"""Way out where the file comes from others."""

Shape = tuple[int | None, ...]
"""Shape that an array may have; nothing stands for any number of rows."""


def read_archive(path: Path, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, np.ndarray]:
    """Named arrays of an archive as float64, all with the same number of rows; others in it are not touched.

    Args:
        path: of the archive.
        shapes: for each name the shape of one row.

    Raises:
        SagError: the archive is missing or damaged, or an array is missing, of another shape, longer than
            `ROWS_LIMIT`, or holds anything but finite numbers.
    """
    arrays = {name: read_array(path, name, [(None, *shape)]) for name, shape in shapes.items()}
    if len({len(array) for array in arrays.values()}) > 1:
        lengths = ", ".join(f"{len(array)} {name}" for name, array in arrays.items())
        raise SagError(f"{path} holds arrays of different lengths ({lengths}); restore the original file")
    return arrays


def read_array(path: Path, name: str, shapes: Sequence[Shape], kinds: str = "f", way_out: str = ORIGINAL) -> np.ndarray:
    """One array of an archive: numbers as float64, text as it is.

    Args:
        path: of the archive.
        name: of the array.
        shapes: those that it may have.
        kinds: numpy's letters of the types that it may have: f, and i, u and U for whole numbers and text.
        way_out: what the error advises.

    Raises:
        SagError: the archive is missing or damaged, or the array is missing, of another shape or type, longer than
            `ROWS_LIMIT`, or holds anything but finite numbers.
    """
    regular(path)
    try:
        with zipfile.ZipFile(path) as archive:
            return _array(archive, name, shapes, kinds)
    except SagError as error:
        raise SagError(f"{path} {error}; {way_out}") from error
    except Exception as error:  # a damaged archive can raise anything
        said = str(error) or type(error).__name__
        raise SagError(f"{path} cannot be read ({said}); {way_out}") from error


def names_in(path: Path) -> set[str]:
    """Names of the arrays of an archive; none where it cannot be read."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {name.removesuffix(".npy") for name in archive.namelist()}
    except (OSError, ValueError, zipfile.BadZipFile):
        return set()


def _array(archive: zipfile.ZipFile, name: str, shapes: Sequence[Shape], kinds: str) -> np.ndarray:
    """One array; the error tells no file."""
    found = [member for member in archive.infolist() if member.filename == f"{name}.npy"]
    if len(found) != 1:
        raise SagError(f"holds {name} {len(found)} times, not once")
    largest = max(int(np.prod([ROWS_LIMIT if size is None else size for size in shape])) for shape in shapes)
    limit = largest * 8 + _HEADER
    if found[0].file_size > limit:
        raise SagError(f"holds {name} of {found[0].file_size:,} bytes, more than the {limit:,} that it may have")
    if found[0].compress_type not in _METHODS:
        raise SagError(f"holds {name} compressed in a way (number {found[0].compress_type}) that numpy does not write")
    # Reading a whole member would unpack all that comes and cut it to the told size afterwards.
    with archive.open(found[0]) as stream:
        return _parsed(stream.read(found[0].file_size + 1), name, shapes, kinds)


def _parsed(content: bytes, name: str, shapes: Sequence[Shape], kinds: str) -> np.ndarray:
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    found, fortran, dtype = read(stream)
    if dtype.kind not in kinds or not any(_fits(found, shape) for shape in shapes):
        raise SagError(f"holds {name} of shape {found} and type {dtype}, not {' or '.join(map(_written, shapes))}")
    values = np.frombuffer(content, dtype, int(np.prod(found)), stream.tell())
    array = values.reshape(found, order="F" if fortran else "C")
    if dtype.kind == "U":
        return array
    numbers = array.astype(np.float64)
    if not np.isfinite(numbers).all():
        row = int(np.argwhere(~np.isfinite(np.atleast_1d(numbers)))[0, 0])
        raise SagError(f"holds {name} that is not finite, first in frame {row}")
    return numbers


def _fits(found: tuple[int, ...], shape: Shape) -> bool:
    rows = all(0 < size <= ROWS_LIMIT for size, wanted in zip(found, shape) if wanted is None)
    return len(found) == len(shape) and rows and all(w in (None, size) for size, w in zip(found, shape))


def _written(shape: Shape) -> str:
    sizes = ", ".join("frames" if size is None else str(size) for size in shape)
    return f"({sizes})" if shape else "a single value"
