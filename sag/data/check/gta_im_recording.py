"""What is found in one recording of GTA-IM."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.ndimage import binary_dilation

from sag.data.archives import names_in, read_archive
from sag.data.check.bodies import bones_of
from sag.data.check.findings import Findings
from sag.data.gta_im.cameras import Cut, camera_cuts, camera_zooms
from sag.data.gta_im.files import ARCHIVE
from sag.data.gta_im.recording import JOINTS, ROOT, SUFFIXES, Recording
from sag.data.gta_im.views import BEFORE_JOINT, BEHIND_JOINT, person_id
from sag.data.pictures import read_colour
from sag.data.recordings.filters import Limits, inside_picture, pixels_of, root_jumps
from sag.data.recordings.plan import spread
from sag.data.recordings.views import Picture
from sag.errors import SagError

LIMBS = np.array(
    [
        (0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (1, 6), (6, 7), (7, 8), (8, 9), (1, 10), (10, 11), (11, 12), (12, 13),
        (13, 14), (14, 15), (15, 16), (16, 17), (14, 18), (18, 19), (19, 20),
    ]
)  # fmt: skip
"""Bones between the 21 joints, as GTA-IM's authors draw them."""

WAY = [JOINTS.index(name) for name in ("head", "neck", "spine0", "spine1", "spine2", "spine3", "root")] + [
    JOINTS.index(f"right_{name}") for name in ("hip", "knee", "ankle")
]
"""Joints from the head along the bones to an ankle."""


@dataclass(frozen=True)
class Look:
    """What a decoded picture shows of the person.

    Attributes:
        visible: joints that nothing hides, by the depth.
        on_person: of these, how many lie on the person's ids.
        gap: median way from the visible skin to the joint behind it, metres; not a number without visible joints.
        depth: planar z of the nearest and farthest hundredth of the known pixels, metres.
    """

    visible: int
    on_person: int
    gap: float
    depth: tuple[float, float]


@dataclass
class GtaImFindings(Findings[Recording, Look]):
    """One recording of GTA-IM.

    Attributes:
        incomplete: frames that have only some of their three pictures.
        projection: farthest that a projected joint is from `joints_2d`, pixels; nothing where that is not told.
        cuts: of the camera.
        zooms: first and last frames.
    """

    incomplete: list[int] = field(default_factory=list)
    projection: float | None = None
    cuts: list[Cut] = field(default_factory=list)
    zooms: list[tuple[int, int]] = field(default_factory=list)


def examine(folder: Path, limits: Limits, pictures: int | None) -> GtaImFindings:
    """Looks at a recording.

    Args:
        folder: of the recording.
        limits: what its windows must keep to.
        pictures: how many frames' pictures are decoded, evenly spread; all where nothing is given.
    """
    found = GtaImFindings(folder)
    try:
        recording = found.recording = Recording.read(folder)
        found.projection = projection_error(recording)
    except SagError as error:
        found.recording = None
        found.broken = _told([str(error), *_broken_pictures(folder, pictures)], folder)
        return found
    found.incomplete = incomplete_frames(folder)
    found.bones = bones_of(recording.joints, LIMBS, WAY)
    found.jumps = root_jumps(recording.joints[:, ROOT], limits)
    found.cuts = camera_cuts(recording.world2cam, recording.intrinsics)
    found.zooms = camera_zooms(recording.intrinsics, found.cuts)

    def look(frame: int) -> Look:
        return look_at(recording.picture(frame), recording.seen_from(frame, slice(frame, frame + 1))[0])

    found.look_at(sorted(recording.pictured), pictures, look)
    found.broken = _told(found.broken, folder)
    return found


def _told(broken: list[str], folder: Path) -> list[str]:
    """All that is broken: empty files first, whether they were read or not, then the others."""
    empty = [path for path in sorted(folder.iterdir()) if path.is_file() and not path.stat().st_size]
    others = [sentence for sentence in broken if not any(sentence.startswith(f"{path} ") for path in empty)]
    return [*(f"{path} is empty" for path in empty), *others]


def projection_error(recording: Recording) -> float | None:
    """Farthest that a joint, seen by the camera of its own frame, is from `joints_2d`, pixels.

    Nothing where the recording does not tell them, or has no joint before a camera.

    Raises:
        SagError: they are damaged, or of other frames.
    """
    path = recording.folder / ARCHIVE
    if "joints_2d" not in names_in(path):
        return None
    published = read_archive(path, {"joints_2d": (len(JOINTS), 2)})["joints_2d"]
    if len(published) != len(recording):
        raise SagError(f"{path} holds joints_2d of {len(published)} frames, but {len(recording)} frames of joints")
    camera = recording.world2cam
    seen = np.einsum("tji,tik->tjk", recording.joints, camera[:, :3, :3]) + camera[:, 3:, :3]
    pixels = np.einsum("tji,tki->tjk", seen, recording.intrinsics)
    before = seen[..., 2] > _nearest(recording)
    errors = np.abs(pixels[..., :2] / np.where(before, seen[..., 2], 1)[..., None] - published)[before]
    return float(errors.max()) if errors.size else None


def _nearest(recording: Recording) -> float:
    """Planar z from which joints are projected: the near clip plane, metres."""
    near = recording.clips[:, 0]
    return float(np.nanmin(near)) if np.isfinite(near).any() else 0.1


def incomplete_frames(folder: Path) -> list[int]:
    """Frames that have some of their three pictures, but not all."""
    return sorted(frame for frame, suffixes in _pictured(folder).items() if len(suffixes) < len(SUFFIXES))


def _pictured(folder: Path) -> dict[int, list[str]]:
    """Frames that have pictures, and how the names of these end."""
    found: dict[int, list[str]] = {}
    for name in (path.name for path in folder.iterdir()):
        if name[:5].isdecimal() and name.isascii() and name[5:] in SUFFIXES:
            found.setdefault(int(name[:5]), []).append(name[5:])
    return found


def _broken_pictures(folder: Path, count: int | None) -> list[str]:
    """Sentences on the pictures of so many frames that cannot be decoded, where a recording's own files are broken."""
    broken, pictured = [], _pictured(folder)
    for frame in spread(sorted(pictured), count):
        for suffix in sorted(pictured[frame]):
            try:
                read_colour(folder / f"{frame:05d}{suffix}")
            except SagError as error:
                broken.append(str(error))
    return broken


def look_at(picture: Picture, joints: np.ndarray) -> Look:
    """What a picture shows of the person.

    Args:
        picture: a frame.
        joints: joints of the same frame, metres, its camera's frame.
    """
    known = picture.depth[picture.depth > 0]
    depth = tuple(np.percentile(known, (1, 99)).tolist()) if known.size else (np.nan, np.nan)
    person = person_id(picture, joints) if np.isfinite(joints).all() else None
    if person is None:
        return Look(0, 0, np.nan, depth)
    pixels = pixels_of(joints, picture.intrinsics)
    inside = inside_picture(pixels, *picture.depth.shape) & (joints[:, 2] > 0)
    columns, rows = pixels[inside].astype(int).T
    gaps = joints[inside, 2] - picture.depth[rows, columns]
    visible = (gaps < BEFORE_JOINT) & (gaps > -BEHIND_JOINT)
    mask = binary_dilation(picture.ids == person, np.ones((3, 3)))
    return Look(int(visible.sum()), int(mask[rows, columns][visible].sum()), float(np.median(gaps[visible])), depth)
