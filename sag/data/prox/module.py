"""The data module of PROX."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

from sag.data.prox.filters import events, usable_starts
from sag.data.prox.fits import Bodies
from sag.data.prox.names import FPS
from sag.data.prox.notes import notes_on
from sag.data.prox.recording import joint_places
from sag.data.prox.root import DepthSource, Root
from sag.data.prox.views import stored_window
from sag.data.recordings import Limits, Reader, RecordedDataModule
from sag.data.recordings.splits import RoomSplit

DEFAULT_LIMITS = Limits()
"""What a window must keep to when a config says nothing."""

TRAIN_ROOMS = (
    "BasementSittingBooth", "MPH1Library", "MPH8", "MPH11", "MPH112",
    "N0SittingBooth", "N0Sofa", "N3Library", "N3Office", "Werkraum",
)  # fmt: skip
"""Ten of the twelve scenes; the paper does not tell its own."""

TEST_ROOMS = ("MPH16", "N3OpenArea")
"""The other two."""

FEMALE_SUBJECTS = (162, 3452, 159, 3403)
"""Subjects whom PROX fits with SMPL-X's female model."""


class ProxDataModule(RecordedDataModule):
    """PROX: windows of its recordings, converted once to a window cache.

    Args:
        root: folder that holds `recordings`, `PROXD`, `scenes`, `cam2world` and `calibration`.
        smplx_models: folder with SMPL-X's models, by which PROXD's fits move; it needs `pip install "sag[prox]"`.
            Without it the Kinect's skeletons move, which tremble, and a note says so.
        female_subjects: numbers of the subjects who are fitted with the female model.
        depth: `scan` draws the scene's scan through the colour camera; `sensor` takes the Kinect's own depth.
        stride: frames from one window to the next (paper, 4.1).
        train_rooms: scenes to train on; the paper does not tell its own.
        test_rooms: scenes to test on; scenes in both are divided by recording.
        shared_test_share: share of a shared scene's recordings that test.
        val_share: share of the training recordings that are held out.
        limits: what a window must keep to.
        cloud_step: of the native depth every so many rows and columns go to the test windows' clouds; 1 is the
            colour picture's own resolution, 4 MB a window.
        skip_broken: leaves recordings out that cannot be read, with a note that names each; otherwise they are errors.
        cache_dir: folder that holds the window caches.
        skeleton: name of the skeleton, see `sag.skeleton.SKELETONS`.
        image_size: rows and columns of the picture; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name = "prox"
    version = 1
    needs = "65 frames with bodies"

    def __init__(
        self,
        root: Path,
        smplx_models: Path | None = None,
        female_subjects: tuple[int, ...] = FEMALE_SUBJECTS,
        depth: DepthSource = "scan",
        stride: int = 5,
        train_rooms: tuple[str, ...] = TRAIN_ROOMS,
        test_rooms: tuple[str, ...] = TEST_ROOMS,
        shared_test_share: float = 0.5,
        val_share: float = 0.05,
        limits: Limits = DEFAULT_LIMITS,
        cloud_step: int = 1,
        skip_broken: bool = False,
        cache_dir: Path = Path("data"),
        skeleton: str = "prox_16",
        image_size: tuple[int, int] = (288, 512),
        batch_size: int = 16,
        eval_batch_size: int = 64,
    ) -> None:
        rooms = RoomSplit(tuple(train_rooms), tuple(test_rooms), shared_test_share, val_share)
        super().__init__(
            root, stride, rooms, limits, cloud_step, skip_broken,
            cache_dir, skeleton, image_size, batch_size, eval_batch_size,
        )  # fmt: skip
        bodies = Bodies(Path(smplx_models), tuple(female_subjects)) if smplx_models else None
        self.files = Root(self.root, bodies, depth)

    def joint_places(self) -> list[int]:
        """Places of the skeleton's joints among those of `prox_16`."""
        return joint_places(self.skeleton)

    @cached_property
    def reader(self) -> Reader:
        """How its recordings are read."""
        return Reader(self.name, self.files.read, usable_starts, stored_window, rooms=self.files.rooms, events=events)

    def recordings(self) -> tuple[Path, ...]:
        """Folders of the recordings."""
        return self.files.recordings

    def sources(self) -> dict[str, Any]:
        """Where depth and bodies come from, and the files by name, size and time."""
        bodies = self.files.bodies
        female = list(bodies.female_subjects) if bodies else None
        return {"files": self.files.digest(), "depth": self.files.depth, "female": female}

    def remarks(self) -> list[str]:
        """What speaks against figures on these recordings, if anything."""
        return list(notes_on(self.files))

    def native_fps(self) -> float:
        """The Kinect's."""
        return FPS
