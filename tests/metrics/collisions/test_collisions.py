"""Collision counts: equal to all points against all bones, in pictures and in any cloud, wherever the camera is."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from torch import Tensor
from toy_data import STANDING

from sag.errors import SagError
from sag.geometry.camera import point_cloud
from sag.geometry.capsule import squared_distance_to_segment
from sag.geometry.cloud import IndexedCloud
from sag.metrics import collision_counts, collision_counts_in_cloud
from sag.skeleton import GTA_IM_19

RADII = (0.030, 0.045, 0.060)
BONES = torch.as_tensor(GTA_IM_19.bone_index)
CAMERA = torch.tensor([[70.0, 0, 60], [0, 75, 40], [0, 0, 1]])
SHAPES = ("capsule", "cylinder")
shapes, seeds = st.sampled_from(SHAPES), st.integers(0, 10_000)


def brute_force(joints: Tensor, cloud: Tensor, shape: str) -> Tensor:
    """Every point against every bone."""
    counts = []
    for frame in joints.double():
        starts, ends = (frame[side] for side in BONES.T)
        nearest = torch.stack([squared_distance_to_segment(cloud, a, b, shape) for a, b in zip(starts, ends)]).amin(0)
        counts.append([int((nearest <= radius**2).sum()) for radius in RADII])
    return torch.tensor(counts)


def seen(depth: Tensor, intrinsics: Tensor = CAMERA) -> Tensor:
    """The points of a depth map."""
    return point_cloud(depth.double()[None], intrinsics.double()[None])[0][depth > 0]


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


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    ("depth", "nearest", "farthest"),
    [(2.0, 1.5, 2.5), (1.0, 0.2, 2.0), (0.1, 0.01, 0.5), (0.0, 0.3, 0.6), (-0.2, 0.02, 0.4)],
    ids=["in front", "near", "across the camera plane", "across, far points", "mostly behind"],
)
def test_equals_brute_force(depth, nearest, farthest, shape):
    differing, touching = 0, 0
    for seed in range(2):
        joints, picture = bodies(seed, 25, depth), rough_depth(seed, nearest, farthest)
        expected = brute_force(joints, seen(picture), shape)
        found = collision_counts(joints, BONES, picture, CAMERA, RADII, shape)
        differing += int((found != expected).sum())
        touching += int((expected > 0).sum())
    assert differing == 0 and touching > 20


@given(seed=seeds, depth=st.floats(-1, 4), shape=shapes)
@settings(max_examples=25, deadline=None)
def test_equals_brute_force_anywhere(seed, depth, shape):
    joints, picture = bodies(seed, 3, depth), rough_depth(seed, 0.05, 4)
    found = collision_counts(joints, BONES, picture, CAMERA, RADII, shape)
    assert torch.equal(found, brute_force(joints, seen(picture), shape))


@pytest.mark.parametrize("size", [(72, 128), (71, 125), (9, 7)], ids=["whole blocks", "ragged", "tiny"])
def test_a_picture_of_any_size(size):
    picture = rough_depth(0, 1.5, 2.5)[: size[0], : size[1]].contiguous()
    joints = bodies(0, 20, 2.0)
    expected = brute_force(joints, seen(picture), "capsule")
    assert torch.equal(collision_counts(joints, BONES, picture, CAMERA, RADII), expected)
    assert size == (9, 7) or expected.any()


@pytest.mark.parametrize("shape", SHAPES)
def test_any_cloud_equals_brute_force_on_hundreds_of_frames(shape):
    differing, touching = 0, 0
    for seed, spread in enumerate((0.3, 1.0)):
        points = spread * torch.randn(4000, 3, generator=torch.manual_seed(seed), dtype=torch.float64)
        cloud, joints = IndexedCloud(points), bodies(seed, 120, 0.0)
        expected = brute_force(joints, points, shape)
        differing += int((collision_counts_in_cloud(joints, BONES, cloud, RADII, shape) != expected).sum())
        touching += int((expected > 0).sum())
    assert differing == 0 and touching > 200


def test_a_cloud_is_found_beyond_both_ends_of_a_bone():
    bone = torch.tensor([[[0.0, 0, 2], [0, 0.4, 2]]])
    directions = torch.nn.functional.normalize(torch.randn(500, 3, generator=torch.manual_seed(0)), dim=-1)
    caps = torch.cat([bone[0, end] + 0.0599 * directions for end in (0, 1)])
    count = collision_counts_in_cloud(bone, torch.tensor([[0, 1]]), caps, (0.06,))
    assert count.tolist() == [[1000]]
    inner = collision_counts_in_cloud(bone, torch.tensor([[0, 1]]), caps, (0.06,), "cylinder")
    assert 400 < int(inner) < 600, "the halves of both balls that lie between the ends"


@given(seed=seeds, depth=st.floats(0, 3), shape=shapes)
@settings(max_examples=15, deadline=None)
def test_the_points_of_a_picture_count_as_a_cloud(seed, depth, shape):
    joints, picture = bodies(seed, 3, depth), rough_depth(seed, 0.5, 3)
    found = collision_counts(joints, BONES, picture, CAMERA, RADII, shape)
    assert torch.equal(found, collision_counts_in_cloud(joints, BONES, seen(picture), RADII, shape))


@given(seed=seeds, radii=st.lists(st.floats(0.001, 0.5), min_size=2, max_size=5))
@settings(max_examples=15, deadline=None)
def test_counts_grow_with_the_radius_and_a_cylinder_lies_in_its_capsule(seed, radii):
    joints, picture = bodies(seed, 3, 2.0), rough_depth(seed, 1, 3)
    capsule, cylinder = (collision_counts(joints, BONES, picture, CAMERA, sorted(radii), s) for s in SHAPES)
    assert (capsule.diff(dim=1) >= 0).all() and (cylinder.diff(dim=1) >= 0).all()
    assert (cylinder <= capsule).all()


@given(seed=seeds, shape=shapes)
@settings(max_examples=15, deadline=None)
def test_a_rigid_motion_of_body_and_cloud_changes_nothing(seed, shape):
    generator = torch.manual_seed(seed)
    points, joints = torch.randn(3000, 3, generator=generator).double(), bodies(seed, 4, 0.0).double()
    turn = torch.from_numpy(Rotation.random(random_state=seed).as_matrix())
    shift = 5 * torch.randn(3, generator=generator).double()
    still, moved = (
        collision_counts_in_cloud(f(joints), BONES, f(points), RADII, shape)
        for f in (lambda x: x, lambda x: x @ turn.T + shift)
    )
    assert torch.equal(still, moved) and still.any()


@given(seed=seeds, shape=shapes)
@settings(max_examples=15, deadline=None)
def test_a_camera_on_its_side_counts_the_same(seed, shape):
    joints, picture = bodies(seed, 3, 2.0), rough_depth(seed, 1.5, 2.5)
    camera = torch.tensor([[75.0, 0, 72 - 40], [0, 70, 60], [0, 0, 1]])
    aside = torch.stack([-joints[..., 1], joints[..., 0], joints[..., 2]], dim=-1)
    found = collision_counts(aside, BONES, picture.rot90(-1).contiguous(), camera, RADII, shape)
    assert torch.equal(found, collision_counts(joints, BONES, picture, CAMERA, RADII, shape))


@given(seed=seeds, shape=shapes)
@settings(max_examples=10, deadline=None)
def test_everything_twice_as_large_counts_the_same(seed, shape):
    joints, picture = bodies(seed, 3, 2.0), rough_depth(seed, 1.5, 2.5)
    doubled = collision_counts(2 * joints, BONES, 2 * picture, CAMERA, [2 * r for r in RADII], shape)
    assert torch.equal(doubled, collision_counts(joints, BONES, picture, CAMERA, RADII, shape))


def test_a_point_that_several_bones_touch_counts_once():
    joints = torch.tensor([[[0.0, 0, 2], [0, 0.3, 2], [0.3, 0, 2]]])
    picture = torch.full((72, 128), 2.0)
    several = torch.tensor([[0, 1], [0, 2], [1, 0], [0, 1]])
    for count, scene in ((collision_counts, (picture, CAMERA)), (collision_counts_in_cloud, (seen(picture),))):
        once, more = (count(joints, bones, *scene, RADII) for bones in (several[:2], several))
        assert torch.equal(once, more) and once.min() > 0


def test_no_points_no_collisions():
    joints = bodies(0, 4, 2.0)
    assert collision_counts(joints, BONES, torch.zeros(72, 128), CAMERA, RADII).tolist() == [[0, 0, 0]] * 4
    assert collision_counts_in_cloud(joints, BONES, torch.zeros(0, 3), RADII).tolist() == [[0, 0, 0]] * 4


def test_the_same_points_in_a_finer_picture():
    joints, picture = bodies(0, 10, 2.0), rough_depth(0, 1.5, 2.5)
    fine = torch.zeros(216, 384)
    fine[1::3, 1::3] = picture
    camera = CAMERA.clone()
    camera[:2] *= 3
    expected = collision_counts(joints, BONES, picture, CAMERA, RADII)
    assert (collision_counts(joints, BONES, fine, camera, RADII) - expected).abs().max() <= 1


@pytest.mark.parametrize("dtype", [torch.bfloat16, torch.float16, torch.float64])
def test_half_precision_is_counted_in_double(dtype):
    joints, picture = bodies(0, 10, 2.0).to(dtype), rough_depth(0, 1.5, 2.5).to(dtype)
    expected = brute_force(joints, seen(picture), "capsule")
    assert torch.equal(collision_counts(joints, BONES, picture, CAMERA, RADII), expected) and expected.any()


def test_refuses_points_that_are_not_finite():
    with pytest.raises(SagError, match="point cloud has coordinates that are not finite"):
        collision_counts_in_cloud(bodies(0, 1, 0.0), BONES, torch.full((5, 3), torch.nan), RADII)
