"""One recording of PROX as it lies on disk."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from sag.data.prox.calibration import Sensor
from sag.data.prox.names import FrameName
from sag.errors import SagError
from sag.skeleton import PROX_16, Skeleton


@dataclass(frozen=True)
class Recording:
    """A recording: joints of all frames, and where their pictures are.

    Attributes:
        folder: its files.
        room: name of the scene.
        frames: those with a colour picture, in order.
        joints: of `prox_16`: metres, colour camera (x right, y down, z forward); not numbers where there is no body.
        world2cam: from the scene's scan (metres, z up) to the colour camera, column vectors.
        size: rows and columns of the colour pictures.
        sensor: the Kinect.
        scan: depth of the scene's mesh, which no person is in, metres; nothing where the depth is the sensor's.
    """

    folder: Path
    room: str
    frames: tuple[FrameName, ...]
    joints: Float[np.ndarray, "t 16 3"]
    world2cam: Float[np.ndarray, "4 4"]
    size: tuple[int, int]
    sensor: Sensor
    scan: Float[np.ndarray, "h w"] | None

    def __len__(self) -> int:
        return len(self.frames)

    @property
    def intrinsics(self) -> Float[np.ndarray, "3 3"]:
        """Camera matrix in continuous pixels of the unmirrored colour pictures."""
        return self.sensor.colour.intrinsics

    @cached_property
    def seconds(self) -> Float[np.ndarray, " t"]:
        """When each frame was recorded, since the recording began."""
        return np.array([frame.seconds for frame in self.frames])

    @cached_property
    def measured(self) -> Bool[np.ndarray, " t"]:
        """Which frames have a depth picture of the sensor."""
        there = stems(self.folder / "Depth", ".png")
        return np.array([frame.stem in there for frame in self.frames])

    def path(self, kind: str, frame: int, suffix: str) -> Path:
        """A file of a frame."""
        return self.folder / kind / f"{self.frames[frame].stem}{suffix}"


def joint_places(skeleton: Skeleton) -> list[int]:
    """Places of a skeleton's joints among those of `prox_16`.

    Raises:
        SagError: PROX lacks one of the joints.
    """
    if missing := sorted(set(skeleton.joints) - set(PROX_16.joints)):
        raise SagError(f"skeleton {skeleton.name} has joints that PROX lacks: {', '.join(missing)}; use prox_16")
    return PROX_16.index(*skeleton.joints)


def stems(folder: Path, suffix: str) -> frozenset[str]:
    """Names without their ending of the files in a folder that have this ending; none where the folder is missing."""
    if not folder.is_dir():
        return frozenset()
    return frozenset(path.stem for path in folder.iterdir() if path.suffix == suffix)
