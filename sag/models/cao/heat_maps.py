"""Heat maps: places in a picture as bumps on a grid of a quarter of its size, and back."""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor

from sag.geometry.camera import pixel_centres

CELL = 4
"""Pixels from one cell of a heat map to the next: 256 x 448 pictures have maps of 64 x 112, the usual sizes."""

FAINTEST = 1e-6
"""Least value whose logarithm is taken; what a network leaves below it is no bump."""


def map_size(rows: int, columns: int) -> tuple[int, int]:
    """Rows and columns of the heat maps of a picture of this size."""
    return -(-rows // CELL), -(-columns // CELL)


def spread(rows: int) -> float:
    """Deviation of a bump on a map of so many rows, in cells: 2 on the usual 64, never less than 1 (ours)."""
    return max(1.0, rows / 32)


def cell_centres(size: tuple[int, int], like: Tensor) -> Float[Tensor, "h w 2"]:
    """Picture coordinates (pixels) of the centre of every cell of a map of `size` (rows, columns)."""
    return CELL * pixel_centres(*size, like=like)


def heat_maps(pixels: Float[Tensor, "b n 2"], size: tuple[int, int]) -> Float[Tensor, "b n h w"]:
    """A Gaussian bump of height 1 around each place.

    Args:
        pixels: picture coordinates; a place outside the picture leaves what of its bump reaches into it.
        size: rows and columns of the maps.
    """
    offset = (cell_centres(size, pixels) - pixels[:, :, None, None]) / (CELL * spread(size[0]))
    return torch.exp(-offset.square().sum(-1) / 2)


def peak(maps: Float[Tensor, "b h w"]) -> Float[Tensor, "b 2"]:
    """Picture coordinates (pixels) of the highest place of each map, finer than its cells.

    A Gaussian is a parabola in the logarithm, so three cells in a row tell exactly where between them its top is.
    """
    rows, columns = maps.shape[1:]
    highest = maps.flatten(1).argmax(dim=1)
    row, column = highest // columns, highest % columns
    logarithm = maps.clamp_min(FAINTEST).log()
    window = torch.arange(len(maps), device=maps.device)
    across = torch.stack([logarithm[window, row, (column + s).clamp(0, columns - 1)] for s in (-1, 0, 1)])
    down = torch.stack([logarithm[window, (row + s).clamp(0, rows - 1), column] for s in (-1, 0, 1)])
    return CELL * (torch.stack([column + _top(across), row + _top(down)], dim=1) + 0.5)


def _top(values: Float[Tensor, "3 b"]) -> Float[Tensor, " b"]:
    """Where a parabola through values at -1, 0 and 1 is highest, at most half a cell from the middle one."""
    before, middle, after = values
    bend = (2 * middle - before - after).clamp_min(FAINTEST)
    return ((after - before) / (2 * bend)).clamp(-0.5, 0.5)
