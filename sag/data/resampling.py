"""Crops of pictures, resampled to the window's picture."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped, UInt8
from scipy.sparse import csr_array

Box = tuple[float, float, float, float]
"""Left, top, right and bottom edge of a crop, continuous pixels of the whole picture."""


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
