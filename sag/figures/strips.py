"""The figure: pictures in lines and columns, names above them, time's colours below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np

from sag.film.colours import time_colour
from sag.film.stage import Stage
from sag.film.strip import strip

WIDTH = 13.0
"""Inches of the whole figure; fewer where there are few columns."""

WIDEST = 4.6
"""Inches of a picture."""

COLUMNS = 960
"""Pixels of a picture across, at most."""


@dataclass(frozen=True)
class Panel:
    """A picture of the figure.

    Attributes:
        title: of its column.
        stage: what it shows.
    """

    title: str
    stage: Stage


def strips_of(lines: Sequence[Sequence[Panel]], poses: int) -> Any:
    """A matplotlib figure.

    Args:
        lines: the pictures of each scene; the titles of the first line head the columns.
        poses: of each motion in a picture.
    """
    from matplotlib.figure import Figure

    pictures = [[strip(panel.stage, COLUMNS, poses) for panel in line] for line in lines]
    across = len(pictures[0])
    wide = min(WIDEST, WIDTH / across)
    heights = [max(picture.shape[0] / picture.shape[1] for picture in line) * wide for line in pictures]
    canvas = Figure(figsize=(wide * across, sum(heights) + 0.75), layout="constrained")
    layout: Any = canvas.get_layout_engine()
    layout.set(w_pad=0.02, h_pad=0.02, wspace=0, hspace=0)
    grid = canvas.subplots(len(pictures), across, squeeze=False, height_ratios=heights)
    for line, panels, axes in zip(pictures, lines, grid):
        for picture, panel, place in zip(line, panels, axes):
            place.imshow(picture, interpolation="none")
            place.set_axis_off()
            if line is pictures[0]:
                place.set_title(panel.title, fontsize=11, fontweight="bold", pad=4)
    _add_time(canvas, grid, lines[0][0].stage)
    return canvas


def _add_time(canvas: Any, grid: np.ndarray, stage: Stage) -> None:
    """The colours of time, in seconds."""
    colours = matplotlib.colors.ListedColormap([time_colour(share) for share in np.linspace(0, 1, 256)])
    seconds = matplotlib.colors.Normalize(0, (stage.frames - 1) / stage.fps)
    scale = matplotlib.cm.ScalarMappable(seconds, colours)
    bar = canvas.colorbar(scale, ax=grid, location="bottom", shrink=0.4, aspect=50, pad=0.01)
    bar.set_label("seconds after the given pose", fontsize=9)
    bar.ax.tick_params(labelsize=9)
    bar.outline.set_visible(False)
