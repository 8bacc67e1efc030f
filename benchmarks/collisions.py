"""Claim: looking only at the pixels of a bone's footprint counts faster than all against all, and counts the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.brute_force import Counts, NearBody, Points, by_columns, by_numpy, by_torch
from benchmarks.claim import Claim, Say, faster
from benchmarks.paired import Pairing, Work, paired
from benchmarks.scenes import SIZES, Room, furnished_room, people
from sag.geometry.camera import point_cloud
from sag.metrics.collisions.counts import collision_counts
from sag.skeleton import GTA_IM_19

LEAST = 250
"""How many times faster than the better of the two plain forms of brute force."""

FRAMES = 10_000
"""Frames on which the counts must be equal, at each size of picture."""

RADII = (0.030, 0.045, 0.060)
BONES = torch.as_tensor(GTA_IM_19.bone_index)
TOGETHER = 10
"""Frames of one room that are counted in one call, as the non-collision ratio does by default."""

TIMED = 5 * TOGETHER
"""People in a room of whom our time is the mean."""

ROOMS = 20
"""Rooms that the frames of the test for equality are spread over."""


@dataclass(frozen=True)
class Furnished:
    """A room, its points and people in it.

    Attributes:
        room: depth and camera.
        points: all that the depth map sees.
        columns: the same points, coordinate by coordinate in memory.
        bodies: people, each a frame.
    """

    room: Room
    points: Points
    columns: Points
    bodies: Float[Tensor, "f 19 3"]

    @classmethod
    def of(cls, seed: int, size: tuple[int, int], frames: int) -> Furnished:
        """The room of this seed with this many people."""
        room = furnished_room(seed, size)
        cloud = point_cloud(room.depth.double()[None], room.intrinsics.double()[None])[0]
        points = cloud[room.depth > 0].numpy()
        return cls(room, points, np.ascontiguousarray(points.T).T, people(room, frames, seed + 1000))

    def counted(self, frames: int = TOGETHER) -> Counts:
        """Our counts (frames, radii), so many frames at a time."""
        depth, camera = self.room.depth, self.room.intrinsics
        parts = [collision_counts(part, BONES, depth, camera, RADII) for part in self.bodies.split(frames)]
        return torch.cat(parts).numpy()

    def ends(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Both ends of the bones of one person."""
        body = self.bodies[frame].double().numpy()
        return body[BONES[:, 0]], body[BONES[:, 1]]


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Speed and equality for pictures of both sizes."""
    sizes = {"27x48": (27, 48)} if quick else SIZES
    for name, size in sizes.items():
        say(f"non-collision by brute force at {name}")
        rooms = [Furnished.of(seed, size, TIMED) for seed in range(1 if quick else 5)]
        timed = _timed(rooms, brute_frames=1 if name == "1080p" else 2)
        yield from _speed(name, timed)
        say(f"equality on {100 if quick else FRAMES:,} frames at {name}")
        yield _equality(name, size, 100 if quick else FRAMES, timed)


def _timed(rooms: list[Furnished], brute_frames: int) -> dict[str, Pairing]:
    """A room a round; brute force takes equally long whatever the frame, so its time is that of the first few."""

    def brute(count: Callable[..., Counts], columns: bool = False) -> Work:
        def run(number: int) -> Counts:
            room = rooms[number]
            points = room.columns if columns else room.points
            return np.stack([count(points, *room.ends(frame), RADII) for frame in range(brute_frames)])

        return Work(run, brute_frames)

    peers = {"numpy": brute(by_numpy), "torch": brute(by_torch), "tuned": brute(by_columns, columns=True)}
    return paired(Work(lambda number: rooms[number].counted(), TIMED), peers, len(rooms))


def _speed(name: str, timed: dict[str, Pairing]) -> Iterator[Claim]:
    """Against the better of the two plain forms, and for whoever asks against one that is written for the cache."""
    what = f"non-collision of a frame, {name}"
    better = min(("numpy", "torch"), key=lambda peer: timed[peer].ratio)
    other = {"numpy": "torch", "torch": "numpy"}[better]
    note = f"the better of two plain forms; {timed[other].ratio:.0f}x for {other}'s"
    yield faster(what, f"all points and bones, {better} float64", timed[better], LEAST, note)
    yield faster(what, "the same by columns in blocks of the cache's size", timed["tuned"], None)


def _equality(name: str, size: tuple[int, int], frames: int, timed: dict[str, Pairing]) -> Claim:
    """Counts that differ from brute force: from the full one on the timed frames, from its cheaper form on all."""
    differing, full = 0, 0
    for pairing in timed.values():
        for ours, theirs in pairing.found:
            differing += int((ours[: len(theirs)] != theirs).sum())
            full += len(theirs)
    touching = 0
    rooms = min(ROOMS, frames)
    for seed in range(rooms):
        room = Furnished.of(seed, size, frames // rooms)
        near, ours = NearBody(room.points), room.counted(100)
        theirs = np.stack([near.counts(*room.ends(frame), RADII) for frame in range(len(ours))])
        differing += int((ours != theirs).sum())
        touching += int((ours > 0).any(1).sum())
    return Claim(
        f"non-collision counts, {frames:,} frames x {len(RADII)} radii, {name}",
        "all points and bones",
        found=differing,
        asked=0,
        ours=f"{touching / frames:.0%} of frames touch",
        theirs="",
        at_least=False,
        rounds=rooms,
        unit=" differ",
        note=f"all against all on the frames timed ({full} comparisons); else all points in the body's bounding box",
    )
