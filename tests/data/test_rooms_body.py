import time

import numpy as np
import pytest
from rooms_plans import (
    ANKLES,
    FRAMES,
    LEGS,
    LENGTHS,
    PEOPLE,
    PLANS,
    ROOT,
    SEAT,
    TARGET,
    clip,
    every_person,
    every_plan,
    every_walk,
    feet_of,
    plan,
    speeds,
    there_and_back,
)

from sag.data.rooms.body import Person, animate
from sag.data.rooms.person import FRAME_RATE
from sag.errors import SagError
from sag.skeleton import GTA_IM_19


@every_plan
@every_person
def test_clip_has_the_joints_of_every_frame(name, person):
    joints = clip(name, person)
    assert joints.shape == (FRAMES, 19, 3)
    assert np.isfinite(joints).all()


@every_plan
@every_person
def test_bones_keep_their_lengths(name, person):
    ends = clip(name, person)[:, GTA_IM_19.bone_index]
    lengths = np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=-1)
    assert np.ptp(lengths, axis=0).max() < 1e-6


@pytest.mark.parametrize(("bone", "length"), LENGTHS.items())
def test_bones_have_the_proportions_of_gta_im(bone, length):
    for person in PEOPLE:
        frame = clip("walk", person)[7]
        for names in {bone, tuple(n.replace("right", "left") for n in bone)}:
            parent, child = frame[GTA_IM_19.index(*names)]
            assert np.linalg.norm(parent - child) == pytest.approx(length * PEOPLE[person].scale, abs=5e-4)


@every_plan
@every_person
def test_nothing_jumps(name, person):
    joints = clip(name, person)
    fastest = speeds(joints).max(axis=0)
    assert fastest.max() < 6.0
    assert fastest[ROOT] < 2.2
    acceleration = np.linalg.norm(np.diff(joints, 2, axis=0), axis=-1) * FRAME_RATE**2
    assert acceleration.max() < 120
    assert acceleration[:, ROOT].max() < 25


@every_walk
def test_pelvis_follows_the_plan(name):
    joints = clip(name)
    assert np.linalg.norm(joints[:, ROOT, :2] - PLANS[name].position, axis=1).max() < 0.05


@pytest.mark.parametrize(("name", "climbs"), [("stairs up", 0.68), ("stairs down", -0.68), ("ramp", 0.5)])
def test_pelvis_goes_up_and_down_with_the_floor(name, climbs):
    height = clip(name)[:, ROOT, 2]
    assert height[-30:].mean() - height[:30].mean() == pytest.approx(climbs, abs=0.04)


def test_arms_swing_against_the_legs():
    joints = clip("walk")
    ahead = np.array([np.cos(0.5), np.sin(0.5), 0])
    wrists = joints[:, GTA_IM_19.index("right_wrist", "left_wrist")] @ ahead
    ankles = joints[:, ANKLES] @ ahead
    assert np.corrcoef(wrists[:, 0] - wrists[:, 1], ankles[:, 0] - ankles[:, 1])[0, 1] < -0.9
    assert np.ptp(wrists[:, 0] - wrists[:, 1]) > 0.3


def test_pelvis_bobs_at_every_step_and_sways_at_every_other():
    joints, (steps, _) = clip("walk"), feet_of("walk")
    pace = len(np.concatenate([s.land[(s.land > 0) & (s.land < FRAMES)] for s in steps])) / (FRAMES / FRAME_RATE)
    left = np.array([-np.sin(0.5), np.cos(0.5), 0])
    for values, rate in ((joints[:, ROOT, 2], pace), (joints[:, ROOT] @ left, pace / 2)):
        spectrum = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(FRAMES)))
        assert np.fft.rfftfreq(FRAMES, 1 / FRAME_RATE)[spectrum.argmax()] == pytest.approx(rate, abs=0.2)
    assert 0.01 < np.ptp(joints[:, ROOT, 2]) < 0.06


def test_body_leans_into_turns():
    joints = clip("curve")
    left = np.stack([-np.sin(PLANS["curve"].heading), np.cos(PLANS["curve"].heading)], axis=-1)
    lean = ((joints[:, GTA_IM_19.index("neck")[0], :2] - joints[:, ROOT, :2]) * left).sum(-1)
    assert lean[80:130].mean() > lean[:20].mean() + 0.02


@every_person
def test_seated_person_sits_on_the_seat_with_hands_on_the_thighs(person):
    joints, scale = clip("sit", person), PEOPLE[person].scale
    seated = PLANS["sit"].seated > 0.999
    np.testing.assert_allclose(
        joints[seated, ROOT] - SEAT, np.broadcast_to([0, 0, 0.095], (seated.sum(), 3)), atol=2e-3
    )
    for side, (hip, knee, _) in LEGS.items():
        wrist = joints[seated, GTA_IM_19.index(f"{side}_wrist")[0]]
        thigh = joints[seated, hip] + 0.5 * (joints[seated, knee] - joints[seated, hip])
        assert np.linalg.norm(wrist - thigh, axis=1).max() < 0.1 * scale
        assert np.linalg.norm(joints[seated, knee, :2] - SEAT[:2], axis=1).min() > 0.3


def test_trunk_leans_forward_on_the_way_to_the_seat_and_is_upright_on_it():
    joints, seated = clip("sit"), PLANS["sit"].seated
    trunk = joints[:, GTA_IM_19.index("neck")[0]] - joints[:, ROOT]
    lean = np.degrees(np.arctan2(trunk[:, :2] @ [np.cos(0.5), np.sin(0.5)], trunk[:, 2]))
    assert lean[(seated > 0.4) & (seated < 0.6)].min() > 20
    assert np.abs(lean[(seated > 0.99) | (seated < 0.01)]).max() < 12


@every_person
def test_hand_gets_to_its_target(person):
    joints, there = clip("reach", person), PLANS["reach"].reach > 0.999
    wrist = joints[:, GTA_IM_19.index("right_wrist")[0]]
    assert np.linalg.norm(wrist[there] - TARGET, axis=1).max() < 0.02
    assert np.linalg.norm(wrist[:20] - TARGET, axis=1).min() > 0.3


def test_trunk_helps_the_hand_to_a_low_target():
    target = np.array([0.5, 0.1, 0.45])
    joints = animate(plan(reach=there_and_back(1, 5), reach_point=target), Person(), np.random.default_rng(0))
    wrist = joints[FRAMES // 2, GTA_IM_19.index("right_wrist")[0]]
    assert np.linalg.norm(wrist - target) < 0.1
    assert joints[FRAMES // 2, ROOT, 2] < joints[0, ROOT, 2] - 0.1


def test_same_seed_gives_the_same_clip_and_another_seed_another():
    one, again, other = (animate(PLANS["curve"], Person(), np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_people_differ():
    scales = [Person.random(np.random.default_rng(seed)).scale for seed in range(50)]
    assert 0.92 <= min(scales) < 0.95 and 1.05 < max(scales) <= 1.08


def test_clip_is_quick_to_make():
    start = time.process_time()
    for seed in range(10):
        animate(PLANS["walk"], Person(), np.random.default_rng(seed))
    assert (time.process_time() - start) / 10 < 0.05


@pytest.mark.parametrize("wish", ["seated", "reach"])
def test_refuses_a_wish_without_a_place(wish):
    with pytest.raises(SagError, match="needs a finite"):
        plan(**{wish: there_and_back(1, 5)})
