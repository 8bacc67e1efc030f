"""Floor error: sunk and floating feet by as much as they are, and nothing else."""

import pickle

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from torchmetrics import MetricCollection

from sag.data.rooms.geometry import FloorPatch, RoomGeometry
from sag.errors import SagError
from sag.metrics.scene.floor_error import ANKLE_HEIGHT, FloorError, known_floor, measured_ankle_height
from sag.types import FRAMES

FEET = (1, 2)
FLAT = RoomGeometry((40.0, 40.0, 3.0), floor=())
RAMP = RoomGeometry((40.0, 40.0, 3.0), floor=(FloorPatch((-15.0, -15.0), (15.0, 15.0), (0.0, 3.0)),))


@pytest.fixture(scope="module")
def walking() -> Tensor:
    """A root and two ankles on flat ground, one foot lifted while the other stands, never both."""
    time = torch.arange(FRAMES).double() / 10
    world = torch.zeros(4, FRAMES, 3, 3, dtype=torch.float64)
    world[..., 0] = (time + torch.arange(4.0)[:, None])[..., None]
    world[..., 0, 2] = 0.9
    for foot, phase in zip(FEET, (0.0, torch.pi)):
        world[..., foot, 1] = 0.1 if phase else -0.1
        world[..., foot, 2] = ANKLE_HEIGHT + 0.1 * (6 * time + phase).sin().clamp_min(0)
    return world


def errors(world: Tensor, room: RoomGeometry = FLAT, size: int = 4, **options: float) -> dict[str, float]:
    metric = FloorError(FEET, **options)
    for chunk in world.split(size):
        metric.update(chunk, known_floor(chunk, FEET, [room] * len(chunk)))
    return {name: float(value) for name, value in metric.compute().items()}


def raised(world: Tensor, height: float) -> Tensor:
    return world + torch.tensor([0, 0, height], dtype=world.dtype)


def on_ramp(world: Tensor) -> Tensor:
    """The same motions with every joint as high over the ramp as it was over the ground."""
    climbed = world.clone()
    climbed[..., 2] += torch.from_numpy(RAMP.floor_height(world[..., :2].numpy()))
    return climbed


def test_walking_on_the_floor_is_without_error(walking):
    assert all(abs(value) < 1e-12 for value in errors(walking).values())
    assert all(abs(value) < 1e-12 for value in errors(on_ramp(walking), RAMP).values())


@given(height=st.floats(-0.5, 0.5))
@settings(max_examples=20, deadline=None)
def test_sunk_and_floating_feet_count_by_as_much_as_they_are(walking, height):
    for world, room in ((walking, FLAT), (on_ramp(walking), RAMP)):
        found = errors(raised(world, height), room)
        assert found["sunk"] == pytest.approx(max(-height, 0), abs=1e-9)
        assert found["floating"] == pytest.approx(max(height, 0), abs=1e-9)
        assert found["error"] == pytest.approx(abs(height), abs=1e-9)


@given(aside=st.tuples(st.floats(-5, 5), st.floats(-5, 5)), seed=st.integers(0, 100))
@settings(max_examples=15, deadline=None)
def test_moves_along_a_flat_floor_and_jitter_of_other_joints_are_nothing(walking, aside, seed):
    moved = raised(walking, -0.05)
    moved = moved + torch.tensor([*aside, 0], dtype=moved.dtype)
    moved[:, :, 0] += 0.05 * torch.randn(moved[:, :, 0].shape, generator=torch.manual_seed(seed))
    assert errors(moved) == pytest.approx(errors(raised(walking, -0.05)), abs=1e-12)


def test_a_step_that_is_not_seen_is_an_error(walking):
    assert errors(walking, RAMP)["sunk"] > 0.5 > errors(walking, RAMP)["floating"] == 0


def test_frame_zero_and_the_split_into_batches_are_nothing(walking):
    moved = raised(walking, 0.03)
    assert errors(moved, size=1) == pytest.approx(errors(moved), rel=1e-12)
    moved[:, 0] += 5
    assert errors(moved) == pytest.approx(errors(raised(walking, 0.03)), rel=1e-12)


def test_feet_over_an_unknown_floor_are_left_out(walking):
    world = raised(walking, 0.05)
    floor = known_floor(world, FEET, [FLAT] * 4)
    floor[:, 20:40] = torch.nan
    metric = FloorError(FEET)
    metric.update(world, floor)
    assert float(metric.compute()["floating"]) == pytest.approx(0.05)
    metric.reset()
    metric.update(world, torch.full_like(floor, torch.nan))
    with pytest.raises(SagError, match="known floor"):
        metric.compute()


def test_the_ankle_is_measured_of_true_motions(walking):
    taller = 1.2 * walking
    height = measured_ankle_height(taller, torch.zeros(4, FRAMES, 2, dtype=torch.float64), FEET)
    assert height == pytest.approx(1.2 * ANKLE_HEIGHT)
    assert errors(taller, ankle_height=height)["error"] == pytest.approx(0, abs=1e-12)
    with pytest.raises(SagError, match="known floor"):
        measured_ankle_height(taller, torch.full((4, FRAMES, 2), torch.nan), FEET)


@pytest.mark.parametrize("dtype", [torch.float32, torch.bfloat16, torch.float16])
def test_takes_any_float(walking, dtype):
    assert errors(raised(walking, 0.05).to(dtype))["floating"] == pytest.approx(0.05, abs=1e-3)


def test_survives_pickle_clone_and_a_collection(walking):
    ankles = {"rooms": FloorError(FEET), "tall": FloorError(FEET, ankle_height=0.12)}
    collection = MetricCollection({name: metric.clone() for name, metric in ankles.items()})
    collection.update(world=walking, floor=known_floor(walking, FEET, [FLAT] * 4))
    found = pickle.loads(pickle.dumps(collection)).compute()
    assert float(found["rooms_error"]) == pytest.approx(0, abs=1e-12)
    assert float(found["tall_sunk"]) == pytest.approx(0.12 - ANKLE_HEIGHT)


@pytest.mark.parametrize("broken", ["nan", "frames", "joints", "floor", "endless"])
def test_refuses(walking, broken):
    world, floor = walking.clone(), known_floor(walking, FEET, [FLAT] * 4)
    if broken == "nan":
        world[0, 3, 0, 1] = torch.nan
    world = {"frames": world[:, :64], "joints": world[:, :, :2]}.get(broken, world)
    floor = {"frames": floor[:, :64], "floor": floor[:, :, :1], "endless": floor - torch.inf}.get(broken, floor)
    with pytest.raises(SagError, match="the floor error"):
        FloorError(FEET).update(world, floor)


def test_refuses_a_missing_scene(walking):
    with pytest.raises(SagError, match="3 scenes"):
        known_floor(walking, FEET, [FLAT] * 3)
