"""A folder in PROX's layout and how it is read."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from sag.data.paths import contained
from sag.data.pictures import picture_size
from sag.data.prox.calibration import Sensor, read_world2cam
from sag.data.prox.fits import Bodies
from sag.data.prox.kinect import read_skeleton
from sag.data.prox.names import FrameName, RecordingName, in_order
from sag.data.prox.numbers import FARTHEST
from sag.data.prox.recording import Recording, stems
from sag.data.prox.scan import scan_depth
from sag.errors import SagError
from sag.skeleton import PROX_16

DepthSource = Literal["scan", "sensor"]
"""Where depth comes from: the scene's scan, drawn through the colour camera, or the Kinect's own, aligned to it."""

BESIDE = ("calibration", "cam2world", "scenes", "PROXD")
"""What lies beside the recordings."""

MODELS = ("SMPLX_MALE.", "SMPLX_FEMALE.")
"""How the names of SMPL-X's models begin."""

HOW_TO_GET = (
    "PROX (non-commercial) is downloaded after registration at https://prox.is.tue.mpg.de; "
    "set its folder by --data.init_args.root"
)


class Root:
    """A folder with `recordings`, `PROXD`, `scenes`, `cam2world` and `calibration`.

    Args:
        path: the folder.
        bodies: SMPL-X models that turn PROXD's fits into joints; without them the Kinect's skeletons move.
        depth: where depth comes from.
    """

    def __init__(self, path: Path, bodies: Bodies | None, depth: DepthSource) -> None:
        self.path = path
        self.bodies = bodies
        self.depth = depth
        self._scans: dict[tuple[str, tuple[int, int]], np.ndarray] = {}
        self._joints: dict[Path, np.ndarray] = {}

    @cached_property
    def recordings(self) -> tuple[Path, ...]:
        """Folders of recordings, in order of their names.

        Raises:
            SagError: there is none, or what they need beside them is missing or a link that leads elsewhere.
        """
        for name in BESIDE:
            contained(self.path / name, self.path)
        found = sorted(path.parent for path in self.path.glob("recordings/*/Color") if path.is_dir())
        if not found:
            raise SagError(
                f"{self.path} is no PROX folder: expected {self.path / 'recordings'} with a folder for each recording, "
                f"Color inside; {HOW_TO_GET}"
            )
        if self.bodies and not (self.path / "PROXD").is_dir():
            raise SagError(
                f"{self.path / 'PROXD'} is missing: download PROXD's fits, or leave out --data.init_args.smplx_models "
                "to move by the Kinect's skeletons"
            )
        return tuple(found)

    @cached_property
    def rooms(self) -> tuple[str, ...]:
        """Names of the scenes; a scene's number is its place here."""
        return tuple(sorted({path.name.split("_")[0] for path in self.recordings}))

    @cached_property
    def sensor(self) -> Sensor:
        """The calibration of the Kinect."""
        return Sensor.read(self.path)

    def read(self, folder: Path) -> Recording:
        """A recording, but for its pictures; joints and scans are read once.

        Raises:
            SagError: a file is missing, damaged or of another layout.
        """
        name = RecordingName.of(folder.name)
        for path in (folder, *folder.iterdir()):
            contained(path, self.path)
        pictures = folder / "Color"
        frames = in_order([FrameName.of(stem, str(pictures)) for stem in stems(pictures, ".jpg")], str(pictures))
        if not frames:
            raise SagError(f"{pictures} holds no .jpg; restore the recording, or move its folder elsewhere")
        first = pictures / f"{frames[0].stem}.jpg"
        size = picture_size(first)
        self.sensor.colour.check_size(*size, first)
        if folder not in self._joints:
            self._joints[folder] = self._moved(folder, name, [frame.stem for frame in frames])
        world2cam = read_world2cam(self.path, name.scene)
        scan = self._scan(name.scene, world2cam, size) if self.depth == "scan" else None
        return Recording(folder, name.scene, frames, self._joints[folder], world2cam, size, self.sensor, scan)

    def _scan(self, scene: str, world2cam: Float[np.ndarray, "4 4"], size: tuple[int, int]) -> np.ndarray:
        """Depth of a scene's scan; its camera does not move, so it is drawn once for all recordings."""
        key = scene, size
        if key not in self._scans:
            path = self.path / "scenes" / f"{scene}.ply"
            if not path.is_file():
                raise SagError(f"{path} is missing: download the scans, or set --data.init_args.depth sensor")
            self._scans[key] = scan_depth(path, world2cam, self.sensor.colour.intrinsics, size)
        return self._scans[key]

    def _moved(self, folder: Path, name: RecordingName, frames: list[str]) -> Float[np.ndarray, "t 16 3"]:
        """Joints of every frame (metres, colour camera), not numbers where there is no body."""
        joints = np.full((len(frames), len(PROX_16.joints), 3), np.nan)
        files = self.bodies_of(folder, frames)
        places = [place for place, frame in enumerate(frames) if frame in files]
        paths = [contained(files[frames[place]], self.path) for place in places]
        if self.bodies:
            joints[places] = self.bodies.joints(paths, name.is_of(self.bodies.female_subjects))
        elif paths:
            joints[places] = self.sensor.to_colour(np.stack([read_skeleton(path) for path in paths]))
        for place, path in zip(places, paths):
            if (np.abs(joints[place]) > FARTHEST).any():
                raise SagError(f"{path} has joints more than {FARTHEST:g} m away; restore the original file")
        return joints

    def bodies_of(self, folder: Path, frames: list[str]) -> dict[str, Path]:
        """The file that tells the body of each frame, where there is one."""
        if self.bodies:
            fits = {frame: self.path / "PROXD" / folder.name / "results" / frame / "000.pkl" for frame in frames}
            return {frame: path for frame, path in fits.items() if path.is_file()}
        there = stems(folder / "Skeleton", ".json")
        return {frame: folder / "Skeleton" / f"{frame}.json" for frame in frames if frame in there}

    def digest(self) -> str:
        """Checksum of the names, sizes and times of all files that are read, models beside the folder included."""
        digest = hashlib.sha256()
        for path in self._files():
            found = path.stat()
            inside = path.is_relative_to(self.path)
            name = str(path.relative_to(self.path)) if inside else path.name
            digest.update(repr((name, found.st_size, found.st_mtime_ns)).encode())
        return digest.hexdigest()

    def _files(self) -> Iterator[Path]:
        """Every file that is read, in order."""
        for name in BESIDE[: 3 if self.depth == "scan" else 2]:
            yield from _inside(self.path / name)
        for folder in self.recordings:
            for kind in ("Color", "BodyIndexColor", "BodyIndex", "Depth"):
                yield from _inside(folder / kind)
            yield from self.bodies_of(folder, sorted(stems(folder / "Color", ".jpg"))).values()
        if self.bodies:
            for place in (self.bodies.folder, self.bodies.folder / "smplx"):
                yield from (path for path in _inside(place) if path.name.startswith(MODELS))


def _inside(folder: Path) -> list[Path]:
    """Files in a folder, in order; none where it is missing."""
    if not folder.is_dir():
        return []
    with os.scandir(folder) as entries:
        return sorted(Path(entry.path) for entry in entries if entry.is_file())
