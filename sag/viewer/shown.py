"""What a page shows: windows with their scene, and motions in rows beside the true one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from sag.errors import SagError

MOST_MOTIONS = 9
"""Motions that a row may have: each has a digit and a colour of its own."""

FARTHEST_JOINT = 1000.0
"""Metres from the camera beyond which a joint is no joint."""


@dataclass(frozen=True, eq=False)
class ShownMotion:
    """One motion.

    Attributes:
        joints: any number of frames, metres, camera frame of frame 0.
        figures: by the key of their column, see `sag.viewer.figures.COLUMNS`; what is missing or no number is left
            empty.
        touched: points of the scene inside a bone at each frame, where that is known.
    """

    joints: Float[np.ndarray, "t j 3"]
    figures: Mapping[str, float] = field(default_factory=dict)
    touched: Int[np.ndarray, " frames"] | None = None


@dataclass(frozen=True, eq=False)
class ShownRow:
    """Motions that belong together, such as the samples of one run.

    Attributes:
        name: of the run or file.
        motions: at most `MOST_MOTIONS`.
    """

    name: str
    motions: tuple[ShownMotion, ...]


@dataclass(frozen=True, eq=False)
class ShownScene:
    """The surfaces that the start frame's depth shows.

    Attributes:
        depth: planar z, metres, 0 where it is not known or where the person stands.
        intrinsics: camera matrix in the pixels of the depth.
        hidden: where the person stands, to be filled by a guess that the page marks as one.
    """

    depth: Float[np.ndarray, "h w"]
    intrinsics: Float[np.ndarray, "3 3"]
    hidden: Bool[np.ndarray, "h w"]


@dataclass(frozen=True, eq=False)
class ShownWindow:
    """A window: what was given, and what was made of it.

    Attributes:
        name: that tells it from others.
        picture: colours of the start frame.
        intrinsics: camera matrix in the pixels of the picture.
        person: where the person stands, on any grid over the picture.
        rows: motions of each run.
        truth: the recorded motion, where there is one.
        scene: surfaces, where there is depth.
        up: direction against gravity, camera frame.
        floor: level of the floor under the start, metres along `up` from the camera.
        guessed: whether the depth is a guess made from the picture, and was not measured.
    """

    name: str
    picture: UInt8[np.ndarray, "h w 3"]
    intrinsics: Float[np.ndarray, "3 3"]
    person: Bool[np.ndarray, "r c"]
    rows: tuple[ShownRow, ...]
    truth: ShownMotion | None = None
    scene: ShownScene | None = None
    up: tuple[float, float, float] = (0.0, -1.0, 0.0)
    floor: float = -1.5
    guessed: bool = False

    @property
    def motions(self) -> list[tuple[str, ShownMotion]]:
        """All motions, the recorded one too, with what a sentence calls them."""
        numbered = [(row.name, number, motion) for row in self.rows for number, motion in enumerate(row.motions, 1)]
        named = [(f"motion {number} of {name}", motion) for name, number, motion in numbered]
        return named + ([] if self.truth is None else [("the recorded motion", self.truth)])


def check_windows(windows: list[ShownWindow], joints: int) -> None:
    """Refuses what cannot be shown.

    Args:
        windows: of one page.
        joints: that every motion must have.

    Raises:
        SagError: there is nothing to show, rows differ between windows or share a name, or a motion has other joints,
            no frames, other frames than its neighbours, or coordinates that are not finite.
    """
    if not windows or not windows[0].rows:
        raise SagError("a page needs at least one window with at least one row of motions")
    names = [row.name for row in windows[0].rows]
    for window in windows:
        if [row.name for row in window.rows] != names or len(set(names)) < len(names):
            raise SagError(f"{window.name}: its rows must be those of {windows[0].name}, each with a name of its own")
        for row in window.rows:
            if not 1 <= len(row.motions) <= MOST_MOTIONS:
                found = len(row.motions)
                raise SagError(f"{row.name} has {found} motions in {window.name}; a page shows 1 to {MOST_MOTIONS}")
        frames = len(window.motions[0][1].joints)
        for name, motion in window.motions:
            _check_motion(f"{name} in {window.name}", motion, frames, joints)


def _check_motion(name: str, motion: ShownMotion, frames: int, joints: int) -> None:
    shape = motion.joints.shape
    if shape[0] < 1 or shape[1] != joints:
        raise SagError(f"{name} has {shape[0]} frames of {shape[1]} joints; a page needs frames of {joints} joints")
    if shape[0] != frames or (motion.touched is not None and len(motion.touched) != frames):
        raise SagError(f"{name} has not the {frames} frames of the first motion; motions of a window run side by side")
    if not np.isfinite(motion.joints).all() or np.abs(motion.joints).max() > FARTHEST_JOINT:
        raise SagError(f"{name} has joints that are not finite, or over {FARTHEST_JOINT:g} m away; leave it out")
