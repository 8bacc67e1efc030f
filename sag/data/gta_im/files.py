"""The files of a recording that are not pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from sag.data.archives import ROWS_LIMIT, read_archive
from sag.data.pickles import load_pickle
from sag.errors import SagError

FAR_CLIP = 800.0
"""Distance of the far clip plane (metres) in frames that do not tell it."""

SHAPES = {"joints_3d_world": (21, 3), "world2cam_trans": (4, 4), "intrinsics": (3, 3)}
"""Arrays of `info_frames.npz` that are read, and the shape of one frame."""

ARCHIVE, PICKLE, REALTIME = "info_frames.npz", "info_frames.pickle", "realtimeinfo.gz"
"""Names of the files: joints and cameras, what else is told of the frames, and of the recording."""

Frame = Mapping[str, Any]
"""What `info_frames.pickle` tells of one frame."""


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """Joints and cameras of a recording by the names of `SHAPES`, float64.

    Raises:
        SagError: the archive is missing, damaged or of another layout.
    """
    return read_archive(path, SHAPES)


def read_frames(path: Path) -> Sequence[Frame]:
    """What `info_frames.pickle` tells of each frame.

    Raises:
        SagError: the pickle is refused, damaged or of another layout, or tells one frame twice.
    """
    frames = load_pickle(path)
    if not isinstance(frames, list) or not frames or not all(isinstance(frame, dict) for frame in frames):
        raise SagError(f"{path} is no list of frames with cam_near_clip; restore the original file")
    if len(frames) > ROWS_LIMIT:
        raise SagError(f"{path} has {len(frames):,} frames, more than the {ROWS_LIMIT:,} allowed")
    times = Counter(str(frame["time"])[:40] for frame in frames if "time" in frame)
    for time, count in times.most_common(1):
        if count > 1:
            raise SagError(f"{path} tells the frame of time {time} {count} times; restore the original file")
    return frames


def clips_of(frames: Sequence[Frame], path: Path) -> Float[np.ndarray, "t 2"]:
    """Distances of the near and the far clip plane in every frame, metres; not a number where unknown.

    Args:
        frames: of a recording.
        path: of their file, for the error.

    Raises:
        SagError: a distance is no number, or the planes are not in order before the camera.
    """
    clips = np.full((len(frames), 2), np.nan)
    for place, frame in enumerate(frames):
        try:
            clips[place] = frame.get("cam_near_clip", np.nan), frame.get("cam_far_clip", FAR_CLIP)
        except (TypeError, ValueError) as error:
            raise SagError(f"{path} is no list of frames with cam_near_clip: frame {place} ({error})") from error
        near, far = clips[place].tolist()
        if "cam_near_clip" in frame and not 0 < near < far < np.inf:
            raise SagError(f"{path} has clip planes at {near:g} and {far:g} metres in frame {place}")
    return clips


def read_room(path: Path) -> int:
    """Number of the scene, from `realtimeinfo.gz`.

    Raises:
        SagError: the pickle is refused, damaged or of another layout.
    """
    # A plain pickle in spite of its name.
    content: Any = load_pickle(path)
    try:
        room = int(content["setting"]["room"])
    except (TypeError, ValueError, KeyError, OverflowError) as error:
        raise SagError(f'{path} tells no ["setting"]["room"] ({error!r})') from error
    if not 0 <= room < 1 << 31:
        raise SagError(f'{path} tells the ["setting"]["room"] {str(room)[:20]}, which is no number of a scene')
    return room
