"""Motions of a file, window by window, with what their data set tells of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from sag.data.base import MotionDataModule
from sag.data.motion_file import MotionFile
from sag.errors import SagError
from sag.export.glb import View
from sag.export.surface import Surface, surface_of
from sag.export.upright import CAMERA_UP, Upright, estimated_up, up_of
from sag.skeleton import Skeleton

LENS = (0.87, 16 / 9)
"""Angle in radians from the lowest row to the highest, and width over height, of a camera that nothing is known of."""


@dataclass(frozen=True)
class Source:
    """What is exported.

    Attributes:
        motions: of the file.
        skeleton: theirs.
        fps: frames a second.
        data: where the windows come from, if that is known.
        level: guesses what is up from the person, whatever the data set says of the camera.
    """

    motions: MotionFile
    skeleton: Skeleton
    fps: float
    data: MotionDataModule | None = None
    level: bool = False

    @cached_property
    def rows(self) -> dict[int, int]:
        """Row of the file for each window.

        Raises:
            SagError: the motions are not of the data set.
        """
        if self.data is not None:
            return self.motions.by_window(self.data)
        count = len(self.motions.joints)
        index = np.arange(count) if self.motions.index is None else self.motions.index
        return {int(window): row for row, window in enumerate(index)}

    def chosen(self, window: int | None, sample: int | None, every: bool) -> Iterator[tuple[int, int]]:
        """Windows and samples, counted from 1.

        Args:
            window: the only one; the first, or all, by default.
            sample: the only one; the first, or all, by default.
            every: whether the default is all.

        Raises:
            SagError: the file has no such window or sample.
        """
        path, samples = self.motions.path, self.motions.joints.shape[1]
        if window is not None and window not in self.rows:
            near = min(self.rows, key=lambda known: abs(known - window))
            raise SagError(f"--window {window} is not in {path}; the nearest that is has the number {near}")
        if sample is not None and not 1 <= sample <= samples:
            raise SagError(f"--sample is {sample}; {path} has {samples} of each window, counted from 1")
        windows = list(self.rows)[: None if every else 1] if window is None else [window]
        numbers = range(1, samples + 1 if every else 2) if sample is None else [sample]
        return ((one, number) for one in windows for number in numbers)

    @property
    def up(self) -> str:
        """What tells which way is up."""
        if self.level:
            return "guessed from the person"
        if self.data is None:
            return "the camera's own, as if it were held level"
        return f"as {self.data.name} tells of the camera"

    def upright(self, window: int) -> Upright:
        """The axes of a window, the same for all its samples."""
        motions = self.motions.joints[self.rows[window]]
        start, up, ankles = motions[0, 0], CAMERA_UP, {}
        if self.data is not None:
            up = up_of(self.data.cache.world2cam[window])
            ankles = {"ankle_height": self.data.ankle_height}
        if self.level:
            up = estimated_up(motions.reshape(-1, *start.shape), self.skeleton)
        return Upright.at(start, self.skeleton, up, **ankles)

    def joints(self, window: int, sample: int) -> Float[np.ndarray, "t j 3"]:
        """A motion, metres, Y up."""
        joints = self.motions.joints[self.rows[window], sample - 1]
        return self.upright(window).from_camera(joints.astype(np.float64))

    def surface(self, window: int) -> Surface:
        """The place that a window's picture shows, metres, Y up.

        Raises:
            SagError: the data set is not known, or the window has no depth.
        """
        if self.data is None:
            raise SagError(f"--scene: {self.motions.path} does not tell its data set; name it by --reference")
        if window not in self._surfaces:  # the samples of a window share it
            self._surfaces.clear()
            self._surfaces[window] = surface_of(self.data, window).stood_up(self.upright(window))
        return self._surfaces[window]

    @cached_property
    def _surfaces(self) -> dict[int, Surface]:
        return {}

    def view(self, window: int) -> View:
        """The camera, which sees at least what the picture shows: one of glTF cannot look past its middle."""
        height, aspect = LENS
        if self.data is not None:
            picture, matrix = self.data.picture_with_camera(window)
            rows, columns = picture.shape[:2]
            sides = ((1, rows), (0, columns))
            up, across = (max(matrix[i, 2], size - matrix[i, 2]) / matrix[i, i] for i, size in sides)
            height, aspect = float(2 * np.arctan(up)), float(across / up)
        upright = self.upright(window)
        return View(upright.from_camera(np.zeros(3)), upright.rotation @ np.diag([1.0, -1, -1]), height, aspect)
