"""Units of length of files that do not tell theirs."""

from __future__ import annotations

from typing import Literal

Unit = Literal["cm", "m"]
"""Centimetres, as MotionBuilder expects, or metres."""

UNITS: dict[Unit, float] = {"cm": 0.01, "m": 1.0}
"""Metres of each."""
