"""A sheet of windows to look at: pictures with the motion drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from jaxtyping import Float, UInt8
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from sag.skeleton import Skeleton

EVERY = 13
"""Frames from one drawn skeleton to the next."""


@dataclass(frozen=True)
class Tile:
    """A window on the sheet.

    Attributes:
        image: colours of its first frame.
        joints: pixels of that picture.
        caption: what stands over it.
    """

    image: UInt8[np.ndarray, "h w 3"]
    joints: Float[np.ndarray, "t j 2"]
    caption: str


def draw_sheet(
    tiles: Sequence[Tile], skeleton: Skeleton, path: Path, columns: int = 3, with_start: bool = False
) -> None:
    """Writes a PNG of windows.

    The picture shows the start; skeletons every 13 frames after it go from dark to bright, the line is the root's way.

    Args:
        tiles: the windows.
        skeleton: of their joints.
        path: of the PNG.
        columns: windows side by side.
        with_start: draws the skeleton of the picture's own frame too, in white.
    """
    lines = -(-len(tiles) // columns)
    figure = Figure(figsize=(columns * 5.2, lines * 3.15), layout="constrained")
    axes = np.ravel(figure.subplots(lines, columns, squeeze=False))
    for place, tile in zip(axes, tiles):
        rows, width = tile.image.shape[:2]
        place.imshow(tile.image, extent=(0, width, rows, 0))
        if with_start:
            bones = list(tile.joints[0][skeleton.bone_index])
            place.add_collection(LineCollection(bones, colors="white", linewidths=1.3))
        _draw(place, tile.joints, skeleton)
        place.set_xlim(0, width)
        place.set_ylim(rows, 0)
        place.set_title(tile.caption, fontsize=9)
    for place in axes:
        place.axis("off")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)


def projected(joints: Float[np.ndarray, "t j 3"], intrinsics: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "t j 2"]:
    """Pixels of joints (metres, camera frame)."""
    pixels = joints @ intrinsics.T
    return pixels[..., :2] / np.maximum(pixels[..., 2:], 1e-6)


def _draw(axes: Axes, joints: Float[np.ndarray, "t j 2"], skeleton: Skeleton) -> None:
    """Skeletons and the root's way, coloured by time."""
    colours = matplotlib.colormaps["plasma"]
    for frame in range(EVERY, len(joints), EVERY):
        bones = joints[frame][skeleton.bone_index]
        axes.add_collection(LineCollection(list(bones), colors=[colours(frame / len(joints))], linewidths=1.3))
    root = joints[:, skeleton.root_index]
    trail = LineCollection(
        list(np.stack([root[:-1], root[1:]], axis=1)), array=np.arange(len(root) - 1), cmap="plasma", linewidths=2
    )
    axes.add_collection(trail)
