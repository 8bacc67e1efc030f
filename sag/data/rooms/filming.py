"""A room of a recipe from first draw to last recording; the same recipe gives the same room anywhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8

from sag.data.cache import WindowCache
from sag.data.rooms.body import Person, animate
from sag.data.rooms.cameras import Camera, random_camera
from sag.data.rooms.figure import Outfit
from sag.data.rooms.layout import random_room
from sag.data.rooms.recipe import CLOUD_SIZE, Recipe
from sag.data.rooms.render import Solids
from sag.data.rooms.room import Room
from sag.data.rooms.routes import Router
from sag.data.rooms.surfaces import room_surfaces
from sag.data.rooms.walks import Stage, Start
from sag.data.rooms.windows import Recording, Scenery, picture_of

TESTED, VALIDATED = 4, 12
"""Every so many training rooms one has a camera for testing, and one for validation."""

SHARED = 2
"""Recordings that begin at the same place: several outcomes from one start."""


@dataclass(frozen=True)
class Shoot:
    """One room and the recordings to be made in it.

    Attributes:
        recipe: of the cache.
        number: of the room.
        room: with everything in it.
        scenery: the room made ready to be filmed.
    """

    recipe: Recipe
    number: int
    room: Room
    scenery: Scenery

    @classmethod
    def of(cls, recipe: Recipe, number: int) -> Shoot:
        """The room of this number."""
        rng = _generator(recipe, number, 0)
        room = random_room(rng)
        solids = Solids.of(room_surfaces(room, rng))
        place = rng.uniform(-0.12, 0.12, 2) * room.size[:2]
        return cls(recipe, number, room, Scenery(solids, np.array([*place, room.size[2] - 0.3])))

    def recordings(self) -> Iterator[Recording]:
        """All recordings of the room, camera by camera."""
        router, recipe = Router(self.room), self.recipe
        rays = self.scenery.solids.rays
        for view, splits in enumerate(self._takes()):
            camera = random_camera(self.room, rays, _generator(recipe, self.number, 1, view))
            stage = Stage(self.room, router, camera, rays)
            for take, split in enumerate(splits):
                yield self._recording(stage, camera, (view, take), split)

    def _takes(self) -> list[list[str]]:
        """Split of each recording of each camera: who tests and validates has cameras of their own everywhere."""
        recipe = self.recipe
        test, val = ["test"] * recipe.recordings, ["val"] * recipe.recordings
        if self.number >= recipe.train_rooms + recipe.test_rooms:
            return [val]
        if self.number >= recipe.train_rooms:
            return [test]
        cameras = [["train"] * recipe.recordings for _ in range(recipe.views)]
        return cameras + [test] * (self.number % TESTED == 0) + [val] * (self.number % VALIDATED == 0)

    def _recording(self, stage: Stage, camera: Camera, key: tuple[int, int], split: str) -> Recording:
        view, take = key
        number = (self.number * (self.recipe.views + 2) + view) * self.recipe.recordings + take
        start: Start = stage.random_start(_generator(self.recipe, self.number, 2, view, take // SHARED))
        rng = _generator(self.recipe, self.number, 3, view, take)
        clip = stage.act(start, rng)
        person = Person.random(rng)
        joints = animate(clip.plan, person, rng)
        outfit = Outfit.random(rng)
        return Recording(number, self.number, split, camera, joints, clip.contact, outfit, person.scale)


def sharp_picture(
    cache: WindowCache, recipe: Recipe, row: int, size: tuple[int, int] = CLOUD_SIZE
) -> UInt8[np.ndarray, "h w 3"]:
    """The picture of a window, rendered again at some size where the cache's is smaller.

    Args:
        cache: of rooms.
        recipe: that the cache was made of.
        row: of the window.
        size: rows and columns.
    """
    if recipe.image_size[0] >= size[0]:
        return np.asarray(cache.image[row])
    shoot = Shoot.of(recipe, int(cache.scene[row]))
    recording = next(r for r in shoot.recordings() if r.number == cache.sequence[row])
    return picture_of(recording, shoot.scenery, int(cache.start[row]), size).image


def _generator(recipe: Recipe, *key: int) -> np.random.Generator:
    """A generator of its own for each thing that is drawn, so that nothing depends on the order."""
    return np.random.default_rng([recipe.seed, *key, len(key)])
