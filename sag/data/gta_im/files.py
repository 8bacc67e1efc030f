"""The files of a recording that are not pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from sag.data.pickles import load_pickle
from sag.errors import SagError

FAR_CLIP = 800.0
"""Distance of the far clip plane (metres) in frames that do not tell it."""

SHAPES = {"joints_3d_world": (21, 3), "world2cam_trans": (4, 4), "intrinsics": (3, 3)}
"""Arrays of `info_frames.npz` that are read, and the shape of one frame."""


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """Joints and cameras of a recording by the names of `SHAPES`, float64.

    Raises:
        SagError: the archive is missing, damaged or of another layout.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: np.asarray(file[name], np.float64) for name in SHAPES}
    except Exception as error:  # a damaged archive can raise anything
        raise SagError(f"{path} cannot be read ({error}); restore the original file") from error
    frames = len(arrays["joints_3d_world"])
    for name, array in arrays.items():
        if array.shape != (frames, *SHAPES[name]) or not np.isfinite(array).all():
            raise SagError(f"{path} holds {name} of shape {array.shape} or with numbers that are not finite")
    return arrays


def read_clips(path: Path) -> Float[np.ndarray, "t 2"]:
    """Distances of the near and the far clip plane in every frame, metres; not a number where unknown.

    Raises:
        SagError: the pickle is refused, damaged or of another layout.
    """
    frames = load_pickle(path)
    try:
        clips = [(float(f.get("cam_near_clip", np.nan)), float(f.get("cam_far_clip", FAR_CLIP))) for f in frames]
    except (TypeError, ValueError, AttributeError) as error:
        raise SagError(f"{path} is no list of frames with cam_near_clip ({error!r})") from error
    return np.array(clips).reshape(-1, 2)


def read_room(path: Path) -> int:
    """Number of the scene, from `realtimeinfo.gz`.

    Raises:
        SagError: the pickle is refused, damaged or of another layout.
    """
    # A plain pickle in spite of its name.
    content: Any = load_pickle(path)
    try:
        return int(content["setting"]["room"])
    except (TypeError, ValueError, KeyError) as error:
        raise SagError(f'{path} tells no ["setting"]["room"] ({error!r})') from error
