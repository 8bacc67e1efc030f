"""Collision details: the same touches as the counts, told by frame and bone."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from toy_data import STANDING

from sag.errors import SagError
from sag.geometry.camera import point_cloud
from sag.geometry.capsule import squared_distance_to_segment
from sag.metrics import collision_counts, collision_details
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

BONES = torch.as_tensor(GTA_IM_19.bone_index)
CAMERA = torch.tensor([[[70.0, 0, 60], [0, 75, 40], [0, 0, 1]]])


def rough_wall(seed: int) -> DepthMap:
    return DepthMap(1.5 + torch.rand(1, 72, 128, generator=torch.manual_seed(seed)), CAMERA)


def bodies(seed: int, frames: int = 6) -> Tensor:
    drift = 0.3 * torch.randn(frames, 1, 3, generator=torch.manual_seed(seed))
    return torch.from_numpy(STANDING).float() + drift + torch.tensor([0, 0, 2.0])


@given(seed=st.integers(0, 10_000), radius=st.floats(0.01, 0.2), shape=st.sampled_from(["capsule", "cylinder"]))
@settings(max_examples=20, deadline=None)
def test_agrees_with_the_counts(seed, radius, shape):
    joints, scene = bodies(seed), rough_wall(seed)
    details = collision_details(joints, BONES, scene, radius, shape)
    counts = collision_counts(joints, BONES, scene.depth[0], scene.intrinsics[0], (radius,), shape)[:, 0]
    assert (details.points.sum(1) >= counts).all() and (details.points.amax(1) <= counts).all()
    assert torch.equal(details.points.sum(1) == 0, counts == 0)


@pytest.mark.parametrize("shape", ["capsule", "cylinder"])
def test_equals_brute_force_of_every_bone_and_point(shape):
    joints, scene = bodies(0).double(), rough_wall(0)
    points = point_cloud(scene.depth.double(), scene.intrinsics.double())[0].flatten(0, 1)
    starts, ends = (joints[:, side, None] for side in BONES.T)
    distance = squared_distance_to_segment(points, starts, ends, shape).sqrt()
    for cloud in (scene, points):
        details = collision_details(joints, BONES, cloud, 0.08, shape)
        assert torch.equal(details.points, (distance <= 0.08).sum(-1))
        torch.testing.assert_close(details.depth, (0.08 - distance.amin(-1)).clamp_min(0))
    assert details.points.any()


@pytest.mark.parametrize("columns", [5, 40, 128])
def test_no_touch_is_told_twice_in_a_picture_that_bodies_fill(columns):
    joints, scene = bodies(0).double(), rough_wall(0)
    narrow = DepthMap(scene.depth[:, :, :columns].contiguous(), CAMERA)
    points = point_cloud(narrow.depth.double(), narrow.intrinsics.double())[0].flatten(0, 1)
    joints = joints - joints[:, :1] + points[columns // 2 + 20 * columns]
    seen, expected = (collision_details(joints, BONES, cloud, 0.3) for cloud in (narrow, points))
    assert torch.equal(seen.points, expected.points) and seen.points.any()


def test_names_the_bone_the_frame_and_the_depth():
    joints = bodies(1, 3) * 0 + torch.from_numpy(STANDING).float() + torch.tensor([0, 0, 2.0])
    wrist, shin = joints[1, 4], (joints[2, 14] + joints[2, 15]) / 2
    joints = joints + torch.tensor([0.0, 5.0, 10.0])[:, None, None]  # each frame is far from the others' points
    points = torch.stack([wrist + 5, shin + 10 + torch.tensor([0.04, 0, 0])])
    details = collision_details(joints, GTA_IM_19.bone_index, points, radius=0.06)
    worst = details.worst(GTA_IM_19.bones)
    assert [(c.frame, c.bone, c.points) for c in worst] == [
        (1, "right_elbow-right_wrist", 1), (2, "right_knee-right_ankle", 1),
    ]  # fmt: skip
    assert [c.depth for c in worst] == pytest.approx([0.06, 0.02], abs=1e-5)
    assert details.lines(GTA_IM_19.bones, count=1) == [
        "frame  1  right_elbow-right_wrist          1 points,  60 mm deep"
    ]


def test_nothing_touched_is_nothing_told():
    details = collision_details(bodies(0), BONES, torch.zeros(0, 3), 0.06)
    assert not details.points.any() and not details.depth.any() and details.worst(GTA_IM_19.bones) == []


def test_refuses():
    with pytest.raises(SagError, match="at least 19 joints"):
        collision_details(bodies(0)[:, :16], BONES, rough_wall(0), 0.06)
    with pytest.raises(SagError, match="given 2 depth maps"):
        collision_details(bodies(0), BONES, rough_wall(0)[[0, 0]], 0.06)
    with pytest.raises(SagError, match="not finite"):
        collision_details(bodies(0) / 0, BONES, rough_wall(0), 0.06)
    with pytest.raises(SagError, match="18 bones were given names of 1"):
        collision_details(bodies(0), BONES, rough_wall(0), 0.06).worst(GTA_IM_19.bones[:1])
