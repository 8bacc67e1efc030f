"""Stages to film, made without a data set: people walk before a wall."""

import numpy as np
from toy_data import STANDING

from sag.export.surface import Surface
from sag.export.upright import Upright
from sag.film import Stage
from sag.skeleton import GTA_IM_19

SIZE = (90, 160)
"""Rows and columns of the picture."""

WALL = 5.0
"""Metres before the camera."""

INTRINSICS = np.array([[120.0, 0, 80], [0, 120.0, 45], [0, 0, 1]])


def motions(samples: int, frames: int, near: float) -> np.ndarray:
    """(k, t, 19, 3) people side by side who move to the right."""
    starts = np.stack([[0.5 * number - 0.5, 0.0, near] for number in range(samples)])
    steps = np.linspace(0, 0.3, frames)[:, None] * [1.0, 0, 0]
    return starts[:, None, None] + steps[None, :, None] + STANDING


def wall() -> Surface:
    """A grey wall as wide as the picture."""
    x, y = np.meshgrid([-6.0, 6.0], [-4.0, 4.0])
    points = np.stack([x, y, np.full_like(x, WALL)], axis=-1).reshape(-1, 3)
    picture = np.full((*SIZE, 3), 120, np.uint8)
    return Surface(points, np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]]), np.array([[0, 2, 1], [1, 2, 3]]), picture)


def stage(samples: int = 2, frames: int = 9, with_picture: bool = True, near: float = 3.0) -> Stage:
    """People who walk to the right at some distance, before a wall 5 m away."""
    joints = motions(samples, frames, near)
    upright = Upright.at(joints[0, 0], GTA_IM_19)
    if not with_picture:
        return Stage(joints, GTA_IM_19, 30.0, upright)
    return Stage(joints, GTA_IM_19, 30.0, upright, np.full((*SIZE, 3), 120, np.uint8), INTRINSICS, wall())
