"""The embedded rooms as a data module."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from sag.data.base import MotionDataModule
from sag.data.cache import WindowCache, open_or_build
from sag.data.rooms.build import build_rooms
from sag.data.rooms.filming import sharp_picture
from sag.data.rooms.geometry import RoomGeometry, load_geometry
from sag.data.rooms.person import ANKLE
from sag.data.rooms.recipe import CLOUD_SIZE, Recipe
from sag.errors import SagError
from sag.skeleton import GTA_IM_19


class RoomsDataModule(MotionDataModule):
    """Synthetic furnished rooms with people who walk, reach, sit and stand in them; made on the spot.

    Args:
        train_rooms: rooms that are trained on; every fourth one also has a camera for testing, and every twelfth
            one for validation.
        test_rooms: rooms that are only tested on.
        val_rooms: rooms that are only validated on.
        views: cameras for training in each training room.
        recordings: recordings of each camera.
        seed: of all that is drawn.
        workers: processes that build the cache; they do not change its bytes.
        cache_dir: folder that holds the window caches.
        skeleton: only `gta_im_19`.
        image_size: rows and columns of the picture, 9:16; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name = "rooms"
    ankle_height = ANKLE

    def __init__(
        self,
        train_rooms: int = 144,
        test_rooms: int = 36,
        val_rooms: int = 12,
        views: int = 2,
        recordings: int = 2,
        seed: int = 0,
        workers: int = 2,
        cache_dir: Path = Path("data"),
        skeleton: str = "gta_im_19",
        image_size: tuple[int, int] = (72, 128),
        batch_size: int = 16,
        eval_batch_size: int = 64,
    ) -> None:
        super().__init__(cache_dir, skeleton, image_size, batch_size, eval_batch_size)
        if self.skeleton.name != GTA_IM_19.name:
            raise SagError(f"data.init_args.skeleton must be {GTA_IM_19.name} for rooms, found {skeleton!r}")
        self.recipe = Recipe(seed, train_rooms, test_rooms, val_rooms, views, recordings, self.image_size)
        self.workers = workers

        self.geometries: dict[int, RoomGeometry] = {}

    def geometry(self, room: int) -> RoomGeometry:
        """Everything solid in a room, read once."""
        if room not in self.geometries:
            self.geometries[room] = load_geometry(self.cache, room)
        return self.geometries[room]

    def picture(self, window: int) -> UInt8[np.ndarray, "h w 3"]:
        """The picture of a window, rendered again at twice the paper's size where the cache's is smaller."""
        return sharp_picture(self.cache, self.recipe, window, (2 * CLOUD_SIZE[0], 2 * CLOUD_SIZE[1]))

    def build(self) -> WindowCache:
        """Opens the cache of the recipe, making the rooms first when it is missing."""
        return open_or_build(
            self.cache_dir,
            self.name,
            self.recipe.as_dict(),
            lambda folder: build_rooms(folder, self.recipe, self.workers),
        )
