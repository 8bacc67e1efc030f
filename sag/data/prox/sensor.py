"""The depth that the Kinect measured, brought from its depth camera to its colour camera."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from sag.data.pictures import read_grey
from sag.data.prox.calibration import Sensor

STEPS_A_METRE = 8000
"""Of the stored depth; 0 is where nothing was measured."""

NEAREST = 0.1
"""Points nearer than this to the colour camera (metres) are left out."""


class Aligned(NamedTuple):
    """Measured depth as the colour camera sees it.

    Attributes:
        depth: planar z, metres, 0 where nothing was measured.
        source: place of the measuring pixel in the flat depth picture, -1 where there is none.
    """

    depth: Float[np.ndarray, "h w"]
    source: Int[np.ndarray, "h w"]


def read_depth(path: Path) -> Float[np.ndarray, "h w"]:
    """A depth picture, unmirrored: planar z in the depth camera, metres, 0 where nothing was measured.

    Raises:
        SagError: the file is missing or damaged.
    """
    return read_grey(path)[:, ::-1] / STEPS_A_METRE


def aligned(measured: Float[np.ndarray, "a b"], sensor: Sensor, size: tuple[int, int]) -> Aligned:
    """Measured depth in the pixels of the colour camera; of several points in a pixel the nearest stays.

    A pixel of the depth camera covers a square of the colour camera's, as large as their focal lengths say.

    Args:
        measured: planar z in the depth camera, metres, 0 where nothing was measured.
        sensor: both cameras.
        size: rows and columns of the colour pictures.
    """
    rows, columns = np.mgrid[: measured.shape[0], : measured.shape[1]] + 0.5
    rays = sensor.infrared.rays(np.stack([columns, rows], axis=-1))
    points = sensor.to_colour((rays * measured[..., None]).reshape(-1, 3))
    places = np.flatnonzero((measured.ravel() > 0) & (points[:, 2] > NEAREST))
    # Far points first, so that near ones are written over them.
    places = places[np.argsort(-points[places, 2], kind="stable")]
    seen = points[places] @ sensor.colour.intrinsics.T
    pixels = seen[:, :2] / seen[:, 2:]
    square = int(np.ceil(sensor.colour.intrinsics[0, 0] / sensor.infrared.intrinsics[0, 0]))
    covered = np.floor(pixels - (square - 1) / 2).astype(int)[:, None] + np.indices((square, square)).reshape(2, -1).T
    column, row = covered.reshape(-1, 2).T
    inside = (column >= 0) & (column < size[1]) & (row >= 0) & (row < size[0])
    source = np.full(size, -1)
    # Where places repeat, numpy keeps the last value.
    source[row[inside], column[inside]] = places.repeat(square**2)[inside]
    return Aligned(np.where(source >= 0, points[source, 2], 0), source)
