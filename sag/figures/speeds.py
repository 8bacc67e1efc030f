"""How fast people move: a histogram for each row beside the recorded motions, in which mode collapse shows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float
from torch import Tensor

from sag.report.plot import INK

STANDS = 0.1
"""Metres a second; whoever's root moves slower over a motion stands or sits."""

BIN = 0.1
"""Metres a second."""

ACCENT = "#2a78b5"


def speeds(roots: Float[Tensor, "n t 3"], fps: float) -> Float[np.ndarray, " n"]:
    """Mean speed of the root over each motion, metres a second."""
    return (roots.diff(dim=1).norm(dim=-1).mean(dim=1) * fps).numpy()


def summary(rows: Mapping[str, np.ndarray], truth: np.ndarray) -> str:
    """A line for each row: motions, who stands, the median, and how far the speeds are from the recorded ones."""
    from scipy.stats import wasserstein_distance

    width = max(map(len, rows))
    lines = [f"{'':{width}}      n  stand %  median m/s  distance m/s"]
    for name, found in rows.items():
        stand, distance = 100 * float((found < STANDS).mean()), wasserstein_distance(found, truth)
        lines.append(f"{name:{width}}  {len(found):5d}  {stand:7.1f}  {np.median(found):10.2f}  {distance:12.3f}")
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
        place.hist(found, edges, weights=np.full(len(found), 100 / len(found)), color=ACCENT, alpha=0.75)
        place.hist(truth, edges, weights=np.full(len(truth), 100 / len(truth)), histtype="step", color=INK, lw=1.2)
        stand = 100 * (found < STANDS).mean()
        place.set_title(f"{name}: {stand:.0f} % stand", fontsize=10, fontweight="bold", loc="left")
    for place in list(grid.flat)[len(rows) :]:
        place.set_axis_off()
    canvas.supxlabel("mean speed of the root over a motion, m/s", fontsize=10)
    canvas.supylabel("% of motions", fontsize=10)
    title = f"outline: recorded motions, {100 * (truth < STANDS).mean():.0f} % stand; N = {len(truth)} windows"
    canvas.suptitle(title, fontsize=10, x=0.99, ha="right")
    return canvas
