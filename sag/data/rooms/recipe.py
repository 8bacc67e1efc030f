"""What a cache of synthetic rooms is made from: every number that decides its bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from sag.errors import SagError

VERSION = 2
"""Raised when the same recipe gives other bytes, so that old caches are not used."""

CLOUD_SIZE = (288, 512)
"""Rows and columns of the test windows' depth clouds: the paper's picture."""

STRIDE = 8
"""Frames from one window to the next; the paper has 5 (4.1), in recordings many times as long."""


@dataclass(frozen=True)
class Recipe:
    """Everything that decides the bytes of a cache of rooms.

    Attributes:
        seed: of all that is drawn.
        train_rooms: rooms that are trained on; every fourth one also has a camera for testing, and every twelfth
            one for validation.
        test_rooms: rooms that are only tested on.
        val_rooms: rooms that are only validated on.
        views: cameras for training in each training room.
        recordings: recordings of each camera.
        image_size: rows and columns of the pictures.
    """

    seed: int = 0
    train_rooms: int = 144
    test_rooms: int = 36
    val_rooms: int = 12
    views: int = 2
    recordings: int = 2
    image_size: tuple[int, int] = (72, 128)

    def __post_init__(self) -> None:
        for name, least in {"train_rooms": 1, "test_rooms": 1, "val_rooms": 0, "views": 1, "recordings": 1}.items():
            if getattr(self, name) < least:
                raise SagError(f"data.init_args.{name} must be at least {least}, found {getattr(self, name)}")
        rows, columns = self.image_size
        if rows < 8 or abs(rows / columns - CLOUD_SIZE[0] / CLOUD_SIZE[1]) > 0.02:
            raise SagError(f"data.init_args.image_size must be 9:16 like {list(CLOUD_SIZE)}, found {[rows, columns]}")

    @property
    def rooms(self) -> int:
        """How many rooms there are: those that are trained on, those only tested on, those only validated on."""
        return self.train_rooms + self.test_rooms + self.val_rooms

    def as_dict(self) -> dict[str, Any]:
        """What the cache's name is a hash of."""
        return {"version": VERSION, **asdict(self), "image_size": list(self.image_size)}

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Recipe:
        """The recipe of a cache (its `index["recipe"]`).

        Raises:
            SagError: it is of another version or of another data set.
        """
        if values.get("version") != VERSION or set(values) != {"version", *(f.name for f in fields(cls))}:
            raise SagError(f"this is no recipe of rooms of version {VERSION}, build the cache again: {dict(values)}")
        sizes = {name: value for name, value in values.items() if name not in ("version", "image_size")}
        return cls(**sizes, image_size=tuple(values["image_size"]))
