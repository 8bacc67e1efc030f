"""A person's body: what a plan asks for, frame by frame, as 19 joints of GTA-IM's proportions.

Feet come first, because a planted foot must not move: footsteps are planned along the path, the pelvis is
carried over them, legs join the two, and the trunk and the arms follow.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from sag.data.rooms.arms import move_arm
from sag.data.rooms.feet import Foot, move_foot
from sag.data.rooms.footsteps import plan_footsteps
from sag.data.rooms.pelvis import Pelvis, Rhythm, carry_pelvis
from sag.data.rooms.person import SHIN, THIGH, Person, Plan
from sag.data.rooms.reaching import Stoop
from sag.data.rooms.torso import hold_torso
from sag.geometry.kinematics import two_bone

__all__ = ["Person", "Plan", "animate"]


def animate(plan: Plan, person: Person, rng: np.random.Generator) -> Float[np.ndarray, "t 19 3"]:
    """A person who carries out a plan: joints in the order of `sag.skeleton.GTA_IM_19`, metres, world frame.

    Bones keep their lengths and planted ankles their places. The same generator state gives the same clip.
    """
    steps = plan_footsteps(plan, person, rng)
    feet = move_foot(steps[0], plan, person), move_foot(steps[1], plan, person)
    rhythm, stoop = Rhythm.of(plan, person, feet, rng), Stoop.of(plan, person)
    pelvis = carry_pelvis(plan, person, feet, rhythm, stoop, rng)
    torso = hold_torso(plan, person, pelvis, rhythm, stoop, rng)
    legs = [_leg(side, person, pelvis, foot) for side, foot in zip((-1, 1), feet)]
    arms = [
        move_arm(side, plan, person, rhythm, torso, leg[:, :2].transpose(1, 0, 2), rng)
        for side, leg in zip((-1, 1), legs)
    ]
    head, neck = torso.head[:, None], torso.neck[:, None]
    spine = torso.spine[:, -2::-1]
    return np.concatenate([head, neck, *arms, spine, pelvis.place[:, None], *legs], axis=1)


def _leg(side: int, person: Person, pelvis: Pelvis, foot: Foot) -> Float[np.ndarray, "t 3 3"]:
    """Hip, knee and ankle of the right (-1) or left (1) leg."""
    hip = pelvis.hips(person.scale)[max(side, 0)]
    yaw = pelvis.yaw + 0.6 * (foot.yaw - pelvis.yaw)
    forward = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=-1)
    knee, ankle = two_bone(hip, foot.ankle, THIGH * person.scale, SHIN * person.scale, forward)
    return np.stack([hip, knee, ankle], axis=1)
