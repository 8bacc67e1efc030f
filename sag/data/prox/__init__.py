"""PROX (Hassan et al., ICCV 2019): people in 12 scanned rooms before a Kinect, as its users download it."""

from __future__ import annotations

import contextlib
from collections import Counter
from dataclasses import asdict
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from sag.data.base import MotionDataModule
from sag.data.cache import DEPTH_UNIT, WindowCache, open_or_build, write_cache
from sag.data.gta_im.convert import convert, counted
from sag.data.gta_im.filters import Limits
from sag.data.gta_im.plan import Plan, planned
from sag.data.gta_im.reader import Reader
from sag.data.gta_im.splits import RoomSplit
from sag.data.gta_im.views import WindowFormat
from sag.data.prox.filters import events, usable_starts
from sag.data.prox.fits import Bodies
from sag.data.prox.names import FPS
from sag.data.prox.notes import notes_on
from sag.data.prox.recording import joint_places
from sag.data.prox.root import DepthSource, Root
from sag.data.prox.views import stored_window
from sag.data.scratch import scratch_folder
from sag.errors import SagError

DEFAULT_LIMITS = Limits()
"""What a window must keep to when a config says nothing."""

VERSION = 1
"""Raised when the same recordings give other bytes, so that old caches are not used."""

FARTHEST = np.iinfo(np.uint16).max * DEPTH_UNIT
"""Largest depth that a cache can hold, metres."""

TRAIN_ROOMS = (
    "BasementSittingBooth", "MPH1Library", "MPH8", "MPH11", "MPH112",
    "N0SittingBooth", "N0Sofa", "N3Library", "N3Office", "Werkraum",
)  # fmt: skip
"""Ten of the twelve scenes; the paper does not tell its own."""

TEST_ROOMS = ("MPH16", "N3OpenArea")
"""The other two."""

FEMALE_SUBJECTS = (162, 3452, 159, 3403)
"""Subjects whom PROX fits with SMPL-X's female model."""


class ProxDataModule(MotionDataModule):
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
        super().__init__(cache_dir, skeleton, image_size, batch_size, eval_batch_size)
        if stride < 1 or cloud_step < 1:
            raise SagError(f"data.init_args.stride and cloud_step must be at least 1, found {stride} and {cloud_step}")
        if not 0 < limits.farthest_depth <= FARTHEST:
            raise SagError(
                f"data.init_args.limits.farthest_depth must be up to {FARTHEST:.1f} metres, the stored limit"
            )
        bodies = Bodies(Path(smplx_models), tuple(female_subjects)) if smplx_models else None
        self.root = Path(root)
        self.files = Root(self.root, bodies, depth)
        self.stride = stride
        self.skip_broken = skip_broken
        self.split = RoomSplit(tuple(train_rooms), tuple(test_rooms), shared_test_share, val_share)
        self.form = WindowFormat(joint_places(self.skeleton), self.image_size, cloud_step, limits)

    @cached_property
    def reader(self) -> Reader:
        """How its recordings are read."""
        return Reader(self.name, self.files.read, usable_starts, stored_window, rooms=self.files.rooms, events=events)

    def build(self) -> WindowCache:
        """Opens the cache, converting the recordings first when it is missing, and prints its notes and counts.

        Raises:
            SagError: the data set is not where the config says, or has no usable window.
        """
        recipe = self._recipe()
        cache = open_or_build(self.cache_dir, self.name, recipe, lambda folder: self._convert(folder, recipe))
        windows = counted(cache.split, Counter(cache.index["dropped"]), Counter(cache.index["events"]))
        for note in (*cache.index["notes"], windows):
            print(f"{self.name}: {note}", flush=True)
        return cache

    def _recipe(self) -> dict[str, Any]:
        """Everything that decides the bytes of the cache."""
        bodies = self.files.bodies
        return {
            "version": VERSION,
            "files": self.files.digest(),
            "depth": self.files.depth,
            "female": list(bodies.female_subjects) if bodies else None,
            "stride": self.stride,
            "rooms": asdict(self.split),
            "form": asdict(self.form),
            "skeleton": self.skeleton.name,
            "skip_broken": self.skip_broken,
        }

    def _convert(self, folder: Path, recipe: dict[str, Any]) -> WindowCache:
        """Converts the recordings to a cache in a folder."""
        recordings, limits = self.files.recordings, self.form.limits
        plan = planned(recordings, self.stride, limits, self.split, self.reader, self.skip_broken)
        if not plan.windows:
            raise SagError(f"{self.root} has no usable window (65 frames with bodies): {dict(plan.dropped)}")
        with scratch_folder(folder) as scratch:
            with contextlib.suppress(SagError):  # another process may have made it in the meantime
                return WindowCache.open(folder)
            converted = convert(plan, self.form, scratch, self.reader)
            dropped = plan.dropped + converted.dropped
            notes = [*notes_on(self.files), *plan.notes, *converted.notes]
            return write_cache(folder, converted.arrays, self._index(recipe, plan, dropped, notes))

    def _index(self, recipe: dict[str, Any], plan: Plan, dropped: Counter[str], notes: list[str]) -> dict[str, Any]:
        return {
            "name": self.name,
            "recipe": recipe,
            "fps": FPS,
            "skeleton": self.skeleton.name,
            "dropped": dict(dropped),
            "notes": notes,
            "events": dict(plan.events),
            "rooms": self.files.rooms,
            "sequences": [path.name for path in plan.folders],
        }
