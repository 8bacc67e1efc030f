"""Relocated motions: the same steps under the same gravity, in another place before another camera."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from toy_data import walks

from sag.errors import SagError
from sag.geometry.camera import to_camera, to_world
from sag.geometry.relocation import relocated
from sag.skeleton import GTA_IM_19

ROOT, FEET = GTA_IM_19.root_index, GTA_IM_19.index("right_ankle", "left_ankle")
seeds = st.integers(0, 10_000)


def cameras(seed: int, count: int = 4) -> Tensor:
    """World to camera, with any heading, up to 40 degrees up or down and 10 to a side."""
    generator = np.random.default_rng(seed)
    heading, pitch, roll = (generator.uniform(-a, a, count) for a in (np.pi, 0.7, 0.17))
    forward = np.stack([np.cos(pitch) * np.cos(heading), np.cos(pitch) * np.sin(heading), np.sin(pitch)], -1)
    right = np.stack([np.sin(heading), -np.cos(heading), np.zeros(count)], -1)
    down = np.cross(forward, right)
    c, s = np.cos(roll)[:, None], np.sin(roll)[:, None]
    world2cam = np.tile(np.eye(4), (count, 1, 1))
    world2cam[:, :3, :3] = np.stack([c * right + s * down, c * down - s * right, forward], axis=1)
    world2cam[:, :3, 3] = generator.uniform(-3, 3, (count, 3))
    return torch.from_numpy(world2cam)


def motions(seed: int, count: int = 4) -> Tensor:
    return torch.from_numpy(walks(count, np.random.default_rng(seed))).double()


def move(joints: Tensor, own: Tensor, others: Tensor, other: Tensor) -> Tensor:
    return relocated(joints, ROOT, FEET, own, others, other)


def azimuth(world2cam: Tensor) -> Tensor:
    return torch.atan2(world2cam[:, 2, 1], world2cam[:, 2, 0])


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_a_motion_moved_to_its_own_place_stays(seed):
    joints, own = motions(seed), cameras(seed)
    torch.testing.assert_close(move(joints, own, joints, own), joints, rtol=0, atol=1e-9)


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_there_and_back_again(seed):
    joints, others, own, other = motions(seed), motions(seed + 1), cameras(seed), cameras(seed + 1)
    there = move(joints, own, others, other)
    torch.testing.assert_close(move(there, other, joints, own), joints, rtol=0, atol=1e-9)


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_bones_and_steps_keep_their_lengths(seed):
    joints, others = motions(seed), motions(seed + 1)
    moved = move(joints, cameras(seed), others, cameras(seed + 1))
    before, after = (torch.cdist(x.flatten(1, 2)[:, ::17], x.flatten(1, 2)[:, ::17]) for x in (joints, moved))
    torch.testing.assert_close(before, after, rtol=0, atol=1e-6)


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_up_stays_up(seed):
    joints, others, own, other = motions(seed), motions(seed + 1), cameras(seed), cameras(seed + 1)
    heights = to_world(joints, own)[..., 2]
    moved = to_world(move(joints, own, others, other), other)[..., 2]
    torch.testing.assert_close(moved - moved[:, :1, :1], heights - heights[:, :1, :1], rtol=0, atol=1e-9)


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_starts_over_the_other_place_with_its_lowest_foot_on_the_others_level(seed):
    joints, others, own, other = motions(seed), motions(seed + 1), cameras(seed), cameras(seed + 1)
    moved, there = (to_world(x[:, 0], other) for x in (move(joints, own, others, other), others))
    torch.testing.assert_close(moved[:, ROOT, :2], there[:, ROOT, :2], rtol=0, atol=1e-9)
    torch.testing.assert_close(moved[:, FEET, 2].amin(1), there[:, FEET, 2].amin(1), rtol=0, atol=1e-9)


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_heads_the_same_way_in_the_other_picture(seed):
    joints, others, own, other = motions(seed), motions(seed + 1), cameras(seed), cameras(seed + 1)
    ways = []
    for motion, camera in ((joints, own), (move(joints, own, others, other), other)):
        x, y, _ = (lambda roots: roots[:, -1] - roots[:, 0])(to_world(motion, camera)[:, :, ROOT]).unbind(-1)
        ways.append(torch.atan2(y, x) - azimuth(camera))
    turn = (ways[1] - ways[0] + math.pi).remainder(2 * math.pi) - math.pi
    torch.testing.assert_close(turn, torch.zeros(4).double(), rtol=0, atol=1e-6)


@given(seed=seeds, angle=st.floats(-3, 3))
@settings(max_examples=20, deadline=None)
def test_where_a_world_has_its_origin_and_its_x_axis_is_all_the_same(seed, angle):
    joints, others, own, other = motions(seed), motions(seed + 1), cameras(seed), cameras(seed + 1)
    c, s = math.cos(angle), math.sin(angle)
    turned = torch.tensor([[c, -s, 0, 1.5], [s, c, 0, -2], [0, 0, 1, 0.7], [0, 0, 0, 1]], dtype=torch.float64)
    expected = move(joints, own, others, other)
    torch.testing.assert_close(move(joints, own @ turned, others, other), expected, rtol=0, atol=1e-8)
    torch.testing.assert_close(move(joints, own, others, other @ turned), expected, rtol=0, atol=1e-8)


def test_a_walker_does_not_sink_where_somebody_sits():
    own = cameras(0)
    walker = motions(0)
    sitter = to_world(motions(1), own)
    sitter[:, :, ROOT, 2] -= 0.4
    moved = to_world(move(walker, own, to_camera(sitter, own), own), own)
    torch.testing.assert_close(moved[:, 0, FEET, 2].amin(1), sitter[:, 0, FEET, 2].amin(1), rtol=0, atol=1e-9)
    assert (moved[:, 0, ROOT, 2] - sitter[:, 0, ROOT, 2]).mean() > 0.2


@pytest.mark.parametrize("dtype", [torch.float32, torch.bfloat16, torch.float16])
def test_short_numbers_are_moved_in_double_and_come_back_as_float32(dtype):
    joints, others, own, other = motions(0).to(dtype), motions(1), cameras(0), cameras(1)
    moved = move(joints, own.float(), others, other)
    expected = move(joints.double(), own.float(), others, other)
    assert moved.dtype == torch.float32
    torch.testing.assert_close(moved, expected.float())


def test_refuses_another_number_of_places():
    with pytest.raises(SagError, match="4 motions need as many places"):
        move(motions(0), cameras(0), motions(1, 3), cameras(1, 3))
