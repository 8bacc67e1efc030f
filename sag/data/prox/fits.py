"""PROX's fits of SMPL-X to the pictures (PROXD), turned into joints by the package `smplx`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float

from sag.data.pickles import load_pickle
from sag.data.prox.bodies import body_of
from sag.data.prox.numbers import array_of
from sag.errors import SagError
from sag.skeleton import PROX_16

SIZES = {
    "betas": 10, "global_orient": 3, "transl": 3, "body_pose": 63, "left_hand_pose": 12, "right_hand_pose": 12,
    "jaw_pose": 3, "leye_pose": 3, "reye_pose": 3, "expression": 10,
}  # fmt: skip
"""What of a fit makes the body, with its count of numbers; the camera beside it is the identity and not used."""

FIT_LIMIT = 1 << 20
"""Bytes of the largest fit that is read; the real ones have a few thousand."""

SMPLX_JOINTS = {
    "root": 0, "left_hip": 1, "right_hip": 2, "left_knee": 4, "right_knee": 5, "left_ankle": 7, "right_ankle": 8,
    "chest": 9, "neck": 12, "head": 15, "left_shoulder": 16, "right_shoulder": 17, "left_elbow": 18, "right_elbow": 19,
    "left_wrist": 20, "right_wrist": 21,
}  # fmt: skip
"""Number of each joint of `prox_16` among those of SMPL-X."""

TOGETHER = 256
"""Frames whose bodies are made at once; a body has 10,475 vertices."""


@dataclass(frozen=True)
class Bodies:
    """SMPL-X models of a user's folder.

    Attributes:
        folder: holds SMPLX_MALE.npz and SMPLX_FEMALE.npz, or a folder `smplx` with them, of which numbers alone are
            read, see `sag.data.prox.bodies`.
        female_subjects: numbers of the subjects who are fitted with the female model.
    """

    folder: Path
    female_subjects: tuple[int, ...]

    def joints(self, fits: Iterable[Path], female: bool) -> Float[np.ndarray, "t 16 3"]:
        """Joints of `prox_16` in each fit: metres, colour camera frame.

        Raises:
            SagError: a fit is damaged, the model is missing or cannot be used, or `smplx` is not installed.
        """
        read = [read_fit(path) for path in fits]
        body = body_of(self.folder, "female" if female else "male", SIZES["left_hand_pose"])
        joints = []
        for first in range(0, len(read), TOGETHER):
            rows = read[first : first + TOGETHER]
            parameters = {
                name: torch.tensor(np.stack([row[name] for row in rows]), dtype=torch.float32) for name in SIZES
            }
            joints.append(body(parameters)[:, [SMPLX_JOINTS[name] for name in PROX_16.joints]])
        return np.concatenate([np.empty((0, len(PROX_16.joints), 3)), *joints])


def read_fit(path: Path) -> dict[str, np.ndarray]:
    """What makes the body of a frame, by the names of `SIZES`.

    Raises:
        SagError: the pickle is missing, damaged, of another layout, or names anything but numpy arrays.
    """
    content = load_pickle(path, FIT_LIMIT)
    if not isinstance(content, dict):
        raise SagError(f"{path} holds no fit of SMPL-X by names; restore the original file")
    missing = [name for name in SIZES if name not in content]
    if missing:
        raise SagError(f"{path} lacks {', '.join(missing)}; restore the original file")
    return {name: array_of(content[name], (1, size), f"{path}: {name}")[0] for name, size in SIZES.items()}
