"""PROX's fits of SMPL-X to the pictures (PROXD), turned into joints by the package `smplx`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float

from sag.data.pickles import load_pickle
from sag.data.prox.numbers import array_of
from sag.errors import SagError
from sag.skeleton import PROX_16

SIZES = {
    "betas": 10, "global_orient": 3, "transl": 3, "body_pose": 63, "left_hand_pose": 12, "right_hand_pose": 12,
    "jaw_pose": 3, "leye_pose": 3, "reye_pose": 3, "expression": 10,
}  # fmt: skip
"""What of a fit makes the body, with its count of numbers; the camera beside it is the identity and not used."""

HAND_COMPONENTS = SIZES["left_hand_pose"]
"""Principal components of a hand's pose."""

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
        folder: holds SMPLX_MALE.npz and SMPLX_FEMALE.npz, or a folder `smplx` with them. They are read by the package
            `smplx`, which trusts them: take them from https://smpl-x.is.tue.mpg.de.
        female_subjects: numbers of the subjects who are fitted with the female model.
    """

    folder: Path
    female_subjects: tuple[int, ...]

    def joints(self, fits: Iterable[Path], female: bool) -> Float[np.ndarray, "t 16 3"]:
        """Joints of `prox_16` in each fit: metres, colour camera frame.

        Raises:
            SagError: a fit is damaged, the model is missing, or `smplx` is not installed.
        """
        read = [read_fit(path) for path in fits]
        body = _body(self.folder, "female" if female else "male")
        joints = []
        for first in range(0, len(read), TOGETHER):
            rows = read[first : first + TOGETHER]
            parameters = {
                name: torch.tensor(np.stack([row[name] for row in rows]), dtype=torch.float32) for name in SIZES
            }
            with torch.no_grad():
                joints.append(body(**parameters).joints.double().numpy())
        places = [SMPLX_JOINTS[name] for name in PROX_16.joints]
        return np.concatenate([np.empty((0, len(places), 3)), *(made[:, places] for made in joints)])


def read_fit(path: Path) -> dict[str, np.ndarray]:
    """What makes the body of a frame, by the names of `SIZES`.

    Raises:
        SagError: the pickle is missing, damaged, of another layout, or names anything but numpy arrays.
    """
    content = load_pickle(path)
    if not isinstance(content, dict):
        raise SagError(f"{path} holds no fit of SMPL-X by names; restore the original file")
    missing = [name for name in SIZES if name not in content]
    if missing:
        raise SagError(f"{path} lacks {', '.join(missing)}; restore the original file")
    return {name: array_of(content[name], (1, size), f"{path}: {name}")[0] for name, size in SIZES.items()}


@lru_cache(maxsize=2)
def _body(folder: Path, gender: str) -> Any:
    """The body model of a gender.

    Raises:
        SagError: the package or the model is missing, or cannot be used.
    """
    try:
        import smplx
    except ImportError as error:
        raise SagError(
            'PROXD fits need the package smplx: run pip install "sag[prox]", or leave out '
            "--data.init_args.smplx_models to move by the Kinect's skeletons"
        ) from error
    file = f"SMPLX_{gender.upper()}.npz"
    found = [path for path in (folder / file, folder / "smplx" / file) if path.is_file()]
    if not found:
        raise SagError(
            f"--data.init_args.smplx_models {folder} holds neither {file} nor smplx/{file}; "
            "they come from https://smpl-x.is.tue.mpg.de under a licence of their own"
        )
    try:
        return smplx.create(
            str(found[0]), model_type="smplx", gender=gender, ext="npz", num_pca_comps=HAND_COMPONENTS
        ).eval()
    except Exception as error:  # what a wrong file raises is smplx's own matter
        raise SagError(f"{found[0]} cannot be used as a model of SMPL-X by smplx ({error})") from error
