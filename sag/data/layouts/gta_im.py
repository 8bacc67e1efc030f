"""Rooms as GTA-IM lies on disk: a folder for each recording, pictures that pack 24 bits, numbers in archives."""

from __future__ import annotations

import pickle
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, UInt8, UInt16
from PIL import Image

from sag.data.cache import DEPTH_UNIT
from sag.data.gta_im.recording import JOINTS
from sag.data.layouts.bones import CLAVICLE, FAR, NEAR, told_frames
from sag.data.layouts.script import Script, filmed
from sag.data.rooms.render import Picture, render
from sag.data.rooms.windows import Recording, Scenery
from sag.skeleton import GTA_IM_19

ROOMS = (1, 13, 10, 11, 2, 3, 6)
"""Numbers that GTA-IM's 30 fps recordings give their rooms: here the first two already train and test."""

FOLDER = "FPS-30"

CORNER = np.array([-1387.3, 512.8, 40.2])
"""Origin of the first room in the game's world, metres; the others lie along x."""

APART = 25.0
"""From one room's origin to the next one's, metres."""

FIRST = datetime(2020, 6, 1, 10)
"""When the first recording was made: recordings are named by their time."""


def write_room(folder: Path, script: Script, number: int) -> None:
    """Films a room and writes its recordings.

    Args:
        folder: of the data set.
        script: what is filmed.
        number: of the room, from 0.
    """
    scene = filmed(script, number)
    for take, recording in enumerate(scene.recordings):
        time = FIRST + timedelta(hours=number, minutes=7 * take)
        write_recording(
            folder / FOLDER / f"{time:%Y-%m-%d-%H-%M-%S}", recording, scene.scenery, script, ROOMS[number], number
        )


def write_recording(
    folder: Path, recording: Recording, scenery: Scenery, script: Script, room: int, place: int
) -> None:
    """Writes a recording's folder.

    Args:
        folder: does not exist.
        recording: what is written.
        scenery: where it took place.
        script: which frames have pictures, and of what size.
        room: GTA-IM's number of the room.
        place: of the room in the world.
    """
    folder.mkdir(parents=True)
    origin = CORNER + [APART * place, 0, 0]
    joints = with_clavicles(recording.joints) + origin
    arrays = camera_arrays(recording, joints, origin, script.size)
    np.savez(folder / "info_frames.npz", **arrays)  # type: ignore[arg-type]
    frames = told_frames(joints, recording.camera, origin)
    # The second is a plain pickle in spite of its name.
    (folder / "info_frames.pickle").write_bytes(pickle.dumps(frames))
    (folder / "realtimeinfo.gz").write_bytes(pickle.dumps({"frames": frames, "setting": {"room": room}}))
    matrix = recording.camera.intrinsics(script.size)
    for frame in range(0, len(joints), script.every):
        stand = scenery.with_person(recording, frame)
        write_picture(folder, frame, render(stand, recording.camera, matrix, script.size))


def with_clavicles(joints: Float[np.ndarray, "t 19 3"]) -> Float[np.ndarray, "t 21 3"]:
    """The 21 joints of GTA-IM's files: clavicles lie on the way from the neck to the shoulders."""
    named = dict(zip(GTA_IM_19.joints, joints.transpose(1, 0, 2)))
    for side in ("right", "left"):
        named[f"{side}_clavicle"] = named["neck"] + CLAVICLE * (named[f"{side}_shoulder"] - named["neck"])
    return np.stack([named[name] for name in JOINTS], axis=1)


def camera_arrays(
    recording: Recording, joints: Float[np.ndarray, "t 21 3"], origin: Float[np.ndarray, " 3"], size: tuple[int, int]
) -> dict[str, np.ndarray]:
    """The content of `info_frames.npz`: joints (metres, and pixels of the native picture) and cameras.

    Args:
        recording: gives the camera.
        joints: metres, the game's world frame.
        origin: of the room in that frame, metres.
        size: rows and columns of the native picture.
    """
    # For row vectors: [x, 1] @ world2cam is in the camera frame.
    world2cam = np.eye(4)
    world2cam[:3, :3] = recording.camera.turn.T
    world2cam[3, :3] = -(recording.camera.place + origin) @ recording.camera.turn.T
    local = joints @ world2cam[:3, :3] + world2cam[3, :3]
    matrix = recording.camera.intrinsics(size)
    projected = local @ matrix.T
    return {
        "joints_2d": projected[..., :2] / projected[..., 2:],
        "joints_3d_cam": local,
        "joints_3d_world": joints,
        "world2cam_trans": np.tile(world2cam, (len(joints), 1, 1)),
        "intrinsics": np.tile(matrix, (len(joints), 1, 1)),
    }


def write_picture(folder: Path, frame: int, picture: Picture) -> None:
    """Writes colour, depth and ids of a frame."""
    Image.fromarray(picture.image).save(folder / f"{frame:05d}.jpg", quality=95)
    for name, values in (("", inverse_depth(picture.depth)), ("_id", spread_ids(picture.ids))):
        Image.fromarray(packed(values)).save(folder / f"{frame:05d}{name}.png", compress_level=3)


def inverse_depth(depth: UInt16[np.ndarray, "h w"]) -> Int[np.ndarray, "h w"]:
    """The 24-bit numbers that GTA-IM stores of a depth map in steps of `DEPTH_UNIT`; 0 where it is not known."""
    metres = np.maximum(depth, 1) * DEPTH_UNIT
    share = NEAR * (FAR / metres - 1) / (FAR - NEAR)
    codes = np.rint(50 / np.maximum(share, 50 / 0xFFFFFF)).astype(np.int64)
    return np.where(depth > 0, codes, 0)


def spread_ids(ids: UInt8[np.ndarray, "h w"]) -> Int[np.ndarray, "h w"]:
    """24-bit numbers of instances: red tells apart what blue does not; 0, the background, stays."""
    wide = ids.astype(np.int64)
    return np.where(wide > 0, (wide // 16 + 1) << 16 | 7 << 8 | wide % 16, 0)


def packed(values: Int[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w 3"]:
    """24-bit numbers as colours: red is the highest byte."""
    return np.stack([values >> 16, values >> 8 & 255, values & 255], axis=-1).astype(np.uint8)
