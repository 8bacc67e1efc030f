"""How the trunk and the knees help a hand to its target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.data.rooms.person import ANKLE, ARM, HIP, LEG, SHOULDER, SPINE, Person, Plan

FARTHEST_LEAN = 1.15
"""How far the trunk leans for a target at most, radians."""

EASY = 1.02
"""Distance from the shoulder, in arm lengths, from which the trunk leans; the turn of the chest adds the rest."""

CURVED = 0.85
"""Share of the chest's lean that the way from root to shoulder leans, because the spine curves."""

HIPS_BACK = 0.3
"""How far the hips go back in a squat for each metre that they sink."""

LOWEST_STANDING = 0.8
"""Height over the floor that a hand gets to without bending the knees, metres at scale 1."""

DEEPEST_SQUAT = 0.45
"""How far the pelvis sinks for a target at most, metres at scale 1."""


@dataclass(frozen=True)
class Stoop:
    """What the body does for a reaching hand, in the frame of the heading.

    Attributes:
        twist: rotation of the chest to the left, which brings the right shoulder forward, radians.
        forward: lean of the trunk, radians.
        aside: lean of the trunk to the right, radians.
        squat: how far the pelvis sinks, metres.
    """

    twist: Float[np.ndarray, " t"]
    forward: Float[np.ndarray, " t"]
    aside: Float[np.ndarray, " t"]
    squat: Float[np.ndarray, " t"]

    @classmethod
    def of(cls, plan: Plan, person: Person) -> Stoop:
        """The stoop that brings the right shoulder near enough to the plan's target; none without a target."""
        if not plan.reach.any():
            return cls(*np.zeros((4, len(plan))))
        target = _from_root(plan, person)
        above_floor = target[:, 2] / person.scale + ANKLE + LEG - HIP[2]
        squat = np.clip(LOWEST_STANDING - above_floor, 0.0, DEEPEST_SQUAT) * person.scale
        lean = _lean(target + np.stack([HIPS_BACK * squat, 0 * squat, squat], axis=-1), person.scale) * plan.reach
        toward = np.clip(np.arctan2(target[:, 1], target[:, 0]), -1.2, 1.2)
        twist = (0.2 + 0.35 * toward) * plan.reach
        return cls(twist, lean * np.cos(toward), -0.7 * lean * np.sin(toward), squat * plan.reach)


def _lean(target: Float[np.ndarray, "t 3"], scale: float) -> Float[np.ndarray, " t"]:
    """Angle from the vertical at which a trunk brings its shoulder within an arm's length of the target, radians."""
    trunk, arm = (SPINE.sum(axis=0) + SHOULDER)[2] * scale, EASY * ARM * scale
    away = np.linalg.norm(target, axis=1)
    down = np.arccos(np.clip(target[:, 2] / away, -1.0, 1.0))
    # Trunk, arm and the way from the root to the target are a triangle.
    between = np.arccos(np.clip((away**2 + trunk**2 - arm**2) / (2 * away * trunk), -1.0, 1.0))
    return np.clip((down - between) / CURVED, 0.0, FARTHEST_LEAN)


def _from_root(plan: Plan, person: Person) -> Float[np.ndarray, "t 3"]:
    """Way from the root of an upright person to the target, less what the shoulder is aside: forward, left, up."""
    x, y = (plan.reach_point[:2] - plan.position).T
    c, s = np.cos(plan.heading), np.sin(plan.heading)
    root = plan.floor(plan.position) + (ANKLE + LEG - HIP[2]) * person.scale
    aside = SHOULDER[1] * person.scale
    return np.stack([x * c + y * s, y * c - x * s + aside, plan.reach_point[2] - root], axis=-1)
