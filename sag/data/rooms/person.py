"""Who moves and what they do: a person's size and manner, and the plan of a clip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.errors import SagError

FRAME_RATE = 30
"""Frames a second of plans and clips."""

HIP = np.array([0.0, 0.0961, -0.0735])
"""Root to left hip in the pelvis' own frame (metres at scale 1), as all lengths here from GTA-IM."""

THIGH, SHIN = 0.4065, 0.4130
LEG = THIGH + SHIN
UPPER_ARM, FOREARM = 0.2742, 0.2592
ARM = UPPER_ARM + FOREARM

SHOULDER = np.array([-0.0201, 0.2027, -0.0622])
"""Neck to left shoulder in the chest's own frame; the clavicle between them is dropped, so the length is a mean."""

SPINE = np.array(
    [
        [-0.0127, 0.0, 0.0170],
        [-0.0084, 0.0, 0.0845],
        [-0.0007, 0.0, 0.0859],
        [0.0034, 0.0, 0.1128],
        [0.0128, 0.0, 0.2482],
    ]
)
"""Root to spine3, spine2, spine1, spine0 and neck, each from the joint before it, upright (metres at scale 1)."""

HEAD = np.array([0.0320, 0.0, 0.1085])
"""Neck to head, looking ahead (metres at scale 1)."""

ANKLE = 0.085
"""Height of the ankle over the floor when the foot is flat (metres at scale 1)."""

BALL = 0.15
"""From the ankle forward to the ball of the foot, about which the heel rises (metres at scale 1)."""


@dataclass(frozen=True)
class Plan:
    """What a person does at 30 frames a second, in the world frame (metres, z up).

    Attributes:
        position: where the pelvis is over the ground while standing or walking; smooth.
        heading: direction the pelvis faces as (cos, sin), radians, unwrapped and smooth.
        seated: 0 standing to 1 seated; while above 0 the pelvis is on its way to the seat or on it.
        seat_point: centre of the seat's surface in use, nan without a seat. The standing place is 0.35 to 0.4 m
            in front of it and faces away from it.
        reach: 0 to 1, how far the right hand has gone to its target.
        reach_point: target of the right hand, nan without one.
        floor: height of the floor under (n, 2) points over the ground.

    Raises:
        SagError: the person is to sit or to reach, but no place is given for it.
    """

    position: Float[np.ndarray, "t 2"]
    heading: Float[np.ndarray, " t"]
    seated: Float[np.ndarray, " t"]
    seat_point: Float[np.ndarray, " 3"]
    reach: Float[np.ndarray, " t"]
    reach_point: Float[np.ndarray, " 3"]
    floor: Callable[[np.ndarray], np.ndarray]

    def __post_init__(self) -> None:
        for wish, point in (("seated", "seat_point"), ("reach", "reach_point")):
            if getattr(self, wish).any() and not np.isfinite(getattr(self, point)).all():
                raise SagError(f"a plan with {wish} above 0 needs a finite {point}, in metres in the world frame")

    def __len__(self) -> int:
        return len(self.heading)


@dataclass(frozen=True)
class Person:
    """A person's size and manner of moving; factors are 1 for the average person.

    Attributes:
        scale: factor on all lengths of the body.
        step_length: factor on the length of steps at a given speed.
        stance: half the distance between the ankles when standing, metres at scale 1.
        toe_out: angle of the feet away from straight ahead, radians.
        heel_lift: factor on how far the heel rises before a step.
        knee_bend: how far the pelvis is below where straight legs would hold it, metres.
        sway: factor on sideways movement and rotation of pelvis and chest.
        lean: forward lean of the torso, radians.
        arm_swing: factor on how far the arms swing.
        arm_spread: angle of the upper arms away from the body, radians.
        elbow_bend: bend of the elbows at rest, radians.
    """

    scale: float = 1.0
    step_length: float = 1.0
    stance: float = 0.1
    toe_out: float = 0.12
    heel_lift: float = 1.0
    knee_bend: float = 0.003
    sway: float = 1.0
    lean: float = 0.03
    arm_swing: float = 1.0
    arm_spread: float = 0.16
    elbow_bend: float = 0.3

    @classmethod
    def random(cls, rng: np.random.Generator) -> Person:
        """Some person."""
        return cls(
            scale=rng.uniform(0.92, 1.08),
            step_length=rng.uniform(0.92, 1.08),
            stance=rng.uniform(0.085, 0.12),
            toe_out=rng.uniform(0.03, 0.22),
            heel_lift=rng.uniform(0.85, 1.15),
            knee_bend=rng.uniform(0.0, 0.008),
            sway=rng.uniform(0.6, 1.4),
            lean=rng.uniform(-0.02, 0.08),
            arm_swing=rng.uniform(0.5, 1.4),
            arm_spread=rng.uniform(0.1, 0.24),
            elbow_bend=rng.uniform(0.15, 0.55),
        )
