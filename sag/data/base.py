"""What every data set is to the rest: a Lightning data module over a window cache."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from sag.data.cache import DEPTH_UNIT, PERSON, SPLITS, WindowCache
from sag.data.order import EpochOrder, ResumableLoader
from sag.errors import SagError
from sag.files import writing_in
from sag.skeleton import Skeleton, skeleton_named
from sag.types import Batch, DepthMap, KnownGeometry, Motion, Scene


class Windows(Dataset[Batch]):
    """The windows of one split; whole batches are read at once from the memory-mapped arrays."""

    def __init__(self, cache: WindowCache, split: str, skeleton: Skeleton, with_cloud: bool = False) -> None:
        self.cache = cache
        self.rows = cache.rows(split)
        self.skeleton = skeleton
        self.with_cloud = with_cloud

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: int) -> Batch:
        return self.__getitems__([index])

    def __getitems__(self, indices: list[int]) -> Batch:
        rows = self.rows[np.asarray(indices)]
        cache = self.cache
        scene = Scene(
            # In place: a batch is read at the speed of memory, and new memory is what takes longest.
            image=_tensor(cache.image, rows).permute(0, 3, 1, 2).float().div_(255),
            depth=_tensor(cache.depth, rows, np.float32).mul_(DEPTH_UNIT),
            person=_tensor(cache.ids, rows) == PERSON,
            intrinsics=_tensor(cache.intrinsics, rows),
        )
        motion = Motion.from_joints(_tensor(cache.joints, rows), self.skeleton.root_index)
        sequence, room = (_tensor(array, rows, np.int64) for array in (cache.sequence, cache.scene))
        world2cam = _tensor(cache.world2cam, rows, np.float32)
        return Batch(motion, scene, torch.as_tensor(rows), sequence, room, world2cam, self._cloud(rows))

    def _cloud(self, rows: np.ndarray) -> DepthMap | None:
        if not self.with_cloud:
            return None
        places = self.cache.cloud_row[rows]
        if (places < 0).any():
            raise SagError(f"{self.cache.folder} has test windows without a depth cloud; delete it to have it rebuilt")
        depth = _tensor(self.cache.cloud_depth, places, np.float32) * DEPTH_UNIT
        return DepthMap(depth, _tensor(self.cache.cloud_intrinsics, places))


def _tensor(array: np.ndarray, rows: np.ndarray, dtype: type | None = None) -> Tensor:
    """Rows of a memory-mapped array as a tensor of their own."""
    picked = array[rows]
    return torch.from_numpy(np.ascontiguousarray(picked if dtype is None else picked.astype(dtype)))


class MotionDataModule(pl.LightningDataModule, ABC):
    """A data set of windows: 65 frames of motion with the picture, depth and camera of their first.

    Args:
        cache_dir: folder that holds the window caches.
        skeleton: name of the skeleton, see `sag.skeleton.SKELETONS`.
        image_size: rows and columns of the picture; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name: str
    """What reports call the data set."""

    ankle_height: float = 0.085
    """Height of a standing person's ankle joint over the floor, metres."""

    recorded: bool = True
    """Whether windows have a motion that was recorded, and not a first pose alone."""

    def __init__(
        self,
        cache_dir: Path = Path("data"),
        skeleton: str = "gta_im_19",
        image_size: tuple[int, int] = (288, 512),
        batch_size: int = 16,
        eval_batch_size: int = 64,
    ) -> None:
        super().__init__()
        self.cache_dir = Path(cache_dir)
        self.skeleton = skeleton_named(skeleton)
        self.image_size = (int(image_size[0]), int(image_size[1]))
        if min(self.image_size) < 1:
            raise SagError(f"data.init_args.image_size must be at least 1 row and 1 column, found {list(image_size)}")
        self.batch_size = batch_size
        self.eval_batch_size = eval_batch_size

    @abstractmethod
    def build(self) -> WindowCache:
        """Opens the cache, building it first when it is missing.

        Raises:
            SagError: the data set is not where the config says.
        """

    @cached_property
    def cache(self) -> WindowCache:
        """The cache behind this data set; a `cache_dir` that cannot be written is a `SagError`."""
        with writing_in(self.cache_dir, "give another folder by --data.init_args.cache_dir"):
            return self.build()

    def prepare_data(self) -> None:
        """Builds the cache when it is missing."""
        _ = self.cache

    def setup(self, stage: str | None = None) -> None:
        """Opens the cache and refuses a split without windows."""
        for split in ("train", "test"):
            if not len(self.cache.rows(split)):
                raise SagError(
                    f"{self.name} at {self.cache.folder} has no {split} windows: {self.cache.index['dropped']}"
                )

    @property
    def encoder_path(self) -> Path:
        """Where Motion FID's encoders trained on exactly these windows lie."""
        return self.cache_dir / "encoders" / f"erd-{self.name}-{self.cache.fingerprint}.pt"

    @property
    def fps(self) -> float:
        """Frames a second."""
        return float(self.cache.index["fps"])

    @property
    def training_motion(self) -> Motion:
        """All true motion of the training split, from which normalisation is computed."""
        joints = torch.from_numpy(np.asarray(self.cache.joints[self.cache.rows("train")]))
        return Motion.from_joints(joints, self.skeleton.root_index)

    def describe(self) -> dict[str, Any]:
        """What a report must know: name, fingerprint, fps, windows of each split, what was left out, warnings."""
        counts = {split: len(self.cache.rows(split)) for split in SPLITS}
        return {
            "name": self.name,
            "fingerprint": self.cache.fingerprint,
            "fps": self.fps,
            "windows": counts,
            "dropped": dict(self.cache.index["dropped"]),
            "notes": list(self.cache.index["notes"]),
        }

    def train_dataloader(self) -> DataLoader[Batch]:
        """Training windows in random order; an incomplete last batch is left out if there is another."""
        windows = Windows(self.cache, "train", self.skeleton)
        size = min(self.batch_size, len(windows))
        order = EpochOrder(windows)
        return ResumableLoader(windows, batch_size=size, sampler=order, drop_last=True, collate_fn=_whole)

    def val_dataloader(self) -> DataLoader[Batch]:
        """Held-out windows of the training rooms."""
        return self._fixed("val", with_cloud=False)

    def test_dataloader(self) -> DataLoader[Batch]:
        """Test windows with their depth clouds, in order."""
        return self._fixed("test", with_cloud=True)

    def elsewhere(self, batch: Batch) -> Batch | None:
        """For each test window another one, with its cloud, that was recorded in another room.

        A window's partner is always the same, so that every method is judged in the same places.

        Returns:
            None where all test windows are of one room.
        """
        rows = self.cache.rows("test")
        rooms = self.cache.scene[rows]
        if len(np.unique(rooms)) < 2:
            return None
        partners = []
        for index, room in zip(batch.index.tolist(), batch.room.tolist()):
            strangers = np.flatnonzero(rooms != room)
            partners.append(int(np.random.default_rng(index).choice(strangers)))
        return Windows(self.cache, "test", self.skeleton, with_cloud=True).__getitems__(partners)

    def picture(self, window: int) -> UInt8[np.ndarray, "h w 3"]:
        """The picture of a window as sharp as it is to be had, for people to look at; methods see the cache's.

        Args:
            window: its place in the data set.
        """
        return np.asarray(self.cache.image[window])

    def picture_with_camera(self, window: int) -> tuple[UInt8[np.ndarray, "h w 3"], Float[np.ndarray, "3 3"]]:
        """`picture`, and the camera matrix in its pixels.

        Args:
            window: its place in the data set.
        """
        picture = np.asarray(self.picture(window))
        larger = picture.shape[1] / self.cache.image.shape[2]
        return picture, np.asarray(self.cache.intrinsics[window], np.float64) * np.array([[larger], [larger], [1.0]])

    def geometry(self, room: int) -> KnownGeometry | None:
        """Solids and floor of a room, where they are known and not only seen."""
        return None

    def predict_dataloader(self) -> DataLoader[Batch]:
        """The test windows."""
        return self.test_dataloader()

    def _fixed(self, split: str, with_cloud: bool) -> DataLoader[Batch]:
        windows = Windows(self.cache, split, self.skeleton, with_cloud)
        return DataLoader(windows, batch_size=self.eval_batch_size, collate_fn=_whole)


def _whole(batch: Any) -> Any:
    """Batches come whole from `Windows.__getitems__`."""
    return batch
