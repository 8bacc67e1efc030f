"""Known geometry: boxes, floors and the furniture that they are made from."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sag.data.rays import RayScene
from sag.data.rooms.floors import patch_triangles, random_floor
from sag.data.rooms.furniture import MAKERS
from sag.data.rooms.geometry import FloorPatch, RoomGeometry, Seat, Solid
from sag.data.rooms.layout import random_room
from sag.data.rooms.room import Room

ROOMS = range(8)


@pytest.fixture(scope="module")
def rooms() -> list[Room]:
    return [random_room(np.random.default_rng(seed)) for seed in ROOMS]


@settings(max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.lists(st.floats(-2, 2), min_size=3, max_size=3))
def test_the_distance_to_a_box_is_that_to_its_nearest_point(yaw: float, place: list[float]) -> None:
    half = np.array([0.5, 0.3, 0.2])
    solid = Solid("box", (0.1, -0.2, 0.3), tuple(half.tolist()), yaw)
    c, s = np.cos(yaw), np.sin(yaw)
    local = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ (np.array(place) - solid.centre)
    outside = np.linalg.norm(local - local.clip(-half, half))
    expected = outside if outside > 0 else -(half - np.abs(local)).min()
    assert solid.signed_distance(np.array(place)) == pytest.approx(expected, abs=1e-9)


def test_a_ramp_rises_evenly_and_the_highest_patch_counts() -> None:
    ground = FloorPatch((-2.0, -2.0), (2.0, 2.0), (0.0, 0.0))
    ramp = FloorPatch((-1.0, -1.0), (1.0, 1.0), (0.0, 0.4), axis=1)
    room = RoomGeometry((4.0, 4.0, 3.0), (ground, ramp))
    points = np.array([[0.0, -1.0], [0.5, 0.0], [0.0, 1.0], [0.0, 1.5], [9.0, 9.0]])
    np.testing.assert_allclose(room.floor_height(points), [0, 0.2, 0.4, 0, 0], atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_rays_from_above_meet_the_floor_at_its_known_height(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = (5.0, 6.0)
    floor = random_floor(size, rng)
    scene = RayScene(np.concatenate([patch_triangles(patch) for patch in floor]))
    points = rng.uniform(-2.4, 2.4, (200, 2))
    known = RoomGeometry((*size, 3.0), floor).floor_height(points)
    met = [2.0 - scene.distance(np.array([*point, 2.0]), np.array([[0, 0, -1.0]]))[0] for point in points]
    assert np.isclose(met, known, atol=1e-4).mean() > 0.99, "rays on the very edge of a step may differ, others not"


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("seed", range(3))
def test_furniture_stands_on_the_ground_and_its_seats_are_free_surfaces(kind: str, seed: int) -> None:
    piece = MAKERS[kind][0](np.random.default_rng(seed))
    low, high = piece.bounds
    assert low[2] == pytest.approx(0, abs=1e-6)
    assert (high - low).max() < 2.5
    scene = RayScene(np.concatenate([part.triangles for part in piece.parts]))
    for seat in piece.seats:
        fall = scene.distance(np.array([seat[0], seat[1], 2.5]), np.array([[0, 0, -1.0]]))[0]
        assert 2.5 - fall == pytest.approx(seat[2], abs=0.02)


def test_rooms_have_the_promised_size_and_number_of_pieces(rooms: list[Room]) -> None:
    for room in rooms:
        assert min(room.size[:2]) >= 4 and max(room.size[:2]) <= 8
        assert 8 <= len(room.pieces) <= 20


def test_most_rooms_have_floors_at_more_than_one_level(rooms: list[Room]) -> None:
    assert np.mean([np.ptp(room.grid.height[room.grid.free]) > 0.1 for room in rooms]) > 0.6


def test_pieces_do_not_overlap_stand_level_and_inside(rooms: list[Room]) -> None:
    for room in rooms:
        for piece in room.pieces:
            ground = piece.ground()
            others = [other.footprint for other in room.pieces if other is not piece]
            assert min(other.signed_distance(ground).min() for other in others) > 0
            np.testing.assert_allclose(room.geometry.floor_height(ground), piece.place[2], atol=1e-9)
            assert room.geometry.signed_distance_to_walls(ground).min() >= 0


def test_geometry_survives_its_file(rooms: list[Room]) -> None:
    geometry = rooms[0].geometry
    assert RoomGeometry.from_json(geometry.to_json()) == geometry


def test_distances_see_furniture_and_walls() -> None:
    table = Solid("table", (0.0, 0.0, 0.5), (0.5, 0.5, 0.5), 0.0)
    room = RoomGeometry((4.0, 4.0, 3.0), (), (table,), (Seat("table", (0.0, 0.0, 1.0), 0.0),))
    points = np.array([[1.5, 0, 0.5], [0, 0, 0.6], [1.9, 0, 0.5], [0, 0, 1.3]])
    np.testing.assert_allclose(room.signed_distance(points), [0.5, -0.4, 0.1, 0.3], atol=1e-12)
