import numpy as np
import pytest
from rooms_plans import (
    ANKLES,
    FRAMES,
    LEGS,
    PLANS,
    ROOT,
    clearance,
    clip,
    every_person,
    every_plan,
    every_walk,
    feet_of,
    knee_bend,
)

from sag.data.rooms.feet import TOE_OFF
from sag.data.rooms.person import FRAME_RATE
from sag.skeleton import GTA_IM_19


@every_plan
@every_person
def test_planted_foot_stays_and_stands_on_the_floor(name, person):
    joints, (_, feet) = clip(name, person), feet_of(name, person)
    height = clearance(joints, name, person)
    for foot, ankle, over_floor in zip(feet, ANKLES, height.T):
        planted = foot.swing == 0
        assert planted.mean() > 0.25
        moved = np.linalg.norm(np.diff(joints[:, ankle], axis=0), axis=1)
        assert moved[planted[1:] & planted[:-1]].max() < 1e-6
        assert np.abs(over_floor[planted]).max() < 1e-6
    assert height.min() > -0.002


@every_plan
def test_foot_does_not_skate_while_its_ankle_is_low(name):
    joints = clip(name)
    for ankle, low in zip(ANKLES, (clearance(joints, name) < 0.004).T):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], low.astype(int), [0]])))
        for start, end in edges.reshape(-1, 2):
            stance = joints[start:end, ankle]
            assert np.linalg.norm(stance - np.median(stance, axis=0), axis=1).max() < 0.012


@every_plan
def test_one_foot_is_always_on_the_floor(name):
    steps, _ = feet_of(name)
    in_air = np.zeros((2, FRAMES), dtype=bool)
    for air, foot in zip(in_air, steps):
        for start, land in zip(foot.start, foot.land):
            air |= (np.arange(FRAMES) > start + TOE_OFF * (land - start)) & (np.arange(FRAMES) < land)
    assert not in_air.all(axis=0).any()


@every_walk
def test_steps_alternate(name):
    (right, left), _ = feet_of(name)
    sides = np.concatenate([np.zeros(len(right.land)), np.ones(len(left.land))])
    order = sides[np.argsort(np.concatenate([right.land, left.land]))]
    assert len(order) >= 4
    assert (np.diff(order) != 0).all()


def test_steps_are_longer_and_quicker_at_speed():
    length, rate = {}, {}
    for name in ("stroll", "walk", "hurry"):
        (right, left), _ = feet_of(name)
        length[name] = np.median(np.linalg.norm(np.diff(right.ankle[2:, :2], axis=0), axis=1)) / 2
        rate[name] = FRAME_RATE / np.median(np.diff(np.sort(np.concatenate([right.land, left.land]))))
    assert length["stroll"] + 0.1 < length["walk"] < length["hurry"]
    assert rate["stroll"] + 0.3 < rate["walk"] < rate["hurry"] < 2.6
    assert 0.55 < length["walk"] < 0.75


@every_plan
@every_person
def test_knees_bend_forward_and_are_never_straight(name, person):
    joints = clip(name, person)
    forward = np.stack([np.cos(PLANS[name].heading), np.sin(PLANS[name].heading), np.zeros(FRAMES)], axis=-1)
    for side, (hip, knee, ankle) in LEGS.items():
        middle = (joints[:, hip] + joints[:, ankle]) / 2
        assert ((joints[:, knee] - middle) * forward).sum(-1).min() > 0
        assert knee_bend(joints, side).min() > 10


def test_swinging_knee_bends_more_than_the_standing_one():
    bend = knee_bend(clip("walk"), "right")
    assert 50 < bend.max() < 80
    assert bend.min() < 25


@pytest.mark.parametrize("name", ["stairs up", "stairs down"])
def test_stairs_are_climbed_tread_by_tread(name):
    steps, _ = feet_of(name)
    for foot in steps:
        assert np.abs(np.diff(foot.ankle[:, 2])).max() < 0.36


@pytest.mark.parametrize("name", ["start and stop", "turn on the spot"])
def test_feet_come_together_at_rest(name):
    joints = clip(name)
    apart = np.linalg.norm(joints[:, ANKLES[0], :2] - joints[:, ANKLES[1], :2], axis=1)
    for still in (apart[:20], apart[-20:]):
        assert np.ptp(still) < 1e-6
        assert still.mean() < 0.35


def test_standing_person_keeps_the_feet_and_moves_a_little():
    moved = np.ptp(clip("stand"), axis=0).max(axis=1)
    assert moved[ANKLES].max() < 1e-6
    assert 0.004 < moved[ROOT] < 0.1
    assert 0.01 < moved[GTA_IM_19.index("right_wrist")[0]] < 0.3
