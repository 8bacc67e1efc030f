"""A sheet of windows to look at: pictures with the motion drawn in."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from jaxtyping import Float, Int
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from sag.data.cache import SPLITS, WindowCache
from sag.data.rooms.build import load_contact
from sag.data.rooms.filming import Shoot
from sag.data.rooms.recipe import CLOUD_SIZE, Recipe
from sag.data.rooms.windows import ROOT, picture_of
from sag.skeleton import GTA_IM_19

EVERY = 13
"""Frames from one drawn skeleton to the next."""

STILL = 0.35
"""A root that moves less than this in a window (metres) is said to stand."""


def sheet(cache: WindowCache, path: Path, count: int = 12, columns: int = 3) -> None:
    """Writes a PNG of windows spread over the splits, rendered again at the paper's size.

    The picture shows the start; skeletons every 13 frames after it go from dark to bright, the line is the root's way.

    Args:
        cache: of rooms.
        path: of the PNG.
        count: windows.
        columns: windows side by side.

    Raises:
        SagError: the cache holds no rooms, or was made by another version.
    """
    recipe, contact = Recipe.from_dict(cache.index["recipe"]), load_contact(cache)
    chosen = _spread(cache, count)
    lines = -(-len(chosen) // columns)
    figure = Figure(figsize=(columns * 5.2, lines * 3.15), layout="constrained")
    axes = np.ravel(figure.subplots(lines, columns, squeeze=False))
    for place, row in zip(axes, chosen):
        place.imshow(_picture(cache, recipe, int(row)), extent=(0, CLOUD_SIZE[1], CLOUD_SIZE[0], 0))
        _draw(place, _projected(cache, int(row)))
        place.set_title(_caption(cache, contact, int(row)), fontsize=9)
    for place in axes:
        place.axis("off")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)


def _spread(cache: WindowCache, count: int) -> Int[np.ndarray, " n"]:
    """Rows of windows from all splits: half of them for training, a sixth for validation, the rest for testing."""
    wanted = (count - count // 6 - count // 3, count // 6, count // 3)
    chosen = []
    for split, number in zip(SPLITS, wanted):
        rows = cache.rows(split)
        number = min(number, len(rows))
        # Middle of equal stretches, so that no window is at the edge of a recording.
        chosen.append(rows[((np.arange(number) + 0.5) * len(rows) / max(number, 1)).astype(int)])
    return np.concatenate(chosen)


def _picture(cache: WindowCache, recipe: Recipe, row: int) -> np.ndarray:
    if recipe.image_size[0] >= CLOUD_SIZE[0]:
        return np.asarray(cache.image[row])
    shoot = Shoot.of(recipe, int(cache.scene[row]))
    recording = next(r for r in shoot.recordings() if r.number == cache.sequence[row])
    return picture_of(recording, shoot.scenery, int(cache.start[row]), CLOUD_SIZE).image


def _projected(cache: WindowCache, row: int) -> Float[np.ndarray, "65 19 2"]:
    """Joints in pixels of a picture of the paper's size."""
    pixels = cache.joints[row] @ cache.intrinsics[row].T
    return pixels[..., :2] / np.maximum(pixels[..., 2:], 1e-6) * (CLOUD_SIZE[0] / cache.image.shape[1])


def _draw(axes: Axes, joints: Float[np.ndarray, "65 19 2"]) -> None:
    """Skeletons and the root's way, coloured by time."""
    colours = matplotlib.colormaps["plasma"]
    for frame in range(EVERY, len(joints), EVERY):
        bones = joints[frame][GTA_IM_19.bone_index]
        axes.add_collection(LineCollection(list(bones), colors=[colours(frame / len(joints))], linewidths=1.3))
    root = joints[:, ROOT]
    trail = LineCollection(
        list(np.stack([root[:-1], root[1:]], axis=1)), array=np.arange(len(root) - 1), cmap="plasma", linewidths=2
    )
    axes.add_collection(trail)
    axes.set_xlim(0, CLOUD_SIZE[1])
    axes.set_ylim(CLOUD_SIZE[0], 0)


def _caption(cache: WindowCache, contact: np.ndarray, row: int) -> str:
    """Split, room and what happens."""
    root = cache.joints[row][:, ROOT]
    travelled = float(np.linalg.norm(np.diff(root, axis=0), axis=1).sum())
    up = cache.world2cam[row][:3, 2]
    rise = float((root[-1] - root[0]) @ up)
    sits = contact[row].any()
    what = "at a seat" if sits else "stands" if travelled < STILL else f"goes {travelled:.1f} m"
    level = f", {'up' if rise > 0 else 'down'} {abs(rise):.2f} m" if abs(rise) > 0.1 and not sits else ""
    split = SPLITS[int(cache.split[row])]
    return f"{split}, room {int(cache.scene[row])}, frame {int(cache.start[row])}: {what}{level}"
