"""Rays and rounded cones: what they meet lies on the surface, and nothing that they pass is nearer."""

import numpy as np
import pytest

from sag.film.solids import rounded_cone

GENERATOR = np.random.default_rng(0)


def signed_distance(points: np.ndarray, start: np.ndarray, end: np.ndarray, radii: tuple[float, float]) -> np.ndarray:
    """To the hull of two balls: the least over many balls between them."""
    shares = np.linspace(0, 1, 401)
    centres = start + shares[:, None] * (end - start)
    sizes = radii[0] + shares * (radii[1] - radii[0])
    away = np.linalg.norm(points[:, None] - centres, axis=-1)
    return (away - sizes).min(axis=1)


def rays(count: int) -> np.ndarray:
    directions = np.concatenate(
        [GENERATOR.uniform([-0.25, -0.15], [0.25, 0.15], (count, 2)), np.ones((count, 1))], axis=1
    )
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("radii", [(0.2, 0.2), (0.3, 0.1), (0.05, 0.25)])
def test_what_is_met_is_the_first_of_the_surface(radii):
    start, end, directions = np.array([-0.3, 0.1, 3.0]), np.array([0.4, -0.2, 3.6]), rays(120)
    met = rounded_cone(directions, start, end, *radii)
    hit = np.isfinite(met.distance)
    assert 0.05 < hit.mean() < 0.9
    points = directions[hit] * met.distance[hit, None]
    assert np.abs(signed_distance(points, start, end, radii)).max() < 2e-3
    along = np.linspace(2, 4.5, 120)
    for ray, distance in zip(directions, met.distance):
        path = signed_distance(ray * along[:, None], start, end, radii)
        assert (path[along < distance - 0.02] > -2e-3).all()
    # Normals lead out of the solid.
    normals = met.normal[hit] / np.linalg.norm(met.normal[hit], axis=1, keepdims=True)
    assert (signed_distance(points + 0.01 * normals, start, end, radii) > 0.008).all()
    assert ((normals * directions[hit]).sum(axis=1) < 1e-6).all()


def test_a_ball_within_a_ball_is_the_larger_ball():
    directions = rays(200)
    centre = np.array([0, 0, 3.0])
    inside = rounded_cone(directions, centre, centre + [0.01, 0, 0], 0.3, 0.1)
    alone = rounded_cone(directions, centre, centre, 0.3, 0.3)
    assert np.allclose(inside.distance, alone.distance) and np.isfinite(alone.distance).any()
