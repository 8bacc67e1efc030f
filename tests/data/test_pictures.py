import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sag.data import pictures
from sag.data.pictures import read_24_bit, read_colour
from sag.errors import SagError


def saved(path: Path, pixels: np.ndarray, **options: object) -> Path:
    Image.fromarray(pixels).save(path, **options)
    return path


def packed(values: np.ndarray) -> np.ndarray:
    return np.stack([values >> 16, values >> 8 & 255, values & 255], -1).astype(np.uint8)


@pytest.fixture
def colours() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (6, 8, 3), dtype=np.uint8)


def test_colours_come_back(tmp_path, colours):
    np.testing.assert_array_equal(read_colour(saved(tmp_path / "a.png", colours)), colours)


def test_24_bit_integers_come_back(tmp_path):
    values = np.array([[0, 1, 255, 256], [65535, 65536, 0x010203, 2**24 - 1]])
    np.testing.assert_array_equal(read_24_bit(saved(tmp_path / "a.png", packed(values))), values)


def test_ids_that_differ_in_any_byte_stay_apart(tmp_path):
    ids = np.array([[0x300000, 0x003000, 0x000030, 0x100010]])
    assert len(np.unique(read_24_bit(saved(tmp_path / "a.png", packed(ids))))) == 4


def test_grey_pictures_are_refused(tmp_path):
    path = saved(tmp_path / "a.png", np.zeros((4, 4), np.uint8))
    with pytest.raises(SagError, match=r"a\.png holds L pixels"):
        read_24_bit(path)


def test_oversize_pictures_are_refused_before_they_are_decoded(tmp_path, monkeypatch):
    monkeypatch.setattr(pictures, "PIXEL_LIMIT", 47)
    monkeypatch.setattr(Image.Image, "load", lambda self: pytest.fail("decoded"))
    path = tmp_path / "a.png"
    path.write_bytes(_png(6, 8))
    with pytest.raises(SagError, match=r"a\.png is 8 x 6 pixels, more than the 47"):
        read_colour(path)


def _png(rows: int, columns: int) -> bytes:
    """A PNG of this size that ends after its header."""
    header = b"IHDR" + columns.to_bytes(4, "big") + rows.to_bytes(4, "big") + b"\x08\x02\x00\x00\x00"
    return b"\x89PNG\r\n\x1a\n" + b"\x00\x00\x00\x0d" + header + zlib.crc32(header).to_bytes(4, "big") + b"\0\0\0\0IDAT"


@pytest.mark.parametrize(("rows", "columns"), [(2160, 3841), (60000, 60000), (2**31 - 1, 2**31 - 1)])
def test_bombs_are_refused(tmp_path, rows, columns):
    (tmp_path / "bomb.png").write_bytes(_png(rows, columns))
    with pytest.raises(SagError, match=r"bomb\.png"):
        read_colour(tmp_path / "bomb.png")


@pytest.mark.parametrize("suffix", ["jpg", "png"])
def test_torn_pictures_are_refused(tmp_path, suffix):
    path = saved(tmp_path / f"a.{suffix}", np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8))
    path.write_bytes(path.read_bytes()[:1200])
    with pytest.raises(SagError, match=rf"a\.{suffix} is damaged"):
        read_colour(path)


@pytest.mark.parametrize("content", [b"", b"GIF89a", b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n"])
def test_other_formats_are_refused(tmp_path, content):
    (tmp_path / "a.jpg").write_bytes(content)
    with pytest.raises(SagError, match=r"a\.jpg cannot be read as a JPG or PNG"):
        read_colour(tmp_path / "a.jpg")


def test_a_missing_picture_is_refused(tmp_path):
    with pytest.raises(SagError, match=r"absent\.jpg"):
        read_colour(tmp_path / "absent.jpg")
