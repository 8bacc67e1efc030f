"""Rotations and axes: proper, exact where they can be, and the right way round."""

import numpy as np
import pytest
from export_motions import rigid_motion, stretching_motion
from hypothesis import given
from hypothesis import strategies as st

from sag.export import CAMERA_UP, Upright, estimated_up, up_of
from sag.export.rig import median_lengths, rest_direction, rig_of
from sag.export.rotations import best_fit, shortest_arc
from sag.geometry.kinematics import unit
from sag.skeleton import GTA_IM_19


@given(st.integers(0, 10_000), st.sampled_from([1.0, 1e-3, 1e-6, 1e-12, 0.0]))
def test_the_shortest_arc_reaches_its_end_without_a_twist(seed, distance):
    generator = np.random.default_rng(seed)
    start = unit(generator.normal(size=3))
    near = [unit(sign * start + distance * generator.normal(size=3)) for sign in (1, -1)]
    for end in (unit(generator.normal(size=3)), *near):
        (turn,) = shortest_arc(start, end[None])
        assert np.allclose(turn @ start, end, atol=1e-5) and np.allclose(turn @ turn.T, np.eye(3), atol=1e-5)
        assert np.linalg.det(turn) == pytest.approx(1, abs=1e-5)
        assert np.trace(turn) == pytest.approx(1 + 2 * start @ end, abs=1e-4)  # by no greater angle than it must


def test_the_best_fit_is_the_turn_that_was_made_and_never_a_reflection():
    generator = np.random.default_rng(0)
    for count in (2, 3, 5):
        starts = unit(generator.normal(size=(count, 3)))
        turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        (found,) = best_fit(starts, (starts @ turn.T)[None])
        assert np.linalg.norm(found - turn) < 0.01  # drawn to staying a little
        (found,) = best_fit(starts, -starts[None])
        assert np.linalg.det(found) == pytest.approx(1)


def test_a_joint_with_its_bones_in_one_line_does_not_spin():
    starts = np.array([[1.0, 0, 0], [-1, 0, 0]])
    for ends in (starts, 0 * starts):
        assert np.allclose(best_fit(starts, ends[None]), np.eye(3))


def test_rigs_give_the_joints_back():
    for motion, split in ((stretching_motion(), False), (stretching_motion(), True), (rigid_motion(), True)):
        rig = rig_of(GTA_IM_19, median_lengths(motion, GTA_IM_19), split)
        turns = rig.rotations(motion)
        assert np.allclose(np.linalg.det(turns), 1) and len(rig.names) == (25 if split else 19)
        assert np.allclose(rig.posed(rig.steps(motion, turns), turns), motion[:, rig.joints])


def test_rest_directions_of_joints_beyond_a_foot_and_of_hips():
    for parent, child, axis, sign in (
        ("left_ankle", "toe", 2, 1), ("root", "left_hip", 0, 1), ("left_hip", "left_knee", 1, -1),
        ("neck", "right_shoulder", 0, -1), ("right_elbow", "right_wrist", 0, -1), ("neck", "head", 1, 1),
    ):  # fmt: skip
        assert np.array_equal(rest_direction(GTA_IM_19, parent, child), sign * np.eye(3)[axis])


def pitched(degrees: float) -> np.ndarray:
    """A world to a camera that looks down by so much, from 1.5 m; world z is up."""
    angle = np.radians(degrees)
    down = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    matrix = np.eye(4)
    matrix[:3, :3] = down @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    matrix[:3, 3] = -matrix[:3, :3] @ np.array([0, 0, 1.5])
    return matrix


@pytest.mark.parametrize("degrees", [0.0, 20.0, -15.0, 90.0])
def test_pitch_is_taken_out_and_nothing_is_mirrored(degrees):
    world2cam = pitched(degrees)
    world = rigid_motion()[0]
    world = np.stack([world[:, 0], 4 - world[:, 2], world[:, 1]], axis=1)  # z up, before the camera
    camera = world @ world2cam[:3, :3].T + world2cam[:3, 3]
    upright = Upright.at(camera, GTA_IM_19, up_of(world2cam), ankle_height=0.1)
    found = upright.from_camera(camera)
    assert np.linalg.det(upright.rotation) == pytest.approx(1) and np.allclose(upright.to_camera(found), camera)
    lowest = world[GTA_IM_19.feet, 2].min() - 0.1
    root = world[GTA_IM_19.root_index]
    expected = np.stack([world[:, 0] - root[0], world[:, 2] - lowest, root[1] - world[:, 1]], axis=1)
    assert np.allclose(found, expected, atol=1e-9)


def test_without_a_world_the_picture_stays_as_it_is_seen():
    joints = rigid_motion()[0] * [1, -1, -1]
    found = Upright.at(joints, GTA_IM_19).from_camera(joints)
    assert np.allclose(found - found[0], (joints - joints[0]) * [1, -1, -1])
    assert np.allclose(found[GTA_IM_19.feet, 1].min(), 0.085)


def test_up_is_guessed_from_who_stands(toy):
    up = estimated_up(np.asarray(toy.cache.joints[0]), GTA_IM_19)
    assert up @ CAMERA_UP > np.cos(np.radians(5))
