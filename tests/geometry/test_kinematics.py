import numpy as np
import pytest

from sag.geometry.kinematics import FOLDED, STRAIGHT, reachable_height, rotation, turned, two_bone, unit

UPPER, LOWER = 0.42, 0.40


@pytest.fixture
def limbs():
    """Starts, wanted ends (some out of reach) and poles of 500 limbs."""
    rng = np.random.default_rng(0)
    start, way, pole = rng.normal(size=(3, 500, 3))
    return start, start + unit(way) * rng.uniform(0.01, 1.2, (500, 1)), pole


def test_rotation_keeps_lengths_and_handedness():
    turns = rotation(*np.random.default_rng(0).uniform(-3, 3, (3, 50)))
    assert turns.shape == (50, 3, 3)
    np.testing.assert_allclose(turns @ turns.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (50, 3, 3)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(turns), 1.0)


@pytest.mark.parametrize(
    ("angles", "vector", "goes_to"),
    [
        ((np.pi / 2, 0, 0), [1, 0, 0], [0, 1, 0]),  # forward turns to the left
        ((0, np.pi / 2, 0), [0, 0, 1], [1, 0, 0]),  # up leans forward
        ((0, 0, np.pi / 2), [0, 0, 1], [0, -1, 0]),  # up leans to the right
        ((np.pi / 2, np.pi / 2, 0), [0, 0, 1], [0, 1, 0]),  # the lean happens first
    ],
)
def test_rotation_turns_left_leans_forward_and_right(angles, vector, goes_to):
    turn = rotation(*(np.array(float(a)) for a in angles))
    np.testing.assert_allclose(turned(turn, np.array(vector, dtype=float)), goes_to, atol=1e-12)


def test_unit_leaves_zero_alone():
    np.testing.assert_allclose(unit(np.array([[0.0, 0, 0], [0, 3, 4]])), [[0, 0, 0], [0, 0.6, 0.8]])


def test_two_bones_keep_their_lengths_wherever_the_end_is(limbs):
    start, wanted, pole = limbs
    middle, end = two_bone(start, wanted, UPPER, LOWER, pole)
    np.testing.assert_allclose(np.linalg.norm(middle - start, axis=1), UPPER, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(end - middle, axis=1), LOWER, atol=1e-9)


def test_two_bones_hit_what_they_can_reach_and_point_at_the_rest(limbs):
    start, wanted, pole = limbs
    _, end = two_bone(start, wanted, UPPER, LOWER, pole)
    away = np.linalg.norm(wanted - start, axis=1)
    near = (away < STRAIGHT * (UPPER + LOWER)) & (away > FOLDED * (UPPER + LOWER))
    assert 100 < near.sum() < 450
    np.testing.assert_allclose(end[near], wanted[near], atol=1e-9)
    np.testing.assert_allclose(unit(end - start), unit(wanted - start), atol=1e-9)
    far = away > UPPER + LOWER
    np.testing.assert_allclose(np.linalg.norm(end - start, axis=1)[far], STRAIGHT * (UPPER + LOWER))


def test_middle_joint_is_on_the_side_of_the_pole_and_in_its_plane(limbs):
    start, wanted, pole = limbs
    middle, end = two_bone(start, wanted, UPPER, LOWER, pole)
    way = unit(end - start)
    aside = (middle - start) - ((middle - start) * way).sum(1, keepdims=True) * way
    assert ((aside * pole).sum(1) > 0).all()
    normal = np.cross(way, pole)
    np.testing.assert_allclose((normal * aside).sum(1), 0.0, atol=1e-9)


def test_from_the_reachable_height_the_end_is_just_reached():
    rng = np.random.default_rng(1)
    start, end = rng.uniform(-0.25, 0.25, (2, 200, 3))
    start[:, 2] = reachable_height(start, end, 0.8)
    np.testing.assert_allclose(np.linalg.norm(start - end, axis=1), STRAIGHT * 0.8)


def test_reachable_height_of_an_end_too_far_aside_is_its_own_height():
    height = reachable_height(np.array([[2.0, 0, 5]]), np.array([[0.0, 0, 0.3]]), 0.8)
    np.testing.assert_allclose(height, [0.3])
