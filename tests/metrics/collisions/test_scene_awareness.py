"""Scene awareness: reacts to scenes, not to jitter, nor to how much motions collide in all of them."""

import math
import pickle

import pytest
import torch
from torch import Tensor
from toy_data import STANDING

from sag.errors import SagError
from sag.geometry.relocation import relocated
from sag.metrics import NonCollisionRatio, SceneAwareness
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

BONES, ROOT = GTA_IM_19.bone_index, GTA_IM_19.root_index
FEET = GTA_IM_19.index("right_ankle", "left_ankle")
UPRIGHT = torch.tensor([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]).expand(24, 4, 4)


@pytest.fixture
def walls() -> DepthMap:
    """A wall before each of 24 people, 0.6 to 2.9 m from where they start, at 2 m."""
    distance = 2.6 + 0.1 * torch.arange(24.0)
    camera = torch.tensor([[200.0, 0, 128], [0, 200, 72], [0, 0, 1]])
    return DepthMap(distance[:, None, None].expand(24, 144, 256), camera.expand(24, 3, 3))


def walk(steps: Tensor) -> Tensor:
    """People who walk these distances (metres) away from the camera."""
    along = steps[:, None] * torch.linspace(0, 1, 65)
    forward = torch.tensor([0, 0, 1.0])
    return torch.from_numpy(STANDING).float() + (2 + along)[..., None, None] * forward


def aware(walls: DepthMap) -> Tensor:
    """As far as the wall lets them."""
    return walk(walls.depth[:, 0, 0] - 2.3)


def measured(joints: Tensor, walls: DepthMap, **options: object) -> dict[str, float]:
    """Each person tried in the room of the one twelve places on."""
    other = torch.arange(24).roll(12)
    moved = relocated(joints, ROOT, FEET, UPRIGHT, joints[other], UPRIGHT)
    metric = SceneAwareness(BONES, **{"frames": 20, **options})
    metric.update(joints=joints, cloud=walls, moved=moved, moved_cloud=walls[other])
    return {name: float(value) for name, value in metric.compute().items()}


def test_reacts_to_scenes(walls):
    matched = measured(aware(walls), walls)
    assert matched["matched"] == 0 and matched["elsewhere"] > 0.02 and matched["ratio"] == 0


def test_is_about_one_for_motions_in_the_wrong_scenes(walls):
    metric, generator = SceneAwareness(BONES, frames=20), torch.manual_seed(0)
    for _ in range(6):
        joints = aware(walls)[torch.randperm(24, generator=generator)]
        metric.update(joints, walls, joints, walls[torch.randperm(24, generator=generator)])
    assert float(metric.compute()["ratio"]) == pytest.approx(1, abs=0.2)


def test_does_not_react_to_a_millimetre_of_jitter(walls):
    blind = walk(torch.full((24,), 1.2))
    jitter = 0.001 * torch.randn(blind.shape, generator=torch.manual_seed(0))
    still, shaken = measured(blind, walls), measured(blind + jitter, walls)
    assert shaken == pytest.approx(still, abs=0.01) and still["matched"] > 0.02


def test_does_not_react_to_the_level_alone(walls):
    blind = walk(torch.full((24,), 1.2))
    thin, fat = (measured(blind, walls, frames=64, radii=(radius,)) for radius in (0.03, 0.12))
    assert fat["matched"] > 1.3 * thin["matched"] > 0
    assert thin["ratio"] == pytest.approx(1) and fat["ratio"] == pytest.approx(1)


def test_shares_are_what_the_non_collision_ratio_leaves(walls):
    joints, other = walk(torch.full((24,), 1.2)), torch.arange(24).roll(12)
    index = torch.arange(24) + 100
    metric = SceneAwareness(BONES, frames=7, seed=3)
    metric.update(joints, walls, joints, walls[other], index)
    for name, scenes in (("matched", walls), ("elsewhere", walls[other])):
        clear = NonCollisionRatio(BONES, frames=7, seed=3)
        clear.update(joints, scenes, index)
        assert float(metric.compute()[name]) == pytest.approx(1 - float(clear.compute()["average"]))


def test_whole_motions(walls):
    found = measured(aware(walls), walls, unit="motion")
    assert found["matched"] == 0 and found["elsewhere"] > measured(aware(walls), walls)["elsewhere"]


def test_has_no_ratio_where_nothing_collides(walls):
    found = measured(walk(torch.zeros(24)), walls)
    assert found["matched"] == found["elsewhere"] == 0 and math.isnan(found["ratio"])


def test_batches_make_no_difference_and_it_survives_a_pickle_and_a_reset(walls):
    joints, other = walk(torch.full((24,), 1.2)), torch.arange(24).roll(12)
    whole, parts = SceneAwareness(BONES, frames=5), SceneAwareness(BONES, frames=5)
    whole.update(joints, walls, joints, walls[other])
    for part in torch.arange(24).split(7):
        parts.update(joints[part], walls[part], joints[part], walls[other][part])
    parts = pickle.loads(pickle.dumps(parts))
    assert parts.compute() == whole.compute() and float(whole.compute()["matched"]) > 0
    parts.reset()
    parts.update(joints[:1], walls[-1:], joints[:1], walls[-1:])
    assert float(parts.compute()["matched"]) == 0


def test_refuses(walls):
    metric, joints = SceneAwareness(BONES), aware(walls)
    with pytest.raises(SagError, match="24 motions but 3 of them moved"):
        metric.update(joints, walls, joints[:3], walls[:3])
    with pytest.raises(SagError, match="scene awareness was given 24 motions but 3 clouds"):
        metric.update(joints, walls, joints, walls[:3])
    with pytest.raises(SagError, match="scene awareness needs the depth"):
        metric.update(joints, walls, joints, None)
    with pytest.raises(SagError, match="not finite"):
        metric.update(joints, walls, joints / 0, walls)
    with pytest.raises(SagError, match="frames of scene awareness"):
        SceneAwareness(BONES, frames=0)
    with pytest.raises(SagError, match="before any motion"):
        metric.compute()
