"""Colours of samples and of times, and how their bodies are lit."""

from __future__ import annotations

import matplotlib
import numpy as np
from jaxtyping import Float

from sag.viewer.body import SAMPLE_COLOURS

TIME = matplotlib.colormaps["plasma"]
"""Of the frames of a motion, from dark to bright."""

DARKEST = 0.12
"""Where on the map time begins; what is darker does not show on dark floors."""


def sample_colour(number: int) -> Float[np.ndarray, " 3"]:
    """Red, green and blue in [0, 1] of a sample, counted from 0."""
    return np.array(matplotlib.colors.to_rgb(SAMPLE_COLOURS[number % len(SAMPLE_COLOURS)]))


def time_colour(share: float) -> Float[np.ndarray, " 3"]:
    """Red, green and blue in [0, 1] of a time, 0 the first frame and 1 the last."""
    return np.array(TIME(DARKEST + (0.97 - DARKEST) * share)[:3])


def lit(
    albedo: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    looks: Float[np.ndarray, "n 3"],
    up: Float[np.ndarray, " 3"],
    sun: Float[np.ndarray, " 3"],
) -> Float[np.ndarray, "n 3"]:
    """Colours in [0, 1] of points of bodies, as the viewer lights them: sky, sun, a soft rim and a dark outline.

    Args:
        albedo: own colours in [0, 1].
        normals: of length 1, outward.
        looks: directions from the eye, of length 1.
        up: against gravity, in the same frame.
        sun: direction to the light, of length 1.
    """
    facing = np.maximum(-(normals * looks).sum(axis=1), 0)[:, None]
    sky = 0.5 + 0.5 * (normals @ up)[:, None]
    key = np.maximum(0, (normals @ sun)[:, None] * 0.85 + 0.15)
    light = (1 - sky) * np.array([0.20, 0.19, 0.18]) + sky * np.array([0.62, 0.64, 0.68])
    half = sun - looks
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-9)
    glint = np.maximum((normals * half).sum(axis=1), 0)[:, None] ** 36
    made = albedo**2.2 * (light + 0.62 * key + 0.18 * facing) + 0.16 * glint + 0.10 * sky * (1 - facing) ** 3
    edge = np.clip(facing / 0.32, 0, 1)
    return np.clip(made * (0.55 + 0.45 * edge**2 * (3 - 2 * edge)), 0, 1) ** (1 / 2.2)
