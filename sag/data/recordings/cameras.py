"""What no camera of any data set can be."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

WORLD = 1e5
"""Farthest that anything lies from the world's origin, metres."""

TOLERANCE = 1e-3
"""How far a rotation may be from an orthonormal matrix, in any of its numbers."""


def improper(turns: Float[np.ndarray, "t 3 3"]) -> Bool[np.ndarray, " t"]:
    """Which matrices are no rotations, but mirror or stretch."""
    products = turns @ turns.swapaxes(1, 2)
    return (np.abs(products - np.eye(3)) > TOLERANCE).any(axis=(1, 2)) | (np.linalg.det(turns) < 0)
