"""A data set of straight walks before a slanted wall, small enough for any test."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sag.data.base import MotionDataModule
from sag.data.cache import PERSON, SPLITS, WindowCache, open_or_build, write_cache
from sag.types import FRAMES

STANDING = np.array(
    [
        [0, -0.75, 0], [0, -0.62, 0], [-0.18, -0.5, 0], [-0.2, -0.25, 0], [-0.2, 0, -0.05], [0.18, -0.5, 0],
        [0.2, -0.25, 0], [0.2, 0, -0.05], [0, -0.4, 0], [0, -0.25, 0], [0, -0.15, 0], [0, -0.07, 0], [0, 0, 0],
        [-0.1, 0.05, 0], [-0.1, 0.45, -0.02], [-0.1, 0.85, 0], [0.1, 0.05, 0], [0.1, 0.45, -0.02], [0.1, 0.85, 0],
    ]
)  # fmt: skip
"""A person of 19 joints, metres from the root, y down."""

LEVEL = np.array([[1.0, 0, 0, 0], [0, 0, -1, 1.2], [0, 1, 0, 0], [0, 0, 0, 1]])
"""A camera 1.2 m over the ground that looks along the horizon; world z is up."""


def walks(count: int, generator: np.random.Generator) -> np.ndarray:
    """(count, 65, 19, 3) people who walk straight on with swinging limbs, metres, camera frame."""
    time = np.arange(FRAMES)[None, :, None, None] / 30
    start = generator.uniform([-0.5, 0.2, 3], [0.5, 0.4, 5], (count, 3))[:, None, None]
    velocity = generator.uniform([-0.8, 0, -0.5], [0.8, 0, 0.5], (count, 3))[:, None, None]
    swing = generator.uniform(0.02, 0.1, (count, 1, 19, 3)) * (np.abs(STANDING).sum(1) > 0.5)[:, None]
    phase = generator.uniform(0, 6, (count, 1, 19, 1))
    return (start + velocity * time + STANDING + swing * np.sin(6 * time + phase)).astype(np.float32)


class ToyDataModule(MotionDataModule):
    """Straight walks.

    Args:
        cache_dir: folder of the cache.
        skeleton: only `gta_im_19`.
        image_size: rows and columns.
        batch_size: windows of a training step.
        eval_batch_size: windows of a test step.
        windows: of the training split; val and test have half as many.
    """

    name = "toy"

    def __init__(
        self,
        cache_dir: Path = Path("data"),
        skeleton: str = "gta_im_19",
        image_size: tuple[int, int] = (36, 64),
        batch_size: int = 4,
        eval_batch_size: int = 4,
        windows: int = 8,
    ) -> None:
        super().__init__(cache_dir, skeleton, image_size, batch_size, eval_batch_size)
        self.windows = windows

    def build(self) -> WindowCache:
        """Builds a few windows at once."""
        recipe = {"windows": self.windows, "image_size": self.image_size}
        return open_or_build(self.cache_dir, self.name, recipe, self._write)

    def _write(self, folder: Path) -> WindowCache:
        generator = np.random.default_rng(0)
        split = np.repeat([0, 1, 2], [self.windows, self.windows // 2, self.windows // 2]).astype(np.uint8)
        n, (h, w) = len(split), self.image_size
        joints = walks(n, generator)
        root = joints[:, 0, 12]
        focal = 0.9 * w
        intrinsics = np.zeros((n, 3, 3), np.float32)
        intrinsics[:, 0, 0] = intrinsics[:, 1, 1] = focal
        intrinsics[:, 0, 2] = w / 2 - focal * root[:, 0] / root[:, 2]
        intrinsics[:, 1, 2] = h / 2 - focal * root[:, 1] / root[:, 2]
        intrinsics[:, 2, 2] = 1
        wall = np.linspace(4000, 7000, w).astype(np.uint16)
        depth = np.broadcast_to(wall, (n, h, w)).copy()
        ids = np.zeros((n, h, w), np.uint8)
        ids[:, h // 3 : 2 * h // 3, w // 2 - 2 : w // 2 + 2] = PERSON
        test = np.flatnonzero(split == SPLITS.index("test"))
        row = np.full(n, -1, np.int32)
        row[test] = np.arange(len(test))
        arrays = {
            "joints": joints,
            "image": generator.integers(0, 255, (n, h, w, 3), dtype=np.uint8),
            "depth": depth,
            "ids": ids,
            "intrinsics": intrinsics,
            "world2cam": np.broadcast_to(LEVEL, (n, 4, 4)),
            "split": split,
            "scene": (np.arange(n) // 2 % 2).astype(np.int32),
            "sequence": (np.arange(n) // 2).astype(np.int32),
            "start": np.zeros(n, np.int32),
            "cloud_row": row,
            "cloud_depth": np.where(ids[test] == PERSON, 0, depth[test]).astype(np.uint16),
            "cloud_intrinsics": intrinsics[test],
        }
        index = {"name": self.name, "fps": 30.0, "skeleton": "gta_im_19", "recipe": {}, "dropped": {}, "notes": []}
        return write_cache(folder, arrays, index)
