"""Windows of a page, made without a data set: people walk before a wall with a floor, and into it."""

import numpy as np
from toy_data import walks

from sag.viewer import ShownMotion, ShownRow, ShownScene, ShownWindow

SIZE = (60, 100)
"""Rows and columns of the depth."""

WALL = 5.0
"""Metres before the camera."""

INTRINSICS = np.array([[80.0, 0, 50], [0, 80.0, 30], [0, 0, 1]])


def wall_and_floor() -> np.ndarray:
    """Depth of a wall and of a floor 1.2 m under the camera, metres, in whole millimetres."""
    rows = np.arange(SIZE[0]) + 0.5 - INTRINSICS[1, 2]
    floor = np.divide(1.2 * INTRINSICS[1, 1], rows, out=np.full(SIZE[0], WALL), where=rows > 0)
    depth = np.minimum(floor, WALL)[:, None].repeat(SIZE[1], axis=1)
    return np.round(depth, 3)


def scene() -> ShownScene:
    """The wall and the floor with a person cut out."""
    hidden = np.zeros(SIZE, bool)
    hidden[20:50, 5:15] = True
    return ShownScene(np.where(hidden, 0.0, wall_and_floor()), INTRINSICS, hidden)


def motion(number: int, frames: int = 65, touched: bool = True) -> ShownMotion:
    """A walk into the wall; each number another."""
    joints = walks(1, np.random.default_rng(number))[0, :frames]
    joints[..., 2] += np.linspace(WALL - 1, WALL, frames, dtype=np.float32)[:, None] - joints[:, 12:13, 2]
    points = np.arange(frames) if touched else None
    return ShownMotion(joints, {"path": 1.0 + number, "off": 0.5 / (1 + number), "foot_skate": float("nan")}, points)


def window(name: str = "room 1", rows: tuple[str, ...] = ("ours",), samples: int = 3) -> ShownWindow:
    """A window with so many motions in each row."""
    picture = np.zeros((180, 300, 3), np.uint8)
    picture[..., 0], picture[..., 1] = np.linspace(40, 90, 300), np.linspace(90, 60, 180)[:, None]
    made = tuple(
        ShownRow(row, tuple(motion(10 * place + number) for number in range(samples))) for place, row in enumerate(rows)
    )
    camera = INTRINSICS * np.array([[3.0], [3.0], [1.0]])
    return ShownWindow(name, picture, camera, scene().hidden, made, motion(99), scene(), floor=-1.2)
