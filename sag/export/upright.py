"""From the camera frame of a window to the axes that animation programs stand people up in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.geometry.kinematics import unit
from sag.skeleton import Skeleton

CAMERA_UP = np.array([0.0, -1, 0])
"""Up, where all that is known of the camera is that it was held level."""

STEEPEST = 1e-6
"""A camera whose axis is nearer to the plumb line (sine) has no heading; what is right in its picture stays right."""


@dataclass(frozen=True, eq=False)
class Upright:
    """A frame with Y up, seen along -Z by the camera, with the origin on the floor under the person's start.

    Attributes:
        rotation: turns directions of the camera frame (x right, y down, z forward) into this frame.
        origin: metres, camera frame.
    """

    rotation: Float[np.ndarray, "3 3"]
    origin: Float[np.ndarray, 3]

    @classmethod
    def at(
        cls,
        start: Float[np.ndarray, "j 3"],
        skeleton: Skeleton,
        up: Float[np.ndarray, 3] = CAMERA_UP,
        ankle_height: float = 0.085,
    ) -> Upright:
        """The frame in which a person begins.

        Args:
            start: joints of frame 0, metres, camera frame; every sample of a window has the same.
            skeleton: whose joints they are.
            up: direction against gravity in the camera frame.
            ankle_height: of a standing person over the floor, metres; the lower ankle is taken to stand.
        """
        up = unit(up)
        right = np.cross(-up, np.array([0.0, 0, 1]))
        if np.linalg.norm(right) < STEEPEST:
            right = np.cross(np.cross(up, np.array([1.0, 0, 0])), up)
        right = unit(right)
        rotation = np.stack([right, up, np.cross(right, up)])
        root = start[skeleton.root_index].astype(np.float64)
        floor = float((start[skeleton.feet] @ up).min()) - ankle_height
        return cls(rotation, root + (floor - root @ up) * up)

    def from_camera(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the camera frame in this one, metres."""
        return (points - self.origin) @ self.rotation.T

    def to_camera(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of this frame in the camera's, metres."""
        return points @ self.rotation + self.origin


def up_of(world2cam: Float[np.ndarray, "4 4"]) -> Float[np.ndarray, 3]:
    """Against gravity in the camera frame, from the camera's place in a world whose z is up."""
    return np.asarray(world2cam[:3, 2], dtype=np.float64)


def estimated_up(joints: Float[np.ndarray, "t j 3"], skeleton: Skeleton) -> Float[np.ndarray, 3]:
    """Against gravity, guessed from a person who stands or walks: on average from between the ankles to the root.

    Args:
        joints: metres, camera frame.
        skeleton: whose joints they are.
    """
    way = joints[:, skeleton.root_index] - joints[:, skeleton.feet].mean(axis=1)
    return unit(way.astype(np.float64).mean(axis=0))
