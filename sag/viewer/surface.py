"""Surfaces of a scene, small enough for a page: depth on a coarser grid, and what the person hid filled by a guess."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int16, UInt8
from PIL import Image
from scipy.ndimage import binary_dilation
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from sag.viewer.shown import ShownScene

MILLIMETRES = 1000.0
"""Steps of a stored depth in a metre."""

FARTHEST = 32.0
"""Depth beyond which nothing is shown, metres: what 15 bits of millimetres hold."""

GROWN = 2
"""Cells by which the person's place is widened before it is filled, since masks end a little too early."""

NEIGHBOURS = ((0, 1), (1, 0), (0, -1), (-1, 0))


class Grid(NamedTuple):
    """Depth on a grid.

    Attributes:
        depth: millimetres; negative where it is guessed, 0 where it is not known.
        stride: pixels of the whole depth map from one cell to the next, which starts half of that in.
    """

    depth: Int16[np.ndarray, "rows columns"]
    stride: int


def grid_of(scene: ShownScene, cells: int) -> Grid:
    """The depth of a scene on a grid of at most so many cells."""
    stride = 1
    while -(-scene.depth.shape[0] // stride) * -(-scene.depth.shape[1] // stride) > cells:
        stride += 1
    picked = slice(stride // 2, None, stride)
    depth = scene.depth[picked, picked].astype(float)
    depth = np.where((depth > 0) & (depth < FARTHEST), depth, 0.0)
    hole = binary_dilation(scene.hidden[picked, picked], iterations=GROWN) & (depth == 0)
    # Planes are linear in 1 / z over a picture, so that is what is carried on into the hole.
    inverse = filled(np.divide(1.0, depth, out=np.zeros_like(depth), where=depth > 0), hole, known=depth > 0)
    guessed = np.divide(-1.0, inverse, out=np.zeros_like(depth), where=hole & (inverse > 1 / FARTHEST))
    return Grid(np.round((depth + guessed) * MILLIMETRES).astype(np.int16), stride)


def empty_picture(picture: UInt8[np.ndarray, "h w 3"], person: Bool[np.ndarray, "r c"]) -> UInt8[np.ndarray, "h w 3"]:
    """The picture with colours from around the person in the person's place.

    Args:
        picture: colours.
        person: where the person stands, on any grid over the same picture.
    """
    size = (picture.shape[1], picture.shape[0])
    mask = np.asarray(Image.fromarray(person).resize(size, Image.Resampling.NEAREST))
    hole = binary_dilation(mask, iterations=GROWN + -(-size[0] // person.shape[1]))
    channels = [filled(picture[..., channel].astype(float), hole, known=~hole) for channel in range(3)]
    return np.stack(channels, axis=-1).round().clip(0, 255).astype(np.uint8)


def filled(
    values: Float[np.ndarray, "h w"], hole: Bool[np.ndarray, "h w"], known: Bool[np.ndarray, "h w"]
) -> Float[np.ndarray, "h w"]:
    """Values with a hole filled as smoothly as its rim allows: each cell is the mean of its neighbours.

    Args:
        values: any unit.
        hole: what is filled; parts of it that touch nothing known become 0.
        known: what may be looked at.
    """
    count = int(hole.sum())
    if not count:
        return values
    number = np.full(np.add(hole.shape, 2), -1)
    number[1:-1, 1:-1][hole] = np.arange(count)
    padded, usable = np.pad(values, 1), np.pad(known & ~hole, 1)
    cells = np.argwhere(hole) + 1
    total, links, right = np.full(count, 1e-9), [], np.zeros(count)
    for step in NEIGHBOURS:
        row, column = (cells + step).T
        inner, rim = number[row, column] >= 0, usable[row, column]
        total += inner | rim
        right += np.where(rim, padded[row, column], 0)
        links.append(np.stack([np.flatnonzero(inner), number[row, column][inner]]))
    first, second = np.concatenate([*links, np.stack([np.arange(count)] * 2)], axis=1)
    entries = np.concatenate([np.full(len(first) - count, -1.0), total])
    solved = values.copy()
    solved[hole] = splu(coo_matrix((entries, (first, second)), (count, count)).tocsc()).solve(right)
    return solved
