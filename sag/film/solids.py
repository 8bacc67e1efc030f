"""Capsules whose ends may differ in size, met by rays: https://iquilezles.org/articles/intersectors/ (rounded cone)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class Met(NamedTuple):
    """Where rays from the origin meet a solid.

    Attributes:
        distance: along rays of length 1, infinite where they miss.
        normal: of the surface there, outward, of any length.
    """

    distance: Float[np.ndarray, " n"]
    normal: Float[np.ndarray, "n 3"]


def rounded_cone(
    rays: Float[np.ndarray, "n 3"],
    start: Float[np.ndarray, " 3"],
    end: Float[np.ndarray, " 3"],
    start_radius: float,
    end_radius: float,
) -> Met:
    """Rays from the origin against two balls and the cone that touches both.

    Args:
        rays: of length 1.
        start: centre of a ball, metres.
        end: centre of the other, metres.
        start_radius: metres.
        end_radius: metres.
    """
    along, rise = end - start, start_radius - end_radius
    square = float(along @ along)
    if square <= rise**2:  # one ball holds the other
        return _ball(rays, start if rise > 0 else end, max(start_radius, end_radius))
    side = square - rise**2
    m1, m2, m3 = -float(along @ start), rays @ along, -(rays @ start)
    m5 = float(start @ start)
    k2 = side - m2**2
    k1 = side * m3 - m1 * m2 + m2 * rise * start_radius
    k0 = side * m5 - m1**2 + 2 * m1 * rise * start_radius - square * start_radius**2
    root = k1**2 - k0 * k2
    meeting = np.flatnonzero(root >= 0)  # others miss the cone, and the balls lie in it
    distance, normal = np.full(len(rays), np.inf), np.zeros((len(rays), 3))
    if len(meeting):
        rays, m2, k1, k2, root = rays[meeting], m2[meeting], k1[meeting], k2[meeting], root[meeting]
        with np.errstate(divide="ignore", invalid="ignore"):
            far = (-np.sqrt(root) - k1) / k2
            share = m1 - start_radius * rise + far * m2
            on_cone = (share > 0) & (share < side) & (far > 0) & np.isfinite(far)
        first, last = _ball(rays, start, start_radius), _ball(rays, end, end_radius)
        nearer = last.distance < first.distance
        far = np.where(on_cone, far, np.where(nearer, last.distance, first.distance))
        outward = np.where(nearer[:, None], last.normal, first.normal)
        outward[on_cone] = side * (rays[on_cone] * far[on_cone, None] - start) - along * share[on_cone, None]
        distance[meeting], normal[meeting] = far, outward
    return Met(distance, normal)


def _ball(rays: Float[np.ndarray, "n 3"], centre: Float[np.ndarray, " 3"], radius: float) -> Met:
    ahead = rays @ centre
    root = ahead**2 - centre @ centre + radius**2
    hit = (root > 0) & (ahead > 0)
    distance = np.where(hit, ahead - np.sqrt(np.maximum(root, 0)), np.inf)
    return Met(distance, rays * np.where(hit, distance, 0)[:, None] - centre)
