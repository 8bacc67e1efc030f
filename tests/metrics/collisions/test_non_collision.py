"""Non-collision ratio: right about what it judges, in pictures and in clouds."""

import pickle

import pytest
import torch
from torch import Tensor
from torchmetrics import MetricCollection
from toy_data import STANDING

from sag.errors import SagError
from sag.geometry.camera import point_cloud
from sag.geometry.cloud import IndexedCloud
from sag.metrics import NonCollisionRatio, collision_counts
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

RADII = (0.030, 0.045, 0.060)
BONES = torch.as_tensor(GTA_IM_19.bone_index)


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
    cloud.depth[:, :, 256:] = 30
    metric = NonCollisionRatio(BONES.numpy(), frames=2)
    metric.update(motions, cloud)
    assert metric.sample().density == 288 * 256


def test_a_cloud_of_points_says_what_the_picture_says(motions, cloud):
    motions = motions[:4] + 0.03 * torch.randn(4, 65, 19, 3, generator=torch.manual_seed(0))
    points = point_cloud(cloud.depth[:4].double(), cloud.intrinsics[:4].double()).flatten(1, 2)
    expected = NonCollisionRatio(BONES.numpy(), frames=5, thresholds=(100, 500, 1000))
    expected.update(motions, cloud[:4])
    for scenes in (list(points), [IndexedCloud(p) for p in points]):
        metric = NonCollisionRatio(BONES.numpy(), frames=5, thresholds=(100, 500, 1000))
        metric.update(motions, scenes)
        assert torch.equal(metric.ratios(), expected.ratios()) and metric.sample() == expected.sample()
    assert 0 < float(expected.ratios().mean()) < 1


def test_flat_ends_leave_more_frames_clear():
    ankle_in_the_floor = torch.tensor([[0.0, 0.0, 3.0], [0.0, 0.49, 3.0]]).expand(1, 65, 2, 3)
    x, z = torch.meshgrid(torch.linspace(-0.5, 0.5, 200), torch.linspace(2.5, 3.5, 200), indexing="ij")
    floor = [torch.stack([x, torch.full_like(x, 0.5), z], dim=-1).flatten(0, 1)]
    found = {}
    for shape in ("capsule", "cylinder"):
        metric = NonCollisionRatio([[0, 1]], shape=shape)
        metric.update(ankle_in_the_floor, floor)
        found[shape] = float(metric.compute()["average"])
    assert found["capsule"] < 1 and found["cylinder"] == 1


def test_a_millimetre_of_jitter_changes_nothing(motions, cloud):
    jitter = 0.001 * torch.randn(motions.shape, generator=torch.manual_seed(0))
    still, shaken = (NonCollisionRatio(BONES.numpy(), frames=5) for _ in range(2))
    still.update(motions, cloud)
    shaken.update(motions + jitter, cloud)
    assert torch.equal(still.ratios(), shaken.ratios())


def test_metrics_of_one_collection_that_agree_at_first_stay_apart(motions, cloud):
    collection = MetricCollection(
        {name: NonCollisionRatio(BONES.numpy(), thresholds=(limit,)) for name, limit in (("few", 40), ("many", 10**6))}
    )
    collection.update(joints=motions[1::2], cloud=cloud[1::2])
    collection.update(joints=motions[::2], cloud=cloud[::2])
    found = collection.compute()
    assert found["few_average"] == 0.5 and found["many_average"] == 1


@pytest.mark.parametrize("dtype", [torch.float64, torch.bfloat16, torch.float16])
def test_any_precision(motions, cloud, dtype):
    metric = NonCollisionRatio(BONES.numpy(), frames=3)
    metric.update(motions.to(dtype), cloud)
    assert float(metric.compute()["average"]) == 0.5


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
    with pytest.raises(SagError, match="neither"):
        metric.update(motions, None)
    with pytest.raises(SagError, match="without points for the motion at 7"):
        metric.update(motions[:1], DepthMap(0 * cloud.depth[:1], cloud.intrinsics[:1]), torch.tensor([7]))
    with pytest.raises(SagError, match="without points for the motion at 0"):
        metric.update(motions[:1], [torch.zeros(0, 3)])
    metric.update(motions[:0], cloud[:0])
    with pytest.raises(SagError, match="before any motion"):
        metric.compute()
