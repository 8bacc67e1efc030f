"""Surfaces and bodies: planes are carried on behind a person, grids keep to their limit, bodies have all bones."""

import dataclasses
import re
from importlib.resources import files

import numpy as np
from viewer_windows import INTRINSICS, SIZE, scene, wall_and_floor

from sag.skeleton import GTA_IM_19, PROX_16
from sag.viewer.body import RADII, SAMPLE_COLOURS, USUAL_RADIUS, links_of, radius_of
from sag.viewer.shown import ShownScene
from sag.viewer.surface import GROWN, empty_picture, filled, grid_of


def test_a_linear_field_is_carried_on_into_a_hole():
    field = np.add.outer(0.3 * np.arange(20.0), -0.1 * np.arange(30.0))
    hole = np.zeros(field.shape, bool)
    hole[5:12, 8:20] = True
    found = filled(np.where(hole, 0, field), hole, known=~hole)
    assert np.abs(found - field).max() < 1e-6


def test_a_hole_beyond_reach_of_anything_known_stays_empty():
    hole = np.ones((4, 5), bool)
    assert (filled(np.zeros((4, 5)), hole, known=~hole) == 0).all()


def test_a_wall_behind_the_person_is_guessed_and_marked():
    depth = np.full(SIZE, 4.0)
    depth[scene().hidden] = 0
    grid = grid_of(ShownScene(depth, INTRINSICS, scene().hidden), cells=10_000)
    assert grid.stride == 1
    assert (grid.depth[scene().hidden] == -4000).all() and (grid.depth[~scene().hidden] == 4000).all()


def test_what_is_unknown_elsewhere_stays_unknown():
    told = scene()
    depth = told.depth.copy()
    depth[:5, :5] = 0
    depth[:5, -5:] = 40.0
    grid = grid_of(dataclasses.replace(told, depth=depth), cells=10_000)
    assert (grid.depth[:5, :5] == 0).all() and (grid.depth[:5, -5:] == 0).all()


def test_a_coarse_grid_takes_the_middle_of_each_step():
    told = dataclasses.replace(scene(), depth=wall_and_floor(), hidden=np.zeros(SIZE, bool))
    grid = grid_of(told, cells=700)
    assert grid.stride == 3 and grid.depth.size <= 700
    assert (grid.depth == np.round(1000 * wall_and_floor()[1::3, 1::3])).all()


def test_the_person_is_gone_from_the_picture():
    picture = np.full((60, 90, 3), (80, 120, 160), np.uint8)
    person = np.zeros((20, 30), bool)
    person[5:15, 10:20] = True
    picture[15:45, 30:60] = 255
    assert (empty_picture(picture, person) == (80, 120, 160)).all()
    assert GROWN > 0


def test_bodies_follow_every_bone_and_are_thick():
    for skeleton in (GTA_IM_19, PROX_16):
        links = links_of(skeleton)
        assert sorted(link.bone for link in links if link.bone >= 0) == list(range(len(skeleton.bones)))
        for link in links:
            assert min(link.start_radius, link.end_radius) > 0.02 and max(link.start_radius, link.end_radius) < 0.15
        assert any(link.start == link.end == skeleton.joints.index("head") for link in links)


def test_radii_go_by_the_last_word_of_a_joint():
    assert radius_of("left_elbow") == RADII["elbow"] and radius_of("spine3") == RADII["spine"]
    assert radius_of("tail") == USUAL_RADIUS


def test_samples_have_one_colour_on_pages_and_in_files():
    script = (files("sag.viewer") / "assets/data.js").read_text()
    assert tuple(re.findall(r"'(#\w{6})'", script.split("const COLOURS")[1].split(";")[0])) == SAMPLE_COLOURS
