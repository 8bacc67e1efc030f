"""The data module of GTA-IM."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sag.data.gta_im.reader import GTA_IM
from sag.data.gta_im.recording import joint_places, recordings_in
from sag.data.recordings import Limits, RecordedDataModule
from sag.data.recordings.digest import digest_of
from sag.data.recordings.splits import RoomSplit
from sag.errors import SagError

DEFAULT_LIMITS = Limits()
"""What a window must keep to when a config says nothing."""

RATES = {"FPS-30": 30.0, "FPS-5": 5.0}
"""Folders of GTA-IM and their nominal frames a second."""

HOW_TO_GET = (
    "GTA-IM (CC BY-NC) is sent by its authors on request by e-mail, see https://github.com/ZheC/GTA-IM-Dataset; "
    "set its folder by --data.init_args.root"
)


class GtaImDataModule(RecordedDataModule):
    """GTA-IM: windows of its recordings, converted once to a window cache.

    Args:
        root: folder that holds `FPS-30`, `FPS-5` or both.
        rate: the one of them that is used; where it is missing the other is, and a note says so.
        stride: frames from one window to the next (paper, 4.1).
        train_rooms: rooms to train on; the paper does not tell its own.
        test_rooms: rooms to test on; rooms in both are divided by recording.
        shared_test_share: share of a shared room's recordings that test.
        val_share: share of the training recordings that are held out.
        limits: what a window must keep to.
        cloud_step: of the native depth every so many rows and columns go to the test windows' clouds; 1 is the
            sensor's own resolution, 4 MB a window.
        skip_broken: leaves recordings out that cannot be read, with a note that names each; otherwise they are errors.
        cache_dir: folder that holds the window caches.
        skeleton: name of the skeleton, see `sag.skeleton.SKELETONS`.
        image_size: rows and columns of the picture; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name = "gta_im"
    reader = GTA_IM
    version = 2
    needs = "65 frames with .jpg, .png and _id.png at the first"

    def __init__(
        self,
        root: Path,
        rate: str = "FPS-30",
        stride: int = 5,
        train_rooms: tuple[int, ...] = (1, 2, 3, 6, 10, 11),
        test_rooms: tuple[int, ...] = (10, 11, 13),
        shared_test_share: float = 0.5,
        val_share: float = 0.05,
        limits: Limits = DEFAULT_LIMITS,
        cloud_step: int = 1,
        skip_broken: bool = False,
        cache_dir: Path = Path("data"),
        skeleton: str = "gta_im_19",
        image_size: tuple[int, int] = (288, 512),
        batch_size: int = 16,
        eval_batch_size: int = 64,
    ) -> None:
        if rate not in RATES:
            raise SagError(f"data.init_args.rate must be one of {', '.join(RATES)}, found {rate!r}")
        rooms = RoomSplit(tuple(train_rooms), tuple(test_rooms), shared_test_share, val_share)
        super().__init__(
            root, stride, rooms, limits, cloud_step, skip_broken,
            cache_dir, skeleton, image_size, batch_size, eval_batch_size,
        )  # fmt: skip
        self.rate = rate

    def joint_places(self) -> list[int]:
        """Places of the skeleton's joints among the 21 of the files."""
        return joint_places(self.skeleton)

    def folder(self) -> Path:
        """Folder of the recordings.

        Raises:
            SagError: there is none.
        """
        for rate in (self.rate, *RATES):
            if any(recordings_in(self.root / rate)):
                return self.root / rate
        raise SagError(
            f"{self.root} is no GTA-IM folder: expected {self.root / self.rate} with a folder for each recording, "
            f"info_frames.npz and pictures inside; {HOW_TO_GET}"
        )

    def recordings(self) -> list[Path]:
        """Folders of the recordings of the rate that is used."""
        return list(recordings_in(self.folder()))

    def sources(self) -> dict[str, Any]:
        """The rate, and the files by name, size and time."""
        folder = self.folder()
        return {"rate": [self.rate, folder.name], "files": digest_of(recordings_in(folder))}

    def native_fps(self) -> float:
        """The nominal rate of the folder that is used."""
        return RATES[self.folder().name]

    def remarks(self) -> list[str]:
        """What to know of the frames a second."""
        used = self.folder().name
        nominal = f"{RATES[used]:g} frames a second is the nominal rate of {used}; some recordings are faster or slower"
        return [nominal] if used == self.rate else [f"{used} USED: {self.root} has no {self.rate}", nominal]
