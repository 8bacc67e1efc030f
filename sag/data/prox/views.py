"""What the cache stores of one window of PROX."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, UInt8

from sag.data.pictures import read_colour, refuse_cut_off
from sag.data.prox.person import mask_of, with_person
from sag.data.prox.recording import Recording
from sag.data.prox.sensor import Aligned, aligned, read_depth
from sag.data.recordings.body import BEHIND_SKIN, NOTHING, PERSON, body_depth, unhidden
from sag.data.recordings.views import Picture, WindowFormat, window_arrays
from sag.errors import SagError
from sag.skeleton import PROX_16
from sag.types import FRAMES


def stored_window(
    recording: Recording, start: int, form: WindowFormat, with_cloud: bool
) -> dict[str, np.ndarray] | None:
    """The cache's arrays of one window by name; nothing when the person is hidden at its start.

    With a scan the picture's depth has the person's capsules put in, and the cloud is the scan alone, complete behind
    the person. With the sensor's depth the picture has what was measured, and the cloud a hole where the person was.

    Args:
        recording: the recording.
        start: frame where the window starts.
        form: how windows are stored.
        with_cloud: whether the cloud is wanted as well.

    Raises:
        SagError: a picture of the start frame cannot be read.
    """
    colour, measured = read_unmirrored(recording, start), measured_depth(recording, start)
    scene = measured.depth if recording.scan is None else recording.scan
    body = body_depth(recording.joints[start], PROX_16, recording.intrinsics, recording.size)
    person = _person(recording, start, scene, body, measured)
    if not (person & np.isfinite(body)).any():
        return None
    ids = np.where(person, PERSON, NOTHING)
    depth = scene if recording.scan is None else with_person(scene, body, person)
    joints = recording.joints[start : start + FRAMES]
    picture = Picture(colour, depth, ids, recording.intrinsics)
    holes = ids if recording.scan is None else np.full_like(ids, NOTHING)
    cloud = Picture(colour, scene, holes, recording.intrinsics) if with_cloud else None
    return window_arrays(picture, PERSON, joints, recording.world2cam, form, cloud)


def read_unmirrored(recording: Recording, frame: int) -> UInt8[np.ndarray, "h w 3"]:
    """Colours of a frame as the camera saw it; PROX stores every picture mirrored.

    Raises:
        SagError: the picture is damaged, cut off, or of another size than the recording's first.
    """
    path = recording.path("Color", frame, ".jpg")
    colour = read_colour(path)[:, ::-1]
    if colour.shape[:2] != recording.size:
        raise SagError(f"{path} has {colour.shape[:2]} pixels, and the recording's first picture {recording.size}")
    refuse_cut_off(colour, path)
    return colour


def measured_depth(recording: Recording, frame: int) -> Aligned:
    """What the sensor measured in a frame; nothing where it is not wanted: with a scan and a mask of its own.

    Raises:
        SagError: the picture is damaged, or of another size than the calibration's.
    """
    path = recording.path("Depth", frame, ".png")
    wanted = recording.scan is None or not recording.path("BodyIndexColor", frame, ".png").is_file()
    if not wanted or not path.is_file():
        return Aligned(np.zeros(recording.size), np.full(recording.size, -1))
    measured = read_depth(path)
    recording.sensor.infrared.check_size(len(measured), measured.shape[1], path)
    return aligned(measured, recording.sensor, recording.size)


def _person(
    recording: Recording,
    frame: int,
    scene: Float[np.ndarray, "h w"],
    body: Float[np.ndarray, "h w"],
    measured: Aligned,
) -> Bool[np.ndarray, "h w"]:
    """Where the person is: by PROX's masks, and without them where the capsules are not hidden by the scene."""
    told = mask_of(recording.folder, recording.frames[frame].stem, recording.size, measured)
    slack = BEHIND_SKIN if recording.scan is None else 0.0
    return unhidden(body, scene, slack) if told is None else told
