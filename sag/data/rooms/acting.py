"""A clip put together move by move: walk, turn, stand, reach, sit down and stand up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter1d

from sag.data.rooms.geometry import Seat
from sag.data.rooms.pacing import directions, eased, passing_times
from sag.data.rooms.person import FRAME_RATE, Plan
from sag.data.rooms.room import Room
from sag.data.rooms.routes import SPACING

SEAT_APPROACH, SEAT_STANDING = 0.62, 0.38
"""How far before the middle of a seat people turn round, and stand before they sit down (metres)."""

TURNING = 2.2
"""Turning speed on the spot, radians a second."""

SMOOTHING = 3.0
"""Deviation of the final smoothing in time, frames."""


@dataclass(frozen=True)
class Clip:
    """What happens in a recording.

    Attributes:
        plan: for the body.
        contact: frames in which the person is meant to touch furniture: from the step back to a seat until the
            step away from it.
    """

    plan: Plan
    contact: Bool[np.ndarray, " t"]


class Actor:
    """Somebody in a room who is told one move after the other.

    Attributes:
        position: where the last move ended, metres over the ground.
        heading: direction it ended in, radians.
    """

    def __init__(self, room: Room, position: Float[np.ndarray, " 2"], heading: float) -> None:
        self.room = room
        self.position, self.heading = position, heading
        self._positions: list[np.ndarray] = []
        self._headings: list[np.ndarray] = []
        self._seated: list[np.ndarray] = []
        self._reach: list[np.ndarray] = []
        self._contact: list[np.ndarray] = []
        self._seat_point = np.full(3, np.nan)
        self._reach_point = np.full(3, np.nan)

    def __len__(self) -> int:
        return sum(len(p) for p in self._headings)

    @property
    def has_sat(self) -> bool:
        """Whether a seat was used; a plan knows one only."""
        return bool(np.isfinite(self._seat_point[0]))

    @property
    def has_reached(self) -> bool:
        """Whether something was reached for; a plan knows one target only."""
        return bool(np.isfinite(self._reach_point[0]))

    def stand(self, seconds: float) -> None:
        """Stays where it is."""
        count = round(seconds * FRAME_RATE)
        self._add(np.repeat(self.position[None], count, axis=0), np.full(count, self.heading))

    def turn(self, heading: float) -> None:
        """Turns on the spot to a direction (radians), the shorter way."""
        change = (heading - self.heading + np.pi) % (2 * np.pi) - np.pi
        count = max(3, round(FRAME_RATE * (0.25 + abs(change) / TURNING)))
        headings = self.heading + change * eased(count)
        self._add(np.repeat(self.position[None], count, axis=0), headings)

    def walk(self, way: Float[np.ndarray, "n 2"], speed: float, moving: bool = False, stopping: bool = True) -> None:
        """Walks a way at most at this speed (metres a second).

        Args:
            way: points `SPACING` apart.
            speed: in metres a second.
            moving: whether it is already at this speed at the start.
            stopping: whether it comes to rest at the end.
        """
        tangent = directions(way, self.heading)
        if not moving and abs(tangent[0] - self.heading) > 0.6:
            self.turn(tangent[0])
            tangent = directions(way, self.heading)
        length = SPACING * np.arange(len(way))
        length = length * (np.linalg.norm(np.diff(way, axis=0), axis=1).sum() / length[-1])
        times = passing_times(length, tangent, speed, moving, stopping)
        frames = np.arange(0, times[-1], 1 / FRAME_RATE)
        along = np.interp(frames, times, length)
        points = np.stack([np.interp(along, length, axis) for axis in way.T], axis=-1)
        self._add(points, np.interp(along + 0.1, length, tangent))

    def reach(self, target: Float[np.ndarray, " 3"], seconds: float) -> None:
        """Reaches for a point and takes the hand back."""
        rise, hold = round(0.8 * FRAME_RATE), round(seconds * FRAME_RATE)
        curve = np.concatenate([eased(rise), np.ones(hold), eased(rise)[::-1]])
        self._reach_point = target
        self._add(np.repeat(self.position[None], len(curve), axis=0), np.full(len(curve), self.heading), reach=curve)

    def sit_down(self, seat: Seat, seconds: float) -> None:
        """Steps back to a seat behind it, sits down and stays."""
        ahead = np.array([np.cos(seat.yaw), np.sin(seat.yaw)])
        self._seat_point = np.array(seat.point)
        self._step(self._seat_point[:2] + SEAT_STANDING * ahead)
        self._sit(np.concatenate([eased(round(1.3 * FRAME_RATE)), np.ones(round(seconds * FRAME_RATE))]))

    def start_seated(self, seat: Seat, seconds: float) -> None:
        """Begins the clip on a seat."""
        ahead = np.array([np.cos(seat.yaw), np.sin(seat.yaw)])
        self._seat_point = np.array(seat.point)
        self.position, self.heading = self._seat_point[:2] + SEAT_STANDING * ahead, seat.yaw
        self._sit(np.ones(round(seconds * FRAME_RATE)))

    def stand_up(self) -> None:
        """Stands up and steps away from the seat."""
        self._sit(eased(round(1.2 * FRAME_RATE))[::-1])
        ahead = np.array([np.cos(self.heading), np.sin(self.heading)])
        self._step(self.position + (SEAT_APPROACH - SEAT_STANDING) * ahead)

    def clip(self, frames: int) -> Clip:
        """The first frames of what was acted."""
        position, heading = np.concatenate(self._positions), np.concatenate(self._headings)
        smooth = [gaussian_filter1d(values, SMOOTHING, axis=0, mode="nearest") for values in (position, heading)]
        plan = Plan(
            smooth[0][:frames],
            smooth[1][:frames],
            np.concatenate(self._seated)[:frames],
            self._seat_point,
            np.concatenate(self._reach)[:frames],
            self._reach_point,
            self.room.geometry.floor_height,
        )
        return Clip(plan, np.concatenate(self._contact)[:frames])

    def _step(self, goal: Float[np.ndarray, " 2"]) -> None:
        share = eased(round(0.8 * FRAME_RATE))
        positions = self.position + share[:, None] * (goal - self.position)
        self._add(positions, np.full(len(share), self.heading), contact=True)

    def _sit(self, curve: Float[np.ndarray, " n"]) -> None:
        positions = np.repeat(self.position[None], len(curve), axis=0)
        self._add(positions, np.full(len(curve), self.heading), seated=curve, contact=True)

    def _add(
        self,
        positions: Float[np.ndarray, "n 2"],
        headings: Float[np.ndarray, " n"],
        seated: Float[np.ndarray, " n"] | None = None,
        reach: Float[np.ndarray, " n"] | None = None,
        contact: bool = False,
    ) -> None:
        if not len(headings):
            return
        self._positions.append(positions)
        self._headings.append(headings)
        self._seated.append(np.zeros(len(headings)) if seated is None else seated)
        self._reach.append(np.zeros(len(headings)) if reach is None else reach)
        self._contact.append(np.full(len(headings), contact))
        self.position, self.heading = positions[-1], float(headings[-1])
