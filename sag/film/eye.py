"""Where a picture is drawn from: a pinhole camera anywhere in the camera frame of frame 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from sag.data.rays import pixel_rays
from sag.geometry.kinematics import unit


@dataclass(frozen=True, eq=False)
class Eye:
    """A camera.

    Attributes:
        intrinsics: camera matrix in the pixels of what is drawn.
        size: rows and columns.
        turn: its right, down and forward in the camera frame of frame 0.
        place: metres, camera frame of frame 0.
    """

    intrinsics: Float[np.ndarray, "3 3"]
    size: tuple[int, int]
    turn: Float[np.ndarray, "3 3"]
    place: Float[np.ndarray, " 3"]

    @classmethod
    def of_picture(cls, intrinsics: Float[np.ndarray, "3 3"], size: tuple[int, int]) -> Eye:
        """The camera that took the picture."""
        return cls(intrinsics, size, np.eye(3), np.zeros(3))

    @classmethod
    def looking_at(
        cls,
        target: Float[np.ndarray, " 3"],
        place: Float[np.ndarray, " 3"],
        up: Float[np.ndarray, " 3"],
        size: tuple[int, int],
        height: float,
    ) -> Eye:
        """A level camera.

        Args:
            target: what is in the middle, metres.
            place: of the eye, metres; not straight above or below the target.
            up: against gravity.
            size: rows and columns.
            height: angle from the lowest row to the highest, radians.
        """
        forward = unit(target - place)
        right = unit(np.cross(forward, up))
        focal = size[0] / 2 / np.tan(height / 2)
        intrinsics = np.array([[focal, 0, size[1] / 2], [0, focal, size[0] / 2], [0, 0, 1.0]])
        return cls(intrinsics, size, np.stack([right, np.cross(forward, right), forward]), place)

    def scaled(self, factor: float) -> Eye:
        """The same view in so many times as many rows and columns."""
        size = (round(self.size[0] * factor), round(self.size[1] * factor))
        scale = np.array([[size[1] / self.size[1]], [size[0] / self.size[0]], [1.0]])
        return Eye(self.intrinsics * scale, size, self.turn, self.place)

    def seen(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the camera frame of frame 0 in this camera's own frame, metres."""
        return (points - self.place) @ self.turn.T

    @cached_property
    def rays(self) -> Float[np.ndarray, "h w 3"]:
        """Directions through the centres of pixels in its own frame, 1 along its axis."""
        rows, columns = self.size
        return pixel_rays(self.intrinsics, (0, rows), (0, columns)).reshape(rows, columns, 3)
