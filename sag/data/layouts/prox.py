"""Rooms as PROX lies on disk: mirrored pictures of a Kinect, its skeletons, scans of the rooms, calibration.

PROX's fits (`PROXD`) are parameters of SMPL-X, which nobody can make from joints without its licensed model: there are
none here, and the Kinect's skeletons move in their place.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Bool, Float, UInt8, UInt16
from PIL import Image

from sag.data.cache import PERSON
from sag.data.layouts.kinect import (
    FIELD,
    INFRARED_SIZE,
    calibration,
    colour_matrix,
    depth_camera,
    depth_matrix,
    skeleton,
)
from sag.data.layouts.script import Script, filmed
from sag.data.rooms.cameras import Camera
from sag.data.rooms.person import FRAME_RATE
from sag.data.rooms.render import Solids, View, render
from sag.data.rooms.surfaces import Surfaces
from sag.data.rooms.windows import Recording, Scenery

SCENES = (
    "MPH8", "MPH16", "MPH1Library", "N3OpenArea", "N0Sofa", "MPH11", "MPH112", "N3Office", "N3Library", "Werkraum",
    "N0SittingBooth", "BasementSittingBooth",
)  # fmt: skip
"""PROX's scenes: of the first four, two train and two test by default."""

SUBJECT = "00034"

FIRST_FRAME = 0.029
"""When the first frame is recorded, seconds since the recording began."""

STEPS_A_METRE, FARTHEST = 8000, 8.0
"""Of the stored depth, and how far (metres) the Kinect measures."""

NOBODY = 255
"""Value of the masks where no person is; the first person is 0."""


def write_room(folder: Path, script: Script, number: int) -> None:
    """Films a room with a Kinect that stands still, and writes its recordings, its scan and its camera.

    Args:
        folder: of the data set.
        script: what is filmed.
        number: of the room, from 0.
    """
    scene, name = filmed(script, number, FIELD), SCENES[number]
    for take, recording in enumerate(scene.recordings):
        write_recording(
            folder / "recordings" / f"{name}_{SUBJECT}_{take + 1:02d}", recording, scene.scenery, script, number + 1
        )
    cam2world = np.linalg.inv(scene.recordings[0].camera.world2cam)
    write_json(folder / "cam2world" / f"{name}.json", cam2world.tolist())
    write_scan(folder / "scenes" / f"{name}.ply", scene.scenery.solids.surfaces)
    if number == 0:
        for camera, content in calibration(script.size).items():
            write_json(folder / "calibration" / f"{camera}.json", content)


def write_json(path: Path, content: object) -> None:
    """Writes a file into a folder that is made when it is missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content))


def write_scan(path: Path, surfaces: Surfaces) -> None:
    """Writes a room as a mesh whose corners have colours (metres, z up)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    corners = surfaces.triangles.reshape(-1, 3)
    colours = surfaces.palette.colour[surfaces.part.repeat(3)]
    faces = np.arange(len(corners)).reshape(-1, 3)
    shown = np.rint(255 * colours.clip(0, 1)).astype(np.uint8)
    trimesh.Trimesh(corners, faces, vertex_colors=shown, process=False).export(path)


def write_recording(folder: Path, recording: Recording, scenery: Scenery, script: Script, scene: int) -> None:
    """Writes a recording's folder: every frame has every kind of file.

    Args:
        folder: does not exist.
        recording: what is written.
        scenery: where it took place.
        script: size of the colour pictures.
        scene: number of the scene in the frames' names.
    """
    for kind in ("Color", "Depth", "BodyIndex", "BodyIndexColor", "Infrared", "Skeleton"):
        (folder / kind).mkdir(parents=True)
    infrared, matrix = depth_camera(recording.camera), colour_matrix(script.size)
    seen = DepthView(infrared, scenery.solids)
    for frame, joints in enumerate(recording.joints):
        stand, stem = scenery.with_person(recording, frame), frame_name(scene, frame)
        picture = render(stand, recording.camera, matrix, script.size)
        depth, person = seen.with_person(stand.person)
        Image.fromarray(mirrored(picture.image)).save(folder / "Color" / f"{stem}.jpg", quality=95)
        for kind, values in {
            "Depth": stored_depth(depth),
            "BodyIndex": mask(person),
            "BodyIndexColor": mask(picture.ids == PERSON),
            "Infrared": brightness(depth),
        }.items():
            Image.fromarray(mirrored(values)).save(folder / kind / f"{stem}.png", compress_level=3)
        write_json(folder / "Skeleton" / f"{stem}.json", skeleton(joints, infrared))


class DepthView:
    """The depth camera before a room: what does not move is met by rays once.

    Args:
        camera: the depth camera.
        room: everything that does not move.
    """

    def __init__(self, camera: Camera, room: Solids) -> None:
        self._view = View(camera, depth_matrix(), INFRARED_SIZE)
        self._room = room.rays.distance(self._view.eye, self._view.directions)

    def with_person(self, person: Solids) -> tuple[Float[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]:
        """Planar depth (metres) with a person in the room, and where the person is."""
        near = self._view.around(person.surfaces.triangles)
        before = person.rays.distance(self._view.eye, self._view.directions[near])
        depth = self._room.copy()
        depth[near] = np.minimum(depth[near], before)
        return depth.reshape(INFRARED_SIZE), (depth < self._room).reshape(INFRARED_SIZE)


def frame_name(scene: int, frame: int) -> str:
    """Name of a frame's files: numbers count from 1, and tell hours, minutes, seconds and thousandths."""
    thousandths = round(1000 * (FIRST_FRAME + frame / FRAME_RATE))
    minutes, rest = divmod(thousandths, 60_000)
    clock = f"{minutes // 60:02d}.{minutes % 60:02d}.{rest // 1000:02d}.{rest % 1000:03d}"
    return f"s{scene:03d}_frame_{frame + 1:05d}__{clock}"


def mirrored(picture: np.ndarray) -> np.ndarray:
    """A picture as PROX stores all of them: right and left are swapped."""
    return np.ascontiguousarray(picture[:, ::-1])


def stored_depth(depth: Float[np.ndarray, "h w"]) -> UInt16[np.ndarray, "h w"]:
    """Depth (metres) as the Kinect stores it; 0 where it measures nothing."""
    # The Kinect tells whole millimetres.
    steps = np.rint(1000 * np.where(depth < FARTHEST, depth, 0)) * (STEPS_A_METRE // 1000)
    return steps.astype(np.uint16)


def mask(person: Bool[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w"]:
    """Where the person is: 0 there, `NOBODY` elsewhere."""
    return np.where(person, 0, NOBODY).astype(np.uint8)


def brightness(depth: Float[np.ndarray, "h w"]) -> UInt16[np.ndarray, "h w"]:
    """What the infrared camera sees by its own light, which fades with the square of the distance (metres)."""
    # In steps of 256, which pack small.
    return (np.rint(200 / np.maximum(depth, 1) ** 2) * 256).astype(np.uint16)
