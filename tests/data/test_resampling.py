import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sag.data.resampling import area_averaged, nearest


@pytest.fixture
def colours() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (6, 8, 3), dtype=np.uint8)


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
