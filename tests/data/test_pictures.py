import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from sag.data import pictures
from sag.data.pictures import area_averaged, nearest, read_24_bit, read_colour
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


def test_the_whole_picture_at_its_own_size_is_itself(colours):
    box = (0.0, 0.0, 8.0, 6.0)
    np.testing.assert_array_equal(area_averaged(colours, box, (6, 8)), colours)
    np.testing.assert_array_equal(nearest(colours[..., 0], box, (6, 8)), colours[..., 0])


def test_halving_takes_the_mean_of_four(colours):
    mean = colours.reshape(3, 2, 4, 2, 3).mean((1, 3))
    assert np.abs(area_averaged(colours, (0.0, 0.0, 8.0, 6.0), (3, 4)) - mean).max() <= 0.5 + 1e-4


def test_half_a_pixel_shares_two(colours):
    crop = area_averaged(colours, (0.5, 0.0, 1.5, 1.0), (1, 1))
    assert np.abs(crop[0, 0] - (colours[0, 0] / 2 + colours[0, 1] / 2)).max() <= 0.5 + 1e-4


def test_outside_the_picture_is_black_and_zero():
    white = np.full((4, 4, 3), 255, np.uint8)
    crop = area_averaged(white, (-4.0, -2.0, 4.0, 6.0), (4, 4))
    expected = np.zeros((4, 4))
    expected[1:3, 2:] = 255
    np.testing.assert_array_equal(crop, np.repeat(expected[..., None], 3, -1))
    np.testing.assert_array_equal(nearest(white[..., 0], (-4.0, -2.0, 4.0, 6.0), (4, 4)), expected)


@settings(deadline=None, max_examples=30)
@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(0.3, 3))
def test_a_crop_that_holds_the_picture_keeps_its_light(left, top, scale):
    image = np.random.default_rng(1).integers(0, 256, (7, 9, 3), dtype=np.uint8)
    box = (left - 5, top - 5, left + 25, top + 15)
    size = (round(20 * scale), round(30 * scale))
    pixels_of_the_picture = 20 * 30 / (size[0] * size[1])
    light = area_averaged(image, box, size).sum((0, 1)) * pixels_of_the_picture
    # Half a level of rounding over the area of all pixels that see the picture.
    assert np.abs(light - image.sum((0, 1), dtype=float)).max() < 0.5 * (7 + 3 / scale) * (9 + 3 / scale)


@settings(deadline=None, max_examples=30)
@given(st.floats(-6, 6), st.floats(-6, 6))
def test_nearest_agrees_with_the_pixel_that_holds_each_centre(left, top):
    values = np.arange(1, 49, dtype=np.int32).reshape(6, 8)
    crop = nearest(values, (left, top, left + 8, top + 6), (3, 4))
    for row in range(3):
        for column in range(4):
            y, x = int(np.floor(top + 2 * row + 1)), int(np.floor(left + 2 * column + 1))
            inside = 0 <= y < 6 and 0 <= x < 8
            assert crop[row, column] == (values[y, x] if inside else 0)
