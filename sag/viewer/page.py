"""The page: one HTML file with data, style and scripts in it, and a policy that forbids it the network."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sag.skeleton import Skeleton
from sag.viewer.assembly import assembled, asset, script_of
from sag.viewer.body import links_of
from sag.viewer.figures import COLUMNS, TOUCH
from sag.viewer.packing import packed, packed_picture, packed_places, script_json
from sag.viewer.shown import ShownMotion, ShownScene, ShownWindow, check_windows
from sag.viewer.surface import empty_picture, grid_of

SCRIPTS = ("touches", "table", "controls", "labels", "player")
"""Modules of the page's script after those that draw, in the order in which they are joined."""

MOST_CELLS = 150_000
"""Of the surfaces of a window: all that 288 x 512 pixels have."""

ALL_CELLS = 600_000
"""Of all windows of a page together; where there are many, each has fewer, though at least a twentieth of that."""


def page(windows: Sequence[ShownWindow], skeleton: Skeleton, fps: float, title: str = "Motions in their scene") -> str:
    """An HTML file that shows motions in their scenes; it asks for nothing from anywhere.

    Joints are rounded to steps of under a millimetre, depth to millimetres on a grid that gets coarser with the
    number of windows, pictures are JPEG.

    Args:
        windows: what is shown, one at a time.
        skeleton: of the joints.
        fps: frames a second.
        title: of the page.

    Raises:
        SagError: there is nothing to show, or a motion cannot be, see `sag.viewer.shown.check_windows`.
    """
    check_windows(list(windows), len(skeleton.joints))
    content = {
        **content_of(skeleton, fps),
        "title": title,
        "columns": [column._asdict() for column in COLUMNS],
        "windows": [window_content(window, cells_of(len(windows))) for window in windows],
    }
    return assembled(asset("page.html"), asset("style.css"), script_of(SCRIPTS), title, data=script_json(content))


def cells_of(windows: int) -> int:
    """Cells of the surfaces of each window of a page with so many."""
    return int(np.clip(ALL_CELLS // windows, ALL_CELLS // 20, MOST_CELLS))


def content_of(skeleton: Skeleton, fps: float) -> dict[str, Any]:
    """What a page's script knows of all motions: time, joints, and the body around them."""
    return {
        "fps": float(fps),
        "touch": TOUCH,
        "root": skeleton.root_index,
        "joints": len(skeleton.joints),
        "bones": skeleton.bone_index.tolist(),
        "links": [list(link) for link in links_of(skeleton)],
    }


def window_content(window: ShownWindow, cells: int) -> dict[str, Any]:
    """A window as a page's script reads it.

    Args:
        window: with everything that is shown of it.
        cells: of its surfaces, at most.
    """
    return {
        "name": window.name,
        "picture": packed_picture(window.picture),
        "size": [window.picture.shape[1], window.picture.shape[0]],
        "camera": _camera(window.intrinsics),
        "up": [float(value) for value in window.up],
        "floor": float(window.floor),
        "guessed": window.guessed,
        "scene": None if window.scene is None else _scene(window, window.scene, cells),
        "truth": None if window.truth is None else _motion(window.truth),
        "rows": [{"name": row.name, "motions": [_motion(motion) for motion in row.motions]} for row in window.rows],
    }


def _scene(window: ShownWindow, scene: ShownScene, cells: int) -> dict[str, Any]:
    grid = grid_of(scene, cells)
    return {
        "colours": packed_picture(empty_picture(window.picture, window.person)),
        "depth": packed(grid.depth),
        "shape": list(grid.depth.shape),
        "stride": grid.stride,
        "camera": _camera(scene.intrinsics),
    }


def _motion(motion: ShownMotion) -> dict[str, Any]:
    touched = None if motion.touched is None else packed(motion.touched.clip(0, 65535).astype(np.uint16))
    figures = {key: float(value) for key, value in motion.figures.items()}
    return {"joints": packed_places(motion.joints), "figures": figures, "touched": touched}


def _camera(intrinsics: np.ndarray) -> list[float]:
    """Focal lengths and centre, pixels."""
    return [float(intrinsics[place]) for place in ((0, 0), (1, 1), (0, 2), (1, 2))]
