"""What people do in rooms: ways, pace and clips."""

from __future__ import annotations

import numpy as np
import pytest

from sag.data.rooms.acting import Actor, Clip
from sag.data.rooms.filming import Shoot
from sag.data.rooms.geometry import Seat
from sag.data.rooms.grid import CLEARANCE
from sag.data.rooms.pacing import passing_times
from sag.data.rooms.person import FRAME_RATE
from sag.data.rooms.recipe import Recipe
from sag.data.rooms.room import Room
from sag.data.rooms.routes import LEAST_CLEARANCE, SPACING, Router
from sag.data.rooms.walks import Stage, Start

TINY = Recipe(train_rooms=2, test_rooms=1)


@pytest.fixture(scope="module")
def shoot() -> Shoot:
    return Shoot.of(TINY, 0)


@pytest.fixture(scope="module")
def room(shoot: Shoot) -> Room:
    return shoot.room


@pytest.fixture(scope="module")
def stage(shoot: Shoot) -> Stage:
    camera = next(shoot.recordings()).camera
    return Stage(shoot.room, Router(shoot.room), camera, shoot.scenery.solids.rays)


@pytest.fixture(scope="module")
def clips(stage: Stage) -> list[Clip]:
    return [stage.act(stage.random_start(rng), rng) for rng in map(np.random.default_rng, range(12))]


def test_routes_join_their_ends_and_keep_clear(room: Room) -> None:
    router, rng = Router(room), np.random.default_rng(0)
    for _ in range(10):
        start, goal = router.points[rng.integers(len(router.points), size=2)]
        way = router.route(start, goal)
        if way is None:
            continue
        np.testing.assert_allclose(way[[0, -1]], [start, goal], atol=1e-9)
        assert np.linalg.norm(np.diff(way, axis=0), axis=1).max() < 1.05 * SPACING
        assert room.grid.at(room.grid.clearance, way).min() > LEAST_CLEARANCE - 0.1


def test_a_route_goes_round_what_stands_in_the_way(room: Room) -> None:
    router, rng = Router(room), np.random.default_rng(1)
    detours = []
    for _ in range(30):
        way = router.route(*router.points[rng.integers(len(router.points), size=2)])
        if way is not None:
            detours.append(SPACING * (len(way) - 1) / max(np.linalg.norm(way[-1] - way[0]), 0.1))
    assert max(detours) > 1.2
    assert min(detours) > 0.9


def test_there_is_no_route_to_where_one_stands(room: Room) -> None:
    router = Router(room)
    assert router.route(router.points[0], router.points[0]) is None


def test_a_straight_way_is_walked_at_the_speed_asked_for() -> None:
    length = np.linspace(0, 6, 121)
    times = passing_times(length, np.zeros(121), 1.2, moving=True, stopping=False)
    np.testing.assert_allclose(np.diff(length) / np.diff(times), 1.2, rtol=1e-6)


def test_walkers_speed_up_slow_down_and_take_bends_slowly() -> None:
    length = np.linspace(0, 6, 121)
    direction = np.where(length < 3, 0.0, np.minimum((length - 3) / 0.5, 1.5))
    speed = np.diff(length) / np.diff(passing_times(length, direction, 1.2, moving=False, stopping=True))
    assert speed[0] < 0.5 > speed[-1]
    assert speed[30] == pytest.approx(1.2, rel=1e-3)
    assert speed[65] < 0.8


def test_clips_are_smooth_and_as_fast_as_people(clips: list[Clip]) -> None:
    for clip in clips:
        speed = np.linalg.norm(np.diff(clip.plan.position, axis=0), axis=1) * FRAME_RATE
        assert speed.max() < 1.6
        assert np.abs(np.diff(speed)).max() * FRAME_RATE < 3
        assert np.abs(np.diff(clip.plan.heading)).max() * FRAME_RATE < 5


def test_nobody_walks_through_furniture(clips: list[Clip], room: Room) -> None:
    """Only on the last steps to a seat in a corner may the way pass the seat itself more closely."""
    walked = np.concatenate([clip.plan.position[~clip.contact] for clip in clips])
    distances = np.array([p.footprint.signed_distance(walked) for p in room.pieces])
    assert distances.min() > 0
    assert (distances.min(axis=0) > CLEARANCE - 0.12).mean() > 0.96


def test_people_sit_only_where_contact_is_meant(clips: list[Clip]) -> None:
    assert any(clip.plan.seated.any() for clip in clips)
    for clip in clips:
        assert clip.contact[clip.plan.seated > 0].all()
        assert np.isfinite(clip.plan.seat_point).all() or not clip.plan.seated.any()


def test_one_start_has_several_outcomes_and_each_can_be_had_again(stage: Stage) -> None:
    start = stage.random_start(np.random.default_rng(0))
    one, other, again = (stage.act(start, np.random.default_rng(seed)).plan for seed in (1, 2, 1))
    np.testing.assert_array_equal(one.position, again.position)
    frames = min(len(one), len(other))
    assert np.abs(one.position[:frames] - other.position[:frames]).max() > 0.3


def test_sitting_down_ends_on_the_seat_that_was_asked_for(room: Room) -> None:
    seat = Seat("chair", (0.0, 0.0, 0.45), 0.0)
    actor = Actor(room, np.array([0.62, 0.0]), np.pi / 2)
    actor.turn(seat.yaw)
    actor.sit_down(seat, 1.0)
    clip = actor.clip(len(actor))
    np.testing.assert_allclose(clip.plan.position[-1], [0.38, 0.0], atol=1e-3)
    assert clip.plan.heading[-1] == pytest.approx(0, abs=1e-3)
    assert clip.plan.seated[-1] == 1


def test_a_turn_takes_the_shorter_way(room: Room) -> None:
    actor = Actor(room, np.zeros(2), 3.0)
    actor.turn(-3.0)
    assert actor.heading == pytest.approx(2 * np.pi - 3.0)


def test_a_start_is_in_view(stage: Stage) -> None:
    starts: list[Start] = [stage.random_start(np.random.default_rng(seed)) for seed in range(10)]
    hips = np.array([[*s.position, float(stage.room.geometry.floor_height(s.position)) + 0.9] for s in starts])
    assert stage.camera.sees(hips).all()
