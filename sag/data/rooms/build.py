"""From a recipe to a window cache: rooms are made and filmed by worker processes, and gathered in order."""

from __future__ import annotations

import io
import json
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool

from sag.data.cache import ARRAYS, SPLITS, WindowCache, write_cache
from sag.data.rooms.filming import Shoot
from sag.data.rooms.geometry import geometry_file
from sag.data.rooms.person import FRAME_RATE
from sag.data.rooms.recipe import CLOUD_SIZE, Recipe
from sag.data.rooms.windows import Row, windows
from sag.data.workers import shared_out
from sag.errors import SagError
from sag.files import scratch_folder
from sag.skeleton import GTA_IM_19

CONTACT_FILE = "contact.npy"
"""Where a cache keeps the frames in which furniture is meant to be touched."""

CLOUDS = ("cloud_depth", "cloud_intrinsics")


def build_rooms(folder: Path, recipe: Recipe, workers: int = 2) -> WindowCache:
    """Makes the rooms of a recipe and writes their windows to a cache.

    Args:
        folder: final place of the cache.
        recipe: what decides its bytes; the number of workers does not.
        workers: processes.

    Raises:
        SagError: the disk has no room.
    """
    with scratch_folder(folder) as scratch:
        dropped: Counter[str] = Counter()
        extra: dict[str, bytes] = {}
        for number, (geometry, lost) in enumerate(_filmed(recipe, scratch, workers)):
            extra[geometry_file(number)] = geometry
            dropped += lost
        arrays = {name: _gathered(scratch, name, recipe) for name in (*ARRAYS, "contact")}
        extra[CONTACT_FILE] = _npy(arrays.pop("contact"))
        return write_cache(folder, arrays, _index(recipe, arrays["split"], dropped), extra)


def load_contact(cache: WindowCache) -> Bool[np.ndarray, "n 65"]:
    """Frames in which the person is meant to touch furniture: on a seat, or on the way to it and from it.

    Raises:
        SagError: the cache does not say.
    """
    path = cache.folder / CONTACT_FILE
    if not path.is_file():
        raise SagError(f"{path} is not there: only caches of synthetic rooms know when contact is meant")
    return np.load(path, allow_pickle=False)


def _filmed(recipe: Recipe, scratch: Path, workers: int) -> Iterator[tuple[bytes, Counter[str]]]:
    """Geometry and dropped windows of each room, in order; the rows are left in the scratch folder."""
    return shared_out(partial(_film, recipe, scratch), recipe.rooms, workers, "rooms: building")


def _film(recipe: Recipe, scratch: Path, number: int) -> tuple[bytes, Counter[str]]:
    """Films one room into files of the scratch folder."""
    shoot = Shoot.of(recipe, number)
    dropped: Counter[str] = Counter()
    rows: list[Row] = []
    for recording in shoot.recordings():
        rows += windows(recording, shoot.scenery, recipe.image_size, dropped)
    for name in {name for row in rows for name in row}:
        np.save(scratch / f"{number}.{name}.npy", np.stack([row[name] for row in rows if name in row]))
    return shoot.room.geometry.to_json(), dropped


def _gathered(scratch: Path, name: str, recipe: Recipe) -> np.ndarray:
    """An array of the cache from the files of all rooms, itself on disk."""
    if name == "cloud_row":
        return _cloud_rows(_gathered(scratch, "split", recipe))
    paths = [scratch / f"{number}.{name}.npy" for number in range(recipe.rooms)]
    pieces = [np.load(path, mmap_mode="r") for path in paths if path.exists()]
    if not pieces:
        return np.zeros((0, *_empty_shape(name, recipe)), ARRAYS.get(name, ("bool",))[0])
    shape = (sum(len(piece) for piece in pieces), *pieces[0].shape[1:])
    array = np.lib.format.open_memmap(scratch / f"{name}.npy", "w+", pieces[0].dtype, shape)
    first = 0
    for piece in pieces:
        array[first : first + len(piece)] = piece
        first += len(piece)
    return array


def _empty_shape(name: str, recipe: Recipe) -> tuple[int, ...]:
    """Shape of one row of an array that has none."""
    pictures = {"image": (*recipe.image_size, 3), "depth": recipe.image_size, "ids": recipe.image_size}
    others = {"joints": (65, 19, 3), "intrinsics": (3, 3), "world2cam": (4, 4), "contact": (65,)}
    return {**pictures, **others, "cloud_depth": CLOUD_SIZE, "cloud_intrinsics": (3, 3)}.get(name, ())


def _cloud_rows(split: np.ndarray) -> np.ndarray:
    tested = split == SPLITS.index("test")
    return np.where(tested, np.cumsum(tested) - 1, -1).astype(np.int32)


def _npy(array: np.ndarray) -> bytes:
    content = io.BytesIO()
    np.save(content, array, allow_pickle=False)
    return content.getvalue()


def _index(recipe: Recipe, split: np.ndarray, dropped: Counter[str]) -> dict[str, Any]:
    return {
        "name": "rooms",
        "recipe": json.loads(json.dumps(recipe.as_dict())),
        "fps": float(FRAME_RATE),
        "skeleton": GTA_IM_19.name,
        "dropped": dict(sorted(dropped.items())),
        "notes": [],
    }
