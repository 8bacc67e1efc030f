"""Cameras of a recording: whether they can be, and where they cut and zoom."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from sag.data.pictures import PIXEL_LIMIT
from sag.data.recordings.cameras import WORLD, improper
from sag.errors import SagError

CUT_STEP = 1.0
"""A camera that moves farther than this in one frame (metres) cuts."""

CUT_TURN = 30.0
"""So does one that turns by more than this, degrees."""

ZOOM = 0.01
"""Least change of the focal length that is a zoom, as a share of it."""


@dataclass(frozen=True)
class Cut:
    """A camera that is elsewhere from one frame to the next.

    Attributes:
        frame: the last one before it.
        step: how far away the next camera is, metres.
        turn: how far it is turned, degrees.
        focal: focal lengths before and after, pixels.
    """

    frame: int
    step: float
    turn: float
    focal: tuple[float, float]


def camera_cuts(world2cam: Float[np.ndarray, "t 4 4"], intrinsics: Float[np.ndarray, "t 3 3"]) -> list[Cut]:
    """Where the camera cuts.

    Args:
        world2cam: for row vectors, metres.
        intrinsics: camera matrices, pixels.
    """
    axes = world2cam[:, :3, :3]
    places = -np.einsum("ti,tji->tj", world2cam[:, 3, :3], axes)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    cosines = (np.einsum("tij,tij->t", axes[:-1], axes[1:]) - 1) / 2
    turns = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    focal = intrinsics[:, 0, 0].tolist()
    found = np.flatnonzero((steps > CUT_STEP) | (turns > CUT_TURN)).tolist()
    return [Cut(f, float(steps[f]), float(turns[f]), (focal[f], focal[f + 1])) for f in found]


def camera_zooms(intrinsics: Float[np.ndarray, "t 3 3"], cuts: list[Cut]) -> list[tuple[int, int]]:
    """First and last frames of the stretches, between cuts, in which the focal length grows or shrinks by `ZOOM`."""
    focal = intrinsics[:, 0, 0]
    change = np.sign(np.diff(focal))
    change[[cut.frame for cut in cuts]] = 0
    edges = np.flatnonzero(np.diff(np.concatenate([[0], change, [0]])))
    stretches = zip(edges[:-1].tolist(), edges[1:].tolist())
    return [(a, b) for a, b in stretches if change[a] and abs(focal[b] / focal[a] - 1) >= ZOOM]


def check_places(joints: Float[np.ndarray, "t 21 3"], path: Path) -> None:
    """Refuses joints (metres) that cannot be.

    Raises:
        SagError: there is no frame, or a joint lies outside the world.
    """
    if not len(joints):
        raise SagError(f"{path} has no frames; restore the original file")
    outside = np.argwhere(np.isinf(joints) | (np.abs(joints) > WORLD))
    if len(outside):
        raise SagError(f"{path} has a joint more than {WORLD:g} metres from the origin in frame {outside[0, 0]}")


def check_cameras(world2cam: Float[np.ndarray, "t 4 4"], intrinsics: Float[np.ndarray, "t 3 3"], path: Path) -> None:
    """Refuses cameras that cannot be.

    Args:
        world2cam: for row vectors, metres.
        intrinsics: camera matrices, pixels.
        path: where they were told, for the error.

    Raises:
        SagError: a focal length is not positive, a rotation is none, or the pictures change their size.
    """
    focal, centre = intrinsics[:, [0, 1], [0, 1]], intrinsics[:, :2, 2]
    axes, rest = world2cam[:, :3, :3], world2cam[:, :, 3]
    faults = {
        "a focal length that is not positive": ~((focal > 0) & (focal < 1e6)).all(axis=1),
        "a camera matrix whose last row is not 0 0 1": (intrinsics[:, 2] != (0, 0, 1)).any(axis=1),
        "a picture of impossible size": (centre < 1).any(axis=1) | (4 * centre.prod(axis=1) > PIXEL_LIMIT),
        "a picture of another size than the first": (np.abs(centre - centre[0]) > 1e-3).any(axis=1),
        "a camera whose rotation is none": improper(axes.swapaxes(1, 2)),
        "a camera for column vectors, or none": (np.abs(rest - (0, 0, 0, 1)) > 1e-6).any(axis=1),
        f"a camera more than {WORLD:g} metres from the origin": (np.abs(world2cam[:, 3, :3]) > WORLD).any(axis=1),
    }
    for fault, frames in faults.items():
        if frames.any():
            raise SagError(f"{path} has {fault} in frame {int(frames.argmax())}; restore the original file")
