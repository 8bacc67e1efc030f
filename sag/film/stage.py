"""What is filmed: motions of one window, and what is known of the place around them."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8

from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.export.checking import check_motion
from sag.export.surface import Surface, surface_of
from sag.export.upright import Upright
from sag.film.colours import sample_colour
from sag.skeleton import Skeleton
from sag.viewer.body import links_of


@dataclass(frozen=True, eq=False)
class Stage:
    """Motions that run side by side; metres, camera frame of frame 0.

    Attributes:
        motions: samples of one window.
        skeleton: theirs.
        fps: frames a second.
        upright: which way is up, and where the floor is under the start.
        picture: colours of the start frame, where it is known.
        intrinsics: camera matrix in the pixels of the picture.
        surface: what the picture shows of the place, where its depth is known.
        measured: whether that depth is more than a guess, so that people can stand behind things.

    Raises:
        SagError: a motion is not finite, or not of the skeleton.
    """

    motions: Float[np.ndarray, "k t j 3"]
    skeleton: Skeleton
    fps: float
    upright: Upright
    picture: UInt8[np.ndarray, "h w 3"] | None = None
    intrinsics: Float[np.ndarray, "3 3"] | None = None
    surface: Surface | None = None
    measured: bool = True

    def __post_init__(self) -> None:
        for motion in self.motions:
            check_motion(motion, self.skeleton, self.fps)

    @property
    def frames(self) -> int:
        """Of each motion."""
        return self.motions.shape[1]

    @property
    def up(self) -> Float[np.ndarray, " 3"]:
        """Against gravity."""
        return self.upright.rotation[1]

    @property
    def roots(self) -> Float[np.ndarray, "k t 3"]:
        """Places of the root."""
        return self.motions[:, :, self.skeleton.root_index]

    def colour(self, number: int) -> Float[np.ndarray, " 3"]:
        """Of a sample."""
        return sample_colour(number)

    def capsules(self, joints: Float[np.ndarray, "j 3"]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Starts (m, 3), ends (m, 3) and radii (m, 2) of a body."""
        links = links_of(self.skeleton)
        starts, ends = joints[[link.start for link in links]], joints[[link.end for link in links]]
        return starts, ends, np.array([[link.start_radius, link.end_radius] for link in links])

    def on_floor(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """The points of the floor under these."""
        height = (points - self.upright.origin) @ self.up
        return points - height[..., None] * self.up


def stage_of(
    joints: Float[np.ndarray, "k t j 3"],
    skeleton: Skeleton,
    fps: float,
    upright: Upright,
    data: MotionDataModule | None = None,
    window: int = 0,
    with_surface: bool = True,
) -> Stage:
    """Motions with what their data set knows of the place.

    Args:
        joints: metres, camera frame of frame 0.
        skeleton: theirs.
        fps: frames a second.
        upright: which way is up, and where the floor is.
        data: where the window comes from, if that is known.
        window: its place in the data set.
        with_surface: whether the place is needed, and not the picture alone.
    """
    joints = joints.astype(np.float64)
    if data is None:
        return Stage(joints, skeleton, fps, upright)
    picture, intrinsics = data.picture_with_camera(window)
    surface = None
    if with_surface:
        with suppress(SagError):  # its depth is not known
            surface = surface_of(data, window, (picture, intrinsics))
    return Stage(joints, skeleton, fps, upright, picture, intrinsics, surface, data.recorded)
