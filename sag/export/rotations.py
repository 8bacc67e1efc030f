"""Rotations that bring directions onto others, frame by frame."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from sag.geometry.kinematics import unit

OPPOSITE = 1e-9
"""Two directions whose cosine is nearer to -1 than this have no single shortest arc."""

STAYING = 1e-3
"""Weight of not turning in a best fit: it decides what directions in one line, or none, leave open."""


def shortest_arc(start: Float[np.ndarray, 3], ends: Float[np.ndarray, "t 3"]) -> Float[np.ndarray, "t 3 3"]:
    """The least rotations that turn one direction into others, without a twist.

    Args:
        start: of length 1.
        ends: of length 1; for one of length 0 nothing turns, for the opposite of the start half a turn is made.
    """
    cosine = ends @ start
    axis = np.cross(start, ends)
    cross = np.cross(axis[:, None, :], np.eye(3)).swapaxes(1, 2)  # cross @ v = axis x v
    turned = np.eye(3) + cross + cross @ cross / np.maximum(1 + cosine, OPPOSITE)[:, None, None]
    aside = unit(np.cross(start, np.eye(3)[np.argmin(np.abs(start))]))
    half_turn = 2 * np.outer(aside, aside) - np.eye(3)
    return np.where((1 + cosine < OPPOSITE)[:, None, None], half_turn, turned)


def best_fit(starts: Float[np.ndarray, "k 3"], ends: Float[np.ndarray, "t k 3"]) -> Float[np.ndarray, "t 3 3"]:
    """The rotations that bring several directions nearest to others, by least squares (Kabsch, 1976).

    Args:
        starts: of length 1.
        ends: of length 1, or 0 for those that do not count.
    """
    together = np.einsum("tki,kj->tij", ends, starts) + STAYING * np.eye(3)
    left, _, right = np.linalg.svd(together)
    proper = np.ones((len(ends), 3))
    proper[:, 2] = np.linalg.det(left @ right)
    return left * proper[:, None, :] @ right


def turning(starts: Float[np.ndarray, "k 3"], ends: Float[np.ndarray, "t k 3"]) -> Float[np.ndarray, "t 3 3"]:
    """Rotations of a joint with bones in these directions: exact for one bone, the best fit for more, else none."""
    if not len(starts):
        return np.broadcast_to(np.eye(3), (len(ends), 3, 3))
    if len(starts) == 1:
        return shortest_arc(starts[0], ends[:, 0])
    return best_fit(starts, ends)
