"""How fast people go along a way, and where they look on it."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

ACCELERATION = 1.0
"""Of walkers who set off and stop, metres a second squared."""

LATERAL = 1.1
"""Greatest acceleration to the side in bends, metres a second squared."""


def eased(count: int) -> Float[np.ndarray, " count"]:
    """From 0 to 1 with zero speed and acceleration at both ends."""
    t = np.linspace(0, 1, count)
    return t**3 * (10 - 15 * t + 6 * t**2)


def directions(way: Float[np.ndarray, "n 2"], heading: float) -> Float[np.ndarray, " n"]:
    """Direction of the way at each point, radians, smooth and without jumps from the heading on."""
    step = np.gradient(way, axis=0)
    angle = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    angle += 2 * np.pi * np.round((heading - angle[0]) / (2 * np.pi))
    return gaussian_filter1d(angle, 3, mode="nearest")


def passing_times(
    length: Float[np.ndarray, " n"], direction: Float[np.ndarray, " n"], speed: float, moving: bool, stopping: bool
) -> Float[np.ndarray, " n"]:
    """When each point of a way is passed, seconds: slower in bends, at rest at the ends that ask for it."""
    bend = np.abs(np.gradient(direction, length))
    fastest = np.minimum(speed, np.sqrt(LATERAL / np.maximum(bend, 1e-6)))
    slowest = 0.12
    if not moving:
        fastest[0] = slowest
    if stopping:
        fastest[-1] = slowest
    step = np.diff(length)
    for order in (range(1, len(length)), range(len(length) - 2, -1, -1)):
        ahead = order.step
        for i in order:
            gap = step[min(i, i - ahead)]
            fastest[i] = min(fastest[i], np.sqrt(fastest[i - ahead] ** 2 + 2 * ACCELERATION * gap))
    return np.concatenate([[0], np.cumsum(2 * step / (fastest[1:] + fastest[:-1]))])
