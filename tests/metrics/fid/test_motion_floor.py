"""The floor of Motion FID: the mean over random halves of whole groups."""

import pytest
import torch
from clip_toys import KEYS, floats, gaussian_features

from sag.errors import SagError
from sag.metrics import motion_fid_floor, motion_fid_of_features
from sag.metrics.fid.clips import clip_features, picked
from sag.metrics.fid.floor import motion_fid_floor_of_features
from sag.metrics.halves import random_halves
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


def average(features, group, **options) -> float:
    return floats(motion_fid_floor_of_features(features, group, **options))["average"]


def test_is_the_mean_over_the_splits(encoders, motions):
    group = torch.tensor([5, 9, 2, 7]).repeat_interleave(12)
    features = clip_features(encoders, motions, ROOT)
    halves = [(group[side == 0], group[side == 1]) for side in random_halves(group, splits=3, seed=2)]
    masks = [[torch.isin(group, half.unique()) for half in pair] for pair in halves]
    figures = [motion_fid_of_features(*(picked(features, mask) for mask in pair))["average"] for pair in masks]
    for floor in (
        motion_fid_floor(encoders, motions, group, ROOT, splits=3, seed=2),
        motion_fid_floor_of_features(features, group, splits=3, seed=2),
    ):
        assert floats(floor)["average"] == pytest.approx(float(torch.stack(figures).mean()), rel=1e-6)
    assert min(figures) > 0


def test_groups_that_differ_lift_it_and_windows_alone_do_not():
    draw = torch.manual_seed(0)
    group = torch.arange(400) // 20
    same = gaussian_features(draw, 400)
    apart = {key: same[key] + torch.randn(20, 1, 4, generator=draw)[group] for key in KEYS}
    assert average(apart, group) > 3 * average(same, group)
    assert average(apart, torch.arange(400)) < average(apart, group) / 3, "windows one by one hide it"


def test_twins_next_to_each_other_do_not_lower_it():
    """Recordings 2i and 2i + 1 are alike: dealt out one by one they would show no difference at all."""
    draw = torch.manual_seed(0)
    recording = torch.arange(400) // 20
    place = torch.randn(10, 1, 4, generator=draw)
    features = {key: x + place[recording // 2] for key, x in gaussian_features(draw, 400).items()}
    dealt_out = motion_fid_of_features(*(picked(features, recording % 2 == side) for side in (0, 1)))
    by_room, by_recording = average(features, recording // 2), average(features, recording)
    assert by_room > by_recording > 2 * float(dealt_out["average"])


def test_goes_as_one_over_the_number_of_motions():
    draw = torch.manual_seed(0)
    few, many = (
        torch.tensor([average(gaussian_features(draw, count), torch.arange(count)) for _ in range(6)]).mean()
        for count in (100, 400)
    )
    assert float(few / many) == pytest.approx(4, rel=0.25)


def test_of_motions_that_are_all_the_same_it_is_zero_and_it_is_repeatable():
    draw = torch.manual_seed(0)
    features, group = gaussian_features(draw, 40), torch.arange(40) // 4
    assert average(features, group) == average(features, group)
    assert average(features, group) != average(features, group, seed=1)
    still = {key: x[:1].expand(40, -1, -1) for key, x in features.items()}
    assert average(still, group) == pytest.approx(0, abs=1e-9)


def test_refuses():
    features = gaussian_features(torch.manual_seed(0), 8)
    with pytest.raises(SagError, match="motions of 2 or more, not of 1"):
        motion_fid_floor_of_features(features, torch.zeros(8, dtype=torch.long))
    with pytest.raises(SagError, match="group of each of 8 motions, not 3"):
        motion_fid_floor_of_features(features, torch.arange(3))
