"""Where a person stands before a camera that is held level or looks down."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.errors import SagError

FACINGS = {"away": 0.0, "right": 90.0, "toward": 180.0, "left": 270.0}
"""Which way a person faces, as the camera sees it: degrees to the right of straight away from it."""

NEAREST, FARTHEST = 0.5, 30.0
"""Distances at which a person may stand, metres."""

STEEPEST = 80.0
"""Farthest that a camera may look down or up, degrees."""


@dataclass(frozen=True, eq=False)
class Place:
    """A person's place in a picture.

    Attributes:
        camera: camera matrix in the pixels of the picture.
        start: pixels of the root.
        distance: of the root from the camera along its axis, metres.
        pitch: degrees by which the camera looks down.
        facing: degrees to the right of straight away from the camera.

    Raises:
        SagError: a number is out of range.
    """

    camera: Float[np.ndarray, "3 3"]
    start: tuple[float, float]
    distance: float
    pitch: float = 0.0
    facing: float = 0.0

    def __post_init__(self) -> None:
        if not NEAREST <= self.distance <= FARTHEST:
            raise SagError(f"--distance is {self.distance:g}; a person can stand {NEAREST:g} to {FARTHEST:g} m away")
        if not abs(self.pitch) <= STEEPEST:
            raise SagError(
                f"--pitch is {self.pitch:g}; a camera can look down by {-STEEPEST:g} to {STEEPEST:g} degrees"
            )
        if not math.isfinite(self.facing):
            raise SagError(f"--facing is {self.facing:g}; give {', '.join(FACINGS)} or degrees")

    @property
    def root(self) -> Float[np.ndarray, " 3"]:
        """Where the root is, metres, camera frame."""
        x, y = (np.array(self.start) - self.camera[:2, 2]) / self.camera[[0, 1], [0, 1]]
        return self.distance * np.array([x, y, 1.0])

    @property
    def turn(self) -> Float[np.ndarray, "3 3"]:
        """The camera's right, down and forward in a world whose z is up and whose y is where the camera heads."""
        sine, cosine = math.sin(math.radians(self.pitch)), math.cos(math.radians(self.pitch))
        return np.array([[1.0, 0, 0], [0, -sine, -cosine], [0, cosine, -sine]])

    def standing(self, pose: Float[np.ndarray, "j 3"]) -> Float[np.ndarray, "j 3"]:
        """Joints of a person who stands upright here, metres, camera frame.

        Args:
            pose: from the root, metres, x forward, y to the left, z up.
        """
        sine, cosine = math.sin(math.radians(self.facing)), math.cos(math.radians(self.facing))
        forward, left, up = np.array([sine, cosine, 0]), np.array([-cosine, sine, 0]), np.array([0, 0, 1.0])
        return self.root + pose @ np.stack([forward, left, up]) @ self.turn.T

    def world2cam(self, root_height: float) -> Float[np.ndarray, "4 4"]:
        """Takes homogeneous world points to the camera frame; the world's origin is on the floor under the root.

        Args:
            root_height: of the root over the floor, metres.
        """
        matrix = np.eye(4)
        matrix[:3, :3] = self.turn
        matrix[:3, 3] = self.root - self.turn @ [0, 0, root_height]
        return matrix
