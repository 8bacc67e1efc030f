"""How the pelvis is carried by the legs: bob, sway and rotation with the steps, weight shifts, sitting down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

from sag.data.rooms.feet import Foot, ease
from sag.data.rooms.person import ANKLE, FRAME_RATE, HIP, LEG, Person, Plan
from sag.data.rooms.reaching import HIPS_BACK, Stoop
from sag.geometry.kinematics import STRAIGHT, reachable_height, rotation, turned

SEATED_HEIGHT = 0.095
"""Height of the pelvis joint over the seat, metres."""

SWAY = 0.024
"""How far the pelvis moves over the foot that carries the weight, metres at scale 1."""

PENDULUM = 0.7
"""Share of an inverted pendulum's fall that the pelvis makes between two steps; bending knees take the rest."""

SETTLE = 2
"""Frames before and after in which the pelvis gives way when a leg could not reach."""


@dataclass(frozen=True)
class Rhythm:
    """What the feet give to the body above them.

    Attributes:
        stride: how far the left foot is ahead of the right one, in leg lengths.
        load: -1 with the weight on the right foot, 1 on the left one.
        still: 1 while the person stands on both feet, 0 while walking or seated.
    """

    stride: Float[np.ndarray, " t"]
    load: Float[np.ndarray, " t"]
    still: Float[np.ndarray, " t"]

    @classmethod
    def of(cls, plan: Plan, person: Person, feet: tuple[Foot, Foot], rng: np.random.Generator) -> Rhythm:
        """The rhythm of these feet (right, left), with slow shifts of weight while they stand."""
        right, left = feet
        ahead = np.stack([np.cos(plan.heading), np.sin(plan.heading)], axis=-1)
        apart = ((left.ankle - right.ankle)[:, :2] * ahead).sum(axis=1) / (LEG * person.scale)
        still = np.exp(-6 * gaussian_filter1d(right.swing + left.swing, 10.0)) * (1 - plan.seated)
        shift = 0.8 * np.tanh(1.5 * wander(len(plan), 6.0, rng)) * still
        return cls(gaussian_filter1d(apart, 2.5), gaussian_filter1d(right.swing - left.swing, 3.0) + shift, still)


@dataclass(frozen=True)
class Pelvis:
    """The pelvis through a clip, world frame.

    Attributes:
        place: the root joint, metres.
        yaw: radians.
        pitch: radians, forward.
        roll: radians, to the right.
    """

    place: Float[np.ndarray, "t 3"]
    yaw: Float[np.ndarray, " t"]
    pitch: Float[np.ndarray, " t"]
    roll: Float[np.ndarray, " t"]

    def hips(self, scale: float) -> tuple[Float[np.ndarray, "t 3"], Float[np.ndarray, "t 3"]]:
        """The right and the left hip, metres, world frame."""
        turn = rotation(self.yaw, self.pitch, self.roll)
        right, left = (self.place + turned(turn, HIP * scale * [1, side, 1]) for side in (-1, 1))
        return right, left


def wander(frames: int, period: float, rng: np.random.Generator) -> Float[np.ndarray, " t"]:
    """Slow irregular movement about 0 with deviation 1, whose waves last about `period` seconds."""
    times = np.arange(frames)[:, None] / FRAME_RATE
    periods = period * rng.uniform(0.6, 1.8, 4)
    return np.sin(2 * np.pi * (times / periods + rng.random(4))).sum(axis=1) / np.sqrt(2)


def carry_pelvis(
    plan: Plan, person: Person, feet: tuple[Foot, Foot], rhythm: Rhythm, stoop: Stoop, rng: np.random.Generator
) -> Pelvis:
    """The pelvis over these feet (right, left), never higher than both legs reach."""
    place = _standing(plan, person, feet, rhythm, stoop)
    if plan.seated.any():
        place = _to_seat(plan, place)
    bend = 0.35 * np.sin(np.pi * plan.seated) ** 2 - 0.2 * ease(plan.seated, 0.5) + 0.6 * stoop.forward
    pelvis = Pelvis(
        place,
        yaw=plan.heading - 0.17 * person.sway * rhythm.stride + 0.03 * wander(len(plan), 5.0, rng) * rhythm.still,
        pitch=0.02 + 0.5 * person.lean + bend,
        roll=0.045 * person.sway * rhythm.load,
    )
    pelvis.place[:, 2] = _within_reach(pelvis, feet, person.scale)
    return pelvis


def _standing(
    plan: Plan, person: Person, feet: tuple[Foot, Foot], rhythm: Rhythm, stoop: Stoop
) -> Float[np.ndarray, "t 3"]:
    """The root of a person on straight legs who does not sit."""
    c, s = np.cos(plan.heading), np.sin(plan.heading)
    left = SWAY * person.scale * person.sway * rhythm.load
    # Who stoops or squats keeps the weight over the feet by moving the hips back.
    ahead = -0.12 * stoop.forward - HIPS_BACK * stoop.squat
    ground = gaussian_filter1d((feet[0].ground + feet[1].ground) / 2, 4.0)
    fall = LEG * (1 - np.sqrt(1 - np.minimum(rhythm.stride / 2, 0.5) ** 2))
    height = ground + (ANKLE + STRAIGHT * LEG - HIP[2] - PENDULUM * fall) * person.scale
    height = height - person.knee_bend - stoop.squat
    x, y = plan.position.T
    return np.stack([x + ahead * c - left * s, y + ahead * s + left * c, height], axis=-1)


def _to_seat(plan: Plan, standing: Float[np.ndarray, "t 3"]) -> Float[np.ndarray, "t 3"]:
    """The root between standing and the seat: the hips travel about the knees, first back, then down."""
    seat = plan.seat_point + [0, 0, SEATED_HEIGHT]
    back, down = np.sin(np.pi / 2 * plan.seated), 1 - np.cos(np.pi / 2 * plan.seated)
    return standing + (seat - standing) * np.stack([back, back, down], axis=-1)


def _within_reach(pelvis: Pelvis, feet: tuple[Foot, Foot], scale: float) -> Float[np.ndarray, " t"]:
    """The height of the root at which both legs reach their ankles, without haste."""
    limits = [reachable_height(h, f.ankle, LEG * scale) - h[:, 2] for h, f in zip(pelvis.hips(scale), feet)]
    height = pelvis.place[:, 2] + np.minimum(np.minimum(*limits), 0.0)
    # Means of the lowest values around a frame are smooth and nowhere above the limit.
    lowest = minimum_filter1d(height, 2 * SETTLE + 1)
    return gaussian_filter1d(lowest, SETTLE / 2, truncate=2.0)
