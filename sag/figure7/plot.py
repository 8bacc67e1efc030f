"""The plot of Figure 7: deviation over time, and pictures with the trajectories drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import torch

from sag.figure7.examples import Example
from sag.figure7.spread import TRAJECTORIES, Spread
from sag.report.plot import GRID, INK, STYLE

CURVES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's, a colour for each run."""

PATHS = ("#F0E442", "#56B4E9", "#E69F00", "#CC79A7", "#00C08B")
"""Five that show on a picture, a colour for each trajectory."""

LEAST_SHOWN = 0.55
"""Share of a picture's width that is shown at least, around the trajectories."""


def plot_of(spreads: Sequence[Spread], examples: Sequence[Example], protocol: dict[str, Any]) -> Any:
    """A matplotlib figure: the curves above, below them a row of pictures for each run."""
    from matplotlib.figure import Figure as Canvas

    rows, columns = examples[0].image.shape[:2]
    width = 11.5
    height = (width - 1) / len(examples) * rows / columns + 0.12
    with matplotlib.rc_context(STYLE):
        canvas = Canvas(figsize=(width, 4.2 + height * len(spreads)), layout="constrained")
        halves: Any = canvas.subfigures(2, 1, height_ratios=[4.2, height * len(spreads)])
        _curves(halves[0].subplots(), spreads, protocol)
        grid = halves[1].subplots(len(spreads), len(examples), squeeze=False)
        for place, spread in enumerate(spreads):
            for axes, example in zip(grid[place], examples):
                _picture(axes, example, place)
            grid[place][0].set_ylabel(spread.name, color=CURVES[place % len(CURVES)], fontweight="bold")
    return canvas


def _curves(axes: Any, spreads: Sequence[Spread], protocol: dict[str, Any]) -> None:
    """A line for each run: the mean over windows; the band around it holds the middle half of them."""
    fps = protocol["data"]["fps"]
    for place, spread in enumerate(spreads):
        colour, seconds = CURVES[place % len(CURVES)], torch.arange(len(spread.curve)) / fps
        low, high = torch.quantile(spread.deviations, torch.tensor([0.25, 0.75]).double(), dim=0)
        axes.fill_between(seconds, low, high, color=colour, alpha=0.15, linewidth=0)
        axes.plot(seconds, spread.curve, color=colour, linewidth=2.2, label=_label(spread))
    axes.set_title(
        f"Standard deviation over time of {TRAJECTORIES} trajectories with the same start and end point\n",
        fontweight="bold", fontsize=12, loc="left",
    )  # fmt: skip
    drawn = f"{TRAJECTORIES} of {protocol['samples']} drawn" if any(not s.told for s in spreads) else "told"
    axes.text(
        0, 1.02, f"mean over {protocol['windows']} test windows of {protocol['data']['name']}, band: the middle half "
        f"of them; end point: the {protocol['end']} one, {drawn}",
        transform=axes.transAxes, fontsize=9, color=INK,
    )  # fmt: skip
    axes.set_xlabel("time (s)")
    axes.set_ylabel("standard deviation (m)")
    axes.set_xlim(0, (len(spreads[0].curve) - 1) / fps)
    top = axes.get_ylim()[1]
    axes.set_ylim(-0.02 * top, 1.12 * top)
    axes.grid(axis="y", color=GRID, alpha=0.3, linewidth=0.8)
    axes.legend(frameon=False, loc="upper left")


def _label(spread: Spread) -> str:
    if spread.told:
        return f"{spread.name} ({spread.kind}, told the end point{'' if spread.curve.any() else ': exactly 0'})"
    return f"{spread.name} ({spread.kind}; ends within {spread.misses.median():.2f} m of it, median)"


def _picture(axes: Any, example: Example, run: int) -> None:
    """The picture with the trajectories of a run, the start as a ring, the common end as a cross."""
    rows, columns = example.image.shape[:2]
    axes.imshow(example.image, extent=(0, columns, rows, 0), interpolation="lanczos")
    paths = example.trajectories[run]
    for path, colour in zip(paths, PATHS):
        axes.plot(*path.T, color="black", linewidth=2.4, alpha=0.4)
        axes.plot(*path.T, color=colour, linewidth=1.4)
    axes.plot(*paths[0][0], "o", markersize=7, markerfacecolor="none", markeredgecolor="white", markeredgewidth=1.5)
    axes.plot(*example.end, "x", markersize=8, markeredgewidth=2, color="white")
    left, right, top, bottom = _shown(example)
    axes.set(xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[])
    axes.spines["bottom"].set_visible(False)


def _shown(example: Example) -> tuple[float, float, float, float]:
    """Left, right, top and bottom of the part of a picture that holds the trajectories of all runs, with its shape."""
    size = np.array(example.image.shape[1::-1], dtype=float)
    places = np.concatenate([paths.reshape(-1, 2) for paths in example.trajectories])
    low, high = places.min(axis=0).clip(0, size), places.max(axis=0).clip(0, size)
    share = min(1.0, max(LEAST_SHOWN, 1.3 * float(((high - low) / size).max())))
    left, top = ((low + high) / 2 - share * size / 2).clip(0, (1 - share) * size)
    return float(left), float(left + share * size[0]), float(top), float(top + share * size[1])
