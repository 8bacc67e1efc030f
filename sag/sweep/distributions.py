"""What a parameter of a sweep may be: W&B's distributions, those that an experiment here needs.

Read here: https://docs.wandb.ai/guides/sweeps/sweep-config-keys
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

DIGITS = 4
"""Digits of a number that is drawn: more would only make the names of rows long."""


@dataclass(frozen=True)
class Choice:
    """Some values, each as likely: W&B's `value`, `values`.

    Attributes:
        values: what can be chosen.
    """

    values: tuple[Any, ...]

    def draw(self, chance: random.Random) -> Any:
        """One of the values."""
        return chance.choice(self.values)

    def holds(self, value: Any) -> bool:
        """Whether this value can be drawn."""
        return value in self.values


@dataclass(frozen=True)
class Integers:
    """Whole numbers, each as likely: W&B's `int_uniform`.

    Attributes:
        low: the least.
        high: the greatest.
    """

    low: int
    high: int

    def draw(self, chance: random.Random) -> int:
        """One of the numbers."""
        return chance.randint(self.low, self.high)

    def holds(self, value: Any) -> bool:
        """Whether this value can be drawn."""
        return isinstance(value, int) and self.low <= value <= self.high


@dataclass(frozen=True)
class Uniform:
    """Numbers of an interval, each as likely: W&B's `uniform`; or each magnitude as likely: `log_uniform_values`.

    Attributes:
        low: the least.
        high: the greatest.
        logarithmic: whether magnitudes are as likely as each other.
    """

    low: float
    high: float
    logarithmic: bool = False

    def draw(self, chance: random.Random) -> float:
        """One of the numbers."""
        if not self.logarithmic:
            return self.rounded(chance.uniform(self.low, self.high))
        return self.rounded(math.exp(chance.uniform(math.log(self.low), math.log(self.high))))

    def rounded(self, value: float) -> float:
        """The number with few digits, still in the interval."""
        return min(max(float(f"{value:.{DIGITS}g}"), self.low), self.high)

    def holds(self, value: Any) -> bool:
        """Whether this value can be drawn."""
        return isinstance(value, (int, float)) and self.low <= value <= self.high


Distribution = Choice | Integers | Uniform

KEYS = {
    "constant": {"value"},
    "categorical": {"values"},
    "int_uniform": {"min", "max"},
    "uniform": {"min", "max"},
    "log_uniform_values": {"min", "max"},
}
"""Keys of each distribution, by W&B's name of it."""


def read_distribution(given: Any) -> Distribution:
    """The distribution that a parameter of a sweep file describes.

    Raises:
        ValueError: it is none that is known here; the message says why.
    """
    keys = dict(given) if isinstance(given, dict) else {}
    kind = keys.pop("distribution", None) or _kind(keys)
    if kind not in KEYS or set(keys) != KEYS[kind]:
        raise ValueError(f"must be {{value: x}}, {{values: [x, y]}} or {{min: x, max: y}}, found {given!r}")
    if kind == "constant":
        return Choice((keys["value"],))
    if kind == "categorical":
        if not isinstance(keys["values"], list) or not keys["values"]:
            raise ValueError(f"must have at least one of its values in a list, found {given!r}")
        return Choice(tuple(keys["values"]))
    return _interval(kind, keys["min"], keys["max"])


def _kind(keys: dict[str, Any]) -> str | None:
    """W&B's rule where no distribution is named: whole bounds mean whole numbers."""
    if set(keys) == {"min", "max"}:
        return "int_uniform" if all(isinstance(bound, int) for bound in keys.values()) else "uniform"
    return next((kind for kind in ("constant", "categorical") if set(keys) == KEYS[kind]), None)


def _interval(kind: str, low: Any, high: Any) -> Distribution:
    for bound in (low, high):
        if not isinstance(bound, (int, float)) or isinstance(bound, bool):
            raise ValueError(f"has the bound {bound!r}, which YAML does not read as a number; write it like 1.0e-4")
    if not low < high:
        raise ValueError(f"has the bounds {low} and {high}; 'min' must be less than 'max'")
    if kind == "int_uniform":
        if not (isinstance(low, int) and isinstance(high, int)):
            raise ValueError(f"is int_uniform with the bounds {low} and {high}; both must be whole numbers")
        return Integers(low, high)
    if kind == "log_uniform_values" and low <= 0:
        raise ValueError(f"is log_uniform_values from {low}; 'min' must be above 0")
    return Uniform(float(low), float(high), logarithmic=kind == "log_uniform_values")
