"""Plans of everything that a person of the rooms does, and clips of them."""

from functools import cache

import numpy as np
import pytest

from sag.data.rooms.body import Person, Plan, animate
from sag.data.rooms.feet import move_foot
from sag.data.rooms.footsteps import plan_footsteps
from sag.data.rooms.person import ANKLE, FRAME_RATE
from sag.skeleton import GTA_IM_19

FRAMES = 240
TIME = np.arange(FRAMES) / FRAME_RATE
NOWHERE = np.full(3, np.nan)
LEGS = {side: GTA_IM_19.index(*(f"{side}_{n}" for n in ("hip", "knee", "ankle"))) for side in ("right", "left")}
ANKLES = [LEGS["right"][2], LEGS["left"][2]]
ROOT = GTA_IM_19.root_index
LENGTHS = {
    ("neck", "head"): 0.1131,
    ("spine0", "neck"): 0.2485,
    ("spine1", "spine0"): 0.1129,
    ("spine2", "spine1"): 0.0859,
    ("spine3", "spine2"): 0.0849,
    ("root", "spine3"): 0.0212,
    ("neck", "right_shoulder"): 0.2130,
    ("right_shoulder", "right_elbow"): 0.2742,
    ("right_elbow", "right_wrist"): 0.2592,
    ("root", "right_hip"): 0.1210,
    ("right_hip", "right_knee"): 0.4065,
    ("right_knee", "right_ankle"): 0.4130,
}


def minimum_jerk(x):
    x = np.clip(x, 0.0, 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2)


def there_and_back(start, end, lasts=1.3):
    return minimum_jerk((TIME - start) / lasts) * (1 - minimum_jerk((TIME - end) / lasts))


def level(points):
    return np.zeros(len(points))


def stairs_up(points):
    return 0.17 * np.clip(np.floor((points[:, 0] - 0.9) / 0.3) + 1, 0, 4)


def stairs_down(points):
    return 0.68 - stairs_up(points)


def ramp(points):
    return 0.2 * np.clip(points[:, 0] - 1, 0, 2.5)


def platform(points):
    return 0.16 * ((points[:, 0] > 1.5) & (points[:, 0] < 3.5))


def plan(speed=0.0, turning=0.0, floor=level, **changed):
    """A plan with these speeds (metres and radians a second, numbers or a value for each frame)."""
    heading = 0.5 + np.cumsum(np.broadcast_to(turning, TIME.shape)) / FRAME_RATE
    if floor is not level:
        heading = heading - 0.5
    way = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    none = np.zeros(FRAMES)
    values = {
        "position": np.cumsum(way * np.broadcast_to(speed, TIME.shape)[:, None], axis=0) / FRAME_RATE,
        "heading": heading,
        "seated": none,
        "seat_point": NOWHERE,
        "reach": none,
        "reach_point": NOWHERE,
        "floor": floor,
    }
    return Plan(**{**values, **changed})


SEAT = np.array([-0.38 * np.cos(0.5), -0.38 * np.sin(0.5), 0.45])
TARGET = np.array([0.45, 0.1, 1.2])
PLANS = {
    "walk": plan(1.2),
    "stroll": plan(0.5),
    "hurry": plan(1.5),
    "curve": plan(1.0, 0.9 * there_and_back(1, 4)),
    "turn on the spot": plan(0.0, 1.4 * there_and_back(1, 3)),
    "start and stop": plan(1.2 * there_and_back(1, 5)),
    "stairs up": plan(0.5, floor=stairs_up),
    "stairs down": plan(0.5, floor=stairs_down),
    "ramp": plan(1.0, floor=ramp),
    "platform": plan(0.9, floor=platform),
    "stand": plan(),
    "sit": plan(seated=there_and_back(1, 5), seat_point=SEAT),
    "reach": plan(reach=there_and_back(1, 5), reach_point=TARGET),
}
WALKS = [name for name in PLANS if name not in ("stand", "sit", "reach")]
PEOPLE = {"average": Person(), "some": Person.random(np.random.default_rng(3)), "small": Person(scale=0.92)}


@cache
def clip(name, person="average", seed=0):
    return animate(PLANS[name], PEOPLE[person], np.random.default_rng(seed))


@cache
def feet_of(name, person="average", seed=0):
    steps = plan_footsteps(PLANS[name], PEOPLE[person], np.random.default_rng(seed))
    return steps, [move_foot(foot, PLANS[name], PEOPLE[person]) for foot in steps]


def clearance(joints, name, person="average"):
    """Height of both ankles over where they are when the foot is flat on the floor, metres."""
    ankles = joints[:, ANKLES]
    floor = PLANS[name].floor(ankles[..., :2].reshape(-1, 2)).reshape(-1, 2)
    return ankles[..., 2] - floor - ANKLE * PEOPLE[person].scale


def speeds(joints):
    return np.linalg.norm(np.diff(joints, axis=0), axis=-1) * FRAME_RATE


def knee_bend(joints, side):
    hip, knee, ankle = (joints[:, j] for j in LEGS[side])
    cosine = ((knee - hip) * (ankle - knee)).sum(-1) / np.linalg.norm(knee - hip, axis=-1)
    return np.degrees(np.arccos(np.clip(cosine / np.linalg.norm(ankle - knee, axis=-1), -1, 1)))


every_plan = pytest.mark.parametrize("name", PLANS)
every_walk = pytest.mark.parametrize("name", WALKS)
every_person = pytest.mark.parametrize("person", PEOPLE)
