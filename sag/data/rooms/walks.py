"""What people do in a room: clips of walks with stops, turns, reaching and sitting, seen by a camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.data.rays import RayScene
from sag.data.rooms.acting import SEAT_APPROACH, Actor, Clip
from sag.data.rooms.cameras import Camera
from sag.data.rooms.geometry import Seat
from sag.data.rooms.grid import CLEARANCE
from sag.data.rooms.person import FRAME_RATE
from sag.data.rooms.placed import Placed
from sag.data.rooms.room import Room
from sag.data.rooms.routes import SPACING, Router

SHORTEST, LONGEST = 3.2, 4.2
"""Length of a recording, seconds: many short ones, so that places and ways differ more than windows overlap."""

ACTIONS: dict[str, float] = {"walk": 0.56, "stand": 0.13, "reach": 0.12, "sit": 0.19}
"""What people do next, and how often."""


@dataclass(frozen=True)
class Start:
    """Where a clip begins.

    Attributes:
        position: metres over the ground.
        heading: radians.
    """

    position: Float[np.ndarray, " 2"]
    heading: float


class Stage:
    """A room as one camera sees it, in which people act."""

    def __init__(self, room: Room, router: Router, camera: Camera, rays: RayScene) -> None:
        self.room, self.router, self.camera, self.rays = room, router, camera, rays
        level = room.grid.edge[room.grid.free] > 0.35
        self._places = router.points[level]
        self._seen = self._places[self._visible(self._places, 0.75)]
        self._seats = [seat for seat in room.geometry.seats if self._usable(seat)]

    def _visible(self, places: Float[np.ndarray, "n 2"], share: float) -> np.ndarray:
        hips = np.concatenate([places, self.room.geometry.floor_height(places)[:, None] + 0.9], axis=1)
        return self.camera.sees(hips, share) & ~self.rays.hidden(hips, self.camera.place)

    def _usable(self, seat: Seat) -> bool:
        """Whether the camera sees the seat and the ground before it is free and as high as the seat's."""
        approach = _before(seat)
        height = seat.point[2] - float(self.room.geometry.floor_height(approach))
        way = np.linspace(np.array(seat.point[:2]), approach, 12)
        level = np.ptp(self.room.geometry.floor_height(way)) < 1e-6
        free = self.room.grid.at(self.room.grid.clearance, approach) > CLEARANCE - 0.03
        return bool(level and free and 0.35 < height < 0.6 and self._visible(approach[None], 0.9)[0])

    def random_start(self, rng: np.random.Generator) -> Start:
        """Some place in view where people can begin, looking anywhere."""
        places = self._seen if len(self._seen) else self._places
        return Start(places[rng.integers(len(places))], float(rng.uniform(-np.pi, np.pi)))

    def act(self, start: Start, rng: np.random.Generator) -> Clip:
        """Some clip from this start; people who begin on a seat leave the start aside."""
        frames = round(rng.uniform(SHORTEST, LONGEST) * FRAME_RATE)
        actor = Actor(self.room, start.position, start.heading)
        if self._seats and rng.random() < 0.15:
            actor.start_seated(self._seats[rng.integers(len(self._seats))], rng.uniform(0.5, 2.0))
            actor.stand_up()
        # Smoothing looks a little beyond the last frame.
        while len(actor) < frames + 10:
            self._next(actor, rng)
        return actor.clip(frames)

    def _next(self, actor: Actor, rng: np.random.Generator) -> None:
        action = rng.choice(list(ACTIONS), p=list(ACTIONS.values()))
        if action == "sit" and self._seats and not actor.has_sat:
            self._sit(actor, rng)
        elif action == "reach" and not actor.has_reached:
            self._reach(actor, rng)
        elif action == "stand":
            actor.stand(rng.uniform(1.2, 4.0))
            if rng.random() < 0.4:
                actor.turn(actor.heading + rng.uniform(-2.2, 2.2))
        else:
            self._walk(actor, rng)

    def _walk(self, actor: Actor, rng: np.random.Generator) -> None:
        """Walks somewhere, rather far away, behind obstacles or to another level."""
        places = self._seen if len(self._seen) and rng.random() < 0.85 else self._places
        best, most = None, 0.0
        for goal in places[rng.integers(len(places), size=3)]:
            way = self.router.route(actor.position, goal)
            if way is None or len(way) < 16:
                continue
            straight = max(float(np.linalg.norm(way[-1] - way[0])), 0.5)
            climbed = abs(float(np.subtract(*self.room.geometry.floor_height(way[[0, -1]]))))
            interest = SPACING * len(way) / straight + min(SPACING * len(way), 4.0) / 4 + 5 * climbed
            if interest > most:
                best, most = way, interest
        if best is None:
            actor.stand(0.5)
        else:
            actor.walk(best, rng.uniform(0.7, 1.5))

    def _sit(self, actor: Actor, rng: np.random.Generator) -> None:
        seat = self._seats[rng.integers(len(self._seats))]
        if self._goes(actor, _before(seat), rng):
            actor.turn(seat.yaw)
            actor.sit_down(seat, rng.uniform(1.0, 3.0))
            actor.stand_up()

    def _reach(self, actor: Actor, rng: np.random.Generator) -> None:
        """Goes to a table, a cabinet or a shelf and reaches for it."""
        pieces = [placed for placed in self.room.pieces if (placed.piece.top or 0) > 0.65]
        for number in rng.permutation(len(pieces)):
            found = self._reachable(pieces[number])
            if found is not None:
                place, target = found
                if self._goes(actor, place, rng):
                    actor.turn(float(np.arctan2(*(target[:2] - place)[::-1])))
                    actor.reach(target, rng.uniform(0.3, 1.2))
                return
        self._walk(actor, rng)

    def _reachable(self, placed: Placed) -> tuple[np.ndarray, np.ndarray] | None:
        """Where to stand and what to reach for; None where there is no way to the piece."""
        box = placed.footprint
        distance = box.signed_distance(self._places)
        height = self.room.geometry.floor_height(self._places)
        near = (distance < CLEARANCE + 0.1) & (np.abs(height - placed.place[2]) < 1e-6)
        if not near.any():
            return None
        place = self._places[near][self._visible(self._places[near], 0.9).argmax()]
        low, high = placed.piece.bounds[:, :2]
        c, s = np.cos(placed.yaw), np.sin(placed.yaw)
        offset = place - np.array(placed.place[:2])
        local = np.array([offset @ [c, s], offset @ [-s, c]])
        over = placed.piece.name == "table"
        # Over a table, but in front of what is taller than its target.
        inset = 0.06 if over else -0.08
        nearest = np.clip(local, low + inset, high - inset)
        target = placed.to_world(np.array([*nearest, (placed.piece.top or 0) + 0.13]))
        return place, target

    def _goes(self, actor: Actor, goal: Float[np.ndarray, " 2"], rng: np.random.Generator) -> bool:
        """Walks to a place; False, and no step, where there is no way."""
        way = self.router.route(actor.position, goal)
        if way is not None:
            actor.walk(way, rng.uniform(0.7, 1.4))
        return way is not None


def _before(seat: Seat) -> Float[np.ndarray, " 2"]:
    """Where people turn round before they sit down."""
    return np.array(seat.point[:2]) + SEAT_APPROACH * np.array([np.cos(seat.yaw), np.sin(seat.yaw)])
