"""Furnished rooms as a depth sensor sees them, with people who stand in, at and before things; all by formula.

Camera frame (metres, x right, y down, z forward) and continuous pixels, as everywhere in `sag`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.types import FRAMES

SIZES = {"288x512": (288, 512), "1080p": (1080, 1920)}
"""Rows and columns of the pictures that the claims are about."""

FLOOR, CEILING, SIDE, BACK = 1.3, -1.4, 3.0, 7.0
"""The camera's height over the floor, and how far ceiling, side walls and back wall are from it."""

ANKLE = 0.05
"""Height of the ankles over the floor: low enough for a capsule of 60 mm to touch it."""

STANDING = np.array(
    [
        [0, -0.76, 0], [0, -0.6, 0], [-0.19, -0.52, 0], [-0.22, -0.24, 0.02], [-0.23, 0.01, -0.06],
        [0.19, -0.52, 0], [0.22, -0.24, 0.02], [0.23, 0.01, -0.06], [0, -0.42, 0], [0, -0.28, 0], [0, -0.18, 0],
        [0, -0.09, 0], [0, 0, 0], [-0.1, 0.06, 0], [-0.11, 0.47, -0.03], [-0.11, 0.88, 0.02], [0.1, 0.06, 0],
        [0.11, 0.47, -0.03], [0.11, 0.88, 0.02],
    ]
)  # fmt: skip
"""A standing person of `sag.skeleton.GTA_IM_19`, metres from the root."""


@dataclass(frozen=True)
class Room:
    """A room and the camera in it.

    Attributes:
        depth: planar z, metres, whole millimetres as a sensor gives them.
        intrinsics: camera matrix in the pixels of the depth map.
    """

    depth: Float[Tensor, "h w"]
    intrinsics: Float[Tensor, "3 3"]


def furnished_room(seed: int, size: tuple[int, int], boxes: int = 14) -> Room:
    """A room of 6 x 7 metres with boxes for furniture."""
    random = np.random.default_rng(seed)
    height, width = size
    focal = 0.6 * width
    x = ((np.arange(width) + 0.5 - width / 2) / focal)[None, :]
    y = ((np.arange(height) + 0.5 - height / 2) / focal)[:, None]
    with np.errstate(divide="ignore"):
        depth = np.minimum(BACK, np.minimum(SIDE / abs(x), np.where(y > 0, FLOOR / y, CEILING / y)))
        for _ in range(boxes):
            near = np.array([random.uniform(-2.5, 2), random.uniform(0.2, 0.8), random.uniform(2, 6)])
            far = np.array([near[0] + random.uniform(0.3, 1.2), FLOOR, near[2] + random.uniform(0.3, 1)])
            depth = np.minimum(depth, _box(x, y, near, far))
    intrinsics = torch.tensor([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]])
    return Room(torch.from_numpy(depth.round(3)).float(), intrinsics)


def _box(x: np.ndarray, y: np.ndarray, near: np.ndarray, far: np.ndarray) -> np.ndarray:
    """Depth at which rays (x, y, 1) enter a box, infinite where they miss it."""
    slabs = [(near[axis] / ray, far[axis] / ray) for axis, ray in enumerate((x, y))]
    enter, leave = near[2], far[2]
    for one, other in slabs:
        enter, leave = np.maximum(enter, np.minimum(one, other)), np.minimum(leave, np.maximum(one, other))
    return np.where(enter < leave, enter, np.inf)


def people(room: Room, count: int, seed: int) -> Float[Tensor, "n 19 3"]:
    """People who stand on the floor at or just before places that the camera sees, each turned and bent otherwise."""
    random = np.random.default_rng(seed)
    depth, intrinsics = room.depth.numpy(), room.intrinsics.numpy()
    columns = random.integers(depth.shape[1] // 8, depth.shape[1] * 7 // 8, count)
    z = depth[random.integers(0, depth.shape[0], count), columns] * random.uniform(0.75, 1.02, count)
    z = np.maximum(z, 1)
    x = (columns + 0.5 - intrinsics[0, 2]) / intrinsics[0, 0] * z
    root = np.stack([x, FLOOR - ANKLE - STANDING[:, 1].max() + random.normal(0, 0.02, count), z], axis=-1)
    bent = STANDING + random.normal(0, 0.03, (count, *STANDING.shape))
    return torch.from_numpy(bent @ _turns(random.uniform(0, 2 * np.pi, count)) + root[:, None]).float()


def _turns(angle: np.ndarray) -> np.ndarray:
    """Rotations about the vertical."""
    c, s, o, i = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.stack([np.stack(row, axis=-1) for row in ((c, o, s), (o, i, o), (-s, o, c))], axis=-2)


def motions(starts: Float[Tensor, "n 19 3"], seed: int) -> Float[Tensor, "n 65 19 3"]:
    """Two seconds of people who drift off from where they stand with swinging limbs, at 30 frames a second."""
    random = np.random.default_rng(seed)
    count = len(starts)
    time = (np.arange(FRAMES) / 30)[None, :, None, None]
    velocity = random.uniform([-0.8, 0, -0.5], [0.8, 0, 0.5], (count, 3))[:, None, None]
    swing = random.normal(0, 0.05, (count, 1, 19, 3)) * (np.abs(STANDING).sum(1) > 0.5)[:, None]
    phase = random.uniform(0, 2 * np.pi, (count, 1, 19, 1))
    moved = velocity * time + swing * (np.sin(6 * time + phase) - np.sin(phase))
    return (starts[:, None].double() + torch.from_numpy(moved)).float()
