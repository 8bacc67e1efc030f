"""Pictures of data sets: decoded under a size limit, and resampled to the window's picture."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped, UInt8
from PIL import Image
from scipy.sparse import csr_array

from sag.data.paths import read_file
from sag.errors import SagError

PIXEL_LIMIT = 3840 * 2160
"""Largest picture that is decoded, in pixels."""

FILE_LIMIT = 64 << 20
"""Largest file of a picture that is read, bytes."""


class CutOffError(SagError):
    """A picture whose lower end is missing."""


Box = tuple[float, float, float, float]
"""Left, top, right and bottom edge of a crop, continuous pixels of the whole picture."""


def read_colour(path: Path) -> UInt8[np.ndarray, "h w 3"]:
    """Colours of a JPG or PNG.

    Raises:
        SagError: the file is missing, damaged, ends too early, is larger than `PIXEL_LIMIT` or has not three colours.
    """
    with _opened(path) as picture:
        if picture.mode not in ("RGB", "RGBA"):
            raise SagError(f"{path} holds {picture.mode} pixels, not RGB; restore the original file")
        try:
            return np.asarray(picture.convert("RGB"))
        except Exception as error:  # damaged pixels can raise anything
            raise _damaged(path, error) from error


def picture_size(path: Path) -> tuple[int, int]:
    """Rows and columns of a picture, by its header.

    Raises:
        SagError: as `read_colour`.
    """
    with _opened(path) as picture:
        return picture.height, picture.width


def read_24_bit(path: Path) -> Int[np.ndarray, "h w"]:
    """Integers that a PNG packs into its colours: red is the highest byte, blue the lowest.

    Raises:
        SagError: as `read_colour`.
    """
    red, green, blue = np.moveaxis(read_colour(path).astype(np.int32), -1, 0)
    return red << 16 | green << 8 | blue


def read_grey(path: Path) -> Int[np.ndarray, "h w"]:
    """Values of a PNG or JPG of one channel, of 8 or 16 bits; colours become grey.

    Raises:
        SagError: as `read_colour`, but for the colours.
    """
    with _opened(path) as picture:
        return _values(picture, path)


def read_16_bit(path: Path) -> Int[np.ndarray, "h w"]:
    """Values of a PNG of one channel of 16 bits.

    Raises:
        SagError: as `read_colour`, but for the colours; or it has other pixels.
    """
    with _opened(path) as picture:
        if not picture.mode.startswith("I"):
            raise SagError(f"{path} holds {picture.mode} pixels, not one channel of 16 bits; write it as uint16")
        return _values(picture, path)


def _values(picture: Image.Image, path: Path) -> Int[np.ndarray, "h w"]:
    try:
        whole = picture if picture.mode in ("I", "I;16", "I;16B") else picture.convert("L")
        return np.asarray(whole).astype(np.int32)
    except Exception as error:  # damaged pixels can raise anything
        raise _damaged(path, error) from error


def refuse_cut_off(colour: UInt8[np.ndarray, "h w 3"], path: Path) -> None:
    """Refuses a picture whose lower end is one single colour, as where nothing was left to be written.

    At least the last 32nd of the rows must be: in a picture of a room some grain or edge is always there. It is blind
    to pictures that end in noise or in part of another picture.

    Args:
        colour: of the picture.
        path: of its file, for the error.

    Raises:
        CutOffError: it is cut off.
    """
    end = colour[-max(1, len(colour) // 32) :]
    if (end == end[0, 0]).all():
        raise CutOffError(f"{path} is cut off: its lower end is one single colour; restore the original file")


def _opened(path: Path) -> Image.Image:
    """A picture whose header is read and whose end is there; its pixels are not yet decoded."""
    content = read_file(path, FILE_LIMIT)
    try:
        picture = Image.open(io.BytesIO(content), formats=("JPEG", "PNG"))
    except Exception as error:  # a damaged header can raise anything
        raise SagError(f"{path} cannot be read as a JPG or PNG ({error}); restore the original file") from error
    if picture.width * picture.height > PIXEL_LIMIT:
        picture.close()
        raise SagError(f"{path} is {picture.width} x {picture.height} pixels, more than the {PIXEL_LIMIT:,} allowed")
    try:
        _check_end(content, str(picture.format))
    except ValueError as error:
        picture.close()
        raise _damaged(path, error) from error
    return picture


def _damaged(path: Path, error: Exception) -> SagError:
    return SagError(f"{path} is damaged ({str(error) or type(error).__name__}); restore the original file")


def _check_end(content: bytes, kind: str) -> None:
    """Compares the checksums of a PNG and looks for the end of a JPG: decoders forgive both.

    Raises:
        ValueError: the file is not whole.
    """
    if kind != "PNG":
        if b"\xff\xd9" not in content[-1024:]:
            raise ValueError("it ends before its end marker")
        return
    place, name = 8, b""
    while name != b"IEND":
        try:
            length, name = struct.unpack_from(">I4s", content, place)
            (expected,) = struct.unpack_from(">I", content, place + 8 + length)
        except struct.error as error:
            raise ValueError(f"it ends at byte {len(content):,}, inside a part") from error
        if zlib.crc32(content[place + 4 : place + 8 + length]) != expected:
            raise ValueError(f"checksum of its part {name!r} at byte {place}")
        place += 12 + length


def area_averaged(
    image: UInt8[np.ndarray, "h w c"], box: Box, size: tuple[int, int]
) -> UInt8[np.ndarray, "rows columns c"]:
    """A crop in which every pixel is the mean over the area that it covers; black outside the picture.

    Args:
        image: the whole picture.
        box: what the crop covers; it may reach beyond the picture.
        size: rows and columns of the crop.
    """
    left, top, right, bottom = box
    rows, columns, colours = image.shape
    low = _shares(rows, top, bottom, size[0]) @ image.astype(np.float32).reshape(rows, -1)
    low = low.reshape(size[0], columns, colours).transpose(1, 0, 2).reshape(columns, -1)
    crop = (_shares(columns, left, right, size[1]) @ low).reshape(size[1], size[0], colours)
    return np.rint(crop.transpose(1, 0, 2)).astype(np.uint8)


def _shares(cells: int, low: float, high: float, count: int) -> csr_array:
    """(count, cells) share of each unit cell in each of `count` equal intervals from low to high."""
    edges = np.linspace(low, high, count + 1)[:, None]
    begin = np.arange(cells)
    overlap = np.minimum(edges[1:], begin + 1) - np.maximum(edges[:-1], begin)
    return csr_array((overlap.clip(0) * count / (high - low)).astype(np.float32))


def nearest(values: Shaped[np.ndarray, "h w"], box: Box, size: tuple[int, int]) -> Shaped[np.ndarray, "rows columns"]:
    """A crop that takes the pixel under the centre of each of its own; 0 outside the picture.

    Args:
        values: the whole picture, such as depth or ids, which must not be mixed.
        box: what the crop covers; it may reach beyond the picture.
        size: rows and columns of the crop.
    """
    left, top, right, bottom = box
    rows = np.floor(_centres(top, bottom, size[0])).astype(int)
    columns = np.floor(_centres(left, right, size[1])).astype(int)
    inside = _within(rows, values.shape[0])[:, None] & _within(columns, values.shape[1])
    picked = values[rows.clip(0, values.shape[0] - 1)][:, columns.clip(0, values.shape[1] - 1)]
    return np.where(inside, picked, 0).astype(values.dtype)


def _centres(low: float, high: float, count: int) -> Float[np.ndarray, " n"]:
    return low + (np.arange(count) + 0.5) * (high - low) / count


def _within(places: Int[np.ndarray, " n"], count: int) -> Bool[np.ndarray, " n"]:
    return (places >= 0) & (places < count)
