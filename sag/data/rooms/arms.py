"""How the arms swing against the legs, rest on the thighs of a seated person and reach for a target."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from sag.data.rooms.feet import ease
from sag.data.rooms.pelvis import Rhythm, wander
from sag.data.rooms.person import FOREARM, UPPER_ARM, Person, Plan
from sag.data.rooms.torso import Torso
from sag.geometry.kinematics import rotation, turned, two_bone, unit

DOWN = np.array([0.0, 0.0, -1.0])

ON_THIGH = 0.45
"""Where a seated person's wrist lies between hip and knee."""

ABOVE_THIGH = 0.08
"""Height of a seated person's wrist over the line from hip to knee, metres at scale 1."""


def move_arm(
    side: int,
    plan: Plan,
    person: Person,
    rhythm: Rhythm,
    torso: Torso,
    thigh: Float[np.ndarray, "2 t 3"],
    rng: np.random.Generator,
) -> Float[np.ndarray, "t 3 3"]:
    """Shoulder, elbow and wrist of the right (-1) or left (1) arm, metres, world frame.

    Args:
        side: which arm.
        plan: what the person does.
        person: who moves.
        rhythm: of the steps.
        torso: the shoulders hang from it.
        thigh: hip and knee of the arm's side, metres, world frame.
        rng: makes each arm a little irregular.
    """
    shoulder = torso.shoulder(side, person.scale)
    upper, fore, yaw = _hanging(side, plan, person, rhythm, torso, rng)
    elbow = shoulder + upper * UPPER_ARM * person.scale
    wrist = elbow + fore * FOREARM * person.scale
    pole = unit(upper - fore)
    rest = ease(plan.seated, 0.3, 0.95)
    lap = thigh[0] + ON_THIGH * (thigh[1] - thigh[0]) - ABOVE_THIGH * person.scale * DOWN
    wrist, pole = _toward(wrist, pole, lap, rest, turned(rotation(yaw), np.array([-0.6, 0.5 * side, -0.3])))
    if side < 0 and plan.reach.any():
        out = turned(rotation(yaw), np.array([-0.2, -0.6, -0.8]))
        wrist, pole = _toward(wrist, pole, plan.reach_point, plan.reach, out)
    elbow, wrist = two_bone(shoulder, wrist, UPPER_ARM * person.scale, FOREARM * person.scale, pole)
    return np.stack([shoulder, elbow, wrist], axis=1)


def _hanging(
    side: int, plan: Plan, person: Person, rhythm: Rhythm, torso: Torso, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "t 3"], Float[np.ndarray, "t 3"], Float[np.ndarray, " t"]]:
    """Directions of upper arm and forearm of a hanging, swinging arm, and the yaw of the chest, radians."""
    frames = len(plan)
    swing = -side * person.arm_swing * rhythm.stride
    yaw = np.unwrap(np.arctan2(torso.chest[:, 1, 0], torso.chest[:, 0, 0]))
    raised = 0.62 * swing - 0.06 + 0.03 * wander(frames, 4.0, rng)
    spread = side * (person.arm_spread + 0.02 * wander(frames, 5.0, rng))
    bend = person.elbow_bend + 0.3 * np.logaddexp(0.0, 5 * swing) / 5 + 0.04 * wander(frames, 5.0, rng)
    upper = turned(rotation(yaw, -raised, spread), DOWN)
    fore = turned(rotation(yaw - side * 0.25, -raised - bend, spread * 0.6), DOWN)
    return upper, fore, yaw


def _toward(
    wrist: Float[np.ndarray, "t 3"],
    pole: Float[np.ndarray, "t 3"],
    target: Float[np.ndarray, "... 3"],
    weight: Float[np.ndarray, " t"],
    target_pole: Float[np.ndarray, "t 3"],
) -> tuple[Float[np.ndarray, "t 3"], Float[np.ndarray, "t 3"]]:
    """The wrist and the pole of its elbow on their way to a target."""
    share = weight[:, None]
    return wrist + (target - wrist) * share, pole + (target_pole - pole) * share
