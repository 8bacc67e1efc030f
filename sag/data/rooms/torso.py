"""How spine, head and arms go with the pelvis: counter-rotation, lean, gaze, arm swing, hands on thighs, reaching."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from sag.data.rooms.feet import ease
from sag.data.rooms.pelvis import Pelvis, Rhythm, wander
from sag.data.rooms.person import FRAME_RATE, HEAD, SHOULDER, SPINE, Person, Plan
from sag.data.rooms.reaching import Stoop
from sag.geometry.kinematics import rotation, turned

BEND = np.array([0.05, 0.25, 0.5, 0.8, 1.0])
"""Share of the rotation from pelvis to chest that each bone of the spine has made."""

GRAVITY = 9.81
"""Metres a second squared."""

LOOK_AHEAD = 18
"""Frames by which the eyes are ahead of the feet."""


@dataclass(frozen=True)
class Torso:
    """Spine, head and chest through a clip.

    Attributes:
        spine: spine3, spine2, spine1, spine0 and neck, metres, world.
        head: metres, world.
        chest: rotation of the chest.
    """

    spine: Float[np.ndarray, "t 5 3"]
    head: Float[np.ndarray, "t 3"]
    chest: Float[np.ndarray, "t 3 3"]

    @property
    def neck(self) -> Float[np.ndarray, "t 3"]:
        """The joint that head and shoulders hang from, metres, world."""
        return self.spine[:, -1]

    def shoulder(self, side: int, scale: float) -> Float[np.ndarray, "t 3"]:
        """The right (-1) or left (1) shoulder, metres, world."""
        return self.neck + turned(self.chest, SHOULDER * scale * [1, side, 1])


def hold_torso(
    plan: Plan, person: Person, pelvis: Pelvis, rhythm: Rhythm, stoop: Stoop, rng: np.random.Generator
) -> Torso:
    """The torso over this pelvis."""
    frames = len(plan)
    gaze = _gaze(plan) + 0.2 * wander(frames, 5.0, rng) * rhythm.still
    forward, aside = _lean(plan)
    breath = 0.012 * np.sin(2 * np.pi * (np.arange(frames) / FRAME_RATE / rng.uniform(3, 4.5) + rng.random()))
    yaw = 0.12 * person.sway * rhythm.stride + 0.25 * gaze + 0.02 * wander(frames, 4.0, rng)
    pitch = person.lean + 0.015 + forward + breath + 0.012 * wander(frames, 4.0, rng)
    roll = aside - 0.025 * person.sway * rhythm.load
    pitch = pitch + 0.65 * np.sin(np.pi * plan.seated) ** 2 + 0.06 * ease(plan.seated, 0.5)
    chest = np.stack([plan.heading + yaw + stoop.twist, pitch + stoop.forward, roll + stoop.aside])
    return _raise_spine(plan, person, pelvis, chest, gaze)


def _raise_spine(
    plan: Plan, person: Person, pelvis: Pelvis, chest: Float[np.ndarray, "3 t"], gaze: Float[np.ndarray, " t"]
) -> Torso:
    """The torso whose chest has this yaw, pitch and roll and whose head looks aside by `gaze`, all radians."""
    base = np.stack([pelvis.yaw, pelvis.pitch, pelvis.roll])
    angles = base[..., None] + (chest - base)[..., None] * BEND
    bones = turned(rotation(*angles), SPINE * person.scale)
    spine = pelvis.place[:, None] + bones.cumsum(axis=1)
    nod = 0.35 * chest[1] + 0.05
    look = rotation(plan.heading + gaze, nod, 0.3 * chest[2])
    return Torso(spine, spine[:, -1] + turned(look, HEAD * person.scale), rotation(*chest))


def _gaze(plan: Plan) -> Float[np.ndarray, " t"]:
    """How far the head is turned from the heading toward where the path leads, radians."""
    ahead = np.minimum(np.arange(len(plan)) + LOOK_AHEAD, len(plan) - 1)
    return gaussian_filter1d(np.clip(plan.heading[ahead] - plan.heading, -0.8, 0.8), 5.0)


def _lean(plan: Plan) -> tuple[Float[np.ndarray, " t"], Float[np.ndarray, " t"]]:
    """Lean forward when speeding up and into turns, radians."""
    velocity = gaussian_filter1d(np.gradient(plan.position, axis=0), 3.0, axis=0) * FRAME_RATE
    force = gaussian_filter1d(np.gradient(velocity, axis=0), 3.0, axis=0) * FRAME_RATE / GRAVITY
    c, s = np.cos(plan.heading), np.sin(plan.heading)
    forward = 0.5 * (force[:, 0] * c + force[:, 1] * s) + 0.035 * (velocity[:, 0] * c + velocity[:, 1] * s)
    aside = 0.7 * (force[:, 0] * s - force[:, 1] * c)
    return np.clip(forward, -0.12, 0.2), np.clip(aside, -0.15, 0.15)
