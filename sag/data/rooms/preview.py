"""A sheet of windows to look at: pictures with the motion drawn in."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from sag.data.cache import SPLITS, WindowCache
from sag.data.rooms.build import load_contact
from sag.data.rooms.filming import sharp_picture
from sag.data.rooms.recipe import Recipe
from sag.data.rooms.windows import ROOT
from sag.data.sheet import Tile, draw_sheet, projected
from sag.skeleton import GTA_IM_19

STILL = 0.35
"""A root that moves less than this in a window (metres) is said to stand."""

LEVEL = 0.1
"""One that ends this much higher or lower (metres) climbs."""

TURNS = ("goes", "sits", "climbs", "goes", "stands")
"""Kinds of windows, in the order in which the sheet shows them."""


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
    recipe, kinds = Recipe.from_dict(cache.index["recipe"]), _kinds(cache, load_contact(cache))
    tiles = [_tile(cache, recipe, row, str(kinds[row])) for row in _spread(cache, kinds, count).tolist()]
    draw_sheet(tiles, GTA_IM_19, path, columns)


def _spread(cache: WindowCache, kinds: np.ndarray, count: int) -> Int[np.ndarray, " n"]:
    """Rows of windows from all splits: half of them for training, a sixth for validation, the rest for testing.

    Each is the middle one, of the kind whose turn it is, in its stretch of the split.
    """
    turns = itertools.cycle(TURNS)
    chosen = []
    for split, number in zip(SPLITS, (count - count // 6 - count // 3, count // 6, count // 3)):
        rows = cache.rows(split)
        for stretch in np.array_split(rows, max(1, min(number, len(rows))))[:number]:
            wanted = stretch[kinds[stretch] == next(turns)]
            candidates = wanted if len(wanted) else stretch
            chosen.append(int(candidates[len(candidates) // 2]))
    return np.array(chosen)


def _kinds(cache: WindowCache, contact: Bool[np.ndarray, "n 65"]) -> np.ndarray:
    """What happens in each window: one of `TURNS`."""
    travelled, rise = _way(cache)
    kinds = np.where(np.abs(rise) > LEVEL, "climbs", np.where(travelled < STILL, "stands", "goes"))
    return np.where(contact.any(axis=1), "sits", kinds)


def _way(cache: WindowCache) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """How far the root travels in each window, and how much higher it ends, metres."""
    root = np.asarray(cache.joints[:, :, ROOT])
    travelled = np.linalg.norm(np.diff(root, axis=1), axis=2).sum(axis=1)
    return travelled, np.einsum("nc,nc->n", root[:, -1] - root[:, 0], cache.world2cam[:, :3, 2])


def _tile(cache: WindowCache, recipe: Recipe, row: int, kind: str) -> Tile:
    """A window at the paper's size."""
    image = sharp_picture(cache, recipe, row)
    joints = projected(cache.joints[row], cache.intrinsics[row]) * (len(image) / cache.image.shape[1])
    return Tile(image, joints, _caption(cache, kind, row))


def _caption(cache: WindowCache, kind: str, row: int) -> str:
    """Split, room and what happens."""
    travelled, rise = (float(values[row]) for values in _way(cache))
    level = f", {'up' if rise > 0 else 'down'} {abs(rise):.2f} m"
    what = {"sits": "at a seat", "stands": "stands", "goes": f"goes {travelled:.1f} m"}
    said = what.get(kind, f"goes {travelled:.1f} m{level}")
    return f"{SPLITS[int(cache.split[row])]}, room {int(cache.scene[row])}, frame {int(cache.start[row])}: {said}"
