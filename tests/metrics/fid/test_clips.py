"""Clips: where they start, and that one pass over the longest gives the features of all."""

import copy

import pytest
import torch
from torch import Tensor

from sag.errors import SagError
from sag.metrics.fid.clips import LENGTHS, clip_features, clip_starts, clips_by_longest
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


@torch.no_grad()
def clip_by_clip(encoders: MotionEncoders, motions: Tensor, length: int) -> dict[tuple[int, int], Tensor]:
    """Features of the disjoint clips of one length, the plain way, (b, clips, d)."""
    clips = motions[:, 1:].unflatten(1, (64 // length, length)).flatten(0, 1)
    found = encoders.features(clips - clips[:, :1, ROOT : ROOT + 1], [length])
    return {key: features.unflatten(0, (len(motions), -1)) for key, features in found.items()}


def test_each_start_is_run_once_and_every_clip_of_every_length_is_in_it(motions):
    found = clips_by_longest(motions[:, 1:], ROOT)
    assert {length: clips.shape[1] for length, clips in found.items()} == {2: 16, 4: 8, 8: 4, 16: 2, 32: 1, 64: 1}
    for length in LENGTHS:
        starts = [start for longer in LENGTHS if longer >= length for start in clip_starts(longer)]
        assert sorted(starts) == list(range(0, 64, length))


@pytest.mark.parametrize("kind", [torch.float32, torch.float64])
def test_features_are_the_bits_of_clip_by_clip_in_order_of_time(encoders, motions, kind):
    single = copy.deepcopy(encoders).to(kind)
    motions = motions.to(kind)
    found = clip_features(single, motions, ROOT)
    assert set(found) == {(frames, length) for frames in (16, 32, 64) for length in LENGTHS}
    for length in LENGTHS:
        for key, plain in clip_by_clip(single, motions, length).items():
            assert torch.equal(found[key], plain), key


def test_a_motion_keeps_its_place_among_however_many(encoders, motions):
    many = motions[:1].expand(300, -1, -1, -1).clone()
    many[270] = motions[5]
    found, alone = (clip_features(encoders, x, ROOT) for x in (many, motions[5:6]))
    for key, features in alone.items():
        assert torch.allclose(found[key][270], features[0], atol=1e-12), key
        assert not torch.allclose(found[key][269], features[0], atol=1e-6), key


@pytest.mark.parametrize(("kind", "coarse"), [(torch.float64, 0), (torch.bfloat16, 0.05), (torch.float16, 0.01)])
def test_joints_of_any_float_type_go_into_encoders_of_theirs(encoders, motions, kind, coarse):
    single = copy.deepcopy(encoders).float()
    found, plain = (clip_features(single, x, ROOT) for x in (motions.to(kind), motions.float()))
    for key, features in found.items():
        assert features.dtype == torch.float32
        assert (features - plain[key]).abs().max() <= coarse + 1e-6


def test_a_run_in_half_precision_has_the_same_features(encoders, motions):
    single = copy.deepcopy(encoders).float()
    plain = clip_features(single, motions.float(), ROOT)
    with torch.autocast("cpu", torch.bfloat16):
        assert all(torch.equal(found, plain[key]) for key, found in clip_features(single, motions, ROOT).items())


def test_the_given_frame_and_the_place_are_left_out(encoders, motions):
    moved = motions + torch.tensor([3.0, 0, -1])
    moved[:, 0] = 0
    plain = clip_features(encoders, motions, ROOT)
    assert all(torch.allclose(x, plain[key], atol=1e-12) for key, x in clip_features(encoders, moved, ROOT).items())


def test_refuses(encoders, motions):
    with pytest.raises(SagError, match="65 frames of 19 joints, not 65 frames of 16 joints"):
        clip_features(encoders, motions[:, :, :16], ROOT)
    with pytest.raises(SagError, match="not 64 frames"):
        clip_features(encoders, motions[:, 1:], ROOT)
    broken = motions.clone()
    broken[3, 5] = torch.nan
    with pytest.raises(SagError, match="not finite"):
        clip_features(encoders, broken, ROOT)
