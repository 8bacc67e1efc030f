"""The window that a photograph makes, in a cache of its own."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from sag.data.base import MotionDataModule
from sag.data.cache import ARRAYS, DEPTH_UNIT, PERSON, SPLITS, WindowCache, write_cache
from sag.data.photo.photograph import Photograph
from sag.data.photo.place import Place
from sag.data.recordings.filters import Limits
from sag.data.recordings.views import Picture, WindowFormat, centred_picture
from sag.errors import SagError
from sag.skeleton import Skeleton
from sag.types import FRAMES

WIDEST = 1280
"""Columns of the photograph that is kept for people to look at, at most."""

KEPT = "photograph.jpg"

WINDOW = "window"
"""Folder of the cache in that of the photograph."""


class PhotoDataModule(MotionDataModule):
    """The one window of a photograph: nothing was recorded, and depth is a decoder's guess or not known.

    Args:
        cache_dir: folder that `write_photo` wrote.
        skeleton: name of the skeleton.
        image_size: rows and columns of the picture.
        batch_size: not used, there is nothing to train on.
        eval_batch_size: not used, there is one window.

    Raises:
        SagError: the folder holds no photograph.
    """

    name = "photo"
    recorded = False

    def build(self) -> WindowCache:
        """Opens the cache."""
        return WindowCache.open(self.cache_dir / WINDOW)

    def picture(self, window: int) -> UInt8[np.ndarray, "h w 3"]:
        """The whole photograph; methods see the cache's part of it."""
        with Image.open(self.cache.folder / KEPT, formats=("JPEG",)) as kept:
            return np.asarray(kept.convert("RGB"))

    def picture_with_camera(self, window: int) -> tuple[UInt8[np.ndarray, "h w 3"], Float[np.ndarray, "3 3"]]:
        """The whole photograph, and the camera matrix in its pixels."""
        return self.picture(window), np.array(self.cache.index["recipe"]["camera"])


def write_photo(
    folder: Path,
    photo: Photograph,
    place: Place,
    joints: Float[np.ndarray, "j 3"],
    skeleton: Skeleton,
    image_size: tuple[int, int],
    fps: float,
    depth: Float[np.ndarray, "h w"] | None = None,
    notes: Mapping[str, Any] = {},
) -> PhotoDataModule:
    """Writes the window of a person's place in a photograph: the part of it with the root at its centre.

    The part is as wide as the photograph and of the shape that methods see, as in the data sets; what lies beyond the
    photograph is black and has no depth.

    Args:
        folder: for it; one of before is replaced.
        photo: the photograph.
        place: of the person in it.
        joints: of the first pose, metres, camera frame.
        skeleton: theirs.
        image_size: rows and columns that methods see.
        fps: frames a second of what will be drawn.
        depth: of the part that methods see, planar z, metres; not known when left out.
        notes: what else is to be told of it.

    Raises:
        SagError: the root is not in the photograph, or a joint is behind the camera.
    """
    rows, columns = photo.size
    if not (0 <= place.start[0] <= columns and 0 <= place.start[1] <= rows):
        x, y = place.start
        raise SagError(f"--start {x:g},{y:g} is not in {photo.path}, which has {columns} x {rows} pixels")
    if joints[:, 2].min() < Limits().nearest_joint:
        raise SagError(f"at {place.distance:g} m a part of the person is behind the camera; give a larger --distance")
    whole = Picture(photo.colour, np.ones(photo.size), np.zeros(photo.size, np.int64), place.camera)
    form = WindowFormat([], 0, image_size, 1, Limits())
    seen = centred_picture(whole, place.root, PERSON, form)
    known = seen["depth"] > 0
    seen["depth"] = np.where(known, np.rint((0 if depth is None else depth) / DEPTH_UNIT), 0).astype(np.uint16)
    kept, camera = _kept(photo.colour, place.camera)
    heights = (joints - place.root) @ place.turn[:, 2]
    standing = place.world2cam(PhotoDataModule.ankle_height - float(heights[skeleton.feet].min()))
    window = seen | {"joints": np.tile(joints, (FRAMES, 1, 1)), "world2cam": standing}
    recipe = {"photograph": photo.path.name, "camera": camera.tolist(), "start": list(place.start), **notes}
    index = {"name": "photo", "fps": fps, "skeleton": skeleton.name, "recipe": recipe, "dropped": {}, "notes": []}
    write_cache(folder / WINDOW, _arrays(window), index, {KEPT: kept})
    return PhotoDataModule(folder, skeleton.reference, image_size, 1, 1)


def _kept(colour: UInt8[np.ndarray, "h w 3"], camera: np.ndarray) -> tuple[bytes, np.ndarray]:
    """The whole photograph as JPEG, smaller where it is large, and its camera matrix."""
    columns = min(WIDEST, colour.shape[1])
    rows = max(1, round(colour.shape[0] * columns / colour.shape[1]))
    file = io.BytesIO()
    Image.fromarray(colour).resize((columns, rows), Image.Resampling.LANCZOS).save(file, "JPEG", quality=92)
    return file.getvalue(), camera * np.array([[columns / colour.shape[1]], [rows / colour.shape[0]], [1.0]])


def _arrays(window: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """A cache of this one test window, which has no cloud."""
    numbers = {"split": SPLITS.index("test"), "scene": 0, "sequence": 0, "start": 0, "cloud_row": -1}
    arrays = {name: value[None] for name, value in window.items()} | {n: np.array([v]) for n, v in numbers.items()}
    empty = {"cloud_depth": np.zeros((0, 1, 1)), "cloud_intrinsics": np.zeros((0, 3, 3))}
    return {name: (arrays | empty)[name].astype(dtype) for name, (dtype, _) in ARRAYS.items()}
