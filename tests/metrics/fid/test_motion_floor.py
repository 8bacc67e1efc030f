"""The floor of Motion FID: halves of whole sequences, equally large."""

import pytest
import torch
from clip_toys import KEYS, floats, gaussian_features

from sag.errors import SagError
from sag.metrics import motion_fid_floor, motion_fid_of_features
from sag.metrics.fid.clips import clip_features, picked
from sag.metrics.fid.floor import motion_fid_floor_of_features
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


def test_splits_by_sequence(encoders, motions):
    sequence = torch.tensor([5, 9, 2, 7]).repeat_interleave(12)
    features = clip_features(encoders, motions, ROOT)
    halves = [(sequence == a) | (sequence == b) for a, b in ((2, 7), (5, 9))]  # every other one in order
    expected = motion_fid_of_features(*(picked(features, half) for half in halves))
    for floor in (
        motion_fid_floor(encoders, motions, sequence, ROOT),
        motion_fid_floor_of_features(features, sequence),
    ):
        assert floats(floor) == pytest.approx(floats(expected), rel=1e-6)
    assert floats(expected)["average"] > 0


def test_the_larger_half_is_thinned_evenly():
    draw = torch.manual_seed(0)
    features = gaussian_features(draw, 30)
    sequence = torch.tensor([0] * 20 + [1] * 10)
    expected = motion_fid_of_features(picked(features, torch.arange(0, 20, 2)), picked(features, slice(20, None)))
    assert floats(motion_fid_floor_of_features(features, sequence)) == pytest.approx(floats(expected), rel=1e-9)


def test_sequences_that_differ_lift_it_and_windows_alone_do_not():
    draw = torch.manual_seed(0)
    sequence = torch.arange(400) // 20
    same = gaussian_features(draw, 400)
    apart = {key: same[key] + torch.randn(20, 1, 4, generator=draw)[sequence] for key in KEYS}
    low, high = (floats(motion_fid_floor_of_features(x, sequence))["average"] for x in (same, apart))
    assert high > 3 * low


def test_refuses_a_single_sequence():
    features = gaussian_features(torch.manual_seed(0), 8)
    with pytest.raises(SagError, match="at least 2 sequences"):
        motion_fid_floor_of_features(features, torch.zeros(8, dtype=torch.long))
