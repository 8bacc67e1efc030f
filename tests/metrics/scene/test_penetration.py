"""Penetration: equal to what lies inside meshes, exact in what it skips, blind to all that is outside."""

import pickle

import numpy as np
import pytest
import torch
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from torchmetrics import MetricCollection

from sag.data.rooms.geometry import RoomGeometry, Solid
from sag.errors import SagError
from sag.metrics.scene.penetration import SPACING, Penetration, deepest_penetration
from sag.skeleton import GTA_IM_19
from sag.types import FRAMES

BONES = GTA_IM_19.bone_index
ROOT = GTA_IM_19.root_index
TABLE = Solid("table", centre=(0.0, 0.0, 0.4), half=(0.5, 0.3, 0.4), yaw=0.4)
SHELF = Solid("shelf", centre=(1.0, 0.2, 0.9), half=(0.2, 0.4, 0.9), yaw=-0.2)
ROOM = RoomGeometry((6.0, 6.0, 3.0), floor=(), solids=(TABLE, SHELF))
EMPTY = RoomGeometry((6.0, 6.0, 3.0), floor=())


def crowd(seed: int, count: int = 3, spread: float = 1.2) -> Tensor:
    """(count, 65, 19, 3) bodies of short and long bones all over the furniture, frame by frame somewhere else."""
    generator = torch.manual_seed(seed)
    place = spread * torch.randn(count, FRAMES, 1, 3, generator=generator, dtype=torch.float64)
    return place + 0.3 * torch.randn(count, FRAMES, 19, 3, generator=generator, dtype=torch.float64)


def values(world: Tensor, room: RoomGeometry = ROOM, size: int = 64, **options: float) -> dict[str, float]:
    metric = Penetration(BONES, ROOT, **options)
    for chunk in world.split(size):
        metric.update(chunk, [room] * len(chunk))
    return {name: float(value) for name, value in metric.compute().items()}


def along_bones(motion: np.ndarray, samples: int = 60) -> np.ndarray:
    """(frames, points, 3) points on every bone, ends included."""
    share = np.linspace(0, 1, samples)[:, None]
    starts, ends = (motion[:, side, None] for side in BONES.T)
    return ((1 - share) * starts + share * ends).reshape(len(motion), -1, 3)


def test_what_it_finds_is_inside_a_mesh_and_the_rest_is_not():
    motion = crowd(0, 1)[0]
    points = along_bones(motion.numpy())
    inside = np.abs(points[..., :2]).max(axis=(1, 2)) > 3
    for solid in ROOM.solids:
        turn = trimesh.transformations.rotation_matrix(solid.yaw, [0, 0, 1])
        turn[:3, 3] = solid.centre
        box = trimesh.creation.box(2 * np.array(solid.half), turn)
        inside |= box.contains(points.reshape(-1, 3)).reshape(points.shape[:2]).any(1)
    found = deepest_penetration(motion, BONES, ROOM).numpy()
    assert 10 < inside.sum() < 60
    assert inside[found > 0].all(), "found inside, but no mesh has it"
    assert (inside != (found > 0)).sum() <= 2, "only grazes may fall between samples"


@given(seed=st.integers(0, 1000))
@settings(max_examples=10, deadline=None)
def test_is_the_depth_of_dense_samples_to_half_the_spacing(seed):
    motion = crowd(seed, 1)[0]
    dense = -ROOM.signed_distance(along_bones(motion.numpy(), 400)).min(axis=1)
    found = deepest_penetration(motion, BONES, ROOM).numpy()
    assert (found <= dense.clip(0) + 0.004).all()
    assert (found >= dense.clip(0) - SPACING / 2 - 1e-9).all()


def test_a_bone_through_a_thin_board_counts_though_its_joints_are_outside():
    board = RoomGeometry((6.0, 6.0, 3.0), floor=(), solids=(Solid("board", (0.0, 0.0, 1.0), (1.0, 0.03, 1.0), 0.0),))
    world = torch.tensor([[0.0, -0.23, 1.0], [0.0, 0.2, 1.0]]).expand(1, FRAMES, 2, 3)
    metric = Penetration([(0, 1)], root=0)
    metric.update(world, [board])
    found = metric.compute()
    assert found["share"] == 1 and found["root"] == 0 and 0 < found["depth"] <= 0.03


def test_joints_without_a_bone_are_no_part_of_the_body():
    world = torch.full((1, FRAMES, 3, 3), 2.0)
    world[:, :, 2] = 0.2
    metric = Penetration([(0, 1)], root=0)
    metric.update(world, [ROOM])
    assert metric.compute()["share"] == 0


def test_the_wrong_room_shows_and_the_empty_one_does_not():
    beside = crowd(0)
    clear = torch.stack([deepest_penetration(m, BONES, ROOM) == 0 for m in beside])
    world = torch.where(clear[..., None, None], beside, torch.tensor([0.0, 2.0, 1.0], dtype=torch.float64))
    assert values(world) == {"share": 0, "root": 0, "depth": 0}
    other = RoomGeometry((6.0, 6.0, 3.0), floor=(), solids=(Solid("chest", (-1.0, -0.5, 1.0), (0.6, 0.6, 1.0), 0.0),))
    assert values(world, other)["share"] > 0.05


def test_jitter_in_free_space_and_moves_along_the_floor_are_nothing():
    world = 0.2 * crowd(0)
    jittered = world + 0.01 * torch.randn(world.shape, generator=torch.manual_seed(1))
    for moved in (jittered, world + 0.5, world - torch.tensor([0, 0, 0.05])):
        assert values(moved, EMPTY) == {"share": 0, "root": 0, "depth": 0}


@given(aside=st.floats(0, 3), size=st.integers(1, 4))
@settings(max_examples=15, deadline=None)
def test_a_room_that_moves_with_the_people_changes_nothing(aside, size):
    world = crowd(1, 4)
    moved = RoomGeometry(
        (100.0, 100.0, 3.0),
        floor=(),
        solids=tuple(Solid(s.name, (s.centre[0] + aside, *s.centre[1:]), s.half, s.yaw) for s in ROOM.solids),
    )
    big = RoomGeometry((100.0, 100.0, 3.0), floor=(), solids=ROOM.solids)
    shifted = world + torch.tensor([aside, 0, 0], dtype=torch.float64)
    assert values(shifted, moved, size) == pytest.approx(values(world, big), abs=1e-9)


def test_frame_zero_is_left_out_and_the_root_is_its_own_figure():
    world = torch.full((1, FRAMES, 19, 3), 2.0)
    world[:, 0] = 0.4
    assert values(world)["share"] == 0
    world[:, 33:, ROOT] = torch.tensor([0.0, 0.0, 0.4])
    found = values(world)
    assert found["share"] == found["root"] == 0.5 and found["depth"] == pytest.approx(0.15)


def test_tolerance_decides_shares_alone_and_every_looks_at_fewer_frames():
    world = crowd(2, 8)
    strict, lenient, sparse = values(world), values(world, tolerance=0.1), values(world, every=4)
    assert lenient["share"] < strict["share"] and lenient["root"] < strict["root"]
    assert lenient["depth"] == strict["depth"]
    assert sparse["share"] == pytest.approx(strict["share"], abs=0.1) and sparse != strict


def test_each_motion_is_judged_in_its_own_room():
    world = crowd(3, 4)
    metric = Penetration(BONES, ROOT)
    metric.update(world, [ROOM, EMPTY, ROOM, EMPTY])
    apart = [values(world[[0, 2]]), values(world[[1, 3]], EMPTY)]
    for name, value in metric.compute().items():
        assert float(value) == pytest.approx((apart[0][name] + apart[1][name]) / 2)


@pytest.mark.parametrize("dtype", [torch.float32, torch.bfloat16, torch.float16])
def test_takes_any_float(dtype):
    world = crowd(4)
    assert values(world.to(dtype))["depth"] == pytest.approx(values(world)["depth"], abs=2e-3)


def test_survives_pickle_clone_and_a_collection_of_tolerances():
    collection = MetricCollection({"strict": Penetration(BONES, ROOT), "lenient": Penetration(BONES, ROOT, 0.05)})
    clear, deep = torch.full((1, FRAMES, 19, 3), 2.0), torch.zeros(1, FRAMES, 19, 3)
    collection.update(world=clear, geometry=[ROOM])
    collection.update(world=deep + torch.tensor([0, 0, 0.78]), geometry=[ROOM])
    found = pickle.loads(pickle.dumps(collection)).clone().compute()
    assert found["strict_share"] == 0.5 and found["lenient_share"] == 0


@pytest.mark.parametrize("broken", ["nan", "frames", "joints", "scenes"])
def test_refuses(broken):
    world = crowd(0)
    if broken == "nan":
        world[0, 3, 0, 1] = torch.nan
    world = {"frames": world[:, :64], "joints": world[:, :, :18]}.get(broken, world)
    with pytest.raises(SagError, match="penetration"):
        Penetration(BONES, ROOT).update(world, [ROOM] * (2 if broken == "scenes" else 3))


def test_refuses_no_motions_and_a_wrong_step():
    with pytest.raises(SagError, match="before any motion"):
        Penetration(BONES, ROOT).compute()
    with pytest.raises(SagError, match=r"1 \.\. 64"):
        Penetration(BONES, ROOT, every=0)
