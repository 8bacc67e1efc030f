"""A tiny data set in PROX's own layout: a person before a wall, seen by a Kinect whose cameras differ."""

from __future__ import annotations

import io
import json
import pickle
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import torch
from PIL import Image
from scipy.spatial.transform import Rotation

from sag.data.prox import ProxDataModule
from sag.data.prox.fits import SIZES, SMPLX_JOINTS
from sag.data.prox.kinect import JOINTS, SDK_JOINTS
from sag.data.prox.recording import joint_places
from sag.data.recordings.filters import Limits
from sag.data.recordings.views import WindowFormat
from sag.skeleton import PROX_16, Skeleton

ROWS, COLUMNS = 108, 192
DEPTH_ROWS, DEPTH_COLUMNS = 84, 102
SIZE = (54, 96)
"""Rows and columns of the windows' pictures."""

PICTURED = 6
"""Frames that have pictures of their own, where windows start; the others repeat the last of them."""

WALL = 4.0
"""Planar z of the wall in the colour camera, metres."""

COLOUR = np.array([[106.0, 0, 95.1], [0, 106.0, 53.7], [0, 0, 1]])
INFRARED = np.array([[36.5, 0, 51.0], [0, 36.5, 41.5], [0, 0, 1]])
"""Camera matrices as the files have them: the first pixel's centre is (0, 0)."""

COLOUR_VIEW = np.eye(3), np.zeros(3)
INFRARED_VIEW = Rotation.from_euler("xyz", [0.01, -0.02, 0.015]).as_matrix(), np.array([0.05, 0.002, -0.003])
"""Rotation and translation from the calibration's frame to the camera's."""

CAM2WORLD = np.array([[1.0, 0, 0, 0.3], [0, 0, 1, -2.0], [0, -1, 0, 1.2], [0, 0, 0, 1]])
"""A camera 1.2 m over the ground that looks along y of the scan, whose z is up."""

STANDING = {
    "head": (0.0, -0.75, 0.0), "neck": (0.0, -0.6, 0.0), "chest": (0.0, -0.4, 0.0), "root": (0.0, 0.0, 0.0),
    "shoulder": (0.2, -0.55, 0.0), "elbow": (0.22, -0.3, 0.0), "wrist": (0.22, -0.1, 0.0),
    "hip": (0.1, 0.0, 0.0), "knee": (0.1, 0.4, 0.0), "ankle": (0.1, 0.8, 0.0),
}  # fmt: skip
"""Joints from the root, metres, camera frame; the person faces the camera, so their left is to the right of it."""


def body() -> np.ndarray:
    """(16, 3) joints of `prox_16` from the root."""
    side = {"left": np.array([1.0, 1, 1]), "right": np.array([-1.0, 1, 1])}
    split = [name.partition("_") for name in PROX_16.joints]
    return np.array([side[a] * STANDING[b] if b else STANDING[a] for a, _, b in split])


def frame_name(number: int, seconds: float) -> str:
    """A frame's name, without the ending."""
    return f"s001_frame_{number:05d}__00.00.{int(seconds):02d}.{round(1000 * (seconds % 1)):03d}"


class Take:
    """What a recording holds, before it is written; tests change its arrays.

    Attributes:
        roots: (t, 3) metres, colour camera.
        seconds: when each frame was recorded.
    """

    def __init__(self, frames: int = 70) -> None:
        self.roots = np.array([-0.2, 0.2, 3.0]) + 0.008 * np.arange(frames)[:, None] * [1, 0, 0]
        self.seconds = 0.029 + np.arange(frames) / 30

    @property
    def joints(self) -> np.ndarray:
        return self.roots[:, None] + body()

    @property
    def names(self) -> list[str]:
        return [frame_name(place + 1, seconds) for place, seconds in enumerate(self.seconds)]

    def write(self, root: Path, name: str, masks: bool = True, fits: bool = False) -> Path:
        """Writes the recording's own files, and its fits where they are asked for."""
        folder = root / "recordings" / name
        for kind in ("Color", "Depth", "BodyIndexColor", "Skeleton"):
            (folder / kind).mkdir(parents=True)
        depth = encoded(measured(), "PNG")
        for place, (stem, joints) in enumerate(zip(self.names, self.joints)):
            if place < PICTURED:
                colour, mask = (encoded(values, kind) for values, kind in zip(drawn(joints), ("JPEG", "PNG")))
            (folder / "Color" / f"{stem}.jpg").write_bytes(colour)
            (folder / "Depth" / f"{stem}.png").write_bytes(depth)
            if masks:
                (folder / "BodyIndexColor" / f"{stem}.png").write_bytes(mask)
            (folder / "Skeleton" / f"{stem}.json").write_text(json.dumps(skeleton(joints)))
            if fits:
                path = root / "PROXD" / name / "results" / stem / "000.pkl"
                path.parent.mkdir(parents=True)
                path.write_bytes(pickle.dumps(fit(joints), protocol=2))
        if not masks:
            (folder / "BodyIndexColor").rmdir()
        return folder


def encoded(values: np.ndarray, kind: str) -> bytes:
    """A picture as it is stored: mirrored."""
    file = io.BytesIO()
    Image.fromarray(values[:, ::-1]).save(file, kind, quality=95)
    return file.getvalue()


def drawn(joints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unmirrored colours (row, column, person) and mask (0 at the person, 255 elsewhere)."""
    rows, columns = np.mgrid[:ROWS, :COLUMNS]
    pixels = joints @ COLOUR.T
    mask = np.full((ROWS, COLUMNS), 255, np.uint8)
    for x, y in pixels[:, :2] / pixels[:, 2:]:
        mask[(columns - x) ** 2 + (rows - y) ** 2 < 16] = 0
    return np.stack([rows, columns, 255 - mask], -1).astype(np.uint8), mask


def measured() -> np.ndarray:
    """Unmirrored depth picture of the wall: where the depth camera's rays meet its plane."""
    rows, columns = np.mgrid[:DEPTH_ROWS, :DEPTH_COLUMNS]
    rays = np.stack([columns, rows, np.ones_like(rows)], -1) @ np.linalg.inv(INFRARED).T
    turn, shift = INFRARED_VIEW
    depth = (WALL + (turn.T @ shift)[2]) / (rays @ turn)[..., 2]
    return np.rint(8000 * depth).astype(np.uint16)


def skeleton(joints: np.ndarray) -> dict:
    """What the Kinect SDK tells of a body: joints by name in its own camera space, the first body not tracked."""
    turn, shift = INFRARED_VIEW
    own = dict(zip(JOINTS, (joints @ turn.T + shift) * [-1, -1, 1]))
    positions = {name: dict(zip("XYZ", own.get(name, np.zeros(3)).tolist())) for name in SDK_JOINTS}
    named = {name: {"JointType": i, "Position": positions[name]} for i, name in enumerate(SDK_JOINTS)}
    return {"Bodies": [{"IsTracked": False, "Joints": {}}, {"IsTracked": True, "Joints": named}]}


def fit(joints: np.ndarray) -> dict[str, np.ndarray]:
    """A fit whose translation is the root; the stand-in for SMPL-X puts the other joints around it."""
    zero = {name: np.zeros((1, size), np.float32) for name, size in SIZES.items()}
    root = joints[PROX_16.root_index].astype(np.float32)[None]
    return {**zero, "transl": root, "pose_embedding": np.zeros((1, 32), np.float32)}


class StandIn:
    """In place of the package `smplx`: a body that is `body()` about its translation, wider for women."""

    def __init__(self) -> None:
        self.created: list[str] = []

    def create(self, path: str, *, gender: str, **options: object) -> object:
        assert options == {"model_type": "smplx", "ext": "npz", "num_pca_comps": 12}
        self.created.append(gender)
        joints = torch.zeros(127, 3)
        joints[[SMPLX_JOINTS[name] for name in PROX_16.joints]] = torch.tensor(body(), dtype=torch.float32)
        joints *= 1.1 if gender == "female" else 1.0

        def made(transl: torch.Tensor, **others: torch.Tensor) -> SimpleNamespace:
            assert {name: tuple(value.shape) for name, value in others.items()} == {
                name: (len(transl), size) for name, size in SIZES.items() if name != "transl"
            }
            return SimpleNamespace(joints=transl[:, None] + joints)

        return SimpleNamespace(eval=lambda: made)


def write_root(root: Path, scenes: tuple[str, ...] = ("N0Sofa", "MPH16")) -> Path:
    """Calibration, and for each scene its camera and a scan: a wall of two triangles, much larger than the picture."""
    for name in ("calibration", "cam2world", "scenes", "recordings"):
        (root / name).mkdir(parents=True)
    for name, matrix, (turn, shift) in (("Color", COLOUR, COLOUR_VIEW), ("IR", INFRARED, INFRARED_VIEW)):
        view = np.concatenate([turn, shift[:, None]], axis=1)
        content = {"camera_mtx": matrix.tolist(), "k": [0.0] * 5, "view_mtx": view.tolist()}
        (root / "calibration" / f"{name}.json").write_text(json.dumps(content))
    corners = np.array([[x, y, WALL] for x, y in ((-9, -9), (9, -9), (9, 9), (-9, 9))])
    world = corners @ CAM2WORLD[:3, :3].T + CAM2WORLD[:3, 3]
    for scene in scenes:
        (root / "cam2world" / f"{scene}.json").write_text(json.dumps(CAM2WORLD.tolist()))
        (root / "scenes" / f"{scene}.ply").write_text(ply(world, [[0, 1, 2], [0, 2, 3]]))
    return root


def ply(vertices: np.ndarray, faces: list[list[int]]) -> str:
    """A mesh as text."""
    head = [
        "ply", "format ascii 1.0", f"element vertex {len(vertices)}",
        *(f"property float {axis}" for axis in "xyz"),
        f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header",
    ]  # fmt: skip
    lines = [" ".join(map(str, row)) for row in vertices.tolist()] + [" ".join(map(str, (3, *face))) for face in faces]
    return "\n".join(head + lines) + "\n"


def form(skeleton: Skeleton = PROX_16) -> WindowFormat:
    """How windows are stored, with small pictures."""
    return WindowFormat(joint_places(skeleton), skeleton.root_index, SIZE, 1, Limits())


def module(root: Path, cache_dir: Path, **options: object) -> ProxDataModule:
    """The data module with small pictures."""
    return ProxDataModule(root, cache_dir=cache_dir, **{"image_size": SIZE, **options})
