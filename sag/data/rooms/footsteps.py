"""Where and when a person's feet are planted: footsteps along a plan."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.ndimage import binary_closing, gaussian_filter1d, label, maximum_filter1d

from sag.data.rooms.person import ANKLE, FRAME_RATE, Person, Plan

MARGIN = 45
"""Frames that a plan is continued for at either end, so that a clip may begin and end in mid-stride."""

LEAST_RATE = 0.3
"""Steps a second that the plan must ask for before a foot is lifted at all."""

TURN_OF_STEP = 0.6
"""How far one step turns on the spot, radians."""

RISE_OF_STEP = 0.18
"""How far one step goes up or down at most on average, metres."""

LEAST_WALK = 0.25
"""Steps that a stretch of a plan must ask for before it counts as a walk; less is a shift of weight."""

EARLY = 0.25
"""A walker's heel comes off the floor this many steps before the other foot lands."""

FLAT = 0.12
"""Steps after which the foot that struck the floor is flat on it and stays."""

LONGEST_SWING = 1.0 * FRAME_RATE
"""Frames that a foot is on its way at most; a slower walker waits with both feet on the ground."""

AHEAD = 0.5
"""A foot lands where the pelvis will be this many steps later."""

BEHIND = 0.03
"""How far the ankles of a standing person are behind the pelvis joint, metres at scale 1."""

SOLE = np.array([-0.06, 0.0, 0.07, 0.14, 0.19])
"""Places along the sole, from heel to toe, whose floors are looked at (metres from the ankle at scale 1)."""

SHIFTS = np.array([0.0, 0.04, -0.04, 0.08, -0.08, 0.12, -0.12, 0.16, -0.16])
"""How far a foot may be put forward or back so that it does not stand on an edge, metres, nearest first."""


@dataclass(frozen=True)
class Track:
    """A plan continued at both ends, with what the gait needs to know of it; times count from the first frame.

    Attributes:
        position: pelvis over the ground, metres, world.
        heading: radians.
        rate: steps a second.
        speed: metres a second.
    """

    position: Float[np.ndarray, "t 2"]
    heading: Float[np.ndarray, " t"]
    rate: Float[np.ndarray, " t"]
    speed: Float[np.ndarray, " t"]

    @classmethod
    def of(cls, plan: Plan, person: Person) -> Track:
        """The track of a plan, walked by this person; standing ends stay, walking ends go straight on."""
        steps = np.arange(1, MARGIN + 1)[:, None]
        first, last = (np.diff(plan.position[part], axis=0).mean(axis=0) for part in (slice(0, 4), slice(-4, None)))
        before = plan.position[0] - steps[::-1] * first
        position = np.concatenate([before, plan.position, plan.position[-1] + steps * last])
        heading = np.pad(plan.heading, MARGIN, mode="edge")
        speed = np.linalg.norm(gaussian_filter1d(np.gradient(position, axis=0), 2, axis=0), axis=1) * FRAME_RATE
        turning = gaussian_filter1d(np.gradient(heading), 2) * FRAME_RATE
        length = person.scale * person.step_length * (0.25 + 0.33 * speed)
        floor = gaussian_filter1d(plan.floor(position), 6)
        climbing = np.abs(np.gradient(floor)) * FRAME_RATE / RISE_OF_STEP
        rate = np.maximum(np.hypot(speed / length, turning / TURN_OF_STEP), climbing)
        # Who sets off or stops does so by shorter steps, not by slower ones.
        rate = gaussian_filter1d(maximum_filter1d(rate, 19), 4) * (rate > LEAST_RATE)
        return cls(position, heading, rate, speed)

    def pose(self, times: Float[np.ndarray, " n"]) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, " n"]]:
        """Position and heading at these times (frames)."""
        known = np.arange(len(self.heading)) - MARGIN
        x, y, heading = (np.interp(times, known, values) for values in (*self.position.T, self.heading))
        return np.stack([x, y], axis=-1), heading


@dataclass(frozen=True)
class Footsteps:
    """The steps of one foot, times in frames: step i leaves place i and lands on place i + 1.

    Attributes:
        start: when the heel leaves the floor.
        land: when the foot is planted again.
        ankle: where the ankle is while planted, metres, world.
        yaw: direction of the planted foot, radians.
    """

    start: Float[np.ndarray, " n"]
    land: Float[np.ndarray, " n"]
    ankle: Float[np.ndarray, "places 3"]
    yaw: Float[np.ndarray, " places"]


def plan_footsteps(plan: Plan, person: Person, rng: np.random.Generator) -> tuple[Footsteps, Footsteps]:
    """Footsteps of the right and of the left foot that carry a person along a plan.

    Steps alternate, are longer at speed and turn by small angles on the spot. A walk begins and ends with the
    feet side by side, unless the plan begins or ends in mid-walk.
    """
    track = Track.of(plan, person)
    walks = [_walk_steps(track, first, last, rng) for first, last in _walks(track)]
    timed = np.concatenate([np.zeros((0, 4)), *walks])
    right, left = (_foot(track, person, plan, timed[timed[:, 3] == side, :3], side) for side in (0, 1))
    return right, left


def _walks(track: Track) -> Iterator[tuple[int, int]]:
    """First and last index of every stretch in which feet move."""
    # A pause of half a second between two steps is a slow step.
    moving = binary_closing(track.rate > LEAST_RATE, np.ones(15))
    stretches, count = label(moving)
    for number in range(1, count + 1):
        inside = np.flatnonzero(stretches == number)
        if track.rate[inside].sum() / FRAME_RATE > LEAST_WALK:
            yield int(inside[0]), int(inside[-1])


def _walk_steps(track: Track, first: int, last: int, rng: np.random.Generator) -> Float[np.ndarray, "n 4"]:
    """Start, landing, time of the pelvis' pose that the foot is placed under, and side (0 right) of a walk's steps."""
    rate = np.maximum(track.rate[first : last + 1], 1.0)
    phase = np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2)]) / FRAME_RATE
    count = max(2, round(phase[-1] + 0.4))
    phase *= count / phase[-1]
    times = np.arange(first, last + 1) - MARGIN
    early = np.interp(track.speed[first : last + 1].mean(), [0.0, 0.5], [0.0, EARLY])
    number = np.arange(count)
    land = np.interp(number + 1 + FLAT, phase, times)
    start = np.maximum(np.interp(number - early, phase, times), land - LONGEST_SWING)
    under = np.interp(number + 1 + AHEAD, phase, times)
    turn = track.heading[min(first + FRAME_RATE, last)] - track.heading[first]
    side = (int(turn > 0) if abs(turn) > 0.3 else rng.integers(2)) + number
    return np.stack([start, land, under, side % 2], axis=-1)


def _foot(track: Track, person: Person, plan: Plan, steps: Float[np.ndarray, "n 3"], side: int) -> Footsteps:
    """The steps of one foot, placed beside where the pelvis will be and narrower at speed."""
    start, land, under = steps.T
    times = np.concatenate([[-MARGIN], under])
    position, heading = track.pose(times)
    outward = 1 if side else -1
    speed = np.interp(times, np.arange(len(track.speed)) - MARGIN, track.speed)
    half = outward * person.scale * (person.stance - 0.02 * np.minimum(speed, 1.0))
    back = -BEHIND * person.scale
    yaw = heading + outward * person.toe_out
    c, s = np.cos(heading), np.sin(heading)
    place = position + np.stack([c * back - s * half, s * back + c * half], axis=-1)
    return Footsteps(start, land, _on_floor(place, yaw, plan, person.scale), yaw)


def _on_floor(
    place: Float[np.ndarray, "n 2"], yaw: Float[np.ndarray, " n"], plan: Plan, scale: float
) -> Float[np.ndarray, "n 3"]:
    """Ankles of planted feet at the nearest places where the whole sole is on one level."""
    ahead = np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)
    along = SHIFTS[:, None] + SOLE * scale
    soles = place[:, None, None] + along[..., None] * ahead[:, None, None]
    floor = plan.floor(soles.reshape(-1, 2)).reshape(soles.shape[:-1])
    uneven = np.ptp(floor, axis=-1) > 0.06
    best: Int[np.ndarray, " n"] = (uneven + np.abs(SHIFTS)).argmin(axis=1)
    height = floor[np.arange(len(place)), best, 1] + ANKLE * scale
    return np.concatenate([place + SHIFTS[best, None] * ahead, height[:, None]], axis=-1)
