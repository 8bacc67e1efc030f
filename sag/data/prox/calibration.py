"""The Kinect's two cameras, and where its colour camera stood in each scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from sag.data.prox.numbers import FARTHEST, array_of, check_rotation, read_json
from sag.errors import SagError

CENTRE = 0.5
"""The files put the centre of the first pixel at (0, 0), sag at (0.5, 0.5): see `sag.types`."""

ROUNDS = 20
"""Rounds in which the lens distortion is taken back; it changes by less than 1e-9 in the last of them."""

OFF_CENTRE = 0.2
"""How far a camera's axis may be from the middle of its pictures, in half widths or heights of them."""


@dataclass(frozen=True)
class Lens:
    """A camera of the Kinect, as its calibration file tells it; its pictures are meant unmirrored.

    Attributes:
        path: the file.
        intrinsics: camera matrix in continuous pixels, the first one's centre at (0.5, 0.5).
        distortion: k1, k2, p1, p2, k3 of OpenCV.
        turn: rotation from the calibration's frame to the camera's (x right, y down, z forward).
        shift: translation that follows it, metres.
    """

    path: Path
    intrinsics: Float[np.ndarray, "3 3"]
    distortion: Float[np.ndarray, " 5"]
    turn: Float[np.ndarray, "3 3"]
    shift: Float[np.ndarray, " 3"]

    @classmethod
    def read(cls, path: Path) -> Lens:
        """Reads `calibration/Color.json` or `calibration/IR.json`.

        Raises:
            SagError: the file is missing, damaged, or tells of no camera that can be.
        """
        content = read_json(path)
        if not isinstance(content, dict) or not {"camera_mtx", "k", "view_mtx"} <= set(content):
            raise SagError(f"{path} lacks one of camera_mtx, k and view_mtx; restore the original file")
        matrix = array_of(content["camera_mtx"], (3, 3), f"{path}: camera_mtx")
        if min(matrix[0, 0], matrix[1, 1]) <= 0 or list(matrix[2]) != [0, 0, 1]:
            raise SagError(f"{path}: camera_mtx has no positive focal lengths, or its last row is not 0 0 1")
        matrix[:2, 2] += CENTRE
        told = np.ravel(np.array(content["k"], dtype=object))
        distortion = array_of([*told, *[0.0] * (5 - len(told))], (5,), f"{path}: k")
        view = array_of(content["view_mtx"], (3, 4), f"{path}: view_mtx")
        check_rotation(view[:, :3], f"{path}: view_mtx")
        return cls(path, matrix, distortion, view[:, :3], view[:, 3])

    def from_calibration(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the calibration's frame in the camera's (metres)."""
        return points @ self.turn.T + self.shift

    def to_calibration(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the camera's frame in the calibration's (metres)."""
        return (points - self.shift) @ self.turn

    def rays(self, pixels: Float[np.ndarray, "*any 2"]) -> Float[np.ndarray, "*any 3"]:
        """Directions, 1 along the camera's axis, in which pixels look; the lens distortion is taken back."""
        k1, k2, p1, p2, k3 = self.distortion
        bent = (pixels - self.intrinsics[:2, 2]) / (self.intrinsics[0, 0], self.intrinsics[1, 1])
        straight = bent
        for _ in range(ROUNDS if self.distortion.any() else 0):
            x, y = straight[..., 0], straight[..., 1]
            square = x * x + y * y
            radial = 1 + square * (k1 + square * (k2 + square * k3))
            tangential = [2 * p1 * x * y + p2 * (square + 2 * x * x), p1 * (square + 2 * y * y) + 2 * p2 * x * y]
            straight = (bent - np.stack(tangential, axis=-1)) / radial[..., None]
        return np.concatenate([straight, np.ones_like(straight[..., :1])], axis=-1)

    def check_size(self, rows: int, columns: int, picture: Path) -> None:
        """Refuses a calibration of other pictures than these.

        Raises:
            SagError: the camera's axis is far from the middle of the pictures.
        """
        middle = np.array([columns, rows]) / 2
        if (np.abs(self.intrinsics[:2, 2] - middle) > OFF_CENTRE * middle).any():
            raise SagError(
                f"{self.path} is no calibration of pictures of {rows} x {columns} pixels, as {picture} is: "
                "its camera_mtx looks far beside their middle; use pictures and calibration of one size"
            )


@dataclass(frozen=True)
class Sensor:
    """The Kinect.

    Attributes:
        colour: its colour camera, in whose frame PROX's fits are.
        infrared: its depth camera.
    """

    colour: Lens
    infrared: Lens

    @classmethod
    def read(cls, root: Path) -> Sensor:
        """Reads a data set's calibration.

        Raises:
            SagError: a file is missing or damaged.
        """
        return cls(*(Lens.read(root / "calibration" / f"{name}.json") for name in ("Color", "IR")))

    def to_colour(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the depth camera's frame in the colour camera's (metres)."""
        return self.colour.from_calibration(self.infrared.to_calibration(points))


def read_world2cam(root: Path, scene: str) -> Float[np.ndarray, "4 4"]:
    """From a scene's scan to its colour camera: metres, column vectors, the scan's z up.

    Raises:
        SagError: `cam2world/<Scene>.json` is missing, damaged or no rotation with a translation.
    """
    path = root / "cam2world" / f"{scene}.json"
    cam2world = array_of(read_json(path), (4, 4), str(path))
    check_rotation(cam2world[:3, :3], str(path))
    if np.abs(cam2world[3] - [0, 0, 0, 1]).max() > 0:
        raise SagError(f"{path} must have 0 0 0 1 as its last row; restore the original file")
    if np.abs(cam2world[:3, 3]).max() > FARTHEST:
        raise SagError(f"{path} puts the camera more than {FARTHEST:g} m away; restore the original file")
    return np.linalg.inv(cam2world)
