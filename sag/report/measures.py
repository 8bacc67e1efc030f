"""Measures: the figures on which rows and letters are compared, each on its scale and with its better side."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sag.report.columns import ARROWS
from sag.report.statistics import Estimate


@dataclass(frozen=True)
class Measure:
    """A figure that is compared.

    Attributes:
        name: as tables and plots call it.
        metric: the figure.
        better: the better side.
        unit: of a difference, when it is printed.
        factor: to that unit.
        digits: behind the point.
        is_ratio: whether it is compared on the logarithmic scale, so that a difference is a ratio.
    """

    name: str
    metric: str
    better: Literal["lower", "higher"] = "lower"
    unit: str = ""
    factor: float = 1.0
    digits: int = 3
    is_ratio: bool = False

    @property
    def label(self) -> str:
        """The name with its unit and an arrow to the better side."""
        return " ".join(filter(None, (self.name, self.unit, ARROWS[self.better])))

    def scaled(self, value: float) -> float:
        """A figure on the scale on which it is compared; NaN where it has no logarithm."""
        if not self.is_ratio:
            return value
        return math.log(value) if value > 0 else math.nan

    def shown(self, difference: float) -> float:
        """A difference as it is printed: a ratio, or in the unit."""
        return float(np.exp(min(difference, 700.0))) if self.is_ratio else difference * self.factor

    def written(self, difference: float) -> str:
        """A difference as a table shows it: `×0.450`, or with its sign."""
        return f"×{self._number(difference)}" if self.is_ratio else self._number(difference, "+")

    def interval(self, estimate: Estimate) -> str:
        """The interval of a difference; a dash where it has none."""
        if estimate.low is None or estimate.high is None:
            return "–"
        return f"[{self._number(estimate.low)}, {self._number(estimate.high)}]"

    def verdict(self, estimate: Estimate) -> Literal["better", "worse", ""]:
        """To which side the interval points, if it excludes no difference."""
        if not estimate.excludes_zero:
            return ""
        return "better" if (estimate.value < 0) == (self.better == "lower") else "worse"

    def record(self, estimate: Estimate) -> dict[str, object]:
        """A difference for a CSV file: a ratio, or in the figure's own unit."""
        ends = (estimate.value, estimate.low, estimate.high)
        plain = (None if end is None else self.shown(end) / self.factor for end in ends)
        scale = "ratio" if self.is_ratio else "difference"
        return {"measure": self.metric, "scale": scale, **dict(zip(("estimate", "low", "high"), plain))}

    def _number(self, difference: float, sign: str = "-") -> str:
        shown = self.shown(difference)
        if self.is_ratio:
            return f"{shown:.{self.digits}f}" if shown < 10 else f"{shown:.3g}"
        return f"{round(shown, self.digits) + 0.0:{sign}.{self.digits}f}"  # never -0.000


MOTION_FID = Measure("Motion FID", "motion_fid/average", is_ratio=True)
VELOCITY = Measure("velocity Fréchet", "velocity_frechet", is_ratio=True)
NON_COLLISION = Measure("non-collision", "non_collision/average", "higher")
AWARENESS = Measure("collisions, own / other scenes", "collisions/ratio")
INSIDE = Measure("inside furniture", "penetration/share", unit="%", factor=100.0, digits=2)
FLOOR = Measure("feet off the floor", "floor/error", unit="mm", factor=1000.0, digits=1)
SCALE = Measure("scale (bone drift)", "bone_drift", unit="%", factor=100.0, digits=2)
DEPTH = Measure("depth error", "depth_error/abs_rel", digits=4)
PROBE = Measure("error of depth read off f", "depth_probe/rmse", unit="m", digits=4)

MEASURES = (
    MOTION_FID,
    VELOCITY,
    NON_COLLISION,
    AWARENESS,
    INSIDE,
    Measure("root inside", "penetration/root", unit="%", factor=100.0, digits=2),
    FLOOR,
    Measure("sunk", "floor/sunk", unit="mm", factor=1000.0, digits=1),
    Measure("floating", "floor/floating", unit="mm", factor=1000.0, digits=1),
    SCALE,
    Measure("foot skate", "foot_skate", unit="m/s"),
    DEPTH,
    PROBE,
)
"""On what the letters are compared; a figure that no row has is left out."""

OWN: tuple[tuple[str, Measure], ...] = (
    ("separate", MOTION_FID),
    ("depth", AWARENESS),
    ("depth", PROBE),
    ("projection", FLOOR),
    ("projection", SCALE),
    ("context", INSIDE),
)
"""What each component is for, so that it should move there: the same for every report, whatever its figures."""
