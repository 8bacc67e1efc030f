"""How fast people move: a histogram for each row beside the recorded motions, in which mode collapse shows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float
from torch import Tensor

from sag.metrics.motion.smoothness import mean_derivative
from sag.report.plot import COLOURS, INK

STANDS = 0.1
"""Metres a second; whoever's root moves slower over a motion stands or sits."""

BIN = 0.1
"""Metres a second."""


def speeds(roots: Float[Tensor, "n t 3"], fps: float) -> Float[np.ndarray, " n"]:
    """Mean speed of the root over each motion, metres a second."""
    return mean_derivative(roots[:, :, None], 1, fps).numpy()


def standing(found: np.ndarray) -> float:
    """Share of the motions that stand, per cent."""
    return 100 * float((found < STANDS).mean())


def summary(rows: Mapping[str, np.ndarray], truth: np.ndarray) -> str:
    """A line for each row: motions, who stands, the median, and how far the speeds are from the recorded ones."""
    from scipy.stats import wasserstein_distance

    width = max(map(len, rows))
    lines = [f"{'':{width}}      n  stand %  median m/s  distance m/s"]
    for name, found in rows.items():
        distance = wasserstein_distance(found, truth)
        lines.append(
            f"{name:{width}}  {len(found):5d}  {standing(found):7.1f}  {np.median(found):10.2f}  {distance:12.3f}"
        )
    lines.append(f"stand: mean root speed under {STANDS} m/s; distance: Wasserstein-1 to the recorded motions' speeds")
    return "\n".join(lines)


def histogram_of(rows: Mapping[str, np.ndarray], truth: np.ndarray) -> Any:
    """A matplotlib figure with a panel for each row, the recorded motions outlined in each.

    Args:
        rows: speeds of each row's motions, metres a second.
        truth: of the recorded ones.
    """
    from matplotlib.figure import Figure

    across = min(3, len(rows))
    down = -(-len(rows) // across)
    canvas = Figure(figsize=(1.2 + 3.4 * across, 0.9 + 2.0 * down), layout="constrained")
    most = max(float(found.max()) for found in (truth, *rows.values()))
    edges = np.arange(0, most + 2 * BIN, BIN)
    grid = canvas.subplots(down, across, sharex=True, sharey=True, squeeze=False)
    for place, (name, found) in zip(grid.flat, rows.items()):
        place.hist(found, edges, weights=np.full(len(found), 100 / len(found)), color=COLOURS["with"], alpha=0.75)
        place.hist(truth, edges, weights=np.full(len(truth), 100 / len(truth)), histtype="step", color=INK, lw=1.2)
        place.set_title(f"{name}: {standing(found):.0f} % stand", fontsize=10, fontweight="bold", loc="left")
    for place in list(grid.flat)[len(rows) :]:
        place.set_axis_off()
    canvas.supxlabel("mean speed of the root over a motion, m/s", fontsize=10)
    canvas.supylabel("% of motions", fontsize=10)
    title = f"outline: recorded motions, {standing(truth):.0f} % stand; N = {len(truth)} windows"
    canvas.suptitle(title, fontsize=10, x=0.99, ha="right")
    return canvas
