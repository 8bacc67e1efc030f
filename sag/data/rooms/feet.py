"""How feet move between the places where they are planted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from sag.data.rooms.footsteps import SOLE, Footsteps
from sag.data.rooms.person import ANKLE, BALL, Person, Plan

TOE_OFF = 0.31
"""Share of a step after which the ball of the foot follows the heel off the floor."""

CLEARANCE = 0.025
"""Height of the sole over the floor in mid-swing, metres."""

STRIKE = 0.018
"""Height of the ankle over its place when the heel of a long stride strikes the floor, metres."""

HIGHEST_ARCH = 0.35
"""How far a foot is lifted at most to clear what is in its way, metres."""


@dataclass(frozen=True)
class Foot:
    """One foot through a clip, world frame.

    Attributes:
        ankle: metres.
        yaw: direction the foot points to, radians.
        ground: height of the places the foot comes from and goes to, blended, metres.
        swing: 0 while planted, up to 1 while it moves.
    """

    ankle: Float[np.ndarray, "t 3"]
    yaw: Float[np.ndarray, " t"]
    ground: Float[np.ndarray, " t"]
    swing: Float[np.ndarray, " t"]


def ease(
    values: Float[np.ndarray, "*frames"],
    low: Float[np.ndarray, "*frames"] | float = 0.0,
    high: Float[np.ndarray, "*frames"] | float = 1.0,
) -> Float[np.ndarray, "*frames"]:
    """0 up to `low`, 1 from `high` on and a smooth step between them."""
    x = np.clip((values - low) / (high - low), 0.0, 1.0)
    return x * x * (3 - 2 * x)


def move_foot(steps: Footsteps, plan: Plan, person: Person) -> Foot:
    """The foot that makes these steps: the heel rises about the ball, the foot swings over the floor and lands."""
    step, progress = _progress(steps, len(plan))
    after = np.minimum(step + 1, len(steps.yaw) - 1)
    came, way = steps.ankle[step], steps.ankle[after] - steps.ankle[step]
    # A foot rises before it goes over the edge of a step up, and sinks after the edge of a step down.
    forward = ease(progress, TOE_OFF, np.where(way[:, 2] < -0.05, 0.88, 1.0))
    rise = np.where(way[:, 2] > 0, ease(progress, 0.1, 0.65), ease(progress, 0.6, 1.0))
    yaw = steps.yaw[step] + (steps.yaw[after] - steps.yaw[step]) * forward
    stride = np.minimum(np.linalg.norm(way[:, :2], axis=1), 1.3)
    flat = came + way * np.stack([forward, forward, rise], axis=-1)
    flat[:, 2] += STRIKE * np.minimum(1.5 * stride, 1.0) * (ease(progress, 0.45, 0.75) - ease(progress, 0.88, 1.0))
    flat[:, 2] += _clearance(flat, yaw, progress, step, plan, person.scale)
    pitch = person.heel_lift * (0.1 + 0.62 * stride) * (ease(progress, 0.0, 0.38) - ease(progress, 0.38, 0.92))
    ankle = flat + _about_ball(pitch, yaw, person.scale)
    ground = came[:, 2] + way[:, 2] * forward - ANKLE * person.scale
    return Foot(ankle, yaw, ground, np.sin(np.pi * progress) ** 2)


def _progress(steps: Footsteps, frames: int) -> tuple[Int[np.ndarray, " t"], Float[np.ndarray, " t"]]:
    """The step that a foot makes or makes next at each frame, and how far it is done."""
    frame = np.arange(frames)
    step = np.searchsorted(steps.land, frame, side="right")
    start, land = np.append(steps.start, frames), np.append(steps.land, frames + 1)
    return step, np.clip((frame - start[step]) / (land[step] - start[step]), 0.0, 1.0)


def _about_ball(pitch: Float[np.ndarray, " t"], yaw: Float[np.ndarray, " t"], scale: float) -> Float[np.ndarray, "t 3"]:
    """How far the ankle moves when the heel rises by this angle about the ball of the foot."""
    ball, ankle = BALL * scale, ANKLE * scale
    forward = ball * (1 - np.cos(pitch)) + ankle * np.sin(pitch)
    up = ball * np.sin(pitch) - ankle * (1 - np.cos(pitch))
    return np.stack([forward * np.cos(yaw), forward * np.sin(yaw), up], axis=-1)


def _clearance(
    flat: Float[np.ndarray, "t 3"],
    yaw: Float[np.ndarray, " t"],
    progress: Float[np.ndarray, " t"],
    step: Int[np.ndarray, " t"],
    plan: Plan,
    scale: float,
) -> Float[np.ndarray, " t"]:
    """How much higher a foot held flat must go to clear the floor: a smooth arch, as high as each step needs."""
    moving = np.flatnonzero(progress > 0)
    arch = ease(progress, 0.1, 0.45) - ease(progress, 0.78, 1.0)
    ahead = np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)[moving]
    sole = flat[moving, None, :2] + (SOLE * scale)[:, None] * ahead[:, None]
    floor = plan.floor(sole.reshape(-1, 2)).reshape(-1, len(SOLE)).max(axis=1)
    room = flat[moving, 2] - floor - ANKLE * scale
    wanted = (CLEARANCE * (arch[moving] > 0.5) - room) / np.maximum(arch[moving], 0.25)
    height = np.zeros(step.max() + 1)
    np.maximum.at(height, step[moving], wanted)
    return arch * np.minimum(height, HIGHEST_ARCH)[step]
