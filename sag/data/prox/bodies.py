"""SMPL-X's body models, of which numbers alone are read, as the package `smplx` makes bodies of them."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float

from sag.data.archives import Shape, read_array
from sag.errors import SagError

SITE = "https://smpl-x.is.tue.mpg.de"
"""Where the models are; under a licence of their own."""

VERTICES, JOINTS, LANDMARKS = 10_475, 55, 51
"""Of SMPL-X; `smplx` adds vertices and landmarks to the joints that it gives."""

NUMBERS: dict[str, list[Shape]] = {
    "v_template": [(VERTICES, 3)],
    "shapedirs": [(VERTICES, 3, 20), (VERTICES, 3, 400)],
    "posedirs": [(VERTICES, 3, 9 * (JOINTS - 1))],
    "J_regressor": [(JOINTS, VERTICES)],
    "weights": [(VERTICES, JOINTS)],
    "hands_componentsl": [(45, 45)], "hands_componentsr": [(45, 45)],
    "hands_meanl": [(45,)], "hands_meanr": [(45,)],
    "lmk_bary_coords": [(LANDMARKS, 3)],
}  # fmt: skip
"""Arrays of a model that make a body, with their shapes. What a file holds besides is left where it is: also arrays
of objects, such as the numbers of its parts by name."""

PLACES: dict[str, list[Shape]] = {
    "f": [(20_908, 3)],
    "kintree_table": [(2, JOINTS)],
    "lmk_faces_idx": [(LANDMARKS,)],
}
"""The same for whole numbers: corners of faces, each joint's parent, and the faces of landmarks."""

WAY_OUT = f"take the model of SMPL-X as .npz from {SITE}"

Body = Callable[[dict[str, torch.Tensor]], Float[np.ndarray, "t joints 3"]]
"""Joints of bodies by their parameters."""


@lru_cache(maxsize=2)
def body_of(folder: Path, gender: str, hand_components: int) -> Body:
    """The body of a gender.

    Args:
        folder: holds SMPLX_MALE.npz and SMPLX_FEMALE.npz, or a folder `smplx` with them.
        gender: `male` or `female`.
        hand_components: principal components of a hand's pose.

    Raises:
        SagError: the package or the model is missing, or cannot be used; making joints raises it, too.
    """
    try:
        import smplx
    except ImportError as error:
        raise SagError(
            'PROXD fits need the package smplx: run pip install "sag[prox]", or leave out '
            "--data.init_args.smplx_models to move by the Kinect's skeletons"
        ) from error
    path = _model(folder, f"SMPLX_{gender.upper()}")
    content: dict[str, Any] = {**read_model(path)}
    try:
        with tempfile.TemporaryDirectory() as copy:
            # `smplx` unpickles whatever objects a file holds; the copy has none.
            numbers = Path(copy) / f"SMPLX_{gender.upper()}.npz"
            np.savez(numbers, **content)
            body = smplx.create(
                str(numbers), model_type="smplx", gender=gender, ext="npz", num_pca_comps=hand_components
            ).eval()
    except Exception as error:  # what a version of smplx raises is its own matter
        raise SagError(f"{path} cannot be used as a model of SMPL-X by smplx ({_said(error)}); {WAY_OUT}") from error
    return lambda parameters: _joints(body, parameters, path)


def read_model(path: Path) -> dict[str, np.ndarray]:
    """Arrays of `NUMBERS` (32 bits) and `PLACES` of a model; nothing of it is run.

    Raises:
        SagError: the file is missing or damaged, or lacks one of them in its shape.
    """
    numbers = {name: read_array(path, name, s, way_out=WAY_OUT).astype(np.float32) for name, s in NUMBERS.items()}
    places = {name: read_array(path, name, s, "iu", WAY_OUT).astype(np.int64) for name, s in PLACES.items()}
    limits = {"f": VERTICES, "kintree_table": JOINTS, "lmk_faces_idx": len(places["f"])}
    for name, limit in limits.items():
        # The root's parent is -1, or what becomes of it in 32 bits.
        found = places[name].ravel()[1 if name == "kintree_table" else 0 :]
        if found.min() < 0 or found.max() >= limit:
            raise SagError(f"{path} holds {name} beyond the {limit:,} there are; {WAY_OUT}")
    return {**numbers, **places}


def _model(folder: Path, name: str) -> Path:
    """The file of a model."""
    for path in (folder / f"{name}.npz", folder / "smplx" / f"{name}.npz"):
        if path.is_file():
            return path
    said = f"--data.init_args.smplx_models {folder} holds neither {name}.npz nor smplx/{name}.npz"
    if any((place / f"{name}.pkl").exists() for place in (folder, folder / "smplx")):
        said += f"; {name}.pkl is a pickle, which could run anything and is not read: take the .npz beside it"
    raise SagError(f"{said}; they come from {SITE} under a licence of their own")


def _joints(body: Any, parameters: dict[str, torch.Tensor], path: Path) -> Float[np.ndarray, "t joints 3"]:
    """Joints of bodies, checked; a version of `smplx` may give others."""
    count = len(parameters["transl"])
    try:
        with torch.no_grad():
            joints = body(**parameters).joints.double().numpy()
    except Exception as error:  # what a version of smplx raises is its own matter
        raise SagError(f"{path} makes no bodies by smplx ({_said(error)}); {WAY_OUT}, or another smplx") from error
    if joints.ndim != 3 or len(joints) != count or joints.shape[1] < JOINTS or joints.shape[2] != 3:
        raise SagError(f"{path} makes joints of shape {joints.shape} by smplx, not ({count}, {JOINTS} or more, 3)")
    if not np.isfinite(joints).all():
        raise SagError(f"{path} makes joints by smplx that are not finite; {WAY_OUT}")
    return joints


def _said(error: Exception) -> str:
    return " ".join((str(error) or type(error).__name__)[:200].split())
