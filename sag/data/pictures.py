"""Pictures of data sets, decoded under a size limit."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import numpy as np
from jaxtyping import Int, UInt8
from PIL import Image

from sag.data.paths import read_file
from sag.errors import SagError

PIXEL_LIMIT = 3840 * 2160
"""Largest picture that is decoded, in pixels."""

FILE_LIMIT = 64 << 20
"""Largest file of a picture that is read, bytes."""


class CutOffError(SagError):
    """A picture whose lower end is missing."""


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
