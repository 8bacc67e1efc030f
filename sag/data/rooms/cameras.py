"""Fixed cameras in rooms: differing in place, height, pitch and field of view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from sag.data.rays import RayScene
from sag.data.rooms.room import Room

NEAREST, FARTHEST = 1.6, 7.0
"""Between these depths (metres) a person's root may be when a window starts."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera.

    Attributes:
        place: metres, world frame.
        turn: rows are the camera's right, down and forward in the world frame.
        field: vertical field of view, radians.
    """

    place: Float[np.ndarray, " 3"]
    turn: Float[np.ndarray, "3 3"]
    field: float

    @classmethod
    def looking(cls, place: Float[np.ndarray, " 3"], yaw: float, pitch: float, field: float) -> Camera:
        """A level camera that looks along `yaw` and down by `pitch` (radians)."""
        right = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
        forward = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
        return cls(place, np.stack([right, np.cross(forward, right), forward]), field)

    def to_camera(self, points: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
        """Points of the world frame in the camera frame (metres)."""
        return (points - self.place) @ self.turn.T

    @property
    def world2cam(self) -> Float[np.ndarray, "4 4"]:
        """The same as a matrix for column vectors."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.turn
        matrix[:3, 3] = -self.turn @ self.place
        return matrix

    def intrinsics(
        self, size: tuple[int, int], centre: Float[np.ndarray, " 3"] | None = None
    ) -> Float[np.ndarray, "3 3"]:
        """Camera matrix in the pixels of a picture.

        Args:
            size: rows and columns.
            centre: a point (metres, camera frame) that the middle of the picture shows; straight ahead without one.
        """
        focal = size[0] / 2 / np.tan(self.field / 2)
        x, y = (0.0, 0.0) if centre is None else centre[:2] / centre[2]
        return np.array([[focal, 0, size[1] / 2 - focal * x], [0, focal, size[0] / 2 - focal * y], [0, 0, 1]])

    def sees(self, points: Float[np.ndarray, "*any 3"], share: float = 1.0) -> Bool[np.ndarray, "*any"]:
        """Whether world points are in the middle share of a 16:9 picture, at depths where windows may start."""
        local = self.to_camera(points)
        depth = np.maximum(local[..., 2], 1e-6)
        limit = np.tan(self.field / 2) * share
        inside = (np.abs(local[..., 1]) < depth * limit) & (np.abs(local[..., 0]) < depth * limit * 16 / 9)
        return np.asarray(inside & (local[..., 2] > NEAREST) & (local[..., 2] < FARTHEST))


def random_camera(room: Room, rays: RayScene, rng: np.random.Generator) -> Camera:
    """Some camera that sees much of the ground that people walk on: of a few with one lens, the best placed."""
    free = room.grid.points[room.grid.free]
    ground = free[rng.choice(len(free), min(len(free), 150), replace=False)]
    people = np.concatenate([ground, room.geometry.floor_height(ground)[:, None] + 0.9], axis=1)
    height, field = rng.uniform(1.2, 2.4), np.deg2rad(rng.uniform(40, 65))
    candidates = [_candidate(room, people, height, field, rng) for _ in range(12)]
    return max(candidates, key=lambda camera: _seen(camera, rays, people))


def _candidate(
    room: Room, people: Float[np.ndarray, "n 3"], height: float, field: float, rng: np.random.Generator
) -> Camera:
    half = np.array(room.size[:2]) / 2 - 0.12
    while True:
        axis, place = int(rng.integers(2)), rng.uniform(-half, half)
        place[axis] = rng.choice([-1, 1]) * (half[axis] - rng.uniform(0, 0.5))
        eye = np.array([*place, min(float(room.geometry.floor_height(place)) + height, room.size[2] - 0.2)])
        if room.geometry.signed_distance(eye) > 0.1:
            break
    target = people[rng.integers(len(people))] * 0.5 + people.mean(axis=0) * 0.5
    way = target - eye
    down = np.arctan2(-way[2], np.hypot(way[0], way[1]))
    pitch = np.clip(down + np.deg2rad(rng.uniform(-5, 12)), 0.0, np.deg2rad(35))
    return Camera.looking(eye, float(np.arctan2(way[1], way[0])), float(pitch), float(field))


def _seen(camera: Camera, rays: RayScene, people: Float[np.ndarray, "n 3"]) -> float:
    """Share of standing people whose hips this camera sees well inside its picture."""
    inside = camera.sees(people, 0.8)
    hidden = rays.hidden(people, camera.place)
    return float((inside & ~hidden).mean())
