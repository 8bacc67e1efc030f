"""Foot contact and foot skate: feet that slide, float and sink, and what is nothing to them."""

import jaxtyping
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from sag.errors import SagError
from sag.metrics.scene.feet import FootContact, FootSkate, footing
from sag.skeleton import GTA_IM_19

FEET = GTA_IM_19.index("right_ankle", "left_ankle")
FPS = 30.0
FLAT = torch.zeros(3, 65, 2)


def standing() -> Tensor:
    """People who stand on a floor at height 0."""
    world = 0.5 + torch.rand(3, 1, 19, 3, generator=torch.manual_seed(0)).expand(3, 65, 19, 3).double()
    world[:, :, FEET, 2] = 0.085
    return world


def figures(world: Tensor, floor: Tensor = FLAT, fps: float = FPS, **options: float) -> tuple[float, float]:
    """Skate and contact."""
    metrics = FootSkate(FEET, fps, **options), FootContact(FEET, fps, **options)
    for metric in metrics:
        for some, under in zip(world.split(2), floor.split(2)):
            metric.update(some, under)
    skate, contact = (float(metric.compute()) for metric in metrics)
    return skate, contact


def test_people_who_stand_touch_and_do_not_slide():
    assert figures(standing()) == (0, 1)


@given(speed=st.floats(0.01, 5), heading=st.floats(0, 6.3), fps=st.sampled_from([5.0, 25.0, 30.0]))
@settings(max_examples=30, deadline=None)
def test_a_body_that_glides_skates_at_its_speed_at_any_rate(speed, heading, fps):
    world = standing()
    direction = torch.tensor([heading, heading + torch.pi / 2]).cos()
    world[..., :2] += (speed / fps) * torch.arange(65.0)[:, None, None] * direction
    skate, contact = figures(world, fps=fps)
    assert skate == pytest.approx(speed, rel=1e-6) and contact == 1


@given(lift=st.floats(0.03, 2), frames=st.integers(1, 63))
@settings(max_examples=20, deadline=None)
def test_a_body_in_the_air_has_no_contact_and_no_skate_there(lift, frames):
    world = standing()
    world[:, -frames:, :, 2] += lift
    world[:, -frames:, :, 0] += 0.1 * torch.arange(frames)[:, None]
    skate, contact = figures(world)
    assert contact == pytest.approx(1 - frames / 64) and skate == 0


def test_feet_that_never_touch_have_no_skate_to_be_proud_of():
    world = standing()
    world[..., 2] += 0.5
    world[..., 0] += 0.1 * torch.arange(65)[:, None]
    skate, contact = figures(world)
    assert skate != skate and contact == 0


def test_a_sunk_foot_slides_no_less():
    world = standing()
    world[..., 0] += 0.1 * torch.arange(65)[:, None]
    world[..., 2] -= 0.3
    assert figures(world) == pytest.approx((3, 1))


def test_one_foot_is_enough_for_contact_and_the_other_is_no_skater_in_the_air():
    world = standing()
    world[:, :, FEET[0], 2] = 0.3
    world[:, :, FEET[0], 0] += 0.05 * torch.arange(65)
    assert figures(world) == (0, 1)


def test_a_foot_that_slides_in_one_step_counts_by_its_share():
    world = standing()
    world[:, 40:, FEET[0], 1] += 0.128
    assert figures(world)[0] == pytest.approx(0.128 * FPS / 128)


def test_the_floor_may_be_anywhere_and_a_wrong_one_is_noticed():
    world, floor = standing(), FLAT + torch.linspace(0, 1, 65)[:, None]
    world[..., 2] += floor[:, :, :1]
    assert figures(world, floor) == (0, 1)
    assert figures(world, floor - 0.1)[1] == 0


def test_hands_and_vertical_motion_are_nothing_to_it():
    world = standing()
    hands = GTA_IM_19.index("right_wrist", "left_wrist")
    world[:, :, hands] += 0.1 * torch.randn(3, 65, 2, 3)
    world[:, ::2, FEET, 2] -= 0.01
    assert figures(world) == (0, 1)


def test_the_tolerance_decides_what_touches():
    world = standing()
    world[:, :, FEET, 2] += 0.04
    assert (
        figures(world)[1] == 0 and figures(world, tolerance=0.05)[1] == 1 and figures(world, ankle_height=0.12)[1] == 1
    )


def test_where_the_floor_is_not_known_nothing_is_judged():
    world, floor = standing(), FLAT.clone()
    world[:, 20:, :, 2] += 1
    floor[:, 20:] = torch.nan
    assert figures(world, floor) == (0, 1)
    floor[:, :, 0] = torch.nan
    world[:, :, FEET[0], 0] += torch.arange(65)
    assert figures(world, floor) == (0, 1)


def test_speed_and_contact_of_each_foot():
    world = standing()
    world[0, 1:, FEET[1]] += torch.tensor([0.3, 0.4, 0.5])
    found = footing(world, FLAT, FEET, FPS)
    assert found.contact[0, 1].tolist() == [True, False] and found.contact.sum() == 3 * 65 * 2 - 64
    assert found.speed[0, 0].tolist() == pytest.approx([0, 15]) and float(found.speed.sum()) == pytest.approx(15)


@pytest.mark.parametrize("kind", [FootSkate, FootContact])
def test_refuses(kind, monkeypatch):
    with pytest.raises(SagError, match=f"fps of {kind.title} must be above 0, not -1"):
        kind(FEET, fps=-1)
    metric = kind(FEET, FPS)
    with pytest.raises(SagError, match=f"{kind.title} was asked for before any motion over a known floor"):
        metric.compute()
    with pytest.raises(SagError, match="at least 19 joints, not 65 frames of 16"):
        metric.update(standing()[:, :, :16], FLAT)
    with pytest.raises(SagError, match="not finite"):
        metric.update(standing() / 0, FLAT)
    with pytest.raises(SagError, match="infinite height of the floor"):
        metric.update(standing(), FLAT - torch.inf)
    with pytest.raises(SagError, match=r"under each foot, shape \(3, 65, 2\), not \(3, 65, 3\)"):
        metric.update(standing(), torch.zeros(3, 65, 3))
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)  # as it is where shapes are not checked
    with pytest.raises(SagError, match=r"not \(3, 64, 2\)"):
        metric.update(standing(), FLAT[:, 1:])
