"""Figure 7 as numbers: a JSON with everything, a table of the curves."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Any

from sag.figure7.spread import Spread

TIMES = (0.5, 1.0, 1.5, 2.0)
"""Seconds at which the terminal shows the deviation."""


def content_of(spreads: Sequence[Spread], protocol: dict[str, Any]) -> dict[str, Any]:
    """All figures, metres, and what they were measured with."""
    return {**protocol, "unit": "m", "methods": [_method(spread, protocol["data"]["fps"]) for spread in spreads]}


def _method(spread: Spread, fps: float) -> dict[str, Any]:
    curve, misses = spread.curve, spread.misses
    frames = {time: round(time * fps) for time in TIMES}
    return {
        "run": spread.name,
        "method": spread.kind,
        "told_the_end": spread.told,
        "deviation": curve.tolist(),
        "deviation_at": {f"{time:g}": float(curve[frame]) for time, frame in frames.items() if frame < len(curve)},
        "mean": float(curve[1:].mean()),
        "largest": float(curve.max()),
        "end_off_by": {"median": float(misses.median()), "max": float(misses.max())},
    }


def spreadsheet(spreads: Sequence[Spread], fps: float) -> str:
    """The curves as CSV: frame, seconds, and the deviation of each run in metres."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(("frame", "seconds", *(spread.name for spread in spreads)))
    for frame, values in enumerate(zip(*(spread.curve.tolist() for spread in spreads))):
        lines.writerow((frame, f"{frame / fps:.4f}", *(f"{value:.6g}" for value in values)))
    return text.getvalue()
