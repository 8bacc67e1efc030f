"""Non-collision: equal to all points against all bones, and right about what it judges."""

import pickle

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from toy_data import STANDING

from sag.errors import SagError
from sag.geometry.camera import point_cloud
from sag.metrics import NonCollisionRatio, collision_counts, points_in_capsules
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

RADII = (0.030, 0.045, 0.060)
BONES = torch.as_tensor(GTA_IM_19.bone_index)
CAMERA = torch.tensor([[70.0, 0, 60], [0, 75, 40], [0, 0, 1]])


def brute_force(joints: Tensor, depth: Tensor, intrinsics: Tensor) -> Tensor:
    """Every point of the cloud against every bone."""
    cloud = point_cloud(depth.double()[None], intrinsics.double()[None])[0][depth > 0]
    ends = [joints.double()[:, side] for side in BONES.T]
    counts = [[int(points_in_capsules(cloud, a, b, r).sum()) for r in RADII] for a, b in zip(*ends)]
    return torch.tensor(counts)


def rough_depth(seed: int, nearest: float, farthest: float) -> Tensor:
    """A bumpy depth map with holes, so that points are everywhere between the two depths."""
    generator = torch.manual_seed(seed)
    depth = nearest + (farthest - nearest) * torch.rand(72, 128, generator=generator)
    return torch.where(torch.rand(72, 128, generator=generator) < 0.1, 0, depth)


def bodies(seed: int, frames: int, depth: float) -> Tensor:
    generator = torch.manual_seed(seed)
    place = torch.randn(frames, 1, 3, generator=generator) * torch.tensor([0.5, 0.2, 0.3])
    jitter = 0.05 * torch.randn(frames, 19, 3, generator=generator)
    return torch.from_numpy(STANDING).float() + place + jitter + torch.tensor([0, 0, depth])


@pytest.mark.parametrize(
    ("depth", "nearest", "farthest"),
    [(2.0, 1.5, 2.5), (1.0, 0.2, 2.0), (0.1, 0.01, 0.5), (0.0, 0.3, 0.6), (-0.2, 0.02, 0.4)],
    ids=["in front", "near", "across the camera plane", "across, far points", "mostly behind"],
)
def test_equals_brute_force(depth, nearest, farthest):
    differing, touching = 0, 0
    for seed in range(4):
        joints, picture = bodies(seed, 25, depth), rough_depth(seed, nearest, farthest)
        expected = brute_force(joints, picture, CAMERA)
        found = collision_counts(joints, BONES, picture, CAMERA, RADII)
        differing += int((found != expected).sum())
        touching += int((expected > 0).sum())
    assert differing == 0 and touching > 20


@given(seed=st.integers(0, 10_000), depth=st.floats(-1, 4))
@settings(max_examples=25, deadline=None)
def test_equals_brute_force_anywhere(seed, depth):
    joints, picture = bodies(seed, 3, depth), rough_depth(seed, 0.05, 4)
    found = collision_counts(joints, BONES, picture, CAMERA, RADII)
    assert torch.equal(found, brute_force(joints, picture, CAMERA))
    assert (found.diff(dim=1) >= 0).all(), "more points at a larger radius"


def test_a_point_that_several_bones_touch_counts_once():
    joints = torch.tensor([[[0.0, 0, 2], [0, 0.3, 2], [0.3, 0, 2]]])
    picture = torch.full((72, 128), 2.0)
    once = collision_counts(joints, torch.tensor([[0, 1], [0, 2]]), picture, CAMERA, RADII)
    twice = collision_counts(joints, torch.tensor([[0, 1], [0, 2], [1, 0], [0, 1]]), picture, CAMERA, RADII)
    assert torch.equal(once, twice) and once.min() > 0


def test_no_points_no_collisions():
    counts = collision_counts(bodies(0, 4, 2.0), BONES, torch.zeros(72, 128), CAMERA, RADII)
    assert counts.tolist() == [[0, 0, 0]] * 4


def test_the_same_points_in_a_finer_picture():
    joints, picture = bodies(0, 10, 2.0), rough_depth(0, 1.5, 2.5)
    fine = torch.zeros(216, 384)
    fine[1::3, 1::3] = picture
    camera = CAMERA.clone()
    camera[:2] *= 3
    expected = collision_counts(joints, BONES, picture, CAMERA, RADII)
    assert (collision_counts(joints, BONES, fine, camera, RADII) - expected).abs().max() <= 1


@pytest.fixture
def motions() -> Tensor:
    """Twelve people; those of even index stand in a wall at 2 m, the others before it."""
    steps = 0.002 * torch.arange(65.0)[None, :, None, None] * torch.tensor([1.0, 0, 0])
    depth = torch.where(torch.arange(12) % 2 == 0, 2.0, 1.5)[:, None, None, None]
    return torch.from_numpy(STANDING).float() + steps + depth * torch.tensor([0, 0, 1.0])


@pytest.fixture
def cloud() -> DepthMap:
    camera = torch.tensor([[400.0, 0, 256], [0, 400, 144], [0, 0, 1]])
    return DepthMap(torch.full((12, 288, 512), 2.0), camera.expand(12, 3, 3))


def test_the_share_of_frames_that_are_clear(motions, cloud):
    metric = NonCollisionRatio(BONES.numpy(), frames=3)
    metric.update(motions, cloud)
    assert {name: float(ratio) for name, ratio in metric.compute().items()} == {
        "30": 0.5, "45": 0.5, "60": 0.5, "average": 0.5,
    }  # fmt: skip
    assert metric.sample() == (36, 288 * 512)


def test_a_frame_may_touch_as_many_points_as_the_threshold(motions, cloud):
    one = motions[:1].clone()
    metric = NonCollisionRatio(BONES.numpy(), frames=64)
    metric.update(one, cloud[:1])
    counts = collision_counts(one[0, 1:], BONES, cloud.depth[0], cloud.intrinsics[0], RADII)
    for touched in (int(counts.min()), int(counts.median())):
        exact = NonCollisionRatio(BONES.numpy(), thresholds=(touched - 1, touched), frames=64)
        exact.update(one, cloud[:1])
        expected = torch.stack([(counts <= t).double().mean(0) for t in (touched - 1, touched)], -1)
        torch.testing.assert_close(exact.ratios(), expected)


def test_a_motion_is_as_clear_as_its_worst_frame(motions, cloud):
    motions = motions[1::2].clone()
    motions[0, 40, :, 2] += 0.5
    metric = NonCollisionRatio(BONES.numpy(), unit="motion")
    metric.update(motions, cloud[:6])
    assert float(metric.compute()["average"]) == pytest.approx(5 / 6)
    assert metric.sample().tested == 6


def test_the_given_frame_is_left_out(motions, cloud):
    motions = motions[1::2].clone()
    motions[:, 0, :, 2] += 0.5
    metric = NonCollisionRatio(BONES.numpy(), frames=64)
    metric.update(motions, cloud[:6])
    assert float(metric.compute()["average"]) == 1


def test_batches_make_no_difference_and_with_an_index_neither_does_order(motions, cloud):
    motions[::3, 20:] += torch.tensor([0, 0, 0.4])
    order = torch.randperm(12)
    found = []
    for places, sizes, index in ((torch.arange(12), 12, False), (torch.arange(12), 5, False), (order, 5, True)):
        metric = NonCollisionRatio(BONES.numpy(), frames=5)
        for part in places.split(sizes):
            metric.update(motions[part], cloud[part], part if index else None)
        found.append(metric.ratios())
    assert torch.equal(found[0], found[1]) and torch.equal(found[0], found[2])
    assert 0 < float(found[0].mean()) < 1


def test_points_beyond_the_farthest_are_none(motions, cloud):
    metric = NonCollisionRatio(BONES.numpy(), frames=2, farthest=1.9)
    metric.update(motions, cloud)
    assert metric.sample().density == 0 and float(metric.compute()["average"]) == 1


def test_starts_anew_after_reset_and_survives_a_pickle(motions, cloud):
    metric = NonCollisionRatio(BONES.numpy(), frames=2)
    metric.update(motions[::2], cloud[::2])
    assert float(metric.compute()["average"]) == 0
    metric.reset()
    metric.update(motions[1::2], cloud[1::2])
    assert float(metric.compute()["average"]) == 1
    assert pickle.loads(pickle.dumps(metric)).compute() == metric.compute()


def test_refuses(motions, cloud):
    metric = NonCollisionRatio(BONES.numpy())
    with pytest.raises(SagError, match="65 frames of at least 19 joints"):
        metric.update(motions[:, :, :16], cloud)
    with pytest.raises(SagError, match="12 motions but 3 clouds"):
        metric.update(motions, cloud[:3])
    with pytest.raises(SagError, match="not finite"):
        metric.update(motions / 0, cloud)
    with pytest.raises(SagError, match="frames of the non-collision ratio"):
        NonCollisionRatio(BONES.numpy(), frames=65)
    metric.update(motions[:0], cloud[:0])
    with pytest.raises(SagError, match="before any motion"):
        metric.compute()
