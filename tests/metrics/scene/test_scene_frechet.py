"""Scene Fréchet distance: sees the wrong scene, and neither jitter nor batches."""

import copy
import pickle

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from sag.errors import SagError
from sag.geometry.camera import point_cloud
from sag.metrics.scene.scene_frechet import SceneFrechet, room_behind
from sag.types import DepthMap

CAMERA = torch.tensor([[60.0, 0, 32], [0, 60, 18], [0, 0, 1]])
ROOT = 1


@pytest.fixture(scope="module")
def rooms() -> tuple[Tensor, DepthMap]:
    """People who walk about before a wall that is somewhere else in each of 400 scenes, never into it."""
    generator = torch.manual_seed(0)
    wall = 2 + 5 * torch.rand(400, generator=generator)
    slant = 0.2 * torch.rand(400, 1, 1, generator=generator) * torch.linspace(-1, 1, 64)
    cloud = DepthMap((wall[:, None, None] + slant).expand(-1, 36, -1).contiguous(), CAMERA.expand(400, 3, 3))
    start, end = (wall - 0.3 - 1.5 * torch.rand(400, generator=generator) for _ in range(2))
    depth = start[:, None] + (end - start)[:, None] * torch.linspace(0, 1, 65)
    joints = torch.zeros(400, 65, 3, 3)
    joints[..., 2] = depth[..., None]
    joints[..., 0] = torch.tensor([-0.1, 0, 0.1])
    return joints, cloud


def distance(real: tuple[Tensor, DepthMap], generated: tuple[Tensor, DepthMap], size: int = 400) -> float:
    metric = SceneFrechet(ROOT)
    for (joints, cloud), side in ((real, True), (generated, False)):
        for rows in torch.arange(len(joints)).split(size):
            metric.update(joints[rows], cloud[rows], real=side)
    return float(metric.compute())


def floor(rooms: tuple[Tensor, DepthMap]) -> float:
    joints, cloud = rooms
    return distance((joints[::2], cloud[::2]), (joints[1::2], cloud[1::2]))


def test_the_wrong_scene_is_far_above_the_floor(rooms):
    joints, cloud = rooms
    assert distance(rooms, (joints, cloud[torch.arange(400).roll(1)])) > 3 * floor(rooms)


def test_good_motions_from_the_right_start_that_ignore_the_scene_are_above_the_floor(rooms):
    joints, cloud = rooms
    others = joints.roll(1, 0)
    blind = others - others[:, :1, ROOT : ROOT + 1] + joints[:, :1, ROOT : ROOT + 1]
    assert distance(rooms, (blind, cloud)) > 3 * floor(rooms)


def test_jitter_and_what_other_joints_do_is_nothing(rooms):
    joints, cloud = rooms
    jittered = joints + 0.01 * torch.randn(joints.shape, generator=torch.manual_seed(1))
    assert distance(rooms, (jittered, cloud)) < 0.05 * floor(rooms)
    bent = joints.clone()
    bent[:, :, [0, 2]] += 1
    assert distance(rooms, (bent, cloud)) < 1e-9


@given(seed=st.integers(0, 1000))
@settings(max_examples=10, deadline=None)
def test_batches_and_order_are_nothing(rooms, seed):
    joints, cloud = rooms
    order = torch.randperm(400, generator=torch.manual_seed(seed))
    assert distance(rooms, (joints[order], cloud[order]), size=1 + seed % 150) < 1e-9


@given(share=st.floats(0.3, 1.6), row=st.integers(0, 35), column=st.integers(0, 63))
@settings(max_examples=40, deadline=None)
def test_a_root_on_the_way_to_a_pixel_has_the_rest_of_it_behind(share, row, column):
    depth = 1 + torch.rand(1, 36, 64, generator=torch.manual_seed(row), dtype=torch.float64)
    cloud = DepthMap(depth, CAMERA[None].double())
    point = point_cloud(depth, cloud.intrinsics)[0, row, column]
    found = room_behind((share * point)[None, None], cloud, reach=0.5)
    assert float(found) == pytest.approx(float(((1 - share) * point[2]).clamp(-0.5, 0.5)), abs=1e-9)


@pytest.mark.parametrize("root", [(0.0, 0.0, 2.0), (50.0, 0.0, 2.0), (0.0, -50.0, 2.0)], ids=["hole", "right", "above"])
def test_nothing_is_in_the_way_where_nothing_is_known(root):
    depth = torch.full((1, 36, 64), 1.0)
    depth[:, 16:20, 30:34] = 0
    assert float(room_behind(torch.tensor([[root]]), DepthMap(depth, CAMERA[None]))) == 1


def test_frame_zero_is_left_out(rooms):
    joints, cloud = rooms
    moved = joints.clone()
    moved[:, 0] += 5
    assert distance(rooms, (moved, cloud)) < 1e-9


@pytest.mark.parametrize("dtype", [torch.float64, torch.bfloat16, torch.float16])
def test_takes_any_float(rooms, dtype):
    joints, cloud = rooms
    low = (joints.to(dtype), cloud.to(dtype))
    assert distance(rooms, low) < 0.1 * floor(rooms)


def test_survives_pickle_clone_reset_and_forward(rooms):
    joints, cloud = rooms
    metric = SceneFrechet(ROOT)
    assert metric(joints, cloud, real=True).isnan()
    metric.update(joints, cloud[torch.arange(400).roll(1)], real=False)
    expected = metric.compute()
    assert pickle.loads(pickle.dumps(metric)).compute() == expected == metric.clone().compute() > 0
    metric.reset()
    with pytest.raises(SagError, match="2 real motions"):
        metric.compute()


@pytest.mark.parametrize("broken", ["nan", "frames", "joints", "clouds", "no depth"])
def test_refuses(rooms, broken):
    joints, cloud = copy.deepcopy(rooms)
    if broken == "nan":
        joints[0, 40, 1, 2] = torch.nan
    if broken == "no depth":
        cloud.depth[3] = 0
    joints = {"frames": joints[:, :64], "joints": joints[:, :, :1]}.get(broken, joints)
    with pytest.raises(SagError, match="the scene Fréchet distance"):
        SceneFrechet(ROOT).update(joints, cloud[:7] if broken == "clouds" else cloud, real=True)
