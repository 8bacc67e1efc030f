"""Windows of a recording: which are kept, and what is stored of each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from sag.data.cache import SPLITS
from sag.data.rooms.cameras import FARTHEST, NEAREST, Camera
from sag.data.rooms.figure import Outfit, figure
from sag.data.rooms.recipe import CLOUD_SIZE, STRIDE
from sag.data.rooms.render import Picture, Solids, Stand, cloud_depth, render
from sag.skeleton import GTA_IM_19
from sag.types import FRAMES

ROOT = GTA_IM_19.root_index

BODY_IN_VIEW = 15
"""Joints that must lie in the picture when a window starts."""

BODY_VISIBLE = 0.7
"""Share of the joints in the picture that nothing may hide when a window starts."""

MARGIN = 0.03
"""How far inside the picture the root stays, in widths or heights of it."""

Row = dict[str, np.ndarray]
"""One window's values for the cache's arrays."""


@dataclass(frozen=True)
class Recording:
    """A person's motion in front of a camera.

    Attributes:
        number: among all recordings.
        room: number of the room.
        split: name of the split.
        camera: does not move.
        joints: metres, world frame.
        contact: frames in which the person is meant to touch furniture.
        outfit: the person's looks.
        scale: the person's size.
    """

    number: int
    room: int
    split: str
    camera: Camera
    joints: Float[np.ndarray, "t 19 3"]
    contact: Bool[np.ndarray, " t"]
    outfit: Outfit
    scale: float

    def intrinsics(self, start: int, size: tuple[int, int]) -> Float[np.ndarray, "3 3"]:
        """Camera matrix of a picture of this many rows and columns with the root of a frame at its centre."""
        # In the stored precision, so that the stored root projects to the centre.
        root = self.camera.to_camera(self.joints[start, ROOT]).astype(np.float32).astype(float)
        return self.camera.intrinsics(size, root)


@dataclass(frozen=True)
class Scenery:
    """A room made ready to be filmed.

    Attributes:
        solids: everything in it that does not move.
        light: place of the lamp, metres, world frame.
    """

    solids: Solids
    light: Float[np.ndarray, " 3"]

    def with_person(self, recording: Recording, frame: int) -> Stand:
        """The room with the person of a recording in it."""
        person = figure(recording.joints[frame], recording.outfit, recording.scale)
        return Stand(self.solids, Solids.of(person), self.light)


def windows(recording: Recording, scenery: Scenery, size: tuple[int, int], dropped: Counter[str]) -> Iterator[Row]:
    """The rows of a recording's windows, one every eight frames.

    Args:
        recording: what is cut.
        scenery: where it took place.
        size: rows and columns of the pictures.
        dropped: windows left out, counted here by reason.
    """
    for start in usable_starts(recording, scenery, dropped):
        yield stored_window(recording, scenery, start, size)


def usable_starts(recording: Recording, scenery: Scenery, dropped: Counter[str], stride: int = STRIDE) -> Iterator[int]:
    """Frames at which windows start that can be used, of one every `stride`; the others are counted by reason."""
    local = recording.camera.to_camera(recording.joints)
    for start in range(0, len(local) - FRAMES + 1, stride):
        reason = _fault(local[start : start + FRAMES], recording, start, scenery)
        if reason:
            dropped[reason] += 1
        else:
            yield start


def _fault(joints: Float[np.ndarray, "65 19 3"], recording: Recording, start: int, scenery: Scenery) -> str:
    """Why a window (metres, camera frame) cannot be used; empty if it can."""
    camera = recording.camera
    first, roots = joints[0], joints[:, ROOT]
    if not NEAREST < first[ROOT, 2] < FARTHEST or not camera.sees(recording.joints[start, ROOT]):
        return "start root out of view"
    if roots[:, 2].min() < 0.6:
        return "root behind the camera"
    if not _inside(roots, first[ROOT], camera, MARGIN).all():
        return "root leaves the picture"
    shown = _inside(first, first[ROOT], camera)
    if shown.sum() < BODY_IN_VIEW:
        return "body out of view"
    hidden = scenery.solids.rays.hidden(recording.joints[start], camera.place)
    if hidden[ROOT] or (~hidden & shown).sum() < BODY_VISIBLE * shown.sum():
        return "body hidden at the start"
    return ""


def _inside(
    points: Float[np.ndarray, "n 3"], centre: Float[np.ndarray, " 3"], camera: Camera, margin: float = 0.0
) -> Bool[np.ndarray, " n"]:
    """Which points (camera frame) a picture around `centre` shows."""
    matrix = camera.intrinsics(CLOUD_SIZE, centre)
    pixels = points @ matrix.T
    share = pixels[:, :2] / np.maximum(pixels[:, 2:], 1e-6) / np.array(CLOUD_SIZE[::-1])
    return (points[:, 2] > 0.1) & ((share > margin) & (share < 1 - margin)).all(axis=1)


def stored_window(recording: Recording, scenery: Scenery, start: int, size: tuple[int, int]) -> Row:
    """The window that begins at a frame, as the cache keeps it; test windows with their cloud."""
    camera = recording.camera
    joints = camera.to_camera(recording.joints[start : start + FRAMES]).astype(np.float32)
    stand = scenery.with_person(recording, start)
    intrinsics = recording.intrinsics(start, size)
    row = {
        "joints": joints,
        **render(stand, camera, intrinsics, size)._asdict(),
        "intrinsics": intrinsics.astype(np.float32),
        "world2cam": camera.world2cam,
        "split": np.uint8(SPLITS.index(recording.split)),
        "scene": np.int32(recording.room),
        "sequence": np.int32(recording.number),
        "start": np.int32(start),
        "contact": recording.contact[start : start + FRAMES],
    }
    if recording.split == "test":
        wide = recording.intrinsics(start, CLOUD_SIZE)
        row["cloud_depth"] = cloud_depth(stand, camera, wide, CLOUD_SIZE)
        row["cloud_intrinsics"] = wide.astype(np.float32)
    return row


def picture_of(recording: Recording, scenery: Scenery, start: int, size: tuple[int, int]) -> Picture:
    """The picture of a frame, of `size` rows and columns, the root at its centre."""
    intrinsics = recording.intrinsics(start, size)
    return render(scenery.with_person(recording, start), recording.camera, intrinsics, size)
