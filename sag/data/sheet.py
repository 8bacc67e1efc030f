"""A sheet of windows to look at: pictures with the motion drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from jaxtyping import Bool, Float, UInt8
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from sag.errors import SagError
from sag.files import write_whole, writing_in
from sag.skeleton import Skeleton
from sag.types import FRAMES

EVERY = 13
"""Frames from one drawn skeleton to the next."""

TIME = matplotlib.colormaps["plasma"]
"""Colours of a window's frames, dark to bright; the darkest third would not be seen on a dark picture."""

SIDES = {"left": "deepskyblue", "right": "lime"}
"""Colours of the person's own sides in the start frame, by which a mirrored picture shows."""

OUTLINE = "white"
"""Of the person's ids, and of the bones in the middle."""


@dataclass(frozen=True)
class Tile:
    """A window on the sheet.

    Attributes:
        image: colours of its first frame.
        joints: pixels of that picture.
        caption: what stands over it.
        person: where the ids put the person, to be outlined with the start frame's skeleton.
    """

    image: UInt8[np.ndarray, "h w 3"]
    joints: Float[np.ndarray, "t j 2"]
    caption: str
    person: Bool[np.ndarray, "h w"] | None = None


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
        with_start: draws the skeleton of the picture's own frame too, the person's outline, and a legend.

    Raises:
        SagError: the file cannot be written.
    """
    lines = -(-len(tiles) // columns)
    figure = Figure(figsize=(columns * 5.2, lines * 3.15), layout="constrained")
    axes = np.ravel(figure.subplots(lines, columns, squeeze=False))
    for place, tile in zip(axes, tiles):
        rows, width = tile.image.shape[:2]
        place.imshow(tile.image, extent=(0, width, rows, 0))
        _draw(place, tile.joints, skeleton)
        if with_start:
            _draw_start(place, tile, skeleton)
        place.set_xlim(0, width)
        place.set_ylim(rows, 0)
        place.set_title(tile.caption, fontsize=9)
    for place in axes:
        place.axis("off")
    if with_start:
        figure.legend(handles=_legend(), loc="outside lower center", ncols=3, facecolor="dimgrey", labelcolor="white")
    with writing_in(path.parent, f"give another file than {path}"):
        write_whole(path, lambda file: figure.savefig(file, format="png", dpi=110))


def check_sheet(option: str, path: Path, count: int) -> None:
    """Refuses a sheet that cannot be drawn, before anything is looked at.

    Args:
        option: that names the file.
        path: of the PNG.
        count: windows on it.

    Raises:
        SagError: the file is no PNG, lies in no folder, or is one; or no window is asked for.
    """
    if count < 1:
        raise SagError(f"--count must be at least 1, found {count}")
    if path.suffix.lower() != ".png":
        raise SagError(f"{option} {path} must name a file that ends in .png")
    if path.is_dir():
        raise SagError(f"{option} {path} is a folder; name a file in it, such as {path / 'sheet.png'}")
    nearest = next(folder for folder in path.absolute().parents if folder.exists())
    if not nearest.is_dir():
        raise SagError(f"{option} {path}: {nearest} is a file; name one in a folder")


def projected(joints: Float[np.ndarray, "t j 3"], intrinsics: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "t j 2"]:
    """Pixels of joints (metres, camera frame)."""
    pixels = joints @ intrinsics.T
    return pixels[..., :2] / np.maximum(pixels[..., 2:], 1e-6)


def _draw(axes: Axes, joints: Float[np.ndarray, "t j 2"], skeleton: Skeleton) -> None:
    """Skeletons and the root's way, coloured by time."""
    for frame in range(EVERY, len(joints), EVERY):
        bones = joints[frame][skeleton.bone_index]
        axes.add_collection(LineCollection(list(bones), colors=[_colour(frame / len(joints))], linewidths=1.3))
    root = joints[:, skeleton.root_index]
    steps, times = np.stack([root[:-1], root[1:]], axis=1), np.linspace(0, 1, len(root) - 1)
    axes.add_collection(LineCollection(list(steps), colors=[_colour(time) for time in times], linewidths=2))


def _draw_start(axes: Axes, tile: Tile, skeleton: Skeleton) -> None:
    """The skeleton of the picture's own frame, its sides in colours of their own, and the person's outline."""
    colours = [SIDES.get(child.partition("_")[0], OUTLINE) for _, child in skeleton.bones]
    axes.add_collection(LineCollection(list(tile.joints[0][skeleton.bone_index]), colors=colours, linewidths=1.6))
    if tile.person is not None and tile.person.any() and not tile.person.all():
        rows, columns = (np.arange(count) + 0.5 for count in tile.person.shape)
        axes.contour(columns, rows, tile.person, levels=[0.5], colors=OUTLINE, linewidths=0.7)


def _legend() -> list[Line2D | Patch]:
    """What the lines and colours mean."""
    sides = {f"the person's {side} side in this frame": colour for side, colour in SIDES.items()}
    meanings: dict[str, Any] = sides | {
        "the person's middle, and where the ids put them": OUTLINE,
        f"every {EVERY}th frame after it, dark to bright": _colour(0.5),
        f"way of the root in all {FRAMES} frames": _colour(1.0),
    }
    lines = [Line2D([], [], color=colour, label=meaning) for meaning, colour in meanings.items()]
    return [*lines, Patch(color="black", label="beyond the picture")]


def _colour(time: float) -> tuple[float, float, float, float]:
    """Of a time between 0 and 1."""
    return TIME(1 / 3 + 2 / 3 * time)
