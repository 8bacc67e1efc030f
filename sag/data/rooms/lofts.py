"""Round surfaces as lofts through rings."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from sag.geometry.kinematics import unit

AROUND = 10
"""Corners of the ring around a limb."""

RING = np.stack([f(np.arange(AROUND) * 2 * np.pi / AROUND) for f in (np.cos, np.sin)], axis=-1)
_CAPS = np.deg2rad([0, 35, 70])


def loft(rings: Float[np.ndarray, "r k 3"]) -> Float[np.ndarray, "n 3 3"]:
    """The closed surface through rings of as many corners each: first cap, sides from ring to ring, last cap."""
    following = np.roll(rings, -1, axis=1)
    sides = np.concatenate(
        [
            np.stack([rings[:-1], following[:-1], rings[1:]], axis=2),
            np.stack([following[:-1], following[1:], rings[1:]], axis=2),
        ],
        axis=1,
    ).reshape(-1, 3, 3)
    caps = []
    for ring in (rings[0], rings[-1]):
        middle = np.broadcast_to(ring.mean(axis=0), ring.shape)
        caps.append(np.stack([middle, ring, np.roll(ring, -1, axis=0)], axis=1))
    return np.concatenate([caps[0], sides, caps[1]])


def tapered(start: Float[np.ndarray, " 3"], end: Float[np.ndarray, " 3"], first: float, last: float) -> np.ndarray:
    """Triangles of a round-ended limb with these radii (metres) at its ends."""
    along = unit(end - start)
    aside = unit(np.cross(along, [0.3, 0.5, 0.81] if abs(along[2]) > 0.9 else [0, 0, 1.0]))
    other = np.cross(along, aside)
    around = RING[:, :1] * aside + RING[:, 1:] * other
    near = [start + first * (np.cos(a) * around - np.sin(a) * along) for a in _CAPS[:0:-1]]
    far = [end + last * (np.cos(a) * around + np.sin(a) * along) for a in _CAPS[1:]]
    return loft(np.stack([*near, start + first * around, end + last * around, *far]))


def ellipsoid(middle: np.ndarray, axes: Float[np.ndarray, "3 3"], radii: Float[np.ndarray, " 3"]) -> np.ndarray:
    """Triangles of an ellipsoid with these axes (rows, of length 1) and radii (metres)."""
    rings = []
    for angle in np.linspace(-0.44 * np.pi, 0.44 * np.pi, 8):
        flat = np.cos(angle) * (RING[:, :1] * radii[0] * axes[0] + RING[:, 1:] * radii[1] * axes[1])
        rings.append(middle + flat + np.sin(angle) * radii[2] * axes[2])
    return loft(np.stack(rings))
